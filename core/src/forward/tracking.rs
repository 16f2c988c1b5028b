//! Tracking: the pose follows the motor angles tick by tick in its assembly mode. A motion that may
//! leave the mode is an error.
//!
//! Newton-Raphson from the last pose finds *a* pose. That it is the one the platform has moved to
//! is a statement on the whole way between, proved here by contraction before a step is taken.
//! With X_0 the last pose, A_0 the Jacobian there, F the three distance conditions and the motors
//! moving in proportion, theta(s) = theta_0 + s dtheta, the map T(X) = X - A_0^-1 F(X; s) has, on
//! a ball of radius r about X_0,
//!
//! ```text
//! |T(X_0) - X_0|  <=  eta = s |A_0^-1 F'| + s^2 sum_i |a_i| l1_i (l1_i + l2_i) dtheta_i^2 / 2
//! |T'|            <=  Q + P r,   P = sum_i |a_i| k_i,   Q = s sum_i |a_i| m_i l1_i |dtheta_i|
//! ```
//!
//! where a_i are the columns of A_0^-1, F'_i = -(r1_i x r2_i) dtheta_i is the first order of F in s,
//! and k_i, m_i bound how fast row i of the Jacobian changes with the pose and with the elbow. If
//! P r^2 - (1 - Q) r + eta <= 0 for some r, T contracts for all motor angles on the way: there is
//! one pose in the ball at each of them, it moves continuously, and det A does not vanish. So the
//! pose that Newton-Raphson then finds in the ball is in the same mode. A motion that is too large
//! is divided; the smaller the distance to the parallel singularity, the more parts it takes.
//!
//! Lengths are those of displacements (dx, dy, rho dalpha) of the middle of the platform's joints,
//! with rho^2 = h (l2 + h), h the largest distance of a joint from the middle.

use super::assembly::half_turn;
use super::newton::{Forward, ForwardError};
use super::polynomial::greater;
use crate::number::{Number, cross, dot, perpendicular};
use crate::setpoint::Pose;
use core::fmt;
use nalgebra::{Vector2, Vector3};

/// Newton steps per part of a motion: many more than a ball in which T contracts takes.
const NEWTON_STEPS: u32 = 20;

/// Coefficients of the tracking; immutable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tracker<N> {
    forward: Forward<N>,
    /// Middle of the platform's joints relative to D, in the platform's frame.
    middle: Vector2<N>,
    rho: N,
    /// k_i and m_i.
    changes: [[N; 2]; 3],
    least_distance: N,
    most_parts: u32,
}

/// Pose of the platform, known with its assembly mode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Track<N: Number> {
    /// The pose; its angle is not wrapped.
    pub pose: Pose<N>,
    /// The motor angles there.
    pub angles: [N::Angle; 3],
    /// det A there, m^4. Its sign is that of the mode.
    pub det_a: N,
    /// Scale-free distance to the parallel singularity.
    pub distance: N,
    /// Largest length error of a distal link relative to its length.
    pub residual: N,
    /// Parts that the last motion was divided into; 0 at the start.
    pub parts: u32,
}

/// End of the tracking. The last [`Track`] stays true for its angles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TrackingError<N> {
    /// Nearer to the parallel singularity than allowed, where two modes meet.
    NearSingular {
        /// The distance reached.
        distance: N,
    },
    /// det A has changed its sign: the pose found belongs to another mode.
    ChangedSide,
    /// The motion is too large to prove, in the parts allowed, that the mode is still the same; or an
    /// angle is not finite.
    StepTooLarge,
    /// Newton-Raphson found no pose near the last one.
    Lost(ForwardError<N>),
    /// Newton-Raphson found a pose, but not the one near the last.
    Jumped,
}

impl<N: Number> fmt::Display for TrackingError<N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NearSingular { distance } => write!(
                f,
                "near the parallel singularity: distance {:e}",
                distance.to_f64()
            ),
            Self::ChangedSide => write!(f, "det A changed its sign: another assembly mode"),
            Self::StepTooLarge => write!(f, "the motors moved too far to be sure of the mode"),
            Self::Lost(error) => write!(f, "lost: {error}"),
            Self::Jumped => write!(f, "the pose found is not the one near the last"),
        }
    }
}

