//! Interrupt controller, system control block and SysTick of a Cortex-M4 (ARMv7-M reference manual, B3).

use crate::time::Time;

/// Numbers of exceptions.
pub(crate) const NMI: u16 = 2;
pub(crate) const HARD_FAULT: u16 = 3;
const PEND_SV: u16 = 14;
pub(crate) const SYS_TICK: u16 = 15;
/// Number of the first interrupt of the chip.
pub(crate) const FIRST_INTERRUPT: u16 = 16;

/// Interrupts of the STM32F405.
const INTERRUPTS: u16 = 82;

/// Bits of a priority that the chip has.
const PRIORITY_BITS: u8 = 0xF0;

/// Priority of code that no exception runs.
const THREAD: u16 = 256;

#[derive(Clone, Debug)]
pub(crate) struct Interrupts {
    enabled: [u32; 3],
    /// Pending by software, or by an edge.
    pended: [u32; 3],
    /// Lines of peripherals.
    lines: [u32; 3],
    priorities: [u8; INTERRUPTS as usize],
    /// Priorities of the exceptions 4 to 15.
    system: [u8; 12],
    /// The crystal has stopped.
    fails: bool,
    tick_pended: bool,
    software_pended: bool,
    /// Exceptions that are being handled, the last one on top.
    active: Vec<u16>,
    vectors: u32,
    control: [u32; 3],
    pub(crate) fault_status: u32,
    pub(crate) hard_fault_status: u32,
    pub(crate) fault_address: u32,
    pub(crate) tick: SysTick,
}

#[derive(Clone, Debug, Default)]
pub(crate) struct SysTick {
    control: u32,
    reload: u32,
    /// Time at which the counter was 0.
    start: Time,
    /// Time up to which it has counted.
    wraps: u64,
}

impl SysTick {
    fn period(&self, core: Time) -> Time {
        core * (Time::from(self.reload) + 1)
    }

    pub(crate) fn next(&self, core: Time) -> Option<Time> {
        let on = self.control & 3 == 3;
        on.then(|| self.start + self.period(core))
    }

    /// Counts on. Returns true if the counter has reached 0 with its interrupt on.
    fn advance(&mut self, now: Time, core: Time) -> bool {
        let mut wrapped = false;
        while self.control & 1 != 0 && now >= self.start + self.period(core) {
            self.start += self.period(core);
            self.wraps += 1;
            wrapped = true;
        }
        wrapped && self.control & 2 != 0
    }

    fn current(&self, now: Time, core: Time) -> u32 {
        if self.control & 1 == 0 {
            return 0;
        }
        // An interrupt may go back by a part of a block.
        let counts = now.saturating_sub(self.start) / core;
        match counts {
            0 => 0,
            _ => (Time::from(self.reload) + 1 - counts) as u32,
        }
    }
}

/// Effect of a write that others have to carry out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Effect {
    None,
    Reset,
    /// No such register.
    Unknown,
}

impl Interrupts {
    pub(crate) fn new() -> Self {
        Self {
            enabled: [0; 3],
            pended: [0; 3],
            lines: [0; 3],
            priorities: [0; INTERRUPTS as usize],
            system: [0; 12],
            fails: false,
            tick_pended: false,
            software_pended: false,
            active: Vec::new(),
            vectors: 0,
            control: [0, 0x200, 0],
            fault_status: 0,
            hard_fault_status: 0,
            fault_address: 0,
            tick: SysTick::default(),
        }
    }

    /// Sets the line of an interrupt.
    pub(crate) fn set_line(&mut self, interrupt: u16, high: bool) {
        let (word, bit) = (usize::from(interrupt / 32), 1 << (interrupt % 32));
        match high {
            true => self.lines[word] |= bit,
            false => self.lines[word] &= !bit,
        }
    }

    /// Pends the exception that nothing masks.
    pub(crate) fn fail(&mut self) {
        self.fails = true;
    }

    pub(crate) fn advance(&mut self, now: Time, core: Time) {
        self.tick_pended |= self.tick.advance(now, core);
    }

    /// Exception that is being handled, 0 for none.
    pub(crate) fn handled(&self) -> u16 {
        self.active.last().copied().unwrap_or(0)
    }

    /// Returns true if HardFault is being handled: another fault locks the processor up.
    pub(crate) fn is_in_hard_fault(&self) -> bool {
        self.active
            .iter()
            .any(|active| [NMI, HARD_FAULT].contains(active))
    }

    fn priority(&self, exception: u16) -> u16 {
        match exception {
            NMI => 0,
            HARD_FAULT => 1,
            4..=15 => 2 + u16::from(self.system[usize::from(exception) - 4] & PRIORITY_BITS),
            _ => {
                let interrupt = usize::from(exception - FIRST_INTERRUPT);
                2 + u16::from(self.priorities[interrupt] & PRIORITY_BITS)
            }
        }
    }

