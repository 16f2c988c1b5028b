//! TIM11 with the crystal's clock at its input: captures of every eighth edge (RM0090, chapter 19).

use crate::time::Time;

/// The crystal's clock is the input: TI1_RMP.
const CRYSTAL_INPUT: u32 = 2;
/// Capture on channel 1 from its own input, after eight edges.
const EIGHTH_EDGE: u32 = 1 | 3 << 2;

const CAPTURED: u32 = 1 << 1;
const MISSED: u32 = 1 << 9;

#[derive(Clone, Debug, Default)]
pub(crate) struct CrystalCapture {
    control: u32,
    mode: u32,
    enable: u32,
    option: u32,
    status: u32,
    capture: u32,
    /// Time at which the counter was 0.
    start: Time,
    /// Time of the capture before the next one.
    last: Time,
}

impl CrystalCapture {
    fn runs(&self) -> bool {
        let set = (self.control & 1, self.enable & 1, self.option & 3);
        set == (1, 1, CRYSTAL_INPUT) && self.mode & 0xFF == EIGHTH_EDGE
    }

    /// Captures edges up to `now`, of a clock of the counter and one at the input with these periods; none without a crystal.
    fn advance(&mut self, now: Time, clock: Time, input: Option<Time>) {
        let Some(input) = input.filter(|_| self.runs()) else {
            return;
        };
        while self.last + 8 * input <= now {
            self.last += 8 * input;
            if self.status & CAPTURED != 0 {
                self.status |= MISSED;
            }
            self.status |= CAPTURED;
            self.capture = ((self.last - self.start) / clock) as u32 & 0xFFFF;
        }
    }

    pub(crate) fn read(
        &mut self,
        offset: u32,
        now: Time,
        clock: Time,
        input: Option<Time>,
    ) -> Option<u32> {
        self.advance(now, clock, input);
        Some(match offset {
            0x00 => self.control,
            0x10 => self.status,
            0x18 => self.mode,
            0x20 => self.enable,
            0x34 => {
                self.status &= !CAPTURED;
                self.capture
            }
            0x50 => self.option,
            _ => return None,
        })
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32, now: Time) -> bool {
        match offset {
            0x00 => {
                if value & !self.control & 1 != 0 {
                    (self.start, self.last) = (now, now);
                }
                self.control = value;
            }
            0x10 => self.status &= value,
            0x18 => self.mode = value,
            0x20 => self.enable = value,
            0x50 => self.option = value,
            _ => return false,
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::{MICROSECOND, period};

    #[test]
    fn the_difference_of_two_captures_is_that_of_the_edges_and_a_late_reader_misses_one() {
        let mut timer = CrystalCapture::default();
        for (offset, value) in [(0x50, 2), (0x18, EIGHTH_EDGE), (0x20, 1), (0x00, 1)] {
            assert!(timer.write(offset, value, 0));
        }
        // 16 MHz count, and 1 MHz comes in: 128 counts between captures.
        let (clock, input) = (period(16_000_000), Some(period(1_000_000)));
        let status = |timer: &mut CrystalCapture, now| timer.read(0x10, now, clock, input);
        assert_eq!(status(&mut timer, 8 * MICROSECOND - 1), Some(0));
        assert_eq!(status(&mut timer, 8 * MICROSECOND), Some(CAPTURED));
        assert_eq!(timer.read(0x34, 9 * MICROSECOND, clock, input), Some(128));
        assert_eq!(
            status(&mut timer, 24 * MICROSECOND),
            Some(CAPTURED | MISSED)
        );
        assert_eq!(timer.read(0x34, 24 * MICROSECOND, clock, input), Some(384));
        assert_eq!(timer.read(0x34, 99 * MICROSECOND, clock, None), Some(384));
    }
}
