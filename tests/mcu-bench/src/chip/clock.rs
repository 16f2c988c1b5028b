//! Reset and clock control: crystal, PLL, dividers, flags of the reset (RM0090, chapter 7).

use crate::time::{MS, SECOND, Time, period};

/// Clock of the internal oscillator, Hz.
const HSI_HZ: u64 = 16_000_000;

/// Part by which it may be off at room temperature, by its data sheet. Only USB asks for less.
const HSI_ERROR: f64 = 0.01;

/// Time until the crystal is ready, of one that starts.
const CRYSTAL_START: Time = 2 * MS;

/// Time until the PLL is locked: the data sheet's longest.
const LOCK: Time = 3 * MS / 10;

/// Clock of the core from a PLL whose crystal has stopped, Hz: its oscillator goes on at its lowest. Reports of other STM32s have a twentieth of
/// the clock (`docs/board.md`, clock).
const FREE_RUN_HZ: u64 = 8_000_000;

/// Crystal of the board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Crystal {
    /// Starts, with this clock in MHz.
    Runs { mhz: u32 },
    /// None, or one that does not start.
    Missing,
}

/// Cause of a reset, as the flags tell it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ResetCause {
    Power,
    /// The reset pin.
    Pin,
    /// The supply fell below the level of the brown-out reset.
    BrownOut,
    Watchdog,
    /// The program asked for it.
    Software,
}

impl ResetCause {
    /// Flags in RCC_CSR. A reset from within pulls the reset pin, too.
    fn flags(self) -> u32 {
        const PIN: u32 = 1 << 26;
        PIN | match self {
            Self::Power => 1 << 27 | 1 << 25,
            Self::Pin => 0,
            Self::BrownOut => 1 << 25,
            Self::Watchdog => 1 << 29,
            Self::Software => 1 << 28,
        }
    }
}

/// Periods of the clocks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Clocks {
    pub(crate) core: Time,
    pub(crate) apb1: Time,
    pub(crate) apb2: Time,
}

impl Clocks {
    /// Period of the timers on a bus with this period: half of it, unless the bus has the core's clock.
    pub(crate) fn timers(&self, bus: Time) -> Time {
        if bus == self.core { bus } else { bus / 2 }
    }
}

#[derive(Clone, Debug)]
pub(crate) struct ClockControl {
    pub(crate) crystal: Crystal,
    control: u32,
    pll: u32,
    configuration: u32,
    status: u32,
    crystal_since: Time,
    pll_since: Time,
    /// Clock of the core from a PLL that follows no crystal, Hz.
    free_hz: Option<u64>,
    /// The security system has told that the crystal has stopped.
    told: bool,
}

const HSE_ON: u32 = 1 << 16;
const PLL_ON: u32 = 1 << 24;
/// Clock security system.
const SECURITY_ON: u32 = 1 << 19;
/// The PLL runs from the crystal.
const PLL_OF_CRYSTAL: u32 = 1 << 22;

impl ClockControl {
    pub(crate) fn new(crystal: Crystal) -> Self {
        Self {
            crystal,
            control: 0x83,
            pll: 0x2400_3010,
            configuration: 0,
            status: 0,
            crystal_since: 0,
            pll_since: 0,
            free_hz: None,
            told: false,
        }
    }

    /// Registers as after a reset. Flags of earlier resets stay until the program clears them, or power goes.
    pub(crate) fn reset(&mut self, cause: ResetCause) {
        let kept = match cause {
            ResetCause::Power => 0,
            _ => self.status & 0xFE00_0000,
        };
        *self = Self::new(self.crystal);
        self.status = kept | cause.flags();
    }

    fn crystal_is_ready(&self, now: Time) -> bool {
        self.control & HSE_ON != 0
            && self.crystal != Crystal::Missing
            && now >= self.crystal_since + CRYSTAL_START
    }

    /// The PLL locks only to a clock that runs.
    fn pll_is_ready(&self, now: Time) -> bool {
        let has_source = self.pll & PLL_OF_CRYSTAL == 0 || self.crystal_is_ready(now);
        self.control & PLL_ON != 0 && has_source && now >= self.pll_since + LOCK
    }

