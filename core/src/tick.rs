//! One tick: from a setpoint to what the three motors have to do.
//!
//! The [`Model`] of a [`Tick`] says what the scene holds: number type, payload, links. What a scene
//! does not use is not in the model, so it is not in the image either.

use crate::dyad::Rrr;
use crate::inverse::{LegMotion, Position, Rotation};
use crate::machine::{BuildError, Geometry};
use crate::model::{Model, OfKind};
use crate::number::Number;
use crate::setpoint::Setpoint;
use crate::status::Status;
use crate::to_source;
use crate::torque::balance::Forces;
use crate::torque::links::LegLoad;
use nalgebra::Vector2;

/// The pipeline of a machine with its coefficients, built once by [`Tick::build`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tick<M: Model> {
    /// Base joints and dyads of the legs.
    geometry: Geometry<M::N>,
    /// Dynamics, if the scene has any.
    model: M,
}

to_source!([M: Model] Tick [M] in trirrr_core::tick { geometry: Geometry<M::N>, model: M });

/// Motion and torque that one motor has to give.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motor<N: Number> {
    /// theta_i1: direction of the proximal link, in (-pi, pi], counter-clockwise from the x axis.
    pub angle: N::Angle,
    /// Angular velocity, positive counter-clockwise.
    pub rate: N,
    /// Angular acceleration.
    pub acceleration: N,
    /// Torque of the motor on the proximal link, positive counter-clockwise; zero in a
    /// [model without torques](crate::model::Kinematic).
    pub torque: N,
}

/// Everything that one tick computes; what a caller does not read is not computed, as long as the
/// call is inlined.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion<N: Number> {
    /// The three motors.
    pub motors: [Motor<N>; 3],
    /// Motion of the links of each leg.
    pub legs: [LegMotion<N>; 3],
    /// Loads of the legs' own masses.
    pub loads: [LegLoad<N>; 3],
    /// Forces along the distal links, and det A.
    pub forces: Forces<N>,
}

impl<N: Number> Motion<N> {
    /// P_i = tau_i thetadot_i1 (5.11): mechanical power of each motor on the machine.
    ///
    /// # Errors
    /// [`Status::OutOfRange`].
    #[inline]
    pub fn powers(&self) -> Result<[N; 3], Status> {
        let powers = self
            .motors
            .each_ref()
            .map(|motor| motor.torque * motor.rate);
        if powers.iter().all(|power| power.is_finite()) {
            Ok(powers)
        } else {
            Err(Status::OutOfRange)
        }
    }

    /// Returns the position of every joint, for the singularity distances.
    pub fn position(&self) -> Position<N> {
        Position {
            legs: self.legs.each_ref().map(|leg| leg.position),
        }
    }
}

