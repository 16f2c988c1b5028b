//! The machine at one instant, by the independent model in plain `f64`.

use crate::inputs::Inputs;
use crate::jet::Jet;
use crate::model::Kinematics;
use crate::scalar::Scalar;
use nalgebra::Vector3;
use trirrr_core::limits::LimitParameters;
use trirrr_core::machine::Parameters;
use trirrr_core::setpoint::{Pose, Setpoint};

/// x, y, alpha.
pub type Coordinates = [f64; 3];

/// Rounding of the independent model, as a part of a value.
const ROUNDING: f64 = 1e-11;

/// State of the platform.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    /// x, y, alpha.
    pub pose: Coordinates,
    /// Its derivative by time.
    pub velocity: Coordinates,
    /// The second derivative.
    pub acceleration: Coordinates,
}

/// Ends of a quintic.
#[derive(Clone, Copy, Debug)]
pub struct QuinticEnds {
    /// States at both ends.
    pub states: [State; 2],
    /// Duration.
    pub duration_s: f64,
}

impl QuinticEnds {
    /// The state after `part` of the duration, by de Casteljau's algorithm, which shares no formula with the setpoints
    /// of the core.
    pub fn at(&self, part: f64) -> State {
        let fifth = self.duration_s / 5.0;
        let [from, to] = &self.states;
        let mut state = State::default();
        for axis in 0..3 {
            let [v0, v1] = [from, to].map(|end| end.velocity[axis] * fifth);
            // The second difference of control points is T^2 a / 20.
            let [a0, a1] = [from, to].map(|end| end.acceleration[axis] * fifth * fifth * 1.25);
            let (from, to) = (from.pose[axis], to.pose[axis]);
            let mut points = vec![
                from,
                from + v0,
                from + 2.0 * v0 + a0,
                to - 2.0 * v1 + a1,
                to - v1,
                to,
            ];
            while points.len() > 1 {
                match points[..] {
                    [a, b] => state.velocity[axis] = (b - a) / fifth,
                    [a, b, c] => {
                        state.acceleration[axis] = (a - 2.0 * b + c) * 0.8 / (fifth * fifth);
                    }
                    _ => {}
                }
                points = points
                    .windows(2)
                    .map(|pair| pair[0] * (1.0 - part) + pair[1] * part)
                    .collect();
            }
            state.pose[axis] = points[0];
        }
        state
    }

    /// Third derivative of the pose after `part` of the duration: a parabola through the third differences of the control
    /// points, which are T^3 / 60 of it.
    pub fn jerk_at(&self, part: f64) -> Coordinates {
        let fifth = self.duration_s / 5.0;
        let [from, to] = &self.states;
        core::array::from_fn(|axis| {
            let [v0, v1] = [from, to].map(|end| end.velocity[axis] * fifth);
            let [a0, a1] = [from, to].map(|end| end.acceleration[axis] * fifth * fifth * 1.25);
            // From the nearer end: a difference of poses that are far away has more rounding.
            let middle = (to.pose[axis] - from.pose[axis]) - 2.0 * (v0 + v1) - (a0 - a1);
            // First differences of the control points are v0, v0 + a0, middle, v1 - a1, v1.
            let [b, c, d] = [
                middle - v0 - 2.0 * a0,
                v0 + v1 + a0 - a1 - 2.0 * middle,
                middle - v1 + 2.0 * a1,
            ];
            let rest = 1.0 - part;
            let blend = b * rest * rest + 2.0 * c * rest * part + d * part * part;
            blend * 0.48 / (fifth * fifth * fifth)
        })
    }
}

/// Everything that a limit bounds. Not a number where a leg does not reach.
#[derive(Clone, Copy, Debug)]
pub struct Instant {
    /// Distances from the serial singularities.
    pub serial: [f64; 3],
    /// Distance from the parallel singularity.
    pub parallel: f64,
    /// det A is positive.
    pub side: bool,
    /// rad/s.
    pub rate: [f64; 3],
    /// rad/s^2.
    pub acceleration: [f64; 3],
    /// N m.
    pub torque: [f64; 3],
}

