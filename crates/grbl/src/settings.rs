//! `$` settings.

use std::fmt::Write as _;

/// Facts about the machine that settings tell.
#[derive(Clone, Debug, PartialEq)]
pub struct MachineFacts {
    /// Name of the machine.
    pub name: String,
    /// Sides of the rectangle around all that it reaches, m.
    pub travel_m: [f64; 2],
    /// The machine finds its reference by homing.
    pub has_homing: bool,
    /// Z words have no effect; otherwise they are refused.
    pub ignore_z: bool,
    /// Outputs that M62 to M65 switch, at most 8. Their numbers begin at 0.
    pub outputs: u8,
    /// Inputs that M66 waits for, at most 8. Their numbers begin at 0.
    pub inputs: u8,
}

/// Speed that is reported for rapids, and to which their override refers, mm/min.
const RAPID_MM_MIN: f64 = 30_000.0;

/// Settings of one connection.
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

    /// Sets `$number=value`.
    ///
    /// # Errors
    /// The reason.
    pub(crate) fn set(&mut self, number: &str, value: &str) -> Result<(), &'static str> {
        let value: f64 = value.trim().parse().map_err(|_| "the value is no number")?;
        let flag = value == 0.0 || value == 1.0;
        match number.trim() {
            "10" if (0.0..=255.0).contains(&value) => self.report = value as u8,
            "13" if flag => self.inches = value == 1.0,
            "30" if (1.0..=1e6).contains(&value) => self.full_power = value,
            "110" | "111" if (1.0..=1e6).contains(&value) => self.rapid_mm_min = value,
            "31" if value == 0.0 => {}
            "32" if value == 1.0 => {}
            "32" => {
                return Err(
                    "the machine is in laser mode always: S is a power, and M4 follows the speed",
                );
            }
            "10" | "13" | "30" | "31" | "110" | "111" => return Err("the value is out of range"),
            _ => {
                return Err(
                    "the scene of the machine says this: $10, $13, $30, $110 and $111 may be set",
                );
            }
        }
        Ok(())
    }
}
