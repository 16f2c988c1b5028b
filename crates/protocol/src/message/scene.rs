//! The parts of a scene that can be read and replaced: binary64 in SI, as in the scene's file.

use nalgebra::Vector2;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};
use trirrr_core::limits::LimitParameters;
use trirrr_core::machine::{Elbow, LegParameters, LinkParameters, Parameters, PlatformParameters};

/// Names a part.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum SectionName {
    /// A leg, from 0.
    Leg(u8),
    /// The platform and its loads.
    Platform,
    /// The limits.
    Limits,
}

/// A part with its values.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub enum Section {
    /// A leg.
    Leg {
        /// Number of the leg, from 0.
        index: u8,
        /// The leg.
        leg: Leg,
    },
    /// The platform and its loads.
    Platform(Platform),
    /// The limits.
    Limits(Limits),
}

impl Section {
    /// The part `name` of a scene that is given in SI units; none where there is no such leg.
    pub fn of(
        name: SectionName,
        parameters: &Parameters,
        limits: &LimitParameters,
    ) -> Option<Self> {
        Some(match name {
            SectionName::Leg(index) => Self::Leg {
                index,
                leg: parameters.legs.get(usize::from(index))?.into(),
            },
            SectionName::Platform => Self::Platform(parameters.into()),
            SectionName::Limits => Self::Limits(limits.into()),
        })
    }
}

/// One leg.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct Leg {
    /// Base joint A in the fixed frame, m.
    pub base_m: [f64; 2],
    /// Length of the proximal link, m.
    pub proximal_m: f64,
    /// Length of the distal link, m.
    pub distal_m: f64,
    /// Distance of the platform joint from the reference point, m.
    pub joint_radius_m: f64,
    /// Its direction in the platform's frame, rad.
    pub joint_angle_rad: f64,
    /// `true`: the elbow lies to the left of A -> C.
    pub elbow_positive: bool,
    /// Mass of the proximal link (kg), distance of its centre of mass from A (m), its moment of
    /// inertia about that (kg m^2).
    pub proximal: [f64; 3],
    /// The same of the distal link, from B.
    pub distal: [f64; 3],
    /// Rotor inertia at the joint, kg m^2.
    pub rotor_inertia_kgm2: f64,
    /// Encoder offset, rad, -pi to pi: the motor stands at the angle that its drive counted as the image was made,
    /// plus this. 0 in an image.
    pub encoder_offset_rad: f64,
}

/// The platform and its loads.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct Platform {
    /// Mass, kg.
    pub mass_kg: f64,
    /// Moment of inertia about the centre of mass, kg m^2.
    pub inertia_kgm2: f64,
    /// Centre of mass from the reference point D, in the platform's frame, m.
    pub com_m: [f64; 2],
    /// Gravity, m/s^2.
    pub gravity_m_s2: [f64; 2],
    /// External force at the reference point, N.
    pub wrench_force_n: [f64; 2],
    /// External moment, N m.
    pub wrench_torque_nm: f64,
    /// Place of the reference point D, the tool point, in the frame of the bare platform, m. Another one takes the platform joints of all
    /// legs along.
    pub tool_point_m: [f64; 2],
}

/// The limits that a move must keep. `None`: no limit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct Limits {
    /// Largest joint rate of either sign, rad/s.
    pub rate_rad_s: Option<[f64; 3]>,
    /// Largest joint acceleration of either sign, rad/s^2.
    pub acceleration_rad_s2: Option<[f64; 3]>,
    /// Largest torque at the joint of either sign, N m.
    pub torque_nm: Option<[f64; 3]>,
    /// Largest mechanical power of either sign, W.
    pub power_w: Option<[f64; 3]>,
    /// Largest joint jerk of either sign, rad/s^3.
    pub jerk_rad_s3: Option<[f64; 3]>,
    /// Least [distance](trirrr_core::singularity) of each leg from its serial singularity.
    pub serial_distance_min: f64,
    /// Least [distance](trirrr_core::singularity) from the parallel singularity.
    pub parallel_distance_min: f64,
}

