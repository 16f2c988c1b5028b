//! Place and scale of a drawing or an image, where the machine has room for it.

use std::fmt;
use trirrr_scene::{ReachMap, Scene};
use trirrr_toolpath::PathFault;

/// Part of the room that is taken: between the nodes of the map nothing is known.
const PART_OF_ROOM: f64 = 0.98;

/// Rounds in which the scale of a drawing with a margin is found. The margin does not shrink with the drawing.
const ROUNDS: u32 = 8;

/// Place of a drawing on a machine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fitted {
    /// Length on the machine of a length 1 in the drawing.
    pub scale: f64,
    /// Zero point of the drawing, m.
    pub origin_m: [f64; 2],
}

/// The arguments of the command line with which the same place comes again.
impl fmt::Display for Fitted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y] = self.origin_m.map(|metres| 1e3 * metres);
        write!(f, "--scale {:.4} --origin {x:.3},{y:.3}", self.scale)
    }
}

/// Puts a drawing with these corners, m, where the machine of `scene` has the most room for its shape, not larger than by
/// `scale`, with `margin_m` free beside it.
///
/// # Errors
/// The machine has no room for a thousandth of the drawing.
pub fn fit(
    [low, high]: [[f64; 2]; 2],
    margin_m: f64,
    scale: f64,
    scene: &Scene,
) -> Result<Fitted, PathFault> {
    let fault = |reason: String| PathFault {
        line: 0,
        word: String::new(),
        reason,
    };
    let map = ReachMap::new(scene, &scene.job.start).map_err(|error| fault(error.to_string()))?;
    let no_room = || fault("--fit: the machine has no room for a thousandth of the drawing".into());
    let size_m = [high[0] - low[0], high[1] - low[1]];
    let mut fitted = scale;
    let mut centre_m = [0.0; 2];
    let rounds = if margin_m > 0.0 { ROUNDS } else { 1 };
    for _ in 0..rounds {
        let around = [size_m[0] + 2.0 * margin_m / fitted, size_m[1]];
        let room = map.room(around).ok_or_else(no_room)?;
        // In the digits that the user is told: with these the same job comes again.
        fitted = (1e4 * scale.min(PART_OF_ROOM * room.factor)).floor() / 1e4;
        centre_m = room.centre_m;
        if fitted < 1e-3 {
            return Err(no_room());
        }
    }
    let origin_m = [0, 1].map(|axis| {
        let metres = centre_m[axis] - 0.5 * fitted * (low[axis] + high[axis]);
        1e-3 * ((1e6 * metres).round() / 1e3)
    });
    Ok(Fitted {
        scale: fitted,
        origin_m,
    })
}
