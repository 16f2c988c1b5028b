//! The three functions whose instructions are counted.
//!
//! None is inlined and all take their coefficients by reference, so that the geometry is
//! known at run time only and nothing is computed by the compiler.

use crate::scene::{Curves, Model, Scalar};
use nalgebra::Vector2;
use trirrr_core::dyad::{OutOfReach, Rrr};
use trirrr_core::number::Arithmetic;
use trirrr_core::setpoint::Setpoint;
use trirrr_core::status::Status;
use trirrr_core::tick::{Motor, Tick};
use trirrr_image::Segment;

/// The tick that the scene needs.
pub type SceneTick = Tick<Model>;

/// Result of one tick: angle, rate, acceleration and torque of each motor, or why there are none.
pub struct TickOutcome {
    /// The motors, as of the last tick that had a motion.
    pub motors: [Motor<Scalar>; 3],
    /// Status with which the tick ended.
    pub status: Result<(), Status>,
}

impl Default for TickOutcome {
    fn default() -> Self {
        let motor = Motor {
            angle: Scalar::angle_from_f64(0.0),
            rate: Scalar::ZERO,
            acceleration: Scalar::ZERO,
            torque: Scalar::ZERO,
        };
        Self {
            motors: [motor; 3],
            status: Ok(()),
        }
    }
}

/// One tick proper: the twelve results of one setpoint.
#[inline(never)]
pub fn evaluate(tick: &SceneTick, setpoint: &Setpoint<Scalar>, outcome: &mut TickOutcome) {
    match tick.evaluate(setpoint) {
        Ok(motion) => {
            outcome.motors = motion.motors;
            outcome.status = Ok(());
        }
        Err(status) => outcome.status = Err(status),
    }
}

/// One setpoint of a move.
#[inline(never)]
pub fn set(segment: &Segment<Scalar, Curves>, tick: u32, setpoint: &mut Setpoint<Scalar>) {
    *setpoint = segment.at(tick);
}

/// Position of one RRR dyad whose ends are `end` apart: its two links, as vectors.
#[inline(never)]
pub fn solve(
    dyad: &Rrr<Scalar>,
    end: &Vector2<Scalar>,
    links: &mut Result<[Vector2<Scalar>; 2], OutOfReach>,
) {
    *links = dyad.position(*end).map(|at| [at.r1, at.r2]);
}
