//! The results of a motion as a flat list, the same for the core and for the independent model.

use crate::double_double::DoubleDouble;
use crate::inputs::{Input, Inputs};
use crate::model::{Dynamics, Kinematics};
use crate::scalar::Scalar;
use core::f64::consts::TAU;
use trirrr_core::machine::Parameters;
use trirrr_core::number::Number;
use trirrr_core::reaction::Reactions;
use trirrr_core::setpoint::Setpoint;
use trirrr_core::status::Status;
use trirrr_core::tick::Motion;

/// Name of a result: a name from the reference files and the leg, 0 to 2, if it belongs to one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Name {
    /// As in the reference files, without the leg.
    pub stem: &'static str,
    /// The leg.
    pub leg: Option<usize>,
}

impl Name {
    /// The column in the reference files.
    pub fn column(self) -> String {
        match (self.leg, self.stem) {
            (None, stem) => stem.to_owned(),
            (Some(leg), stem) if stem.contains("th") => format!("{stem}_{}", leg + 1),
            (Some(leg), stem) => format!("{stem}{}", leg + 1),
        }
    }

    /// Returns true if the result is an angle, of which whole turns do not matter.
    pub fn is_angle(self) -> bool {
        matches!(self.stem, "th1" | "th2")
    }
}

/// The error of the angle `result`, without whole turns.
pub fn angle_error(truth: DoubleDouble, result: f64) -> f64 {
    let error = truth.error_of(result);
    if error.abs() > 3.0 {
        // 2 pi as pi is known to 53 bits and 53 more.
        let turn = DoubleDouble::sum(TAU, 2.449_293_598_294_706_4e-16);
        (truth + turn * DoubleDouble::new((error / TAU).round())).error_of(result)
    } else {
        error
    }
}

/// The results that every leg has, in the order of the lists.
const PER_LEG: [&str; 19] = [
    "xb", "yb", "xc", "yc", "th1", "th2", "dth1", "dth2", "ddth1", "ddth2", "D", "tau", "P", "FAx",
    "FAy", "FBx", "FBy", "FCx", "FCy",
];

/// Names of all results, in the order of the lists.
pub fn names() -> Vec<Name> {
    let of_legs = (0..3).flat_map(|leg| {
        PER_LEG.map(|stem| Name {
            stem,
            leg: Some(leg),
        })
    });
    of_legs
        .chain([Name {
            stem: "detA",
            leg: None,
        }])
        .collect()
}

/// The core's results.
///
/// # Errors
/// When a power or a joint force leaves the range of the number type.
pub fn of_core<N: Number>(
    parameters: &Parameters,
    setpoint: &Setpoint<N>,
    motion: &Motion<N>,
) -> Result<Vec<f64>, Status> {
    let forces = Reactions::build(parameters).forces(motion)?;
    let powers = motion.powers()?;
    let mut list: Vec<N> = Vec::with_capacity(3 * PER_LEG.len() + 1);
    for (leg, forces) in forces.iter().enumerate() {
        let base = parameters.legs[leg].base_m.map(N::from_f64);
        let (at, motor) = (&motion.legs[leg], &motion.motors[leg]);
        let b = base + at.position.links.r1;
        let c = setpoint.pose.position + at.position.platform_joint;
        let angles = [motor.angle, at.position.distal_angle()].map(N::radians);
        let joints = [forces.base, forces.elbow, forces.platform];
        list.extend([b.x, b.y, c.x, c.y, angles[0], angles[1]]);
        list.extend([motor.rate, at.rates.distal]);
        list.extend([motor.acceleration, at.accelerations.distal]);
        list.extend([at.position.links.r1_cross_r2, motor.torque, powers[leg]]);
        list.extend(joints.iter().flat_map(|force| [force.x, force.y]));
    }
    list.push(motion.forces.det_a);
    Ok(list.into_iter().map(N::to_f64).collect())
}

/// The model's results.
pub fn of_model<S: Scalar>(kinematics: &Kinematics<S>, dynamics: &Dynamics<S>) -> Vec<S> {
    let mut list = Vec::with_capacity(3 * PER_LEG.len() + 1);
    for (leg, motion) in kinematics.legs.iter().enumerate() {
        let torque = dynamics.torques[leg];
        list.extend(motion.joints.into_iter().flatten());
        list.extend(
            motion
                .angles
                .into_iter()
                .chain(motion.rates)
                .chain(motion.accelerations),
        );
        list.extend([motion.cross, torque, torque * motion.rates[0]]);
        list.extend(dynamics.forces[leg].into_iter().flatten());
    }
    list.push(kinematics.det_a);
    list
}

/// The true results for the inputs as they are.
pub fn truth<N: Number>(parameters: &Parameters, setpoint: &Setpoint<N>) -> Vec<DoubleDouble> {
    let inputs = Inputs::exact(parameters, setpoint);
    let kinematics = inputs.kinematics();
    of_model(&kinematics, &inputs.dynamics(&kinematics))
}

/// Condition of every result: the sum of |dq/dp p| over all inputs p.
pub fn conditions<N: Number>(parameters: &Parameters, setpoint: &Setpoint<N>) -> Vec<f64> {
    uncertainties(parameters, setpoint, |input| input.value.abs())
}

/// The same with the length of a vector in place of its components, larger than
/// [`conditions`] and the same in every direction.
pub fn isotropic_conditions<N: Number>(
    parameters: &Parameters,
    setpoint: &Setpoint<N>,
) -> Vec<f64> {
    uncertainties(parameters, setpoint, |input| input.length)
}

/// Computes how far every result moves, at most and to first order. Each input moves by what
/// `uncertainty` says of it. The value is the sum of |dq/dp| times that.
pub fn uncertainties<N: Number>(
    parameters: &Parameters,
    setpoint: &Setpoint<N>,
    uncertainty: impl Fn(Input) -> f64,
) -> Vec<f64> {
    let (inputs, sizes) = Inputs::variable(parameters, setpoint, uncertainty);
    let kinematics = inputs.kinematics();
    of_model(&kinematics, &inputs.dynamics(&kinematics))
        .iter()
        .map(|result| result.sensitivity(&sizes.0))
        .collect()
}
