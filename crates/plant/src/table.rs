//! The table of a run, `plant.csv`.

use crate::model::{Control, Plant};
use crate::motor::{MotorModel, wrapped};
use crate::refusal::Refusal;

/// One row: the plant at one instant, SI units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Row {
    /// Time, s.
    pub t: f64,
    /// x, y, alpha.
    pub pose: [f64; 3],
    /// Their rates.
    pub rates: [f64; 3],
    /// Currents; 0 where a motor has none.
    pub currents: [f64; 3],
    /// Voltages; 0 where a motor has none.
    pub voltages: [f64; 3],
    /// Joint angles theta_i1, in (-pi, pi].
    pub angles: [f64; 3],
    /// Joint rates.
    pub joint_rates: [f64; 3],
    /// Reference angles of the joints.
    pub references: [f64; 3],
    /// Torques of the motors at the joints, N m.
    pub torques: [f64; 3],
    /// Mechanical powers of the motors, W.
    pub powers: [f64; 3],
    /// Angles on the rotors' side of the transmissions, unwrapped.
    pub rotors: [f64; 3],
    /// Setpoint of the platform: x, y, alpha.
    pub setpoint: [f64; 3],
}

/// Columns of `plant.csv`.
pub const COLUMNS: [&str; 34] = [
    "t", "x", "y", "alpha", "vx", "vy", "valpha", "i1", "i2", "i3", "u1", "u2", "u3", "th1_1",
    "th1_2", "th1_3", "dth1_1", "dth1_2", "dth1_3", "thref_1", "thref_2", "thref_3", "tau1",
    "tau2", "tau3", "P1", "P2", "P3", "phi1", "phi2", "phi3", "xref", "yref", "alpharef",
];

impl Row {
    /// The plant at `t` in the state `y`. Statistics of a controller without samples are gathered
    /// here, for it has no other instants.
    ///
    /// # Errors
    /// As the plant's equations.
    pub(crate) fn of<const N: usize>(
        plant: &mut Plant<N>,
        t: f64,
        y: &[f64; N],
    ) -> Result<Self, Refusal> {
        let outputs = plant.outputs(t, y)?;
        let references = match plant.references(t) {
            Some(references) => references?.map(|reference| reference.angle),
            None => plant.commands.angle,
        };
        let voltage = |leg: usize| match &plant.motors[leg] {
            MotorModel::Bldc(_) => outputs.told[leg],
            MotorModel::Ideal | MotorModel::Stepper(_) => 0.0,
        };
        let pose = plant.path.at(t).pose;
        let row = Self {
            t,
            pose: outputs.pose,
            rates: outputs.rates,
            currents: outputs.currents,
            voltages: [voltage(0), voltage(1), voltage(2)],
            angles: outputs.angles,
            joint_rates: outputs.legs.map(|leg| leg.rates[0]),
            references,
            torques: outputs.torques,
            powers: [0, 1, 2].map(|leg| outputs.torques[leg] * outputs.rotor_rates[leg]),
            rotors: outputs.rotor_angles,
            setpoint: [pose.position.x, pose.position.y, pose.angle],
        };
        plant.statistics.tool(t, row.pose, row.setpoint);
        if let Control::Continuous(_) = &plant.control {
            for leg in 0..3 {
                let motor = &mut plant.statistics.motors[leg];
                motor
                    .error
                    .push(t, wrapped(row.references[leg] - row.angles[leg]));
                motor.torque.push(t, row.torques[leg]);
                motor.current.push(t, row.currents[leg]);
                motor.power.push(t, row.powers[leg]);
            }
        }
        Ok(row)
    }

    /// The values of the columns.
    pub fn values(&self) -> [f64; COLUMNS.len()] {
        let mut values = [0.0; COLUMNS.len()];
        values[0] = self.t;
        let triples = [
            self.pose,
            self.rates,
            self.currents,
            self.voltages,
            self.angles,
            self.joint_rates,
            self.references,
            self.torques,
            self.powers,
            self.rotors,
            self.setpoint,
        ];
        for (place, value) in values[1..].iter_mut().zip(triples.iter().flatten()) {
            *place = *value;
        }
        values
    }
}
