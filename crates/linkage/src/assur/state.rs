//! State of a link: place and motion.

use crate::motion::{LinkMotion, unit};
use nalgebra::Vector2;

/// Motion of a link in binary64.
pub(super) type Motion = LinkMotion<f64>;

/// A link at one position of the linkage.
#[derive(Clone, Copy, Debug)]
pub struct State {
    /// Its frame's motion.
    pub motion: LinkMotion<f64>,
    /// The angle of its frame, rad: not wrapped, so that it follows whole turns.
    pub angle: f64,
    /// `true` once the link is solved for the current position.
    pub(super) known: bool,
}

impl State {
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