impl<N: Number> core::error::Error for TrackingError<N> {}

/// Bounds of a motion from a track, for s = 1.
struct Reach<N> {
    /// |A_0^-1 F(X_0)|: the closing error of the last pose.
    gap: N,
    /// |A_0^-1 F'|
    linear: N,
    /// The factor of s^2 in eta.
    square: N,
    /// P
    pose: N,
    /// Q
    elbows: N,
}

impl<N: Number> Reach<N> {
    /// The radius within which the pose after the part `s` of the motion is the only one; `None` where
    /// the bounds do not prove it.
    fn radius(&self, s: N) -> Option<N> {
        let two = N::ONE + N::ONE;
        let eta = self.gap + s * (self.linear + s * self.square);
        let free = N::ONE - s * self.elbows;
        let root_sq = free * free - two * (two * (self.pose * eta));
        // A quarter is kept back for the rounding of these lines.
        let sure = free > N::ZERO && root_sq > N::HALF * N::HALF * (free * free);
        sure.then(|| (free + root_sq.sqrt()).div(two * self.pose))
    }
}

impl<N: Number> Tracker<N> {
    /// Poses at a scale-free distance of `least_distance` or less to the parallel singularity are
    /// refused; a motion is divided into at most `most_parts` parts, each of which costs a few
    /// Newton steps.
    pub fn new(forward: Forward<N>, least_distance: N, most_parts: u32) -> Self {
        let third = N::ratio(1, 3);
        let [a, b, c] = forward.legs.each_ref().map(|leg| leg.joint);
        let middle = (a + b + c) * third;
        let arms = forward.legs.each_ref().map(|leg| {
            let arm = leg.joint - middle;
            dot(arm, arm).sqrt()
        });
        let legs = arms.iter().zip(&forward.legs);
        let rho_sq = legs.fold(N::ZERO, |most, (&h, leg)| greater(most, h * (leg.l2 + h)));
        let rho = rho_sq.sqrt();
        let change = |index: usize| {
            let h = arms[index].div(rho);
            let far = (forward.legs[index].l2 + arms[index]).div(rho);
            let [h_sq, far_sq] = [h * h, far * far];
            let of_pose = N::ONE + h_sq + h_sq * (N::ONE + far_sq);
            [of_pose.sqrt(), (N::ONE + h_sq).sqrt()]
        };
        Self {
            forward,
            middle,
            rho,
            changes: [change(0), change(1), change(2)],
            least_distance,
            most_parts,
        }
    }

    /// The forward kinematics of the tracker.
    pub fn forward(&self) -> &Forward<N> {
        &self.forward
    }

    /// The track that begins at the pose that Newton-Raphson finds from `guess`; the mode is the
    /// one of that pose.
    ///
    /// # Errors
    /// [`TrackingError::Lost`] and [`TrackingError::NearSingular`].
    pub fn start(
        &self,
        angles: &[N::Angle; 3],
        guess: Pose<N>,
    ) -> Result<Track<N>, TrackingError<N>> {
        let track = self.solve(angles, guess)?;
        self.far_enough(track)
    }

    /// The track after the motors have moved to `angles`, each the shorter way round.
    ///
    /// # Errors
    /// [`TrackingError`]; never a pose of another mode.
    pub fn follow(
        &self,
        track: &Track<N>,
        angles: &[N::Angle; 3],
    ) -> Result<Track<N>, TrackingError<N>> {
        let mut at = *track;
        for part in 1..=self.most_parts {
            let move_of = |leg: usize| N::radians(half_turn::<N>(angles[leg] - at.angles[leg]));
            let motion = [move_of(0), move_of(1), move_of(2)];
            let reach = self.reach(&at, &motion);
            // Where a millionth of the motion is still too large, a singularity is near.
            let mut s = N::ONE;
            let mut radius = reach.radius(s);
            for _ in 0..20 {
                if radius.is_some() {
                    break;
                }
                s = N::HALF * s;
                radius = reach.radius(s);
            }
            let Some(radius) = radius else {
                return Err(TrackingError::StepTooLarge);
            };
            let whole = s == N::ONE;
            let along = |leg: usize| at.angles[leg] + N::angle(s * motion[leg]);
            let target = if whole {
                *angles
            } else {
                [along(0), along(1), along(2)]
            };
            let next = self.solve(&target, at.pose)?;
            if !(self.moved(&at.pose, &next.pose) < radius) {
                return Err(TrackingError::Jumped);
            }
            if (next.det_a > N::ZERO) != (track.det_a > N::ZERO) {
                return Err(TrackingError::ChangedSide);
            }
            at = self.far_enough(next)?;
            if whole {
                return Ok(Track { parts: part, ..at });
            }
        }
        Err(TrackingError::StepTooLarge)
    }

