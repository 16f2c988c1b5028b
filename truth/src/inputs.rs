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
pub struct Leg<S> {
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
    pub legs: [Leg<S>; 3],
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

/// The sizes of all inputs: what each is perturbed by, relative to the unit roundoff.
#[derive(Clone, Copy, Debug)]
pub struct Sizes(pub [f64; INPUTS]);

impl<S: Scalar> Inputs<S> {
    /// Calls `lift` once for each input, in a fixed order, with its value and the length of the
    /// vector that it is a component of (a scalar's own size).
    fn lifted<N: Number>(
        parameters: &Parameters,
        setpoint: &Setpoint<N>,
        mut lift: impl FnMut(f64, f64) -> S,
    ) -> Self {
        let mut vector = |x: f64, y: f64| {
            let length = x.hypot(y);
            [lift(x, length), lift(y, length)]
        };
        let bases = parameters
            .legs
            .map(|leg| vector(leg.base_m.x, leg.base_m.y));
        let of = |v: Vector2<f64>| (v.x, v.y);
        let number = |x: N| x.to_f64();
        let pairs = [
            of(parameters.platform.com_m),
            of(parameters.gravity_m_s2),
            of(parameters.wrench_force_n),
            of(setpoint.pose.position.map(number)),
            of(setpoint.velocity.xy().map(number)),
            of(setpoint.acceleration.xy().map(number)),
        ];
        let [com, gravity, force, position, velocity, acceleration] =
            pairs.map(|(x, y)| vector(x, y));
        let mut scalar = |x: f64| lift(x, x.abs());
        let mut leg = |base: Plane<S>, leg: &LegParameters| Leg {
            base,
            l1: scalar(leg.proximal_m),
            l2: scalar(leg.distal_m),
            h: scalar(leg.joint_radius_m),
            lambda: scalar(leg.joint_angle_rad),
            elbow: leg.elbow.sign(),
            m1: scalar(leg.proximal.mass_kg),
            c1: scalar(leg.proximal.com_m),
            i1: scalar(leg.proximal.inertia_kgm2),
            m2: scalar(leg.distal.mass_kg),
            c2: scalar(leg.distal.com_m),
            i2: scalar(leg.distal.inertia_kgm2),
            rotor: scalar(leg.rotor_inertia_kgm2),
        };
        let legs = [0, 1, 2].map(|index| leg(bases[index], &parameters.legs[index]));
        Self {
            legs,
            mass: scalar(parameters.platform.mass_kg),
            inertia: scalar(parameters.platform.inertia_kgm2),
            com,
            gravity,
            force,
            moment: scalar(parameters.wrench_torque_nm),
            position,
            angle: scalar(N::angle_to_f64(setpoint.pose.angle)),
            velocity,
            angle_rate: scalar(setpoint.velocity.z.to_f64()),
            acceleration,
            angle_acceleration: scalar(setpoint.acceleration.z.to_f64()),
        }
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
        Self::lifted(parameters, setpoint, |x, _| DoubleDouble::constant(x))
    }
}

impl Inputs<Dual> {
    /// The inputs as variables, with their sizes: of a vector's components the size of each.
    pub fn variable<N: Number>(parameters: &Parameters, setpoint: &Setpoint<N>) -> (Self, Sizes) {
        let (inputs, sizes, _) = Self::with_sizes(parameters, setpoint);
        (inputs, sizes)
    }

    /// The same with the length of a vector as the size of its components: for what a turn of the
    /// whole machine does.
    pub fn isotropic<N: Number>(parameters: &Parameters, setpoint: &Setpoint<N>) -> (Self, Sizes) {
        let (inputs, _, lengths) = Self::with_sizes(parameters, setpoint);
        (inputs, lengths)
    }

    fn with_sizes<N: Number>(
        parameters: &Parameters,
        setpoint: &Setpoint<N>,
    ) -> (Self, Sizes, Sizes) {
        let (mut sizes, mut lengths, mut count) = ([0.0; INPUTS], [0.0; INPUTS], 0);
        let inputs = Self::lifted(parameters, setpoint, |x, length| {
            (sizes[count], lengths[count]) = (x.abs(), length);
            count += 1;
            Dual::variable(x, count - 1)
        });
        assert_eq!(count, INPUTS);
        (inputs, Sizes(sizes), Sizes(lengths))
    }
}