    fn is_pending(&self, exception: u16) -> bool {
        match exception {
            NMI => self.fails,
            PEND_SV => self.software_pended,
            SYS_TICK => self.tick_pended,
            _ => {
                let interrupt = exception - FIRST_INTERRUPT;
                let (word, bit) = (usize::from(interrupt / 32), 1 << (interrupt % 32));
                // A line that is still high pends again after its handler, not during it.
                let line = self.lines[word] & bit != 0 && !self.active.contains(&exception);
                self.enabled[word] & bit != 0 && (self.pended[word] & bit != 0 || line)
            }
        }
    }

    /// Returns true if any exception is pending, whether it may preempt or not.
    fn any_pending(&self) -> bool {
        let masked = |word: usize| self.enabled[word] & (self.pended[word] | self.lines[word]);
        self.fails
            || self.tick_pended
            || self.software_pended
            || (0..3).any(|word| masked(word) != 0)
    }

    /// Returns the exception that preempts what runs now, if the masks let it.
    pub(crate) fn due(&self) -> Option<u16> {
        if !self.any_pending() {
            return None;
        }
        let running = self
            .active
            .iter()
            .map(|active| self.priority(*active))
            .min();
        let running = running.unwrap_or(THREAD);
        let all = [NMI, PEND_SV, SYS_TICK]
            .into_iter()
            .chain(FIRST_INTERRUPT..FIRST_INTERRUPT + INTERRUPTS);
        all.filter(|exception| self.is_pending(*exception))
            .min_by_key(|exception| (self.priority(*exception), *exception))
            .filter(|exception| self.priority(*exception) < running)
    }

    /// Returns true if `exception` passes the mask of priorities, of which 0 masks nothing.
    pub(crate) fn passes(&self, exception: u16, base_priority: u32) -> bool {
        base_priority == 0 || u32::from(self.priority(exception) - 2) < base_priority & 0xF0
    }

    pub(crate) fn enter(&mut self, exception: u16) {
        match exception {
            NMI => self.fails = false,
            PEND_SV => self.software_pended = false,
            SYS_TICK => self.tick_pended = false,
            FIRST_INTERRUPT.. => {
                let interrupt = exception - FIRST_INTERRUPT;
                self.pended[usize::from(interrupt / 32)] &= !(1 << (interrupt % 32));
            }
            _ => {}
        }
        self.active.push(exception);
    }

    pub(crate) fn leave(&mut self) -> Option<u16> {
        self.active.pop()
    }

    /// Returns the address of the vector of an exception.
    pub(crate) fn vector(&self, exception: u16) -> u32 {
        self.vectors + 4 * u32::from(exception)
    }

    pub(crate) fn set_vectors(&mut self, address: u32) {
        self.vectors = address;
    }

    pub(crate) fn read(&self, offset: u32, now: Time, core: Time) -> Option<u32> {
        let word = |start: u32| ((offset - start) / 4) as usize;
        let bytes = |from: &[u8], start: u32| {
            let at = (offset - start) as usize;
            let mut word = [0; 4];
            for (byte, place) in word.iter_mut().enumerate() {
                *place = from.get(at + byte).copied().unwrap_or(0);
            }
            u32::from_le_bytes(word)
        };
        Some(match offset {
            0x010 => self.tick.control,
            0x014 => self.tick.reload,
            0x018 => self.tick.current(now, core),
            0x01C => 0,
            0x100..=0x108 => self.enabled[word(0x100)],
            0x180..=0x188 => self.enabled[word(0x180)],
            0x200..=0x208 => self.pended[word(0x200)] | self.lines[word(0x200)],
            0x280..=0x288 => self.pended[word(0x280)] | self.lines[word(0x280)],
            0x400..=0x451 => bytes(&self.priorities, 0x400),
            0xD00 => 0x410F_C241,
            0xD04 => {
                let pending = |is: bool, bit: u32| u32::from(is) << bit;
                pending(self.tick_pended, 26)
                    | pending(self.software_pended, 28)
                    | u32::from(self.handled())
            }
            0xD08 => self.vectors,
            0xD0C => 0xFA05_0000,
            0xD10 => self.control[0],
            0xD14 => self.control[1],
            0xD18..=0xD23 => bytes(&self.system, 0xD18),
            0xD24 => 0,
            0xD28 => self.fault_status,
            0xD2C => self.hard_fault_status,
            0xD34 | 0xD38 => self.fault_address,
            0xD88 => self.control[2],
            _ => return None,
        })
    }