fn link(link: LinkParameters) -> [f64; 3] {
    [link.mass_kg, link.com_m, link.inertia_kgm2]
}

fn link_parameters([mass_kg, com_m, inertia_kgm2]: [f64; 3]) -> LinkParameters {
    LinkParameters {
        mass_kg,
        com_m,
        inertia_kgm2,
    }
}

impl From<&LegParameters> for Leg {
    fn from(leg: &LegParameters) -> Self {
        Self {
            base_m: leg.base_m.into(),
            proximal_m: leg.proximal_m,
            distal_m: leg.distal_m,
            joint_radius_m: leg.joint_radius_m,
            joint_angle_rad: leg.joint_angle_rad,
            elbow_positive: leg.elbow == Elbow::Positive,
            proximal: link(leg.proximal),
            distal: link(leg.distal),
            rotor_inertia_kgm2: leg.rotor_inertia_kgm2,
            encoder_offset_rad: 0.0,
        }
    }
}

impl From<&Leg> for LegParameters {
    fn from(leg: &Leg) -> Self {
        Self {
            base_m: Vector2::from(leg.base_m),
            proximal_m: leg.proximal_m,
            distal_m: leg.distal_m,
            joint_radius_m: leg.joint_radius_m,
            joint_angle_rad: leg.joint_angle_rad,
            elbow: if leg.elbow_positive {
                Elbow::Positive
            } else {
                Elbow::Negative
            },
            proximal: link_parameters(leg.proximal),
            distal: link_parameters(leg.distal),
            rotor_inertia_kgm2: leg.rotor_inertia_kgm2,
        }
    }
}

impl From<&Parameters> for Platform {
    fn from(parameters: &Parameters) -> Self {
        Self {
            mass_kg: parameters.platform.mass_kg,
            inertia_kgm2: parameters.platform.inertia_kgm2,
            com_m: parameters.platform.com_m.into(),
            gravity_m_s2: parameters.gravity_m_s2.into(),
            wrench_force_n: parameters.wrench_force_n.into(),
            wrench_torque_nm: parameters.wrench_torque_nm,
            tool_point_m: parameters.platform.tool_point_m.into(),
        }
    }
}

impl Platform {
    /// `parameters` with this platform and these loads. Platform joints stay where they are on the platform, and are given from its
    /// tool point.
    pub fn put_into(&self, parameters: &Parameters) -> Parameters {
        let tool_point_m = Vector2::from(self.tool_point_m);
        Parameters {
            platform: PlatformParameters {
                mass_kg: self.mass_kg,
                inertia_kgm2: self.inertia_kgm2,
                com_m: Vector2::from(self.com_m),
                tool_point_m,
            },
            gravity_m_s2: Vector2::from(self.gravity_m_s2),
            wrench_force_n: Vector2::from(self.wrench_force_n),
            wrench_torque_nm: self.wrench_torque_nm,
            ..parameters.at_tool_point(tool_point_m)
        }
    }
}

impl From<&LimitParameters> for Limits {
    fn from(limits: &LimitParameters) -> Self {
        Self {
            rate_rad_s: limits.rate_rad_s,
            acceleration_rad_s2: limits.acceleration_rad_s2,
            torque_nm: limits.torque_nm,
            power_w: limits.power_w,
            jerk_rad_s3: limits.jerk_rad_s3,
            serial_distance_min: limits.serial_distance_min,
            parallel_distance_min: limits.parallel_distance_min,
        }
    }
}

impl From<&Limits> for LimitParameters {
    fn from(limits: &Limits) -> Self {
        Self {
            rate_rad_s: limits.rate_rad_s,
            acceleration_rad_s2: limits.acceleration_rad_s2,
            torque_nm: limits.torque_nm,
            power_w: limits.power_w,
            jerk_rad_s3: limits.jerk_rad_s3,
            serial_distance_min: limits.serial_distance_min,
            parallel_distance_min: limits.parallel_distance_min,
        }
    }
}
