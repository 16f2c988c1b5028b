//! `$` settings.

use crate::fault;
use std::fmt::Write as _;
use trirrr_toolpath::gcode::ZWords;

/// Facts about the machine that settings tell.
#[derive(Clone, Debug, PartialEq)]
pub struct MachineFacts {
    /// Name of the machine.
    pub name: String,
    /// Sides of the rectangle around all that it reaches, m.
    pub travel_m: [f64; 2],
    /// The machine finds its reference by homing.
    pub has_homing: bool,
    /// Motions that wait at most, as `Bf` counts them.
    pub motions: usize,
    /// Sense of words of Z.
    pub z: ZWords,
    /// Outputs that M62 to M65 switch, at most 8. Their numbers begin at 0.
    pub outputs: u8,
    /// Inputs that M66 waits for, at most 8. Their numbers begin at 0.
    pub inputs: u8,
}

/// Speed that is reported for rapids, and to which their override refers, mm/min.
const RAPID_MM_MIN: f64 = 30_000.0;

/// Settings. They last as long as the dialect, from one sender to the next.
#[derive(Clone, Debug)]
pub(crate) struct Settings {
    facts: MachineFacts,
    /// $10: bit 0 for machine coordinates in reports, bit 1 for buffers.
    pub(crate) report: u8,
    /// $13: reports are in inches.
    pub(crate) inches: bool,
    /// $30: S word of full power.
    pub(crate) full_power: f64,
    /// $110: mm/min.
    pub(crate) rapid_mm_min: f64,
}

impl Settings {
    pub(crate) fn new(facts: MachineFacts) -> Self {
        Self {
            facts,
            report: 3,
            inches: false,
            full_power: 1000.0,
            rapid_mm_min: RAPID_MM_MIN,
        }
    }

    pub(crate) fn facts(&self) -> &MachineFacts {
        &self.facts
    }

    /// Lines of `$$`.
    pub(crate) fn list(&self) -> String {
        let mut text = String::new();
        let [width, height] = self.facts.travel_m.map(|side| side * 1000.0);
        let values = [
            (10, f64::from(self.report), 0),
            (13, f64::from(u8::from(self.inches)), 0),
            (20, 1.0, 0),
            (21, 0.0, 0),
            (22, f64::from(u8::from(self.facts.has_homing)), 0),
            (30, self.full_power, 0),
            (31, 0.0, 0),
            (32, 1.0, 0),
            (110, self.rapid_mm_min, 3),
            (111, self.rapid_mm_min, 3),
            (130, width, 3),
            (131, height, 3),
        ];
        for (number, value, digits) in values {
            // Writing to a String does not fail.
            let _ = write!(text, "${number}={value:.digits$}\r\n");
        }
        text
    }

    /// Sets the setting of a number.
    ///
    /// # Errors
    /// The number of GRBL, and the reason.
    pub(crate) fn set(&mut self, number: f64, value: f64) -> Result<(), (u8, &'static str)> {
        let flag = value == 0.0 || value == 1.0;
        let refused = |reason| Err((fault::STATEMENT, reason));
        if value < 0.0 {
            return Err((fault::NEGATIVE, "the value is negative"));
        }
        // GRBL cuts a fraction of the number off.
        match number.trunc() {
            10.0 if value <= 255.0 => self.report = value as u8,
            13.0 if flag => self.inches = value == 1.0,
            30.0 if (1.0..=1e6).contains(&value) => self.full_power = value,
            110.0 | 111.0 if (1.0..=1e6).contains(&value) => self.rapid_mm_min = value,
            31.0 if value == 0.0 => {}
            32.0 if value == 1.0 => {}
            32.0 => {
                return refused(
                    "the machine is in laser mode always: S is a power, and M4 follows the speed",
                );
            }
            10.0 | 13.0 | 30.0 | 31.0 | 110.0 | 111.0 => {
                return refused("the value is out of range");
            }
            _ => {
                return refused(
                    "the scene of the machine says this: $10, $13, $30, $110 and $111 may be set",
                );
            }
        }
        Ok(())
    }
}
