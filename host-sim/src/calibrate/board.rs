//! A calibration on its way to a board: legs and encoder offsets.

use crate::failure::CliError;
use crate::goals::MachineArgs;
use crate::machine::{ReplacedGeometry, replace_geometry};
use std::sync::atomic::AtomicBool;
use trirrr_calibration::Calibration;
use trirrr_figures::document::Facts;
use trirrr_scene::Scene;

/// Board with the calibrated legs.
pub(super) struct CalibratedBoard {
    geometry: ReplacedGeometry,
    /// Encoder offsets that it got.
    offsets_rad: [f64; 3],
}

impl CalibratedBoard {
    /// Gives the board the calibrated legs, and the encoder offsets unless the joints have been turned by them.
    ///
    /// # Errors
    /// Refused: by the board. Failed: the port.
    pub(super) fn set(
        machine: &MachineArgs,
        joints_placed: bool,
        scene: &Scene,
        calibration: &Calibration,
        stop: &AtomicBool,
    ) -> Result<Self, CliError> {
        let legs = calibration.values.put_into(&scene.parameters);
        let offsets_rad = match joints_placed {
            true => [0.0; 3],
            false => calibration.values.offsets_rad(),
        };
        let geometry = replace_geometry(machine, scene, &legs, offsets_rad, stop);
        let geometry = geometry.map_err(|error| match error {
            CliError::Refused(why) => {
                CliError::Refused(format!("the board does not take the geometry: {why}; without --port the results are written"))
            }
            failed => failed,
        })?;
        Ok(Self {
            geometry,
            offsets_rad,
        })
    }

    /// Its pose by the legs before, and by the calibrated ones.
    pub(super) fn record(&self) -> Facts {
        let ReplacedGeometry { stood, stands } = self.geometry;
        let pose =
            |[x, y, alpha]: [f64; 3]| format!("x {x:.6} m, y {y:.6} m, alpha {alpha:.6} rad");
        let offsets = match self.offsets_rad == [0.0; 3] {
            true => "",
            false => " and encoder offsets",
        };
        let text = format!(
            "has the calibrated legs{offsets} until it is switched off; the platform stands at {}, which were {} by the legs before",
            pose(stands),
            pose(stood)
        );
        Facts::new()
            .pair("stands", "board", stands)
            .words(text)
            .data("stood", stood)
            .data("offsets_rad", self.offsets_rad)
    }
}
