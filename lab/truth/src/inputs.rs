//! Everything that a motion depends on, as plain numbers of any [`Scalar`] type.

use crate::double_double::DoubleDouble;
use crate::dual::{Dual, INPUTS};
use crate::scalar::{Plane, Scalar, scaled, sum};
use nalgebra::Vector2;
use trirrr_core::machine::{LegParameters, Parameters};
use trirrr_core::number::Number;
use trirrr_core::setpoint::Setpoint;

/// A leg: symbols as in the thesis; masses, centres of mass and central inertias of the links.
#[derive(Clone, Copy, Debug)]
#[allow(missing_docs)] // named after the fields of `LegParameters`
pub struct LegInputs<S> {
    pub base: Plane<S>,
    pub l1: S,
    pub l2: S,
    pub h: S,
    pub lambda: S,
    pub elbow: f64,
    pub m1: S,
    pub c1: S,
    pub i1: S,
    pub m2: S,
    pub c2: S,
    pub i2: S,
    pub rotor: S,
}

/// A machine with its loads, and the state of its platform.
#[derive(Clone, Copy, Debug)]
#[allow(missing_docs)] // named after the fields of `Parameters` and `Setpoint`
pub struct Inputs<S> {
    pub legs: [LegInputs<S>; 3],
    pub mass: S,
    pub inertia: S,
    pub com: Plane<S>,
    pub gravity: Plane<S>,
    pub force: Plane<S>,
    pub moment: S,
    pub position: Plane<S>,
    pub angle: S,
    pub velocity: Plane<S>,
    pub angle_rate: S,
    pub acceleration: Plane<S>,
    pub angle_acceleration: S,
}

/// Kind of an input.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Quantity {
    /// A base joint's place, a link's length, a radius, a centre of mass on a link, m.
    Length,
    /// Angle at which a platform joint lies about D, rad.
    JointAngle,
    /// kg.
    Mass,
    /// kg m^2.
    Inertia,
    /// m/s^2.
    Gravity,
    /// N.
    Force,
    /// N m.
    Moment,
    /// Of D, m.
    Position,
    /// Of the platform, rad.
    Angle,
    /// Of D, m/s.
    Velocity,
    /// Of the platform, rad/s.
    AngleRate,
    /// Of D, m/s^2.
    Acceleration,
    /// Of the platform, rad/s^2.
    AngleAcceleration,
}

impl Quantity {
    /// Exponents of length, time and mass; none of an angle, which number types hold apart.
    pub fn dimension(self) -> Option<[i32; 3]> {
        Some(match self {
            Self::JointAngle | Self::Angle => return None,
            Self::Length | Self::Position => [1, 0, 0],
            Self::Mass => [0, 0, 1],
            Self::Inertia => [2, 0, 1],
            Self::Gravity | Self::Acceleration => [1, -2, 0],
            Self::Force => [1, -2, 1],
            Self::Moment => [2, -2, 1],
            Self::Velocity => [1, -1, 0],
            Self::AngleRate => [0, -1, 0],
            Self::AngleAcceleration => [0, -2, 0],
        })
    }
}

/// One input.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Input {
    /// Its kind.
    pub quantity: Quantity,
    /// Its value.
    pub value: f64,
    /// The length of the vector that it is a component of; of a scalar, its size.
    pub length: f64,
    /// Number of the component, 0 or 1; of a scalar, 0.
    pub component: usize,
}

/// The sizes of all inputs: what each is perturbed by, relative to the unit roundoff.
#[derive(Clone, Copy, Debug)]
pub struct Sizes(pub [f64; INPUTS]);