    /// Returns true if the core's clock comes from the crystal.
    pub(crate) fn is_fed_by_crystal(&self) -> bool {
        match self.configuration & 3 {
            1 => true,
            2 => self.pll & PLL_OF_CRYSTAL != 0,
            _ => false,
        }
    }

    /// The crystal stops. Returns true if the clock security system puts the core on the internal oscillator for it; without, the PLL runs free.
    pub(crate) fn stop_crystal(&mut self) -> bool {
        self.crystal = Crystal::Missing;
        self.run_free(FREE_RUN_HZ);
        let sees = self.control & (SECURITY_ON | HSE_ON) == SECURITY_ON | HSE_ON;
        if sees {
            if self.is_fed_by_crystal() {
                self.configuration &= !3;
            }
            self.control &= !HSE_ON;
            if self.pll & PLL_OF_CRYSTAL != 0 {
                self.control &= !PLL_ON;
            }
            self.told = true;
        }
        sees
    }

    /// The PLL follows its crystal no more, and makes another clock of the core, Hz.
    pub(crate) fn run_free(&mut self, hz: u64) {
        self.free_hz = Some(hz);
    }

    fn runs_free(&self) -> bool {
        self.pll & PLL_OF_CRYSTAL != 0 && self.free_hz.is_some()
    }

    /// Returns true if the security system has told of a crystal that has stopped, and was not answered.
    pub(super) fn has_told(&self) -> bool {
        self.told
    }

    /// The program has seen what the security system tells.
    pub(super) fn answer(&mut self) {
        self.told = false;
    }

    /// Returns the period of the crystal's clock behind the divider for the real-time clock, once it is ready.
    pub(crate) fn divided_crystal(&self, now: Time) -> Option<Time> {
        let Crystal::Runs { mhz } = self.crystal else {
            return None;
        };
        let divider = Time::from(self.configuration >> 16 & 31);
        (self.crystal_is_ready(now) && divider > 1)
            .then(|| divider * period(u64::from(mhz) * 1_000_000))
    }

    /// Returns the part by which the PLL's clock for USB is off 48 MHz; none if it does not run.
    pub(crate) fn usb_error(&self, now: Time) -> Option<f64> {
        let hz = match self.crystal {
            _ if !self.pll_is_ready(now) => return None,
            _ if self.pll & PLL_OF_CRYSTAL == 0 => HSI_HZ as f64 * (1.0 + HSI_ERROR),
            Crystal::Runs { mhz } => f64::from(mhz) * 1e6,
            Crystal::Missing => return None,
        };
        let (m, n, q) = (self.pll & 0x3F, self.pll >> 6 & 0x1FF, self.pll >> 24 & 15);
        Some(hz / f64::from(m) * f64::from(n) / f64::from(q) / 48e6 - 1.0)
    }

    pub(crate) fn read(&self, offset: u32, now: Time) -> Option<u32> {
        let ready = |is: bool, bit: u32| u32::from(is) << bit;
        Some(match offset {
            0x00 => {
                self.control
                    | ready(self.crystal_is_ready(now), 17)
                    | ready(self.pll_is_ready(now), 25)
            }
            0x04 => self.pll,
            0x08 => self.configuration & !0xC | (self.configuration & 3) << 2,
            // LSI: on and ready, as the watchdog turns it on.
            0x74 => self.status | 3,
            _ => return None,
        })
    }

    /// Returns false if `offset` is no register of the clocks.
    pub(crate) fn write(&mut self, offset: u32, value: u32, now: Time) -> bool {
        match offset {
            0x00 => {
                let risen = value & !self.control;
                if risen & HSE_ON != 0 {
                    self.crystal_since = now;
                }
                if risen & PLL_ON != 0 {
                    self.pll_since = now;
                }
                self.control = value & !(1 << 17 | 1 << 25);
            }
            0x04 => self.pll = value,
            0x08 => self.configuration = value,
            0x74 if value & 1 << 24 != 0 => self.status &= 0x00FF_FFFF,
            0x74 => {}
            _ => return false,
        }
        true
    }

