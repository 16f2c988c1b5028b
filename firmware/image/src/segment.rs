//! Moves of a scene, from constants in the image to setpoints.

use nalgebra::Vector3;
use trirrr_core::number::Number;
use trirrr_core::setpoint::{self, CurveKind, Ends, Pose, Setpoint};

/// Move as a constant in an image. Poses are (x m, y m, alpha rad), velocities
/// (vx m/s, vy m/s, alphadot rad/s).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Move {
    /// Starts and ends at rest.
    RestToRest {
        /// First pose.
        from: [f64; 3],
        /// Last pose.
        to: [f64; 3],
        /// Length in ticks, positive.
        ticks: u32,
    },
    /// Has a velocity at one end or both.
    Hermite {
        /// First pose.
        from: [f64; 3],
        /// Velocity there.
        from_velocity: [f64; 3],
        /// Last pose.
        to: [f64; 3],
        /// Velocity there.
        to_velocity: [f64; 3],
        /// Length in ticks, positive.
        ticks: u32,
    },
    /// Has accelerations at both ends.
    Quintic {
        /// First pose and last pose.
        poses: [[f64; 3]; 2],
        /// Velocities there.
        velocities: [[f64; 3]; 2],
        /// Accelerations there: (ax m/s^2, ay m/s^2, alphaddot rad/s^2).
        accelerations: [[f64; 3]; 2],
        /// Length in ticks, positive.
        ticks: u32,
    },
}

impl Move {
    /// Length in ticks.
    pub fn ticks(&self) -> u32 {
        match self {
            Self::RestToRest { ticks, .. }
            | Self::Hermite { ticks, .. }
            | Self::Quintic { ticks, .. } => *ticks,
        }
    }

    /// What the curve is given by, in the number type `N`. A quintic of a scene that plays none is a cubic.
    pub fn ends<N: Number, K: CurveKind>(&self) -> Ends<N, K> {
        let pose = |[x, y, alpha]: [f64; 3]| Pose::from_f64(x, y, alpha);
        let vector = |v: [f64; 3]| Vector3::from(v.map(N::from_f64));
        let ([from, to], velocities, accelerations) = match *self {
            Self::RestToRest { from, to, .. } => ([from, to], [[0.0; 3]; 2], None),
            Self::Hermite {
                from,
                from_velocity,
                to,
                to_velocity,
                ..
            } => ([from, to], [from_velocity, to_velocity], None),
            Self::Quintic {
                poses,
                velocities,
                accelerations,
                ..
            } => (poses, velocities, Some(accelerations)),
        };
        let accelerations = accelerations.map(|both| both.map(|one| one.map(N::from_f64)));
        Ends {
            from: pose(from),
            to: pose(to),
            velocities: velocities.map(vector),
            accelerations: accelerations.and_then(K::some).unwrap_or_else(K::none),
        }
    }
}

/// Move built in the number type `N`, with the number of its own ticks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment<N: Number, K: CurveKind> {
    curve: setpoint::Segment<N, K>,
    ticks: u32,
}

impl<N: Number, K: CurveKind> Segment<N, K> {
    /// Number of ticks of this move alone, from its first. The tick between two moves belongs to the later one,
    /// the last tick of the job to the last move.
    pub fn ticks(&self) -> u32 {
        self.ticks
    }

    /// Setpoint at `tick`, counted from the start of the move.
    #[inline(always)]
    pub fn at(&self, tick: u32) -> Setpoint<N> {
        self.curve.at(tick)
    }
}

/// Builds the moves one after another in the number type `N`, as the iterator reaches them.
pub fn segments<N: Number, K: CurveKind>(
    moves: &[Move],
    period_s: f64,
) -> impl Iterator<Item = Segment<N, K>> {
    let period = N::factor_from_f64(period_s);
    moves.iter().enumerate().map(move |(index, one)| {
        let ticks = one.ticks();
        let is_last = index + 1 == moves.len();
        Segment {
            curve: setpoint::Segment::new(&one.ends(), ticks, period),
            ticks: ticks + u32::from(is_last),
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use trirrr_core::setpoint::Cubics;

    #[test]
    fn chained_moves_share_the_tick_between_them() {
        let middle = [0.1, 0.2, 0.3];
        let speed = [0.5, 0.0, 1.0];
        let moves = [
            Move::Hermite {
                from: [0.0; 3],
                from_velocity: [0.0; 3],
                to: middle,
                to_velocity: speed,
                ticks: 4,
            },
            Move::Hermite {
                from: middle,
                from_velocity: speed,
                to: [0.4; 3],
                to_velocity: [0.0; 3],
                ticks: 6,
            },
            Move::RestToRest {
                from: [0.4; 3],
                to: [0.0; 3],
                ticks: 5,
            },
        ];
        let built: Vec<Segment<f64, Cubics>> = segments(&moves, 0.01).collect();
        let ticks: Vec<u32> = built.iter().map(Segment::ticks).collect();
        assert_eq!(ticks, [4, 6, 5 + 1]);
        for pair in built.windows(2) {
            let (end, start) = (pair[0].at(pair[0].ticks()), pair[1].at(0));
            assert_eq!(end.pose, start.pose);
            // Each end of a move gives its own pose and velocity, the latter to rounding.
            let difference = end.velocity - start.velocity;
            assert!(difference.iter().all(|part| part.abs() < 1e-14));
        }
        assert_eq!(built[0].at(4).pose.position.x, 0.1);
        assert_eq!(built[2].at(5).pose.angle, 0.0);
    }
}