impl<S: Scalar> Inputs<S> {
    /// Calls `lift` once for each input, in a fixed order.
    fn lifted<N: Number>(
        parameters: &Parameters,
        setpoint: &Setpoint<N>,
        mut lift: impl FnMut(Input) -> S,
    ) -> Self {
        use Quantity as Q;
        let mut vector = |quantity, v: Vector2<f64>| {
            let length = v.x.hypot(v.y);
            [(0, v.x), (1, v.y)].map(|(component, value)| {
                lift(Input {
                    quantity,
                    value,
                    length,
                    component,
                })
            })
        };
        let bases = parameters.legs.map(|leg| vector(Q::Length, leg.base_m));
        let com = vector(Q::Length, parameters.platform.com_m);
        let gravity = vector(Q::Gravity, parameters.gravity_m_s2);
        let force = vector(Q::Force, parameters.wrench_force_n);
        let position = vector(Q::Position, setpoint.pose.position.map(N::to_f64));
        let velocity = vector(Q::Velocity, setpoint.velocity.xy().map(N::to_f64));
        let acceleration = vector(Q::Acceleration, setpoint.acceleration.xy().map(N::to_f64));
        let mut scalar = |quantity, value: f64| {
            lift(Input {
                quantity,
                value,
                length: value.abs(),
                component: 0,
            })
        };
        let mut leg = |base: Plane<S>, leg: &LegParameters| LegInputs {
            base,
            l1: scalar(Q::Length, leg.proximal_m),
            l2: scalar(Q::Length, leg.distal_m),
            h: scalar(Q::Length, leg.joint_radius_m),
            lambda: scalar(Q::JointAngle, leg.joint_angle_rad),
            elbow: leg.elbow.sign(),
            m1: scalar(Q::Mass, leg.proximal.mass_kg),
            c1: scalar(Q::Length, leg.proximal.com_m),
            i1: scalar(Q::Inertia, leg.proximal.inertia_kgm2),
            m2: scalar(Q::Mass, leg.distal.mass_kg),
            c2: scalar(Q::Length, leg.distal.com_m),
            i2: scalar(Q::Inertia, leg.distal.inertia_kgm2),
            rotor: scalar(Q::Inertia, leg.rotor_inertia_kgm2),
        };
        let legs = [0, 1, 2].map(|index| leg(bases[index], &parameters.legs[index]));
        Self {
            legs,
            mass: scalar(Q::Mass, parameters.platform.mass_kg),
            inertia: scalar(Q::Inertia, parameters.platform.inertia_kgm2),
            com,
            gravity,
            force,
            moment: scalar(Q::Moment, parameters.wrench_torque_nm),
            position,
            angle: scalar(Q::Angle, N::angle_to_f64(setpoint.pose.angle)),
            velocity,
            angle_rate: scalar(Q::AngleRate, setpoint.velocity.z.to_f64()),
            acceleration,
            angle_acceleration: scalar(Q::AngleAcceleration, setpoint.acceleration.z.to_f64()),
        }
    }

    /// The inputs as constants.
    pub fn constants<N: Number>(parameters: &Parameters, setpoint: &Setpoint<N>) -> Self {
        Self::lifted(parameters, setpoint, |input| S::constant(input.value))
    }

    /// The inputs `time` seconds later, when the platform keeps its acceleration.
    pub fn later(&self, time: S) -> Self {
        let half = S::constant(0.5) * time * time;
        Self {
            position: sum(
                self.position,
                sum(scaled(self.velocity, time), scaled(self.acceleration, half)),
            ),
            angle: self.angle + self.angle_rate * time + self.angle_acceleration * half,
            velocity: sum(self.velocity, scaled(self.acceleration, time)),
            angle_rate: self.angle_rate + self.angle_acceleration * time,
            ..*self
        }
    }
}

impl Inputs<DoubleDouble> {
    /// The inputs exactly as given.
    pub fn exact<N: Number>(parameters: &Parameters, setpoint: &Setpoint<N>) -> Self {
        Self::constants(parameters, setpoint)
    }
}

impl Inputs<Dual> {
    /// The inputs as variables, each with what `size` makes of it: how far it may move.
    pub fn variable<N: Number>(
        parameters: &Parameters,
        setpoint: &Setpoint<N>,
        size: impl Fn(Input) -> f64,
    ) -> (Self, Sizes) {
        let (mut sizes, mut count) = ([0.0; INPUTS], 0);
        let inputs = Self::lifted(parameters, setpoint, |input| {
            sizes[count] = size(input);
            count += 1;
            Dual::variable(input.value, count - 1)
        });
        assert_eq!(count, INPUTS);
        (inputs, Sizes(sizes))
    }
}
