//! Frames and bit timing of CAN FD, for controllers with a driver of the board's own.

use super::BitTiming;
use embedded_can::{Frame, Id};

/// Lengths of frames by their codes.
const LENGTHS: [u8; 16] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 20, 24, 32, 48, 64];

/// Code of a frame of `length` bytes; none if no frame is so long.
pub fn length_code(length: usize) -> Option<u8> {
    let is_it = |of: &u8| usize::from(*of) == length;
    LENGTHS.iter().position(is_it).map(|code| code as u8)
}

/// Bytes of a frame with this code, of which four bits count.
pub fn length_of(code: u8) -> usize {
    let length = LENGTHS.get(usize::from(code & 0xF));
    length.map_or(0, |length| usize::from(*length))
}

/// Frame of up to 64 bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FdFrame {
    id: Id,
    length: u8,
    data: [u8; 64],
}

impl Frame for FdFrame {
    /// Refuses lengths between those that a frame can have.
    #[inline(always)]
    fn new(id: impl Into<Id>, data: &[u8]) -> Option<Self> {
        length_code(data.len())?;
        let mut kept = [0; 64];
        kept.get_mut(..data.len())?.copy_from_slice(data);
        Some(Self {
            id: id.into(),
            length: data.len() as u8,
            data: kept,
        })
    }

    /// None: CAN FD has no remote frames.
    fn new_remote(_: impl Into<Id>, _: usize) -> Option<Self> {
        None
    }

    fn is_extended(&self) -> bool {
        matches!(self.id, Id::Extended(_))
    }

    fn is_remote_frame(&self) -> bool {
        false
    }

    #[inline(always)]
    fn id(&self) -> Id {
        self.id
    }

    /// Number of bytes.
    #[inline(always)]
    fn dlc(&self) -> usize {
        self.length.into()
    }

    #[inline(always)]
    fn data(&self) -> &[u8] {
        self.data.get(..self.length.into()).unwrap_or(&[])
    }
}

/// Bits of frames that switch their rate in the data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FdTiming {
    /// Outside the data.
    pub nominal: BitTiming,
    /// In the data.
    pub data: BitTiming,
    /// Cycles of the controller's clock from the begin of a bit in the data to its sample: at most 127. The transmitter adds them to
    /// the measured delay of its transceiver.
    pub compensation: u8,
}

impl FdTiming {
    /// Timing of exactly these rates from a clock of `clock_hz`, sampled near 2/3 of a bit: where moteus samples. `None` if the clock
    /// is no multiple of a rate, or the delay of the transceiver could not be compensated.
    pub const fn new(clock_hz: u32, nominal_hz: u32, data_hz: u32) -> Option<Self> {
        let (Some(nominal), Some(data)) = (
            sampled_at_two_thirds(clock_hz, nominal_hz, 255, 128),
            sampled_at_two_thirds(clock_hz, data_hz, 32, 16),
        ) else {
            return None;
        };
        let compensation = data.prescaler * (1 + data.before_sample as u32);
        // The controller measures the delay only with these prescalers (RM0440, 44.3.3).
        if data.prescaler > 2 || compensation > 127 {
            return None;
        }
        Some(Self {
            nominal,
            data,
            compensation: compensation as u8,
        })
    }
}

/// Timing with the most quanta that the fields of a controller take.
const fn sampled_at_two_thirds(
    clock_hz: u32,
    bit_rate_hz: u32,
    before_max: u32,
    after_max: u32,
) -> Option<BitTiming> {
    let mut prescaler = 1;
    while prescaler <= 32 {
        let step = bit_rate_hz.saturating_mul(prescaler);
        if step > 0 && clock_hz.is_multiple_of(step) && clock_hz / step >= 8 {
            let quanta = clock_hz / step;
            let after = (quanta - 1) / 3;
            let before = quanta - 1 - after;
            if before <= before_max && after <= after_max {
                return Some(BitTiming {
                    prescaler,
                    before_sample: before as u8,
                    after_sample: after as u8,
                });
            }
        }
        prescaler += 1;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use embedded_can::ExtendedId;

    #[test]
    fn a_frame_keeps_its_bytes_and_has_a_length_of_the_standard() {
        let id = ExtendedId::new(0x8001).unwrap();
        let bytes: Vec<u8> = (1..=24).collect();
        let frame = FdFrame::new(id, &bytes).unwrap();
        assert_eq!((frame.data(), frame.dlc()), (&bytes[..], 24));
        assert!(frame.is_extended() && !frame.is_remote_frame());
        for length in [9, 11, 23, 25, 63, 65] {
            assert_eq!(FdFrame::new(id, &vec![0; length]), None, "{length}");
        }
        assert_eq!(FdFrame::new_remote(id, 8), None);
        for code in 0..16 {
            assert_eq!(length_code(length_of(code)), Some(code));
        }
        assert_eq!((length_of(0xF), length_of(0x1C)), (64, 24));
    }

    #[test]
    fn bits_take_exactly_their_time_and_are_sampled_where_moteus_does() {
        let timing = FdTiming::new(170_000_000, 1_000_000, 5_000_000).unwrap();
        for (bit, rate) in [(timing.nominal, 1_000_000), (timing.data, 5_000_000)] {
            let quanta = 1 + u32::from(bit.before_sample) + u32::from(bit.after_sample);
            assert_eq!(bit.prescaler * quanta * rate, 170_000_000);
            let sample = f64::from(1 + bit.before_sample) / f64::from(quanta);
            assert!((0.66..0.69).contains(&sample), "{rate}: {sample}");
        }
        // 113 and 56, 22 and 11: those of the firmware of moteus on the same clock.
        assert_eq!(
            (timing.nominal.before_sample, timing.nominal.after_sample),
            (113, 56)
        );
        assert_eq!(
            (timing.data.before_sample, timing.data.after_sample),
            (22, 11)
        );
        assert_eq!(timing.compensation, 23);
        // 24 MHz are no multiple of 5 MHz; 16 MHz have too few cycles in a bit.
        assert_eq!(FdTiming::new(24_000_000, 1_000_000, 5_000_000), None);
        assert_eq!(FdTiming::new(16_000_000, 1_000_000, 4_000_000), None);
        assert_eq!(FdTiming::new(170_000_000, 0, 5_000_000), None);
    }
}
