//! Frames and bit timing of classic CAN, for controllers with a driver of the board's own.

use embedded_can::{Frame, Id};

/// Frame of up to eight bytes, or a remote frame that asks for one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ClassicFrame {
    id: Id,
    length: u8,
    remote: bool,
    /// Zeros behind the length.
    data: [u8; 8],
}

impl ClassicFrame {
    /// Data frame from a controller's registers: the first `length` bytes of `data`, at most eight.
    pub fn of(id: Id, length: u8, data: [u8; 8]) -> Self {
        let length = length.min(8);
        let mut kept = [0; 8];
        for (place, byte) in kept.iter_mut().zip(data).take(length.into()) {
            *place = byte;
        }
        Self {
            id,
            length,
            remote: false,
            data: kept,
        }
    }

    /// Bytes as two words, the first byte lowest, zeros behind the [length](Frame::dlc).
    #[inline(always)]
    pub fn words(&self) -> [u32; 2] {
        let [a, b, c, d, e, f, g, h] = self.data;
        [
            u32::from_le_bytes([a, b, c, d]),
            u32::from_le_bytes([e, f, g, h]),
        ]
    }
}

impl Frame for ClassicFrame {
    #[inline(always)]
    fn new(id: impl Into<Id>, data: &[u8]) -> Option<Self> {
        let mut kept = [0; 8];
        kept.get_mut(..data.len())?.copy_from_slice(data);
        Some(Self {
            id: id.into(),
            length: data.len() as u8,
            remote: false,
            data: kept,
        })
    }

    fn new_remote(id: impl Into<Id>, length: usize) -> Option<Self> {
        (length <= 8).then(|| Self {
            id: id.into(),
            length: length as u8,
            remote: true,
            data: [0; 8],
        })
    }

    fn is_extended(&self) -> bool {
        matches!(self.id, Id::Extended(_))
    }

    #[inline(always)]
    fn is_remote_frame(&self) -> bool {
        self.remote
    }

    #[inline(always)]
    fn id(&self) -> Id {
        self.id
    }

    #[inline(always)]
    fn dlc(&self) -> usize {
        self.length.into()
    }

    fn data(&self) -> &[u8] {
        let length = if self.remote { 0 } else { self.length.into() };
        self.data.get(..length).unwrap_or(&[])
    }
}

/// One bit on the bus in time quanta: one to synchronise, then those before and those after the sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BitTiming {
    /// Cycles of the controller's clock per quantum.
    pub prescaler: u32,
    /// Quanta from the synchronisation to the sample, at most 16 in classic CAN.
    pub before_sample: u8,
    /// Quanta from the sample to the end of the bit, at most 8 in classic CAN.
    pub after_sample: u8,
}

impl BitTiming {
    /// Timing of exactly `bit_rate_hz` from a clock of `clock_hz`, sampled near 7/8 of the bit, in eight to
    /// sixteen quanta. `None` if the clock is no multiple of the rate.
    pub const fn new(clock_hz: u32, bit_rate_hz: u32) -> Option<Self> {
        let mut quanta = 16;
        while quanta >= 8 {
            let rate = bit_rate_hz.saturating_mul(quanta);
            if rate > 0 && clock_hz.is_multiple_of(rate) && clock_hz / rate <= 1024 {
                let after = (quanta + 4) / 8;
                return Some(Self {
                    prescaler: clock_hz / rate,
                    before_sample: (quanta - 1 - after) as u8,
                    after_sample: after as u8,
                });
            }
            quanta -= 1;
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use embedded_can::StandardId;

    #[test]
    fn a_frame_keeps_its_bytes() {
        let id = StandardId::new(0x2C).unwrap();
        let bytes = [1, 2, 3, 4, 5, 6, 7, 8];
        let frame = ClassicFrame::new(id, &bytes).unwrap();
        assert_eq!(frame.words(), [0x0403_0201, 0x0807_0605]);
        assert_eq!((frame.data(), frame.dlc()), (&bytes[..], 8));
        let short = ClassicFrame::new(id, &bytes[..5]).unwrap();
        assert_eq!(short.words(), [0x0403_0201, 5]);
        assert_eq!(short, ClassicFrame::of(id.into(), 5, bytes));
        assert_eq!(short.data(), &bytes[..5]);
        assert_eq!(ClassicFrame::new(id, &[0; 9]), None);
        assert_eq!(ClassicFrame::new(id, &[]).unwrap().data(), &[0; 0]);
        let remote = ClassicFrame::new_remote(id, 8).unwrap();
        assert_eq!((remote.is_remote_frame(), remote.dlc()), (true, 8));
        assert_eq!(remote.data(), &[0; 0]);
        assert_eq!(ClassicFrame::new_remote(id, 9), None);
    }

    #[test]
    fn bits_take_exactly_their_time() {
        for clock in [42_000_000, 16_000_000, 36_000_000] {
            for rate in [125_000, 250_000, 500_000, 1_000_000] {
                let bit = BitTiming::new(clock, rate).unwrap();
                let quanta = 1 + u32::from(bit.before_sample) + u32::from(bit.after_sample);
                assert_eq!(bit.prescaler * quanta * rate, clock);
                let sample = f64::from(1 + bit.before_sample) / f64::from(quanta);
                assert!((0.8..=0.9).contains(&sample), "{clock} {rate}: {sample}");
                assert!(bit.before_sample <= 16 && bit.after_sample <= 8);
            }
        }
        assert_eq!(BitTiming::new(16_000_000, 300_000), None);
        assert_eq!(BitTiming::new(16_000_000, 0), None);
    }
}
