//! Frames of a simulated bus, and the time that they take.

use embedded_can::{ExtendedId, Frame, Id, StandardId};

/// Frame of up to `LONGEST` bytes: 8 in classic CAN, 64 in CAN FD.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BusFrame<const LONGEST: usize> {
    id: Id,
    data: Vec<u8>,
    /// Bytes that a remote frame asks for.
    asked: Option<usize>,
}

impl<const LONGEST: usize> Frame for BusFrame<LONGEST> {
    fn new(id: impl Into<Id>, data: &[u8]) -> Option<Self> {
        (data.len() <= LONGEST).then(|| Self {
            id: id.into(),
            data: data.into(),
            asked: None,
        })
    }

    fn new_remote(id: impl Into<Id>, length: usize) -> Option<Self> {
        (length <= 8).then(|| Self {
            id: id.into(),
            data: Vec::new(),
            asked: Some(length),
        })
    }

    fn is_extended(&self) -> bool {
        matches!(self.id, Id::Extended(_))
    }

    fn is_remote_frame(&self) -> bool {
        self.asked.is_some()
    }

    fn id(&self) -> Id {
        self.id
    }

    fn dlc(&self) -> usize {
        self.asked.unwrap_or(self.data.len())
    }

    fn data(&self) -> &[u8] {
        &self.data
    }
}

/// Bits after the checksum: its delimiter, the acknowledgement, the end, the space to the next frame.
const TAIL: usize = 13;

/// Polynomial of the checksum of classic CAN, x^15 left out.
const CRC15: u16 = 0x4599;

/// Rate in the data of a CAN FD frame, Hz.
const FAST_HZ: u64 = 5_000_000;

impl<const LONGEST: usize> BusFrame<LONGEST> {
    /// Frame with an eleven-bit identifier, or a longer one where that is too short for `id`.
    pub(super) fn from(id: u32, data: &[u8]) -> Option<Self> {
        let standard = u16::try_from(id)
            .ok()
            .and_then(StandardId::new)
            .map(Id::Standard);
        let id = standard.or_else(|| ExtendedId::new(id).map(Id::Extended))?;
        Self::new(id, data)
    }

    /// Rank in an arbitration: the lower goes first, a data frame before the remote frame that asks for it.
    pub(super) fn rank(&self) -> (u32, bool) {
        let id = match self.id {
            Id::Standard(id) => u32::from(id.as_raw()) << 18,
            Id::Extended(id) => id.as_raw(),
        };
        (id, self.is_remote_frame())
    }

    /// Time on a bus of `bit_rate_hz`, with the space behind it, ns. A frame of classic CAN takes exactly its bits,
    /// stuffing included; of CAN FD the most that they can be.
    pub fn duration_ns(&self, bit_rate_hz: u32) -> u64 {
        let rate = u64::from(bit_rate_hz.max(1));
        if LONGEST <= 8 {
            return self.classic_bits() as u64 * 1_000_000_000 / rate;
        }
        // 32 bits up to the switch of the rate and 13 after the checksum, stuffing of one in four; the length, the data
        // and a checksum of 21 bits between them.
        let slow = (32 * 5 / 4 + TAIL) as u64;
        let fast = (5 + 8 * self.data.len() as u64 + 21) * 5 / 4;
        slow * 1_000_000_000 / rate + fast * 1_000_000_000 / FAST_HZ
    }

    /// Bits of the frame in classic CAN.
    fn classic_bits(&self) -> usize {
        let mut bits = vec![false];
        let mut push = |value: u32, number: u32| {
            for at in (0..number).rev() {
                bits.push(value >> at & 1 == 1);
            }
        };
        let remote = u32::from(self.is_remote_frame());
        match self.id {
            Id::Standard(id) => {
                push(id.as_raw().into(), 11);
                push(remote << 2, 3);
            }
            Id::Extended(id) => {
                push(id.as_raw() >> 18, 11);
                push(0b11, 2);
                push(id.as_raw() & 0x3_FFFF, 18);
                push(remote << 2, 3);
            }
        }
        push(self.dlc() as u32, 4);
        for byte in &self.data {
            push((*byte).into(), 8);
        }
        let mut crc: u16 = 0;
        for bit in &bits {
            let out = crc >> 14 & 1 == 1;
            crc = crc << 1 & 0x7FFF;
            if out != *bit {
                crc ^= CRC15;
            }
        }
        for at in (0..15).rev() {
            bits.push(crc >> at & 1 == 1);
        }
        bits.len() + stuffed(&bits) + TAIL
    }
}

/// Bits that are stuffed into `bits`: one after five alike, which counts itself.
fn stuffed(bits: &[bool]) -> usize {
    let (mut last, mut alike, mut stuffed) = (None, 0, 0);
    for bit in bits {
        alike = if last == Some(*bit) { alike + 1 } else { 1 };
        last = Some(*bit);
        if alike == 5 {
            stuffed += 1;
            (last, alike) = (Some(!bit), 1);
        }
    }
    stuffed
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bits(id: u16, data: &[u8]) -> usize {
        let id = StandardId::new(id).expect("eleven bits");
        BusFrame::<8>::new(id, data)
            .expect("eight bytes")
            .classic_bits()
    }

    /// Bounds by the formula of Tindell, Burns and Wellings: 8 n + 47 bits, and up to (34 + 8 n - 1) / 4 stuffed ones.
    #[test]
    fn frames_take_their_bits() {
        for length in 0..=8 {
            let (least, most) = (8 * length + 47, 8 * length + 47 + (33 + 8 * length) / 4);
            for fill in [0x00, 0xFF, 0x55, 0xAA, 0x0F, 0x3C] {
                for id in [0, 0x2C, 0x555, 0x7FF] {
                    let found = bits(id, &vec![fill; length]);
                    assert!((least..=most).contains(&found), "{id:x} {fill:x}: {found}");
                }
            }
        }
        // 0x555 and bytes of 0x55 leave next to nothing to stuff; zeros nearly the most.
        assert!(bits(0x555, &[0x55; 8]) <= 113 && bits(0, &[0; 8]) >= 127);
        // Five alike, then the stuffed bit begins the next five.
        assert_eq!(
            [
                stuffed(&[true; 4]),
                stuffed(&[true; 5]),
                stuffed(&[false; 10])
            ],
            [0, 1, 2]
        );
        let id = StandardId::new(0x2C).expect("eleven bits");
        let frame = BusFrame::<8>::new(id, &[0; 8]).expect("eight bytes");
        assert_eq!(
            frame.duration_ns(500_000),
            frame.classic_bits() as u64 * 2000
        );
    }
}