impl<N: Number, M: Model<N = N>> Tick<M> {
    /// Checks the machine and builds the coefficients. Parts of its parameters that the model has
    /// no room for are left out: the scene has to choose a model that fits.
    ///
    /// # Errors
    /// The first quantity that is refused.
    pub fn build<'a>(machine: impl Into<OfKind<'a>>) -> Result<Self, BuildError> {
        let machine = machine.into();
        Ok(Self {
            geometry: Geometry::build(machine.parameters)?,
            model: M::build(machine),
        })
    }

    /// The geometry, for whoever needs positions only.
    pub fn geometry(&self) -> &Geometry<N> {
        &self.geometry
    }

    /// The dynamics, for whoever needs torques only.
    pub fn model(&self) -> &M {
        &self.model
    }

    /// Position, rates, accelerations and load of leg `index`: all of one leg before the next begins,
    /// so that few values are alive at a time.
    #[inline(always)]
    fn kinematics(
        &self,
        index: usize,
        setpoint: &Setpoint<N>,
        rotation: &Rotation<N>,
    ) -> Result<(LegMotion<N>, LegLoad<N>), Status> {
        let leg = &self.geometry.legs[index];
        let position = leg.position_unchecked(index, setpoint.pose.position, rotation)?;
        let rates = leg.rates(&position, &setpoint.velocity);
        let accelerations = leg.accelerations(&position, &rates, setpoint);
        let motion = LegMotion {
            position,
            rates,
            accelerations,
        };
        let load = self.model.load(index, &motion);
        let fits = match M::TORQUES {
            true => motion.fits() && load.fits(),
            false => motion.joints_fit(),
        };
        if N::PROPAGATES_NON_FINITE || fits {
            Ok((motion, load))
        } else {
            Err(Status::OutOfRange)
        }
    }

    /// The torques alone, for legs whose motion is known.
    ///
    /// # Errors
    /// [`Status::ParallelSingular`].
    pub fn torques(
        &self,
        legs: &[LegMotion<N>; 3],
        setpoint: &Setpoint<N>,
        rotation: &Rotation<N>,
    ) -> Result<[N; 3], Status> {
        self.model.torques(None, legs, setpoint, rotation)
    }

    /// Reason why a tick without a finite result has none.
    #[cold]
    #[inline(never)]
    fn refusal(&self, place: Vector2<N>, rotation: &Rotation<N>, is_singular: bool) -> Status {
        for (index, leg) in self.geometry.legs.iter().enumerate() {
            if let Err(status) = leg.position(index, place, rotation) {
                return status;
            }
        }
        match is_singular {
            true => Status::ParallelSingular,
            false => Status::OutOfRange,
        }
    }

    /// One tick: inverse kinematics, rates, accelerations, torques.
    ///
    /// # Errors
    /// The [`Status`] that leaves the setpoint without a motion. A motion that is returned holds
    /// no infinity and nothing that is not a number.
    #[inline(always)]
    pub fn evaluate(&self, setpoint: &Setpoint<N>) -> Result<Motion<N>, Status> {
        // A platform joint lies within 1/2 of the reference point, in units where anything has to
        // fit: its velocity and acceleration are in range if these are.
        let [vx, vy, turning] = setpoint.velocity.into();
        let [ax, ay, angular] = setpoint.acceleration.into();
        let place = setpoint.pose.position;
        let near = N::within_reach_range(place.x) && N::within_reach_range(place.y);
        if !(near && N::in_range([vx, vy, turning * turning, ax, ay, angular])) {
            return Err(Status::OutOfRange);
        }
        let rotation = Rotation::new(setpoint.pose.angle);
        let (leg1, load1) = self.kinematics(0, setpoint, &rotation)?;
        let (leg2, load2) = self.kinematics(1, setpoint, &rotation)?;
        let (leg3, load3) = self.kinematics(2, setpoint, &rotation)?;
        let legs = [leg1, leg2, leg3];
        let loads = [load1, load2, load3];

        let forces = self
            .model
            .forces(None, &legs, &loads, setpoint, &rotation)?;
        let torques = forces.torques(&legs, &loads);

        // Whatever is out of reach or leaves the range on the way reaches an acceleration or a torque, and a sum
        // with a part that is not finite is not finite.
        let [a1, a2, a3] = legs.each_ref().map(|leg| leg.accelerations.proximal);
        let [t1, t2, t3] = torques;
        let lost = match (N::PROPAGATES_NON_FINITE, M::TORQUES) {
            (true, true) => !((a1 + a2 + a3) + (t1 + t2 + t3)).is_finite(),
            (true, false) => !(a1 + a2 + a3).is_finite(),
            (false, torques_count) => torques_count && !N::in_range(torques),
        };
        // Otherwise each stage has told its reason.
        let is_singular = N::PROPAGATES_NON_FINITE && self.model.is_singular(forces.det_a);
        if lost && N::PROPAGATES_NON_FINITE {
            return Err(self.refusal(setpoint.pose.position, &rotation, is_singular));
        }
        if lost {
            return Err(Status::OutOfRange);
        }
        if is_singular {
            return Err(Status::ParallelSingular);
        }
        // The angles come last: nothing else waits for them, and with them would wait.
        let dyads = self.geometry.legs.each_ref().map(|leg| &leg.dyad);
        let angles = Rrr::proximal_angles(dyads, legs.each_ref().map(|leg| &leg.position.links));
        let motor = |index: usize| Motor {
            angle: angles[index],
            rate: legs[index].rates.proximal,
            acceleration: legs[index].accelerations.proximal,
            torque: torques[index],
        };
        let motors = [motor(0), motor(1), motor(2)];
        Ok(Motion {
            motors,
            legs,
            loads,
            forces,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machine::{Parameters, example};
    use crate::model::{Dynamic, Kinematic};
    use crate::number::Fixed;
    use crate::setpoint::Pose;
    use crate::torque::lines::DistalLines;
    use crate::torque::links::{InPlane, Massive};
    use crate::torque::payload::Offset;
    use nalgebra::Vector3;

    /// Without torques the rest is the same, in the bits; and a machine whose torques leave the
    /// range moves.
    fn leaves_the_motion_as_it_is<N: Number>() {
        let mut parameters = example();
        let setpoint = Setpoint {
            pose: Pose::<N>::from_f64(0.26, 0.23, 0.2),
            velocity: Vector3::new(0.1, -0.05, 0.2).map(N::from_f64),
            acceleration: Vector3::new(-0.05, 0.1, 0.2).map(N::from_f64),
        };
        let with: Tick<Dynamic<N>> = Tick::build(&parameters).expect("a machine");
        let without: Tick<Kinematic<N>> = Tick::build(&parameters).expect("a machine");
        let (all, bare) = (with.evaluate(&setpoint), without.evaluate(&setpoint));
        let (all, bare) = (all.expect("a motion"), bare.expect("a motion"));
        assert_eq!(all.legs, bare.legs);
        assert_eq!(all.forces.det_a, bare.forces.det_a);
        for (a, b) in all.motors.iter().zip(&bare.motors) {
            assert_eq!(
                (a.angle, a.rate, a.acceleration),
                (b.angle, b.rate, b.acceleration)
            );
            assert!(a.torque != N::ZERO && b.torque == N::ZERO);
        }

        if N::PROPAGATES_NON_FINITE {
            return;
        }
        parameters.platform.mass_kg = 1e3;
        let with: Tick<Dynamic<N>> = Tick::build(&parameters).expect("a machine");
        let without: Tick<Kinematic<N>> = Tick::build(&parameters).expect("a machine");
        assert_eq!(with.evaluate(&setpoint), Err(Status::OutOfRange));
        assert!(without.evaluate(&setpoint).is_ok());
    }

    /// Torques are linear in the load: those of the motion alone and those of the load at rest add up.
    #[test]
    fn motion_and_load_share_the_torques() {
        let mut parameters = example();
        parameters.gravity_m_s2 = Vector2::new(1.0, -9.0);
        parameters.wrench_force_n = Vector2::new(0.8, -0.5);
        parameters.wrench_torque_nm = 0.02;
        parameters.platform.com_m = Vector2::new(0.01, 0.03);
        for leg in &mut parameters.legs {
            (leg.proximal.mass_kg, leg.proximal.com_m) = (0.3, 0.1);
            (leg.distal.mass_kg, leg.distal.com_m) = (0.2, 0.15);
        }
        type Loaded = Dynamic<f64, Offset<f64>, Massive<f64, InPlane<f64>>>;
        let tick: Tick<Loaded> = Tick::build(&parameters).expect("a machine");
        let moving = Setpoint {
            pose: Pose::from_f64(0.26, 0.23, 0.2),
            velocity: Vector3::new(0.1, -0.05, 0.2),
            acceleration: Vector3::new(-0.5, 1.0, 2.0),
        };
        let resting = Setpoint {
            velocity: Vector3::zeros(),
            acceleration: Vector3::zeros(),
            ..moving
        };
        let of = |setpoint| tick.evaluate(setpoint).expect("a motion");
        let (all, rest) = (of(&moving), of(&resting));
        let [leg1, leg2, leg3] = all.legs.each_ref().map(|leg| &leg.position);
        let lines = DistalLines::of([leg1, leg2, leg3]);
        let rotation = Rotation::new(moving.pose.angle);
        let alone = |lines| {
            let model = tick.model().inertial();
            let torques = model.torques(lines, &all.legs, &moving, &rotation);
            torques.expect("regular")
        };
        let motion = alone(None);
        assert_eq!(motion, alone(Some(&lines)));
        for (index, all) in all.motors.iter().enumerate() {
            let parts = [motion[index], rest.motors[index].torque];
            assert!(parts.iter().all(|part| part.abs() > 1e-3), "{parts:?}");
            let error = (all.torque - (parts[0] + parts[1])).abs();
            assert!(error < 1e-13, "{error:e}");
        }
    }

    /// The velocity, or the square of the turning rate, has no place in fixed point; near the base, where everything else has.
    #[test]
    fn fixed_point_refuses_velocities_beyond_its_range() {
        let mut parameters = example();
        // Elbows of 60 degrees: the motors turn slower than the platform moves.
        for (leg, base) in
            (parameters.legs.iter_mut()).zip([[-0.89, 0.05], [-0.89, -0.05], [1.09, 0.0]])
        {
            (leg.base_m, leg.joint_radius_m) = (base.into(), 0.0);
            (leg.proximal_m, leg.distal_m) = (0.99, 0.99);
        }
        fn of<N: Number>(parameters: &Parameters, velocity: [f64; 3]) -> Option<Status> {
            let tick: Tick<Kinematic<N>> = Tick::build(parameters).expect("a machine");
            let setpoint = Setpoint {
                pose: Pose::from_f64(0.1, 0.0, 0.0),
                velocity: Vector3::from(velocity).map(N::from_f64),
                acceleration: Vector3::zeros().map(N::from_f64),
            };
            tick.evaluate(&setpoint).err()
        }
        for (velocity, status) in [
            ([1.95, 0.0, 0.0], None),
            ([2.05, 0.0, 0.0], Some(Status::OutOfRange)),
            ([0.0, 0.0, 1.2], None),
            ([0.0, 0.0, 1.5], Some(Status::OutOfRange)),
        ] {
            assert_eq!(of::<Fixed>(&parameters, velocity), status, "{velocity:?}");
            assert_eq!(of::<f32>(&parameters, velocity), None, "{velocity:?}");
        }
    }

    #[test]
    fn a_scene_without_torques_moves_the_same() {
        leaves_the_motion_as_it_is::<f32>();
        leaves_the_motion_as_it_is::<Fixed>();
    }
}
