//! Settings of a calibration.

use crate::parameter::{DEVICE, PARAMETER_COUNT, ParameterGroup, TARGET, is_angle};

/// Settings of a calibration.
#[derive(Clone, Debug, PartialEq)]
pub struct CalibrationSetup {
    /// Parameters that are fitted.
    pub free: Vec<ParameterGroup>,
    /// Frame of the device in that of the machine, x and y in m and angle in rad; a first guess where it is free.
    pub device: [f64; 3],
    /// Target on the platform, the same.
    pub target: [f64; 3],
    /// Deviation that is expected of a length or a coordinate of a part, m.
    pub expected_m: f64,
    /// Deviation that is expected of an encoder offset, rad.
    pub expected_rad: f64,
    /// Keeps outliers in the fit.
    pub keeps_outliers: bool,
}

impl Default for CalibrationSetup {
    /// Free are the parts of the machine and its encoder offsets; the device's frame is that of the machine, and the target D.
    fn default() -> Self {
        Self {
            free: ParameterGroup::ALL[..5].to_vec(),
            device: [0.0; 3],
            target: [0.0; 3],
            expected_m: 1e-3,
            expected_rad: 0.01,
            keeps_outliers: false,
        }
    }
}

impl CalibrationSetup {
    /// Indices of the free parameters.
    pub(crate) fn free_indices(&self) -> Vec<usize> {
        let is_free = |index: &usize| self.free.contains(&ParameterGroup::of(*index));
        (0..PARAMETER_COUNT).filter(is_free).collect()
    }

    /// Deviation that is expected of each parameter. A device stands anywhere; a target is put on by hand.
    pub(crate) fn expected(&self) -> [f64; PARAMETER_COUNT] {
        std::array::from_fn(|index| match index {
            TARGET.. if is_angle(index) => 0.1,
            TARGET.. => 10.0 * self.expected_m,
            DEVICE.. => 1.0,
            _ if is_angle(index) => self.expected_rad,
            _ => self.expected_m,
        })
    }
}
