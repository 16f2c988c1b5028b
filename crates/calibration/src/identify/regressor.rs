//! Torques by unit of each parameter: the core's own model with one parameter at a time.

use super::bodies::{BODY_COUNT, FRICTION, PASSIVE, PER_BODY_LEG, PLATFORM, READING};
use nalgebra::{Matrix3, Vector2, Vector3};
use trirrr_core::machine::{LinkParameters, Parameters, PlatformParameters};
use trirrr_core::setpoint::Setpoint;
use trirrr_design::ratios::Ratios;
use trirrr_scene::pipeline::{Pipeline, build};

/// Torques of the three motors, N m, by each parameter.
pub(crate) struct TorqueRows {
    pub(crate) slopes: [[f64; BODY_COUNT]; 3],
    /// Torques of the wrench, which is known.
    pub(crate) known: [f64; 3],
    /// Rates of the joints: motors, elbows, platform joints, rad/s.
    pub(crate) rates: [[f64; 3]; 3],
}

/// The core's model of machines that each have one body of mass or inertia 1.
pub(crate) struct UnitMachines {
    /// Proximal link: mass at 1 m, inertia. Distal link: mass at B, mass at 1 m, inertia. Of each leg.
    legs: [[Box<dyn Pipeline<f64>>; PER_BODY_LEG]; 3],
    /// Platform: mass at D, at x = 1 m, at y = 1 m, inertia.
    platform: [Box<dyn Pipeline<f64>>; 4],
    wrench: Box<dyn Pipeline<f64>>,
}

const NO_LINK: LinkParameters = LinkParameters {
    mass_kg: 0.0,
    com_m: 0.0,
    inertia_kgm2: 0.0,
};

fn point(com_m: f64) -> LinkParameters {
    LinkParameters {
        mass_kg: 1.0,
        com_m,
        inertia_kgm2: 0.0,
    }
}

const WHEEL: LinkParameters = LinkParameters {
    mass_kg: 0.0,
    com_m: 0.0,
    inertia_kgm2: 1.0,
};

fn platform(mass_kg: f64, com: [f64; 2], inertia_kgm2: f64) -> PlatformParameters {
    PlatformParameters {
        mass_kg,
        inertia_kgm2,
        com_m: Vector2::from(com),
        tool_point_m: Vector2::new(0.0, 0.0),
    }
}

impl UnitMachines {
    /// Machines of the geometry and the gravity of `parameters`. None where that is no machine.
    pub(crate) fn new(parameters: &Parameters) -> Option<Self> {
        let mut bare = *parameters;
        bare.platform = platform(0.0, [0.0; 2], 0.0);
        (bare.wrench_force_n, bare.wrench_torque_nm) = (Vector2::new(0.0, 0.0), 0.0);
        for leg in &mut bare.legs {
            (leg.proximal, leg.distal, leg.rotor_inertia_kgm2) = (NO_LINK, NO_LINK, 0.0);
        }
        let of_leg = |leg: usize, proximal: LinkParameters, distal: LinkParameters| {
            let mut machine = bare;
            (machine.legs[leg].proximal, machine.legs[leg].distal) = (proximal, distal);
            build::<f64>(&machine).ok()
        };
        let leg = |leg: usize| {
            Some([
                of_leg(leg, point(1.0), NO_LINK)?,
                of_leg(leg, WHEEL, NO_LINK)?,
                of_leg(leg, NO_LINK, point(0.0))?,
                of_leg(leg, NO_LINK, point(1.0))?,
                of_leg(leg, NO_LINK, WHEEL)?,
            ])
        };
        let of_platform = |body: PlatformParameters| {
            let mut machine = bare;
            machine.platform = body;
            build::<f64>(&machine).ok()
        };
        let mut wrench = bare;
        wrench.wrench_force_n = parameters.wrench_force_n;
        wrench.wrench_torque_nm = parameters.wrench_torque_nm;
        Some(Self {
            legs: [leg(0)?, leg(1)?, leg(2)?],
            platform: [
                of_platform(platform(1.0, [0.0; 2], 0.0))?,
                of_platform(platform(1.0, [1.0, 0.0], 0.0))?,
                of_platform(platform(1.0, [0.0, 1.0], 0.0))?,
                of_platform(platform(0.0, [0.0; 2], 1.0))?,
            ],
            wrench: build::<f64>(&wrench).ok()?,
        })
    }

