//! Joint reactions (thesis (4.1) to (4.7)): the forces in the nine joints, from the balance of the
//! links. They size bearings and links; the torque does not need them.

use crate::inverse::LegMotion;
use crate::machine::{LegParameters, Parameters};
use crate::number::{Number, perpendicular};
use crate::status::Status;
use crate::tick::Motion;
use crate::torque::links::LegLoad;
use nalgebra::Vector2;

/// Coefficients of the reactions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reactions<N> {
    legs: [LegMasses<N>; 3],
    gravity: Vector2<N>,
}

/// Coefficients of one leg's reactions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LegMasses<N> {
    /// m1
    proximal: N,
    /// c1 / l1
    proximal_com: N,
    /// m2
    distal: N,
    /// c2 / l2
    distal_com: N,
}

/// The forces in the joints of one leg, in the fixed frame. Each acts on the outer of the two
/// bodies that meet; the inner one feels the opposite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointForces<N> {
    /// At A, of the frame on the proximal link.
    pub base: Vector2<N>,
    /// At B, of the proximal on the distal link.
    pub elbow: Vector2<N>,
    /// At C, of the distal link on the platform.
    pub platform: Vector2<N>,
}

impl<N: Number> LegMasses<N> {
    /// Builds the coefficients from checked parameters.
    pub fn build(leg: &LegParameters) -> Self {
        Self {
            proximal: N::from_f64(leg.proximal.mass_kg),
            proximal_com: N::from_f64(leg.proximal.com_m / leg.proximal_m),
            distal: N::from_f64(leg.distal.mass_kg),
            distal_com: N::from_f64(leg.distal.com_m / leg.distal_m),
        }
    }

    /// Returns the forces in the joints of a leg, N.
    ///
    /// The leg moves with `motion` and puts the force `along` r2 on the platform. `gravity`, m/s^2,
    /// is the gravity in the frame of the base joint.
    pub fn forces(
        &self,
        motion: &LegMotion<N>,
        along: N,
        load: &LegLoad<N>,
        gravity: Vector2<N>,
    ) -> JointForces<N> {
        let (at, rates, acc) = (&motion.position.links, &motion.rates, &motion.accelerations);
        // Along the distal link as the balance has it, across from the link's own inertia.
        let mut platform = at.r2 * along;
        if let Some(q) = load.distal_over_l2_sq {
            platform -= perpendicular(at.r2) * q;
        }
        // Acceleration of the outer end of a link relative to the inner one.
        let of_link = |r: Vector2<N>, rate: N, acceleration: N| {
            perpendicular(r) * acceleration - r * (rate * rate)
        };
        let b = of_link(at.r1, rates.proximal, acc.proximal);
        let c_from_b = of_link(at.r2, rates.distal, acc.distal);
        let distal_com = b + c_from_b * self.distal_com - gravity;
        let elbow = platform + distal_com * self.distal;
        let proximal_com = b * self.proximal_com - gravity;
        JointForces {
            base: elbow + proximal_com * self.proximal,
            elbow,
            platform,
        }
    }
}

impl<N: Number> Reactions<N> {
    /// Builds the coefficients from checked parameters.
    pub fn build(parameters: &Parameters) -> Self {
        Self {
            legs: parameters.legs.each_ref().map(LegMasses::build),
            gravity: parameters.gravity_m_s2.map(N::from_f64),
        }
    }

    /// The forces in the joints of each leg, for a motion of the same machine.
    ///
    /// # Errors
    /// [`Status::OutOfRange`].
    pub fn forces(&self, motion: &Motion<N>) -> Result<[JointForces<N>; 3], Status> {
        let forces = |leg: usize| {
            let (along, load) = (motion.forces.along[leg], &motion.loads[leg]);
            self.legs[leg].forces(&motion.legs[leg], along, load, self.gravity)
        };
        let all = [forces(0), forces(1), forces(2)];
        // The force at A holds the one at B, and that the one at C.
        if all
            .iter()
            .all(|leg| leg.base.x.is_finite() && leg.base.y.is_finite())
        {
            Ok(all)
        } else {
            Err(Status::OutOfRange)
        }
    }
}
