//! Machines with a workspace to move about in.

use crate::draw::{Draw, within_a_turn};
use crate::instant::{Coordinates, Instant, State};
use crate::random::Case;
use nalgebra::Vector2;
use trirrr_core::machine::{Elbow, LegParameters, LinkParameters, Parameters, PlatformParameters};

/// One of two machines with the whole of their workspace, or any machine about a pose; a pose to start from, and how far to
/// turn from there.
pub fn machine(case: &Case, draw: &mut Draw) -> (Parameters, Coordinates, f64) {
    let family = draw.within(0.0, 3.0);
    if family < 1.0 {
        let case = within_a_turn(case);
        let mut parameters = case.parameters;
        for leg in &mut parameters.legs {
            // A rotor belongs to a drive.
            leg.rotor_inertia_kgm2 = 0.0;
        }
        let pose = case.setpoint.pose;
        let start = [pose.position.x, pose.position.y, pose.angle];
        return (parameters, start, 0.3);
    }
    let thesis = family < 2.0;
    let rods = draw.chance(0.5).then(|| draw.log_within(0.01, 0.3));
    let (bases, lengths, radius, elbow) = match thesis {
        true => (
            [[0.0, 0.433], [0.5, 0.433], [0.25, 0.0]],
            [0.2, 0.2],
            0.02,
            Elbow::Positive,
        ),
        false => (
            [[0.0, 0.7], [0.8, 0.7], [0.4, 0.0]],
            [0.3, 0.36],
            0.06,
            Elbow::Negative,
        ),
    };
    let angles = [150.0f64, 30.0, 270.0].map(f64::to_radians);
    let link = |length: f64| {
        rods.map_or(LinkParameters::default(), |mass| {
            LinkParameters::uniform_rod(mass, length)
        })
    };
    let legs = [0, 1, 2].map(|index: usize| LegParameters {
        base_m: Vector2::from(bases[index]),
        proximal_m: lengths[0],
        distal_m: lengths[1],
        joint_radius_m: radius,
        joint_angle_rad: angles[index],
        elbow,
        proximal: link(lengths[0]),
        distal: link(lengths[1]),
        rotor_inertia_kgm2: 0.0,
    });
    let mass = draw.log_within(0.1, 2.0);
    let pair = |draw: &mut Draw, part: f64, size: f64| match draw.chance(part) {
        true => Vector2::new(draw.within(-size, size), draw.within(-size, size)),
        false => Vector2::zeros(),
    };
    let parameters = Parameters {
        legs,
        platform: PlatformParameters {
            mass_kg: mass,
            inertia_kgm2: mass * draw.log_within(1e-3, 2e-2),
            com_m: pair(draw, 0.3, 0.02),
            tool_point_m: Vector2::new(0.0, 0.0),
        },
        gravity_m_s2: match draw.chance(0.3) {
            true => Vector2::new(0.0, -9.81),
            false => Vector2::zeros(),
        },
        wrench_force_n: pair(draw, 0.2, 1.0),
        wrench_torque_nm: if draw.chance(0.2) {
            draw.within(-0.05, 0.05)
        } else {
            0.0
        },
    };
    let start = match thesis {
        true => [
            draw.within(0.19, 0.31),
            draw.within(0.21, 0.33),
            draw.within(-0.1, 0.6),
        ],
        false => [
            draw.within(0.3, 0.5),
            draw.within(0.3, 0.5),
            draw.within(-0.5, 0.1),
        ],
    };
    (parameters, start, 0.6)
}

/// Distances that the job has to keep, and the side of the parallel singularity.
pub struct Workspace<'a> {
    /// The machine.
    pub parameters: &'a Parameters,
    /// Least distance from the serial singularities.
    pub serial_min: f64,
    /// Least distance from the parallel singularity.
    pub parallel_min: f64,
    /// Side of the parallel singularity: det A is positive.
    pub side: bool,
}

impl Workspace<'_> {
    /// Returns true if the pose is free, with room: what is drawn is feasible between the places too.
    pub fn holds(&self, at: Coordinates) -> bool {
        let state = State {
            pose: at,
            ..State::default()
        };
        let instant = Instant::kinematics(self.parameters, &state);
        instant
            .serial
            .into_iter()
            .all(|serial| serial > 1.25 * self.serial_min)
            && instant.parallel > 1.25 * self.parallel_min
            && instant.side == self.side
    }
}