    /// Writes a register; those of priorities by bytes, too.
    pub(crate) fn write(&mut self, offset: u32, size: usize, value: u32, now: Time) -> Effect {
        let word = |start: u32| ((offset - start) / 4) as usize;
        match offset {
            0x010 => {
                if value & !self.tick.control & 1 != 0 {
                    self.tick.start = now;
                }
                self.tick.control = value & 7;
            }
            0x014 => self.tick.reload = value & 0x00FF_FFFF,
            0x018 => self.tick.start = now,
            0x100..=0x108 => self.enabled[word(0x100)] |= value,
            0x180..=0x188 => self.enabled[word(0x180)] &= !value,
            0x200..=0x208 => self.pended[word(0x200)] |= value,
            0x280..=0x288 => self.pended[word(0x280)] &= !value,
            0x400..=0x451 => put(&mut self.priorities, (offset - 0x400) as usize, size, value),
            0xD04 => {
                // Bits 25 to 28: clear and set of the tick's, clear and set of the software's.
                self.tick_pended = self.tick_pended && value & 1 << 25 == 0 || value & 1 << 26 != 0;
                self.software_pended =
                    self.software_pended && value & 1 << 27 == 0 || value & 1 << 28 != 0;
            }
            0xD08 => self.vectors = value,
            // The key, and the request.
            0xD0C if value >> 16 == 0x05FA && value & 4 != 0 => return Effect::Reset,
            0xD0C => {}
            0xD10 => self.control[0] = value,
            0xD14 => self.control[1] = value,
            0xD18..=0xD23 => put(&mut self.system, (offset - 0xD18) as usize, size, value),
            0xD28 => self.fault_status &= !value,
            0xD2C => self.hard_fault_status &= !value,
            0xD88 => self.control[2] = value,
            _ => return Effect::Unknown,
        }
        Effect::None
    }
}

fn put(to: &mut [u8], at: usize, size: usize, value: u32) {
    for (place, byte) in to.iter_mut().skip(at).zip(value.to_le_bytes()).take(size) {
        *place = byte;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with(priorities: &[(u16, u8)]) -> Interrupts {
        let mut interrupts = Interrupts::new();
        for (interrupt, priority) in priorities {
            let at = 0x400 + u32::from(*interrupt);
            interrupts.write(at, 1, u32::from(*priority), 0);
            let (word, bit) = (u32::from(interrupt / 32), 1 << (interrupt % 32));
            interrupts.write(0x100 + 4 * word, 4, bit, 0);
        }
        interrupts
    }

    #[test]
    fn the_lower_number_preempts_and_an_equal_one_waits() {
        let mut interrupts = with(&[(38, 0xE0), (55, 0xC0), (20, 0xE0)]);
        for interrupt in [38, 20] {
            interrupts.set_line(interrupt, true);
        }
        // Of equal ones the lower interrupt.
        assert_eq!(interrupts.due(), Some(16 + 20));
        interrupts.enter(16 + 20);
        assert_eq!(interrupts.due(), None);
        interrupts.set_line(55, true);
        assert_eq!(interrupts.due(), Some(16 + 55));
        interrupts.enter(16 + 55);
        interrupts.set_line(55, false);
        assert_eq!(interrupts.leave(), Some(16 + 55));
        assert_eq!(interrupts.due(), None);
        interrupts.set_line(20, false);
        interrupts.leave();
        assert_eq!(interrupts.due(), Some(16 + 38));
    }

    #[test]
    fn a_line_that_stays_high_pends_again_after_its_handler() {
        let mut interrupts = with(&[(38, 0xE0)]);
        interrupts.set_line(38, true);
        interrupts.enter(16 + 38);
        assert_eq!(interrupts.due(), None);
        interrupts.leave();
        assert_eq!(interrupts.due(), Some(16 + 38));
    }

    #[test]
    fn the_tick_comes_every_reload_and_one_counts() {
        let mut interrupts = Interrupts::new();
        for (offset, value) in [(0x014, 999), (0x018, 0), (0x010, 7)] {
            interrupts.write(offset, 4, value, 0);
        }
        assert_eq!(interrupts.tick.next(6), Some(6000));
        assert_eq!(interrupts.read(0x018, 6, 6), Some(999));
        assert_eq!(interrupts.read(0x018, 5999, 6), Some(1));
        interrupts.advance(6000, 6);
        assert_eq!(interrupts.due(), Some(SYS_TICK));
        assert_eq!(interrupts.read(0xD04, 6000, 6), Some(1 << 26));
    }

    #[test]
    fn base_priority_masks_equal_and_lower_ones() {
        let interrupts = with(&[(38, 0xE0), (55, 0xC0)]);
        assert!(interrupts.passes(16 + 55, 0xD0) && !interrupts.passes(16 + 38, 0xD0));
        assert!(!interrupts.passes(16 + 55, 0xC0) && interrupts.passes(16 + 38, 0));
    }

    #[test]
    fn a_reset_needs_its_key() {
        let mut interrupts = Interrupts::new();
        assert_eq!(interrupts.write(0xD0C, 4, 4, 0), Effect::None);
        assert_eq!(interrupts.write(0xD0C, 4, 0x05FA_0004, 0), Effect::Reset);
    }
}