    fn solve(&self, angles: &[N::Angle; 3], guess: Pose<N>) -> Result<Track<N>, TrackingError<N>> {
        let elbows = self.forward.elbows(angles);
        let found = self
            .forward
            .solve_elbows(&elbows, guess, NEWTON_STEPS)
            .map_err(TrackingError::Lost)?;
        let (det_a, distance) = self.forward.det_a(&found.pose, &elbows);
        Ok(Track {
            pose: found.pose,
            angles: *angles,
            det_a,
            distance,
            residual: found.residual,
            parts: 0,
        })
    }

    fn far_enough(&self, track: Track<N>) -> Result<Track<N>, TrackingError<N>> {
        if track.distance > self.least_distance {
            Ok(track)
        } else {
            Err(TrackingError::NearSingular {
                distance: track.distance,
            })
        }
    }

    /// Displacement of the middle of the joints, turns counted by rho.
    fn moved(&self, from: &Pose<N>, to: &Pose<N>) -> N {
        let middle = |pose: &Pose<N>| {
            let (sin, cos) = N::sin_cos(pose.angle);
            self.middle * cos + perpendicular(self.middle) * sin
        };
        let place = (to.position - from.position) + (middle(to) - middle(from));
        let turn = self.rho * N::radians(to.angle - from.angle);
        (dot(place, place) + turn * turn).sqrt()
    }

    fn reach(&self, track: &Track<N>, motion: &[N; 3]) -> Reach<N> {
        let legs = &self.forward.legs;
        let (sin, cos) = N::sin_cos(track.pose.angle);
        let turned = |v: Vector2<N>| v * cos + perpendicular(v) * sin;
        let mut rows = [Vector3::new(N::ZERO, N::ZERO, N::ZERO); 3];
        let mut gaps = [N::ZERO; 3];
        let mut linear = [N::ZERO; 3];
        for (index, leg) in legs.iter().enumerate() {
            let (sin, cos) = N::sin_cos(track.angles[index]);
            let r1 = Vector2::new(cos, sin) * leg.l1;
            let r2 = (track.pose.position - (leg.base + r1)) + turned(leg.joint);
            let arm = turned(leg.joint - self.middle);
            rows[index] = Vector3::new(r2.x, r2.y, cross(arm, r2).div(self.rho));
            gaps[index] = N::HALF * (dot(r2, r2) - leg.l2 * leg.l2);
            linear[index] = -(cross(r1, r2) * motion[index]);
        }
        let [a, b, c] = &rows;
        let columns = [b.cross(c), c.cross(a), a.cross(b)];
        let det = a.x * columns[0].x + a.y * columns[0].y + a.z * columns[0].z;
        let inverse = N::ONE.div(det);
        let columns = columns.map(|column| column * inverse);

        let length = |v: Vector3<N>| (v.x * v.x + v.y * v.y + v.z * v.z).sqrt();
        let solved = |f: &[N; 3]| length(columns[0] * f[0] + columns[1] * f[1] + columns[2] * f[2]);
        let mut reach = Reach {
            gap: solved(&gaps),
            linear: solved(&linear),
            square: N::ZERO,
            pose: N::ZERO,
            elbows: N::ZERO,
        };
        for (index, leg) in legs.iter().enumerate() {
            let column = length(columns[index]);
            let elbow = leg.l1 * motion[index].abs();
            let bend = N::HALF * (elbow * motion[index].abs()) * (leg.l1 + leg.l2);
            let [of_pose, of_elbow] = self.changes[index];
            reach.square += column * bend;
            reach.pose += column * of_pose;
            reach.elbows += column * (of_elbow * elbow);
        }
        reach
    }
}

#[cfg(test)]
mod tests;