    /// Returns the periods of the clocks that the registers choose.
    pub(crate) fn clocks(&self) -> Clocks {
        let crystal_hz = match self.crystal {
            Crystal::Runs { mhz } => u64::from(mhz) * 1_000_000,
            Crystal::Missing => HSI_HZ,
        };
        let core_hz = match self.configuration & 3 {
            1 => crystal_hz,
            2 if self.runs_free() => self.free_hz.unwrap_or(FREE_RUN_HZ),
            2 => {
                let from = if self.pll & PLL_OF_CRYSTAL != 0 {
                    crystal_hz
                } else {
                    HSI_HZ
                };
                let m = u64::from(self.pll & 0x3F).max(1);
                let n = u64::from(self.pll >> 6 & 0x1FF);
                let p = u64::from((self.pll >> 16 & 3) * 2 + 2);
                from * n / m / p
            }
            _ => HSI_HZ,
        };
        let core = period(core_hz.clamp(1, SECOND));
        let bus = |bits: u32| match self.configuration >> bits & 7 {
            divided @ 4.. => core << (divided - 3),
            _ => core,
        };
        Clocks {
            core,
            apb1: bus(10),
            apb2: bus(13),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Registers as the image writes them, for a crystal of 8 MHz.
    fn started(crystal: Crystal, now: Time) -> ClockControl {
        let mut control = ClockControl::new(crystal);
        control.write(0x00, 0x83 | HSE_ON, 0);
        control.write(0x04, 0x0740_5408, 0);
        control.write(0x00, 0x83 | HSE_ON | PLL_ON, now);
        control.write(0x08, 0x0000_9402, now);
        control
    }

    #[test]
    fn a_crystal_of_8_mhz_makes_168() {
        let control = started(Crystal::Runs { mhz: 8 }, CRYSTAL_START);
        let Clocks { core, apb1, apb2 } = control.clocks();
        assert_eq!((core, apb1, apb2), (170, 680, 340));
        assert_eq!(control.clocks().timers(apb1), 340);
    }

    #[test]
    fn a_wrong_crystal_makes_a_wrong_clock() {
        // 12 MHz for 8: the core has 252 MHz.
        assert_eq!(started(Crystal::Runs { mhz: 12 }, 0).clocks().core, 113);
    }

    #[test]
    fn a_missing_crystal_is_never_ready_and_a_pll_needs_its_source() {
        let control = started(Crystal::Missing, 0);
        let flags = control.read(0, 100 * MS).expect("a register");
        assert_eq!(flags & (1 << 17 | 1 << 25), 0);
        let control = started(Crystal::Runs { mhz: 8 }, CRYSTAL_START);
        let of = |now| control.read(0, now).expect("a register") >> 25 & 1;
        assert_eq!((of(CRYSTAL_START), of(CRYSTAL_START + LOCK)), (0, 1));
    }

    #[test]
    fn the_security_system_puts_the_core_on_the_internal_oscillator() {
        let mut control = started(Crystal::Runs { mhz: 8 }, CRYSTAL_START);
        let mut without = control.clone();
        assert!(!without.stop_crystal());
        assert_eq!(without.clocks().core, period(FREE_RUN_HZ));
        control.write(0x00, 0x83 | HSE_ON | PLL_ON | SECURITY_ON, CRYSTAL_START);
        assert!(control.is_fed_by_crystal() && control.stop_crystal());
        assert!(!control.is_fed_by_crystal());
        assert_eq!(control.clocks().core, period(16_000_000));
    }

    #[test]
    fn flags_of_resets_stay_until_they_are_cleared() {
        let mut control = ClockControl::new(Crystal::Missing);
        control.reset(ResetCause::Power);
        control.reset(ResetCause::Watchdog);
        let flags = |control: &ClockControl| control.read(0x74, 0).expect("a register") >> 24;
        assert_eq!(flags(&control), 0x2E);
        control.write(0x74, 1 << 24, 0);
        assert_eq!(flags(&control), 0);
        control.reset(ResetCause::Pin);
        assert_eq!(flags(&control), 0x04);
    }
}
