//! A calibration on its way to a board: the legs go over the line, encoder offsets do not.

use super::text::{length, offsets};
use crate::failure::CliError;
use crate::goals::MachineArgs;
use crate::machine::{ReplacedGeometry, replace_geometry};
use serde_json::{Value, json};
use std::fmt::Write;
use std::sync::atomic::AtomicBool;
use trirrr_calibration::{Calibration, PoseError};
use trirrr_scene::Scene;

/// Board with the calibrated legs.
pub(super) struct CalibratedBoard {
    geometry: ReplacedGeometry,
    /// Error over the workspace until the encoder offsets are taken into account, too; none where there are none.
    without_offsets: Option<PoseError>,
}

impl CalibratedBoard {
    /// Gives the board the calibrated legs.
    ///
    /// # Errors
    /// Refused: legs that are worse than none without the encoder offsets; by the board. Failed: the port.
    pub(super) fn set(
        machine: &MachineArgs,
        joints_placed: bool,
        scene: &Scene,
        calibration: &Calibration,
        places: &[[f64; 3]],
        stop: &AtomicBool,
    ) -> Result<Self, CliError> {
        let missing = offsets(calibration).filter(|_| !joints_placed);
        let without_offsets = missing.map(|offsets| {
            let left = calibration.without_offsets(&scene.parameters, places);
            let before = calibration.before.rms_m;
            if left.rms_m < before {
                return Ok(left);
            }
            Err(CliError::Refused(format!(
                "the board's messages have no encoder offsets, and the calibrated legs alone would leave RMS {} of error in place of {}: \
                 {offsets}. Turn the joints by that and give --joints-placed; or place the joints, measure, and calibrate with \
                 --hold offset; or calibrate without --port, and build the image of the calibrated scene",
                length(left.rms_m),
                length(before)
            )))
        });
        let without_offsets = without_offsets.transpose()?;
        let legs = calibration.values.put_into(&scene.parameters);
        let geometry = replace_geometry(machine, scene, &legs, stop);
        let geometry = geometry.map_err(|error| match error {
            CliError::Refused(why) => {
                CliError::Refused(format!("the board does not take the geometry: {why}; without --port the results are written"))
            }
            failed => failed,
        })?;
        Ok(Self {
            geometry,
            without_offsets,
        })
    }

    /// Lines of the summary.
    pub(super) fn say(&self, text: &mut String, offsets_in: Option<&str>) {
        let ReplacedGeometry { stood, stands } = self.geometry;
        let pose =
            |[x, y, alpha]: [f64; 3]| format!("x {x:.6} m, y {y:.6} m, alpha {alpha:.6} rad");
        let _ = writeln!(
            text,
            "  board       has the calibrated legs until it is switched off; the platform stands at {}, which were {} by the legs before",
            pose(stands),
            pose(stood)
        );
        if let Some(left) = &self.without_offsets {
            let place = match offsets_in {
                Some(key) => format!("they are {key} of the calibrated scene, for the next image"),
                None => "turn the joints by them".into(),
            };
            let _ = writeln!(
                text,
                "              it has no encoder offsets: {place}. Until then RMS {}, at most {} of error is left",
                length(left.rms_m),
                length(left.worst_m)
            );
        }
    }

    /// The same as JSON, SI units.
    pub(super) fn as_json(&self) -> Value {
        json!({
            "stood": self.geometry.stood,
            "stands": self.geometry.stands,
            "without_offsets": self.without_offsets.as_ref().map(super::text::error_json),
        })
    }
}