    /// Torques at a setpoint; none where it has no motion.
    pub(crate) fn rows(&self, setpoint: &Setpoint<f64>) -> Option<TorqueRows> {
        let torques = |machine: &dyn Pipeline<f64>| {
            let record = machine.evaluate(0.0, setpoint).ok()?;
            Some(record.legs.map(|leg| leg.torque))
        };
        let mut slopes = [[0.0; BODY_COUNT]; 3];
        let mut put = |index: usize, column: [f64; 3]| {
            for (row, value) in slopes.iter_mut().zip(column) {
                row[index] = value;
            }
        };
        let less = |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|motor| a[motor] - b[motor]);
        for (leg, machines) in self.legs.iter().enumerate() {
            let [far, wheel, near, distal_far, distal_wheel] =
                [0, 1, 2, 3, 4].map(|index: usize| torques(&*machines[index]));
            let (wheel, near, distal_wheel) = (wheel?, near?, distal_wheel?);
            // A mass at 1 m has a first moment of 1 kg m and an inertia of 1 kg m^2.
            let columns = [
                less(far?, wheel),
                wheel,
                near,
                less(less(distal_far?, near), distal_wheel),
                distal_wheel,
            ];
            for (part, column) in columns.into_iter().enumerate() {
                put(leg * PER_BODY_LEG + part, column);
            }
        }
        let [mass, along_x, along_y, wheel] =
            [0, 1, 2, 3].map(|index: usize| torques(&*self.platform[index]));
        let (mass, wheel) = (mass?, wheel?);
        let columns = [
            mass,
            less(less(along_x?, mass), wheel),
            less(less(along_y?, mass), wheel),
            wheel,
        ];
        for (part, column) in columns.into_iter().enumerate() {
            put(PLATFORM + part, column);
        }
        let known = torques(&*self.wrench)?;
        let (columns, rates) = self.friction(setpoint)?;
        for (index, column) in columns {
            put(index, column);
        }
        Some(TorqueRows {
            slopes,
            known,
            rates,
        })
    }

    /// Columns of friction and of readings, and the rates of the joints A, B and C.
    #[allow(clippy::type_complexity)] // a list of columns and a matrix
    fn friction(
        &self,
        setpoint: &Setpoint<f64>,
    ) -> Option<(Vec<(usize, [f64; 3])>, [[f64; 3]; 3])> {
        let machine = &*self.platform[0];
        let ratios = Ratios::at(machine, setpoint.pose)?;
        // Rates of the distal links by the velocity of the platform.
        let mut two = Matrix3::zeros();
        for axis in 0..3 {
            let unit = Setpoint {
                velocity: Vector3::ith(axis, 1.0),
                acceleration: Vector3::zeros(),
                ..*setpoint
            };
            let record = machine.evaluate(0.0, &unit).ok()?;
            for (leg, record) in record.legs.iter().enumerate() {
                two[(leg, axis)] = record.dth2;
            }
        }
        let turn = Matrix3::from_fn(|_, axis| if axis == 2 { 1.0 } else { 0.0 });
        let (elbow, joint) = (two - ratios.inverse, turn - two);
        let motors = ratios.inverse * setpoint.velocity;
        let rates = [motors, elbow * setpoint.velocity, joint * setpoint.velocity];
        let mut columns = Vec::with_capacity(BODY_COUNT - FRICTION);
        for motor in 0..3 {
            for (part, moment) in [motors[motor], motors[motor].signum()]
                .into_iter()
                .enumerate()
            {
                let mut column = [0.0; 3];
                column[motor] = moment;
                columns.push((FRICTION + 2 * motor + part, column));
                if part == 0 {
                    columns.push((READING + motor, column));
                }
            }
        }
        // Virtual work: torques . one v = moments . (rates of the joints by v) v.
        let back = ratios.jacobian.transpose();
        for (kind, (map, rate)) in [(elbow, rates[1]), (joint, rates[2])]
            .into_iter()
            .enumerate()
        {
            for (part, moments) in [rate, rate.map(f64::signum)].into_iter().enumerate() {
                let column = back * (map.transpose() * moments);
                columns.push((PASSIVE + 2 * kind + part, column.into()));
            }
        }
        Some((columns, rates.map(Into::into)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::bodies::BodyVector;
    use trirrr_core::machine::example;
    use trirrr_core::setpoint::Pose;
    use trirrr_truth::double_double::DoubleDouble;
    use trirrr_truth::inputs::Inputs;

    fn heavy() -> Parameters {
        let mut machine = example();
        for (number, leg) in (1..).zip(&mut machine.legs) {
            let mass = 0.1 * f64::from(number);
            leg.proximal = LinkParameters {
                mass_kg: mass,
                com_m: 0.07,
                inertia_kgm2: 1e-3 * mass,
            };
            leg.distal = LinkParameters {
                mass_kg: 0.5 * mass,
                com_m: 0.12,
                inertia_kgm2: 2e-3 * mass,
            };
            leg.rotor_inertia_kgm2 = 1e-4 * mass;
        }
        machine.platform = platform(0.7, [0.01, -0.02], 3e-3);
        machine.gravity_m_s2 = Vector2::new(1.0, -9.81);
        machine.wrench_force_n = Vector2::new(0.4, 0.3);
        machine.wrench_torque_nm = 0.02;
        machine
    }

    fn moving() -> Setpoint<f64> {
        Setpoint {
            pose: Pose::from_f64(0.24, 0.26, 0.15),
            velocity: Vector3::new(0.3, -0.2, 0.8),
            acceleration: Vector3::new(-1.5, 2.0, 4.0),
        }
    }

    /// Newton and Euler's balance of seven bodies, in 31 digits.
    #[test]
    fn torques_are_those_of_newton_and_euler() {
        let (machine, setpoint) = (heavy(), moving());
        let inputs = Inputs::<DoubleDouble>::exact(&machine, &setpoint);
        let truth = inputs.dynamics(&inputs.kinematics());
        let machines = UnitMachines::new(&machine).expect("machines");
        let rows = machines.rows(&setpoint).expect("torques");
        let values = BodyVector::of(&machine, [[0.0; 2]; 3]);
        for motor in 0..3 {
            let parts = rows.slopes[motor].iter().zip(values.0);
            let sum: f64 = parts.map(|(slope, value)| slope * value).sum();
            let torque = sum + rows.known[motor];
            let real = truth.torques[motor].value();
            assert!((torque / real - 1.0).abs() < 1e-10, "{torque} {real}");
        }
        let (back, impossible) = values.put_into(&machine);
        assert!(impossible.is_empty(), "{impossible:?}");
        for (own, leg) in back.legs.iter().zip(&machine.legs) {
            assert!((own.distal.inertia_kgm2 - leg.distal.inertia_kgm2).abs() < 1e-15);
            assert!((own.proximal.com_m - leg.proximal.com_m).abs() < 1e-15);
        }
    }

    #[test]
    fn motors_give_the_power_that_friction_takes() {
        let machines = UnitMachines::new(&heavy()).expect("machines");
        let rows = machines.rows(&moving()).expect("torques");
        for index in FRICTION..READING {
            let power: f64 = (0..3)
                .map(|motor| rows.slopes[motor][index] * rows.rates[0][motor])
                .sum();
            let kind = if index < PASSIVE {
                0
            } else {
                1 + (index - PASSIVE) / 2
            };
            let joints: Vec<usize> = match kind {
                0 => vec![(index - FRICTION) / 2],
                _ => vec![0, 1, 2],
            };
            let is_viscous = (index - FRICTION).is_multiple_of(2);
            let lost: f64 = joints
                .iter()
                .map(|joint| {
                    let rate = rows.rates[kind][*joint].abs();
                    if is_viscous { rate * rate } else { rate }
                })
                .sum();
            assert!((power - lost).abs() < 1e-12, "{index}: {power} {lost}");
        }
    }
}
