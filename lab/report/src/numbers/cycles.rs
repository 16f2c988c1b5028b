//! Modelled cycles per tick on boards, as they are checked in: CI models them anew and compares.

use super::counts::rows;
use crate::error::ReportError;
use serde::Deserialize;

const CHECKED_IN: &str = include_str!("../../../../xtask/budgets/cycles.json");

/// Boards by their cores, in the order of tables.
pub(crate) const BOARDS: [(&str, &str); 4] = [
    ("m4f", "STM32F405, 168 MHz"),
    ("m3", "STM32F103, 72 MHz"),
    ("m0", "STM32F072, 48 MHz"),
    ("m0plus", "RP2040, 125 MHz"),
];

/// Setpoint and tick of one number type and scene on one board, or other work there.
#[derive(Clone, Debug, Deserialize)]
pub(crate) struct ModelledCycles {
    core: String,
    scalar: String,
    scene: String,
    what: String,
    memory: String,
    #[cfg(test)]
    board: String,
    #[cfg(test)]
    mhz: f64,
    pub(crate) mean: f64,
    pub(crate) us_mean: f64,
}

/// All of them.
pub(crate) fn checked_in() -> Result<Vec<ModelledCycles>, ReportError> {
    rows("xtask/budgets/cycles.json", CHECKED_IN)
}

/// Setpoint and tick on a board, by its core, that reads its code from flash.
pub(crate) fn find<'a>(
    cycles: &'a [ModelledCycles],
    core: &str,
    scalar: &str,
    scene: &str,
) -> Option<&'a ModelledCycles> {
    cycles.iter().find(|row| {
        let key = (row.core.as_str(), row.scalar.as_str(), row.scene.as_str());
        key == (core, scalar, scene) && row.what == "tick" && row.memory == "flash"
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_board_is_called_as_in_the_file_and_has_every_number_type() {
        let cycles = checked_in().unwrap();
        for (core, name) in BOARDS {
            for scalar in ["f64", "f32", "fixed", "micromath"] {
                for scene in ["thesis", "thesis-links"] {
                    let row = find(&cycles, core, scalar, scene).unwrap();
                    assert_eq!(format!("{}, {:.0} MHz", row.board, row.mhz), name);
                    assert!((row.mean / row.mhz - row.us_mean).abs() <= 0.006);
                }
            }
        }
    }
}
