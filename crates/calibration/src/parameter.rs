//! Kinematic parameters of a machine and of its measurement, as one vector.

use std::fmt;
use trirrr_core::machine::Parameters;

/// Number of parameters: seven of each leg, three of the measuring device, three of the target.
pub const PARAMETER_COUNT: usize = 27;

/// Parameters of a leg, in this order: base joint x and y, proximal and distal length, platform joint x and y, encoder offset.
pub(crate) const PER_LEG: usize = 7;

/// First parameter of the device: x, y and angle of its frame.
pub(crate) const DEVICE: usize = 3 * PER_LEG;

/// First parameter of the target: x, y and angle on the platform.
pub(crate) const TARGET: usize = DEVICE + 3;

/// Parameters that are free or held together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParameterGroup {
    /// x and y of the base joints A.
    Base,
    /// Lengths of the proximal links.
    Proximal,
    /// Lengths of the distal links.
    Distal,
    /// x and y of the platform joints C, in the platform's frame.
    Joint,
    /// Joint angle less the angle that the encoder tells, of each motor.
    Offset,
    /// Frame of the measuring device in that of the machine.
    Device,
    /// Place and angle of the measured target on the platform.
    Target,
}

impl ParameterGroup {
    /// All groups.
    pub const ALL: [Self; 7] = [
        Self::Base,
        Self::Proximal,
        Self::Distal,
        Self::Joint,
        Self::Offset,
        Self::Device,
        Self::Target,
    ];

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Base => "base",
            Self::Proximal => "proximal",
            Self::Distal => "distal",
            Self::Joint => "joint",
            Self::Offset => "offset",
            Self::Device => "device",
            Self::Target => "target",
        }
    }

    /// Group of parameter `index`.
    pub fn of(index: usize) -> Self {
        match index {
            TARGET.. => Self::Target,
            DEVICE.. => Self::Device,
            _ => match index % PER_LEG {
                0 | 1 => Self::Base,
                2 => Self::Proximal,
                3 => Self::Distal,
                4 | 5 => Self::Joint,
                _ => Self::Offset,
            },
        }
    }
}

impl fmt::Display for ParameterGroup {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Returns true if parameter `index` is an angle, rad; otherwise it is a length, m.
pub fn is_angle(index: usize) -> bool {
    ParameterGroup::of(index) == ParameterGroup::Offset
        || index == DEVICE + 2
        || index == TARGET + 2
}

/// Name of parameter `index` for a person; legs are counted from 1.
pub fn parameter_name(index: usize) -> String {
    const OF_LEG: [&str; PER_LEG] = [
        "base joint x",
        "base joint y",
        "proximal length",
        "distal length",
        "platform joint x",
        "platform joint y",
        "encoder offset",
    ];
    const OTHERS: [&str; 6] = [
        "device x",
        "device y",
        "device angle",
        "target x",
        "target y",
        "target angle",
    ];
    match index.checked_sub(DEVICE) {
        Some(other) => OTHERS[other.min(5)].to_owned(),
        None => format!("leg {} {}", index / PER_LEG + 1, OF_LEG[index % PER_LEG]),
    }
}

/// Values of all parameters, m and rad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KinematicVector(pub [f64; PARAMETER_COUNT]);

impl KinematicVector {
    /// The machine of `parameters`, measured by a `device` whose frame lies at x, y and an angle in that of the machine; it
    /// measures a `target` at x, y and an angle in the platform's frame. m and rad.
    pub fn of(parameters: &Parameters, device: [f64; 3], target: [f64; 3]) -> Self {
        let mut values = [0.0; PARAMETER_COUNT];
        for (leg, own) in parameters.legs.iter().zip(values.chunks_mut(PER_LEG)) {
            let (sin, cos) = leg.joint_angle_rad.sin_cos();
            own.copy_from_slice(&[
                leg.base_m.x,
                leg.base_m.y,
                leg.proximal_m,
                leg.distal_m,
                leg.joint_radius_m * cos,
                leg.joint_radius_m * sin,
                0.0,
            ]);
        }
        values[DEVICE..TARGET].copy_from_slice(&device);
        values[TARGET..].copy_from_slice(&target);
        Self(values)
    }

    /// `parameters` with the geometry of this vector. Angles of platform joints stay within half a turn of what they were.
    pub fn put_into(&self, parameters: &Parameters) -> Parameters {
        let mut put = *parameters;
        for (leg, own) in put.legs.iter_mut().zip(self.0.chunks(PER_LEG)) {
            leg.base_m = [own[0], own[1]].into();
            (leg.proximal_m, leg.distal_m) = (own[2], own[3]);
            leg.joint_radius_m = own[4].hypot(own[5]);
            let turn = own[5].atan2(own[4]) - leg.joint_angle_rad;
            leg.joint_angle_rad += wrapped(turn);
        }
        put
    }

    /// Joint angle less the angle that the encoder tells, of each motor, rad.
    pub fn offsets_rad(&self) -> [f64; 3] {
        [0, 1, 2].map(|leg| self.0[leg * PER_LEG + PER_LEG - 1])
    }

    /// x, y (m) and angle (rad) of the device's frame in that of the machine.
    pub fn device(&self) -> [f64; 3] {
        [0, 1, 2].map(|part| self.0[DEVICE + part])
    }

    /// x, y (m) and angle (rad) of the target in the platform's frame.
    pub fn target(&self) -> [f64; 3] {
        [0, 1, 2].map(|part| self.0[TARGET + part])
    }
}

/// The angle within half a turn, rad.
pub(crate) fn wrapped(angle: f64) -> f64 {
    let turn = std::f64::consts::TAU;
    angle - turn * (angle / turn).round()
}

#[cfg(test)]
mod tests {
    use super::*;
    use trirrr_core::machine::example;

    #[test]
    fn a_machine_comes_back_out_of_its_vector() {
        let machine = example();
        let values = KinematicVector::of(&machine, [0.1, 0.2, 0.3], [0.0; 3]);
        let back = values.put_into(&machine);
        for (leg, own) in back.legs.iter().zip(&machine.legs) {
            assert!((leg.joint_angle_rad - own.joint_angle_rad).abs() < 1e-15);
            assert!((leg.joint_radius_m - own.joint_radius_m).abs() < 1e-17);
            assert_eq!((leg.base_m, leg.distal_m), (own.base_m, own.distal_m));
        }
        assert_eq!(values.device(), [0.1, 0.2, 0.3]);
    }

    #[test]
    fn each_parameter_has_a_name_of_its_own() {
        let mut names: Vec<String> = (0..PARAMETER_COUNT).map(parameter_name).collect();
        names.sort();
        names.dedup();
        assert_eq!(names.len(), PARAMETER_COUNT);
        assert_eq!(parameter_name(PER_LEG + 6), "leg 2 encoder offset");
        assert_eq!(ParameterGroup::of(DEVICE + 2), ParameterGroup::Device);
    }
}
