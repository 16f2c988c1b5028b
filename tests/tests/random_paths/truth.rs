//! The machine at one instant, by the independent model in plain `f64`.

use crate::geometry::Coordinates;
use nalgebra::Vector3;
use trirrr_core::machine::Parameters;
use trirrr_core::setpoint::{Pose, Setpoint};
use trirrr_tests::inputs::Inputs;
use trirrr_tests::model::Kinematics;

/// State of the platform.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct State {
    pub(crate) pose: Coordinates,
    pub(crate) velocity: Coordinates,
    pub(crate) acceleration: Coordinates,
}

/// Everything that a limit bounds. Not a number where a leg does not reach.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Instant {
    pub(crate) serial: [f64; 3],
    pub(crate) parallel: f64,
    /// det A is positive.
    pub(crate) side: bool,
    pub(crate) rate: [f64; 3],
    pub(crate) acceleration: [f64; 3],
    pub(crate) torque: [f64; 3],
}

fn inputs(parameters: &Parameters, state: &State) -> Inputs<f64> {
    let [x, y, alpha] = state.pose;
    let setpoint = Setpoint {
        pose: Pose::from_f64(x, y, alpha),
        velocity: Vector3::from(state.velocity),
        acceleration: Vector3::from(state.acceleration),
    };
    Inputs::constants(parameters, &setpoint)
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
    pub(crate) fn kinematics(parameters: &Parameters, state: &State) -> Self {
        let kinematics = inputs(parameters, state).kinematics();
        Self::from(parameters, &kinematics, [0.0; 3])
    }

    pub(crate) fn of(parameters: &Parameters, state: &State) -> Self {
        let inputs = inputs(parameters, state);
        let kinematics = inputs.kinematics();
        let torques = inputs.dynamics(&kinematics).torques;
        Self::from(parameters, &kinematics, torques)
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