fn inputs<S: Scalar>(parameters: &Parameters, state: &State) -> Inputs<S> {
    let [x, y, alpha] = state.pose;
    let setpoint = Setpoint {
        pose: Pose::from_f64(x, y, alpha),
        velocity: Vector3::from(state.velocity),
        acceleration: Vector3::from(state.acceleration),
    };
    Inputs::constants(parameters, &setpoint)
}

/// Jerks of the motors, rad/s^3, where the platform has the jerk `jerk`: the third derivatives of the angles, which the
/// independent model finds from poses alone.
pub fn jerks(parameters: &Parameters, state: &State, jerk: Coordinates) -> [f64; 3] {
    let zero = State {
        pose: state.pose,
        ..State::default()
    };
    let along = |axis: usize| {
        Jet::from_derivatives([
            state.pose[axis],
            state.velocity[axis],
            state.acceleration[axis],
            jerk[axis],
        ])
    };
    let moving = Inputs {
        position: [along(0), along(1)],
        angle: along(2),
        ..inputs::<Jet>(parameters, &zero)
    };
    moving
        .kinematics()
        .legs
        .map(|leg| leg.angles[0].derivatives()[3])
}

impl Instant {
    fn from(parameters: &Parameters, kinematics: &Kinematics<f64>, torque: [f64; 3]) -> Self {
        let legs = &kinematics.legs;
        let serial = |leg: usize| {
            let lengths = parameters.legs[leg].proximal_m * parameters.legs[leg].distal_m;
            legs[leg].cross.abs() / lengths
        };
        Self {
            serial: [0, 1, 2].map(serial),
            parallel: kinematics.det_a.abs() / greatest_det_a(parameters),
            side: kinematics.det_a > 0.0,
            rate: [0, 1, 2].map(|leg: usize| legs[leg].rates[0]),
            acceleration: [0, 1, 2].map(|leg: usize| legs[leg].accelerations[0]),
            torque,
        }
    }

    /// Without torques.
    pub fn kinematics(parameters: &Parameters, state: &State) -> Self {
        let kinematics = inputs::<f64>(parameters, state).kinematics();
        Self::from(parameters, &kinematics, [0.0; 3])
    }

    /// With torques.
    pub fn of(parameters: &Parameters, state: &State) -> Self {
        let inputs = inputs::<f64>(parameters, state);
        let kinematics = inputs.kinematics();
        let torques = inputs.dynamics(&kinematics).torques;
        Self::from(parameters, &kinematics, torques)
    }

    /// The largest part of a limit, at most 1 where all are kept; infinite where a value is none. `side`: that of the path.
    pub fn part_of(&self, limits: &LimitParameters, side: bool) -> f64 {
        let power: [f64; 3] = core::array::from_fn(|motor| self.torque[motor] * self.rate[motor]);
        let mut most: f64 = match self.side == side {
            true => 0.0,
            false => f64::INFINITY,
        };
        let mut note = |part: f64| {
            most = if part.is_nan() {
                f64::INFINITY
            } else {
                most.max(part)
            }
        };
        for (limit, values) in [
            (limits.rate_rad_s, self.rate),
            (limits.acceleration_rad_s2, self.acceleration),
            (limits.torque_nm, self.torque),
            (limits.power_w, power),
        ] {
            for (limit, value) in limit.iter().flatten().zip(values) {
                note(value.abs() * (1.0 - ROUNDING) / limit);
            }
        }
        for serial in self.serial {
            note(limits.serial_distance_min * (1.0 - ROUNDING) / serial);
        }
        note(limits.parallel_distance_min * (1.0 - ROUNDING) / self.parallel);
        most
    }
}

/// l2_1 l2_2 l2_3 times half the perimeter of the platform's triangle.
fn greatest_det_a(parameters: &Parameters) -> f64 {
    let joints = parameters.legs.map(|leg| {
        let (sin, cos) = leg.joint_angle_rad.sin_cos();
        [leg.joint_radius_m * cos, leg.joint_radius_m * sin]
    });
    let side =
        |a: usize, b: usize| (joints[a][0] - joints[b][0]).hypot(joints[a][1] - joints[b][1]);
    let half = 0.5 * (side(0, 1) + side(1, 2) + side(2, 0));
    parameters
        .legs
        .iter()
        .map(|leg| leg.distal_m)
        .product::<f64>()
        * half
}
