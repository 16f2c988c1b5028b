//! Instructions per tick on the microcontrollers, as they are checked in: CI measures them anew
//! and compares.

use crate::error::ReportError;
use serde::Deserialize;
use serde::de::DeserializeOwned;

const CHECKED_IN: &str = include_str!("../../../../xtask/budgets/insns.json");

/// The cores, in the order of tables.
pub(crate) const CORES: [&str; 4] = ["m4f", "m3", "m0", "rv32imc"];

/// Instructions of one core, number type and scene.
#[derive(Clone, Debug, Deserialize)]
pub(crate) struct InstructionCount {
    pub(crate) core: String,
    pub(crate) scalar: String,
    pub(crate) scene: String,
    pub(crate) min: f64,
    pub(crate) mean: f64,
    pub(crate) max: f64,
}

/// A checked-in file of figures.
#[derive(Deserialize)]
struct Budget<Row> {
    rows: Vec<Row>,
}

/// All counts.
pub(crate) fn checked_in() -> Result<Vec<InstructionCount>, ReportError> {
    rows("xtask/budgets/insns.json", CHECKED_IN)
}

/// The rows of `file`, whose contents are `text`.
pub(crate) fn rows<Row: DeserializeOwned>(file: &str, text: &str) -> Result<Vec<Row>, ReportError> {
    let budget: Budget<Row> = serde_json::from_str(text)
        .map_err(|error| ReportError::Failed(format!("{file}: {error}")))?;
    Ok(budget.rows)
}

/// The count of one core, number type and scene.
pub(crate) fn find<'a>(
    counts: &'a [InstructionCount],
    core: &str,
    scalar: &str,
    scene: &str,
) -> Option<&'a InstructionCount> {
    counts
        .iter()
        .find(|count| count.core == core && count.scalar == scalar && count.scene == scene)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_two_scenes_are_counted_for_every_number_type_on_every_core() {
        let counts = checked_in().unwrap();
        for core in CORES {
            for scalar in ["f64", "f32", "fixed", "micromath"] {
                for scene in ["thesis", "thesis-links"] {
                    let count = find(&counts, core, scalar, scene).unwrap();
                    assert!(0.0 < count.min && count.min <= count.mean && count.mean <= count.max);
                }
            }
        }
    }
}
