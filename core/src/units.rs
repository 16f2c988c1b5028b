//! Units of a machine: what 1 stands for in a number type that reaches a few and no further.
//!
//! Powers of two of the SI units, so that a description is scaled exactly and so are results. The
//! equations of motion are the same in any units: a machine that is described in its own runs
//! through the pipeline as it is. For floats the units are SI.

use crate::limits::LimitParameters;
use crate::machine::{LegParameters, LinkParameters, Parameters, PlatformParameters};
use crate::setpoint::{Pose, Setpoint};
use crate::to_source;
use nalgebra::Vector3;

/// Base units, as exponents of two of the metre, the second and the kilogram. Angles are turns or
/// radians in any of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Units {
    /// Of m.
    pub length: i32,
    /// Of s.
    pub time: i32,
    /// Of kg.
    pub mass: i32,
}

to_source!(pub [] Units [] in trirrr_core::units { length, time, mass });

impl Units {
    /// Metre, second, kilogram.
    pub const SI: Self = Self {
        length: 0,
        time: 0,
        mass: 0,
    };

    /// The other way round: what is given in these units becomes SI.
    pub fn inverse(&self) -> Self {
        Self {
            length: -self.length,
            time: -self.time,
            mass: -self.mass,
        }
    }

    /// SI value of one unit of a quantity of dimension length^l time^t mass^m; exact while it is a
    /// normal number.
    pub fn of(&self, length: i32, time: i32, mass: i32) -> f64 {
        let exponent = self.length * length + self.time * time + self.mass * mass;
        f64::from_bits(((exponent.clamp(-1022, 1023) + 1023) as u64) << 52)
    }

    /// The unit of length, m.
    pub fn length_m(&self) -> f64 {
        self.of(1, 0, 0)
    }

    /// The unit of time, s.
    pub fn time_s(&self) -> f64 {
        self.of(0, 1, 0)
    }

    /// The unit of rates of angles, rad/s.
    pub fn rate_rad_s(&self) -> f64 {
        self.of(0, -1, 0)
    }

    /// The unit of accelerations of angles, rad/s^2.
    pub fn acceleration_rad_s2(&self) -> f64 {
        self.of(0, -2, 0)
    }

    /// The unit of jerks of angles, rad/s^3.
    pub fn jerk_rad_s3(&self) -> f64 {
        self.of(0, -3, 0)
    }

    /// The unit of forces, N.
    pub fn force_n(&self) -> f64 {
        self.of(1, -2, 1)
    }

    /// The unit of torques, N m.
    pub fn torque_nm(&self) -> f64 {
        self.of(2, -2, 1)
    }

    /// The unit of power, W.
    pub fn power_w(&self) -> f64 {
        self.of(2, -3, 1)
    }

    /// `parameters`, given in SI units, in these.
    pub fn parameters(&self, parameters: &Parameters) -> Parameters {
        let (length, mass) = (1.0 / self.length_m(), 1.0 / self.of(0, 0, 1));
        let inertia = mass * length * length;
        let link = |link: LinkParameters| LinkParameters {
            mass_kg: link.mass_kg * mass,
            com_m: link.com_m * length,
            inertia_kgm2: link.inertia_kgm2 * inertia,
        };
        let force = 1.0 / self.force_n();
        Parameters {
            legs: parameters.legs.map(|leg| LegParameters {
                base_m: leg.base_m * length,
                proximal_m: leg.proximal_m * length,
                distal_m: leg.distal_m * length,
                joint_radius_m: leg.joint_radius_m * length,
                proximal: link(leg.proximal),
                distal: link(leg.distal),
                rotor_inertia_kgm2: leg.rotor_inertia_kgm2 * inertia,
                ..leg
            }),
            platform: PlatformParameters {
                mass_kg: parameters.platform.mass_kg * mass,
                inertia_kgm2: parameters.platform.inertia_kgm2 * inertia,
                com_m: parameters.platform.com_m * length,
                tool_point_m: parameters.platform.tool_point_m * length,
            },
            gravity_m_s2: parameters.gravity_m_s2 / self.of(1, -2, 0),
            wrench_force_n: parameters.wrench_force_n * force,
            wrench_torque_nm: parameters.wrench_torque_nm / self.torque_nm(),
        }
    }

    /// `limits`, given in SI units, in these.
    pub fn limits(&self, limits: &LimitParameters) -> LimitParameters {
        let over =
            |values: Option<[f64; 3]>, unit: f64| values.map(|values| values.map(|v| v / unit));
        LimitParameters {
            rate_rad_s: over(limits.rate_rad_s, self.rate_rad_s()),
            acceleration_rad_s2: over(limits.acceleration_rad_s2, self.acceleration_rad_s2()),
            torque_nm: over(limits.torque_nm, self.torque_nm()),
            power_w: over(limits.power_w, self.power_w()),
            jerk_rad_s3: over(limits.jerk_rad_s3, self.jerk_rad_s3()),
            ..*limits
        }
    }

    /// A duration in s.
    pub fn time(&self, time_s: f64) -> f64 {
        time_s / self.time_s()
    }

    /// A pose in m and rad.
    pub fn pose(&self, pose: &Pose<f64>) -> Pose<f64> {
        Pose {
            position: pose.position / self.length_m(),
            angle: pose.angle,
        }
    }

    /// (vx, vy, alphadot) in m/s and rad/s.
    pub fn velocity(&self, v: &Vector3<f64>) -> Vector3<f64> {
        let linear = self.of(1, -1, 0);
        Vector3::new(v.x / linear, v.y / linear, v.z / self.rate_rad_s())
    }

    /// (ax, ay, alphaddot) in m/s^2 and rad/s^2.
    pub fn acceleration(&self, a: &Vector3<f64>) -> Vector3<f64> {
        let linear = self.of(1, -2, 0);
        Vector3::new(a.x / linear, a.y / linear, a.z / self.acceleration_rad_s2())
    }

    /// A setpoint in SI units.
    pub fn setpoint(&self, setpoint: &Setpoint<f64>) -> Setpoint<f64> {
        Setpoint {
            pose: self.pose(&setpoint.pose),
            velocity: self.velocity(&setpoint.velocity),
            acceleration: self.acceleration(&setpoint.acceleration),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machine::example;
    use crate::model::Dynamic;
    use crate::tick::Tick;

    /// The equations of motion know no units: in f64, where powers of two are exact, a machine in
    /// any units has the very bits of the one in SI.
    #[test]
    fn a_machine_in_its_own_units_moves_the_same() {
        let parameters = example();
        let setpoint = Setpoint {
            pose: Pose::<f64>::from_f64(0.26, 0.23, 0.2),
            velocity: Vector3::new(0.3, -0.2, 0.5),
            acceleration: Vector3::new(-1.5, 0.7, 3.0),
        };
        let motion = |units: Units| {
            let tick: Tick<Dynamic<f64>> =
                Tick::build(&units.parameters(&parameters)).expect("a machine");
            tick.evaluate(&units.setpoint(&setpoint)).expect("a motion")
        };
        let si = motion(Units::SI);
        let units = Units {
            length: -3,
            time: 4,
            mass: -6,
        };
        let own = motion(units);
        for (a, b) in si.motors.iter().zip(&own.motors) {
            assert_eq!(a.angle, b.angle);
            assert_eq!(a.rate, b.rate * units.rate_rad_s());
            assert_eq!(a.acceleration, b.acceleration * units.acceleration_rad_s2());
            assert_eq!(a.torque, b.torque * units.torque_nm());
        }
        assert_eq!(si.forces.det_a, own.forces.det_a * units.of(4, 0, 0));
    }
}
