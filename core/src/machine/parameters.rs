//! Description of a machine, as a scene or a batch row gives it.

use crate::number::Arithmetic;
use crate::to_source;
use nalgebra::Vector2;

/// Sign of an elbow. The three of a machine are its *working mode* (eight of them).
///
/// `Positive` on every leg is the thesis's mode, theta_i1 = theta_AC + gamma: seen along A -> C
/// the elbow lies on the left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Elbow {
    /// sigma = +1: the elbow lies to the left of A -> C.
    Positive,
    /// sigma = -1: the elbow lies to the right of A -> C.
    Negative,
}

to_source!(pub Elbow in trirrr_core::machine: Positive, Negative);

impl Elbow {
    /// sigma as a number, +1 or -1.
    pub fn sign(self) -> f64 {
        match self {
            Elbow::Positive => 1.0,
            Elbow::Negative => -1.0,
        }
    }
}

/// One rigid link. All zero: massless.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct LinkParameters {
    /// Mass, kg, not negative.
    pub mass_kg: f64,
    /// Distance of the centre of mass from the inner joint along the link, m.
    pub com_m: f64,
    /// Moment of inertia about the centre of mass, kg m^2, not negative.
    pub inertia_kgm2: f64,
}

to_source!(pub [] LinkParameters [] in trirrr_core::machine { mass_kg, com_m, inertia_kgm2 });

impl LinkParameters {
    /// A uniform rod: centre of mass in the middle, I = m l^2 / 12.
    pub fn uniform_rod(mass_kg: f64, length_m: f64) -> Self {
        Self {
            mass_kg,
            com_m: length_m / 2.0,
            inertia_kgm2: mass_kg * length_m * length_m / 12.0,
        }
    }

    /// Returns `true` if the link has neither mass nor inertia. The image then needs no link code.
    pub fn is_massless(&self) -> bool {
        self.mass_kg == 0.0 && self.inertia_kgm2 == 0.0
    }
}

/// One leg: motor at A, proximal link A -> B, distal link B -> C, platform joint C.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LegParameters {
    /// Base joint A in the fixed frame, m.
    pub base_m: Vector2<f64>,
    /// Length of the proximal link A -> B, m, positive.
    pub proximal_m: f64,
    /// Length of the distal link B -> C, m, positive.
    pub distal_m: f64,
    /// Distance of the platform joint C from the platform's reference point D, m, not negative.
    pub joint_radius_m: f64,
    /// Direction D -> C in the platform's frame, rad, counter-clockwise from its x axis.
    pub joint_angle_rad: f64,
    /// Sign of the elbow.
    pub elbow: Elbow,
    /// The proximal link's mass; its centre of mass is measured from A.
    pub proximal: LinkParameters,
    /// The distal link's mass; its centre of mass is measured from B.
    pub distal: LinkParameters,
    /// Rotor inertia seen at the joint, N^2 J_r behind a gear of ratio N, kg m^2.
    pub rotor_inertia_kgm2: f64,
}

to_source!(pub [] LegParameters [] in trirrr_core::machine {
    base_m,
    proximal_m,
    distal_m,
    joint_radius_m,
    joint_angle_rad,
    elbow,
    proximal,
    distal,
    rotor_inertia_kgm2,
});

/// The platform (end-effector with its payload).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlatformParameters {
    /// Mass, kg, not negative.
    pub mass_kg: f64,
    /// Moment of inertia about the centre of mass, kg m^2, not negative.
    pub inertia_kgm2: f64,
    /// Centre of mass relative to the reference point D, in the platform's frame, m.
    pub com_m: Vector2<f64>,
    /// Place of the reference point D, the tool point, in the frame of the bare platform, m. No stage reads it: all else is given
    /// from D. [`Parameters::at_tool_point`] takes another tool point.
    pub tool_point_m: Vector2<f64>,
}

to_source!(pub [] PlatformParameters [] in trirrr_core::machine {
    mass_kg,
    inertia_kgm2,
    com_m,
    tool_point_m,
});

/// A whole machine with its loads, in SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters {
    /// The three legs.
    pub legs: [LegParameters; 3],
    /// The platform.
    pub platform: PlatformParameters,
    /// Gravity in the plane, m/s^2; zero for a horizontal machine.
    pub gravity_m_s2: Vector2<f64>,
    /// External force on the platform at D, in the fixed frame, N.
    pub wrench_force_n: Vector2<f64>,
    /// External moment on the platform, N m, counter-clockwise positive.
    pub wrench_torque_nm: f64,
}

