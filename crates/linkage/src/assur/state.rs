//! Place and motion of a link.

use super::parts::Prismatic;
use crate::LinkageStatus;
use crate::motion::{LinkMotion, unit};
use nalgebra::Vector2;

/// A link at one position of the linkage.
#[derive(Clone, Copy, Debug)]
pub struct LinkState {
    /// Its frame's motion.
    pub motion: LinkMotion<f64>,
    /// The angle of its frame, rad: not wrapped, so that it follows whole turns.
    pub angle: f64,
    /// `true` once the link is solved for the current position.
    pub(super) known: bool,
}

/// Result of one group.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solved {
    /// Scale-free distance from a singular position, 0 there, at most 1: of a dyad its own, of what
    /// is solved by Newton-Raphson the reciprocal condition of the Jacobian, with lengths measured
    /// in the linkage's size.
    pub distance: f64,
    /// Newton-Raphson's iterations; 0 for a closed form.
    pub iterations: u32,
    /// Sign of the Jacobian's determinant where there is one: it changes only through a singular
    /// position.
    pub(super) positive: bool,
}

/// Reason why a group has no position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reason {
    /// A dyad's answer.
    Dyad(LinkageStatus),
    /// Newton-Raphson did not converge from where it started.
    Diverged,
    /// The Jacobian of the group's equations has no inverse.
    Singular,
    /// The only position found is on the other side of a singular one.
    Flipped,
}

impl Prismatic {
    /// The direction of the guide's line, a unit vector in the fixed frame.
    pub(super) fn along(&self, states: &[LinkState]) -> Vector2<f64> {
        states[self.guide.link].motion.vector(unit(self.direction))
    }
}

impl LinkState {
    /// At rest at x, y and an angle.
    pub(super) fn at_rest([x, y, angle]: [f64; 3]) -> Self {
        Self {
            motion: LinkMotion::fixed(Vector2::new(x, y), unit(angle)),
            angle,
            known: false,
        }
    }

    /// x, y and angle.
    pub fn pose(&self) -> [f64; 3] {
        let position = self.motion.origin.position;
        [position.x, position.y, self.angle]
    }

    /// Moves to another pose, rates and accelerations kept.
    pub(super) fn move_to(&mut self, [x, y, angle]: [f64; 3]) {
        self.motion.origin.position = Vector2::new(x, y);
        self.motion.direction = unit(angle);
        self.angle = angle;
    }

    /// The state `dt` later if the accelerations stayed as they are.
    pub(super) fn predicted(&self, dt: f64) -> Self {
        let mut state = *self;
        let motion = &self.motion;
        let ahead = |value: f64, rate: f64, acceleration: f64| {
            value + dt * (rate + 0.5 * acceleration * dt)
        };
        let (r, v, a) = (
            motion.origin.position,
            motion.origin.velocity,
            motion.origin.acceleration,
        );
        state.move_to([
            ahead(r.x, v.x, a.x),
            ahead(r.y, v.y, a.y),
            ahead(self.angle, motion.rate, motion.acceleration),
        ]);
        state.known = false;
        state
    }

    /// Takes a motion whose angle is known up to whole turns only: the one nearest to where the
    /// state is now.
    pub(super) fn take(&mut self, motion: LinkMotion<f64>) {
        use std::f64::consts::TAU;
        let angle = motion.angle();
        self.angle = angle + TAU * ((self.angle - angle) / TAU).round();
        self.motion = motion;
        self.known = true;
    }
}
