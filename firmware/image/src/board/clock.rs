//! Clocks made of a crystal: the dividers of the PLL, or the reason that there are none.

/// Clock that a family runs from.
pub(super) struct ClockSettings {
    /// Clock of the core, Hz.
    pub(super) core_hz: u32,
    /// Clock of the timer that calls the slots of steppers, Hz.
    pub(super) slot_timer_hz: u32,
    /// Cycles of the core by which an edge of a slot may come late, against the next one at its driver.
    pub(super) slot_cycles: u32,
    /// Longest time for which the driver of USB masks the slots, cycles of the core: an edge comes so much later still where the line is USB.
    pub(super) usb_cycles: u32,
    /// Crystals that the chip takes, Hz.
    pub(super) crystal_hz: (u32, u32),
    /// Frequencies of the PLL: input, Hz.
    input_hz: (u32, u32),
    /// Frequency of the oscillator inside the PLL, Hz.
    oscillator_hz: u32,
    /// Dividers in front of the PLL.
    dividers: (u32, u32),
    /// Factors of the PLL.
    factors: (u32, u32),
    /// Input that is preferred among those that would do, Hz.
    preferred_hz: u32,
    /// The crystal has to be a whole number of MHz.
    whole_mhz: bool,
}

/// STM32F405: RM0090, 7.3.2, and the limits of DS8626, tables 31 and 35. The oscillator goes through 2 to the core.
pub(super) const STM32F405_CLOCK: ClockSettings = ClockSettings {
    core_hz: 168_000_000,
    slot_timer_hz: 84_000_000,
    // In the slot that takes new positions, with two cycles for an instruction: `cargo xtask bench` finds edges as late as that.
    slot_cycles: 440,
    // As it takes a full packet out of its buffer: `cargo xtask bench --usb inputs/guarded` finds 2,000, with two cycles for an instruction.
    usb_cycles: 2_500,
    crystal_hz: (4_000_000, 26_000_000),
    input_hz: (1_000_000, 2_000_000),
    oscillator_hz: 336_000_000,
    dividers: (2, 63),
    factors: (50, 432),
    preferred_hz: 1_000_000,
    whole_mhz: false,
};

/// STM32G474: RM0440, 7.2.4, and the limits of the PLL in DS12288. The oscillator goes through 2 to the core.
pub(super) const STM32G474_CLOCK: ClockSettings = ClockSettings {
    core_hz: 170_000_000,
    slot_timer_hz: 170_000_000,
    // As long as those of the STM32F405, which has the same core.
    slot_cycles: 440,
    // With each packet: the bench finds 742.
    usb_cycles: 1_000,
    crystal_hz: (4_000_000, 48_000_000),
    input_hz: (2_660_000, 16_000_000),
    oscillator_hz: 340_000_000,
    dividers: (1, 16),
    factors: (8, 127),
    preferred_hz: 4_000_000,
    whole_mhz: false,
};

/// RP2040: data sheet, 2.16 and 2.18. The oscillator goes through 6 and 2 to the core. The watchdog counts microseconds by whole MHz.
pub(super) const RP2040_CLOCK: ClockSettings = ClockSettings {
    core_hz: 125_000_000,
    slot_timer_hz: 125_000_000,
    // Half of the least time between two slots.
    slot_cycles: 600,
    // Critical sections let the slots pass.
    usb_cycles: 0,
    crystal_hz: (5_000_000, 15_000_000),
    input_hz: (5_000_000, 15_000_000),
    oscillator_hz: 1_500_000_000,
    dividers: (1, 1),
    factors: (16, 320),
    preferred_hz: 12_000_000,
    whole_mhz: true,
};

/// Settings of a PLL.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Pll {
    /// The crystal is divided by this,
    pub(super) divider: u32,
    /// and then taken so many times.
    pub(super) factor: u32,
}

impl ClockSettings {
    /// Settings of the PLL that make exactly the clock of the family.
    pub(super) fn pll(&self, crystal_hz: u32) -> Option<Pll> {
        if self.whole_mhz && !crystal_hz.is_multiple_of(1_000_000) {
            return None;
        }
        let (least, most) = self.dividers;
        let settings = (least..=most).filter_map(|divider| {
            let (input_min, input_max) = self.input_hz;
            // Compared as products: an input need not be a whole number of Hz.
            let fits =
                (input_min * divider..=input_max.saturating_mul(divider)).contains(&crystal_hz);
            let product = u64::from(self.oscillator_hz) * u64::from(divider);
            let factor = product / u64::from(crystal_hz);
            let exact = factor * u64::from(crystal_hz) == product;
            let factor = u32::try_from(factor).ok()?;
            let (factor_min, factor_max) = self.factors;
            (fits && exact && (factor_min..=factor_max).contains(&factor))
                .then_some(Pll { divider, factor })
        });
        settings.min_by_key(|pll| (crystal_hz / pll.divider).abs_diff(self.preferred_hz))
    }