to_source!(pub [] Parameters [] in trirrr_core::machine {
    legs,
    platform,
    gravity_m_s2,
    wrench_force_n,
    wrench_torque_nm,
});

impl LegParameters {
    /// The same leg, with the reference point D of the platform `by` farther in the platform's frame, m.
    #[must_use]
    pub fn with_reference_moved(&self, by: Vector2<f64>) -> Self {
        let (sin, cos) = <f64 as Arithmetic>::sin_cos(self.joint_angle_rad);
        let joint = Vector2::new(cos, sin) * self.joint_radius_m - by;
        Self {
            joint_radius_m: <f64 as Arithmetic>::sqrt(joint.dot(&joint)),
            joint_angle_rad: <f64 as Arithmetic>::atan2(joint.y, joint.x),
            ..*self
        }
    }
}

impl PlatformParameters {
    /// The same platform with its reference point D at `tool_point_m` in the frame of the bare platform, m.
    #[must_use]
    pub fn at_tool_point(&self, tool_point_m: Vector2<f64>) -> Self {
        Self {
            com_m: self.com_m - (tool_point_m - self.tool_point_m),
            tool_point_m,
            ..*self
        }
    }
}

impl Parameters {
    /// The same machine with the reference point D of its platform at `tool_point_m` in the frame of the bare platform, m: platform joints
    /// and centre of mass are given from there. The external force acts there.
    #[must_use]
    pub fn at_tool_point(&self, tool_point_m: Vector2<f64>) -> Self {
        let by = tool_point_m - self.platform.tool_point_m;
        // The bits of an unchanged machine stay.
        if by == Vector2::new(0.0, 0.0) {
            return *self;
        }
        Self {
            legs: self.legs.map(|leg| leg.with_reference_moved(by)),
            platform: self.platform.at_tool_point(tool_point_m),
            ..*self
        }
    }

    /// Returns `true` if no link has mass or inertia.
    pub fn links_are_massless(&self) -> bool {
        self.legs
            .iter()
            .all(|leg| leg.proximal.is_massless() && leg.distal.is_massless())
    }

    /// Returns true if the motors may have to hold something at rest: gravity or a wrench.
    pub fn is_loaded_at_rest(&self) -> bool {
        let (gravity, force) = (self.gravity_m_s2, self.wrench_force_n);
        let loads = [
            gravity.x,
            gravity.y,
            force.x,
            force.y,
            self.wrench_torque_nm,
        ];
        loads.iter().any(|&load| load != 0.0)
    }

    /// The greatest size that det A can have: l2_1 l2_2 l2_3 times half the perimeter of the
    /// platform's triangle, m^4.
    pub fn greatest_det_a(&self) -> f64 {
        let joints = self.legs.map(|leg| {
            let (sin, cos) = <f64 as Arithmetic>::sin_cos(leg.joint_angle_rad);
            Vector2::new(cos, sin) * leg.joint_radius_m
        });
        let side = |a: usize, b: usize| {
            let edge: Vector2<f64> = joints[b] - joints[a];
            Arithmetic::sqrt(edge.x * edge.x + edge.y * edge.y)
        };
        let half_perimeter = (side(0, 1) + side(1, 2) + side(2, 0)) / 2.0;
        self.legs
            .iter()
            .fold(half_perimeter, |product, leg| product * leg.distal_m)
    }
}

/// Returns the thesis machine, SI units: the example of documentation and tests.
pub fn example() -> Parameters {
    let leg = |x: f64, y: f64, joint_angle_rad: f64| LegParameters {
        base_m: Vector2::new(x, y),
        proximal_m: 0.2,
        distal_m: 0.2,
        joint_radius_m: 0.02,
        joint_angle_rad,
        elbow: Elbow::Positive,
        proximal: LinkParameters::default(),
        distal: LinkParameters::default(),
        rotor_inertia_kgm2: 0.0,
    };
    Parameters {
        legs: [
            leg(0.0, 0.433, 2.617_993_877_991_494_4),
            leg(0.5, 0.433, 0.523_598_775_598_298_8),
            leg(0.25, 0.0, 4.712_388_980_384_69),
        ],
        platform: PlatformParameters {
            mass_kg: 0.5,
            inertia_kgm2: 0.0025,
            com_m: Vector2::new(0.0, 0.0),
            tool_point_m: Vector2::new(0.0, 0.0),
        },
        gravity_m_s2: Vector2::new(0.0, 0.0),
        wrench_force_n: Vector2::new(0.0, 0.0),
        wrench_torque_nm: 0.0,
    }
}
