//! Work coordinates: zero points of G54 to G59, and the shift of G92. They move the frame and do not turn it.
use super::setup::ORIGINS;
use crate::ToolPlace;

/// Axes of the machine: letter, and place in `axes` and `ToolPlace`.
pub(super) const AXES: [u8; 3] = *b"XYA";

/// Zero points and shift.
#[derive(Clone, Debug)]
pub(super) struct WorkFrames {
    pub(super) origins: [ToolPlace; ORIGINS],
    pub(super) shift: ToolPlace,
}

impl WorkFrames {
    /// Zero point of the system, from 0. Beyond the last: the last one.
    pub(super) fn origin(&self, index: usize) -> ToolPlace {
        self.origins[index.min(ORIGINS - 1)]
    }

    /// Sets the zero point of a system. An index beyond the last has no effect.
    pub(super) fn set_origin(&mut self, index: usize, origin: ToolPlace) {
        if let Some(place) = self.origins.get_mut(index) {
            *place = origin;
        }
    }

    /// Work zero in the fixed frame.
    pub(super) fn zero(&self, index: usize) -> ToolPlace {
        each(self.origin(index), self.shift, |origin, shift| {
            origin + shift
        })
    }

    /// Coordinates in the system of a place in the fixed frame.
    pub(super) fn work(&self, index: usize, at: ToolPlace) -> ToolPlace {
        each(at, self.zero(index), |at, zero| at - zero)
    }
}

/// x, y in metres and alpha in radians.
pub(super) fn axes(place: ToolPlace) -> [f64; 3] {
    let [x, y] = place.position_m;
    [x, y, place.alpha_rad]
}

/// Place of x, y in metres and alpha in radians.
pub(super) fn place([x, y, alpha_rad]: [f64; 3]) -> ToolPlace {
    ToolPlace {
        position_m: [x, y],
        alpha_rad,
    }
}

/// Combines two places axis by axis.
pub(super) fn each(a: ToolPlace, b: ToolPlace, combine: impl Fn(f64, f64) -> f64) -> ToolPlace {
    let (a, b) = (axes(a), axes(b));
    place([
        combine(a[0], b[0]),
        combine(a[1], b[1]),
        combine(a[2], b[2]),
    ])
}