    /// Whole MHz of crystals that would do, as text.
    pub(super) fn good_crystals(&self) -> String {
        let (least, most) = self.crystal_hz;
        let good = (least.div_ceil(1_000_000)..=most / 1_000_000)
            .filter(|mhz| self.pll(mhz * 1_000_000).is_some());
        let good: Vec<String> = good.map(|mhz| mhz.to_string()).collect();
        good.join(", ")
    }

    /// Time from one slot to the next, s, when the timer is set to at least `slots_hz`.
    pub(super) fn slot_s(&self, slots_hz: u32) -> f64 {
        let counts = (self.slot_timer_hz / slots_hz.max(1)).max(1);
        // The prescaler of a counter of 16 bits; the rest is cut, so that there are enough slots.
        let prescaler = counts.div_ceil(1 << 16);
        f64::from(counts / prescaler * prescaler) / f64::from(self.slot_timer_hz)
    }

    /// Time by which an edge may be late, s: the longest run of a slot; and what USB masks, if the line is that.
    pub(super) fn late_s(&self, has_usb: bool) -> f64 {
        let masked = if has_usb { self.usb_cycles } else { 0 };
        f64::from(self.slot_cycles + masked) / f64::from(self.core_hz)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_pll_makes_the_clock_exactly_or_not_at_all() {
        let pll = |mhz: f64| STM32F405_CLOCK.pll((mhz * 1e6) as u32);
        let of = |divider, factor| Some(Pll { divider, factor });
        for mhz in [8, 12, 16, 25, 26] {
            assert_eq!(pll(mhz.into()), of(mhz, 336), "{mhz}");
        }
        assert_eq!(pll(10.5), of(10, 320));
        assert_eq!(pll(8.4), of(8, 320));
        // 168 / 14.7456 is 4375 / 384.
        assert_eq!(pll(14.7456), None);
        assert_eq!(pll(24.576), None);
        assert_eq!(STM32G474_CLOCK.pll(24_000_000), of(6, 85));
        assert_eq!(STM32G474_CLOCK.pll(8_000_000), of(2, 85));
        assert_eq!(RP2040_CLOCK.pll(12_000_000), of(1, 125));
        assert_eq!(RP2040_CLOCK.pll(7_000_000), None);
        assert_eq!(RP2040_CLOCK.pll(12_500_000), None);
    }

    #[test]
    fn every_crystal_makes_the_clock_of_usb_too() {
        // The second PLL of the RP2040 makes 1,200 MHz, and 48 of them.
        let crystals = (5..=15).filter(|mhz| RP2040_CLOCK.pll(mhz * 1_000_000).is_some());
        for mhz in crystals {
            assert_eq!(1_200 % mhz, 0, "{mhz}");
        }
        // A third output of the PLL of the STM32F405, through 7.
        assert_eq!(STM32F405_CLOCK.oscillator_hz, 7 * 48_000_000);
    }

    #[test]
    fn every_setting_is_within_the_limits_of_the_chip() {
        for clock in [&STM32F405_CLOCK, &STM32G474_CLOCK, &RP2040_CLOCK] {
            let (least, most) = clock.crystal_hz;
            for crystal_hz in (least..=most).step_by(10_000) {
                let Some(Pll { divider, factor }) = clock.pll(crystal_hz) else {
                    continue;
                };
                let made = u64::from(crystal_hz) * u64::from(factor);
                assert_eq!(made, u64::from(clock.oscillator_hz) * u64::from(divider));
                let input = f64::from(crystal_hz) / f64::from(divider);
                let (low, high) = clock.input_hz;
                assert!(
                    f64::from(low) <= input && input <= f64::from(high),
                    "{input}"
                );
            }
        }
        assert_eq!(RP2040_CLOCK.good_crystals(), "5, 6, 10, 12, 15");
        assert!(STM32F405_CLOCK.good_crystals().starts_with("4, 5, 6, "));
    }

    #[test]
    fn a_slot_is_as_long_as_its_timer_makes_it() {
        // 84 MHz / 41,001 are 2,048 counts and a part.
        let slot_s = STM32F405_CLOCK.slot_s(41_001);
        assert!((slot_s - 2048.0 / 84e6).abs() < 1e-15, "{slot_s}");
        // 840,000 counts take a prescaler of 13.
        let slot_s = STM32F405_CLOCK.slot_s(100);
        assert!((slot_s - 839_995.0 / 84e6).abs() < 1e-12, "{slot_s}");
    }
}
