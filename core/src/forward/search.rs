//! From arcs with a root to poses.

use super::isolate::Arc;
use super::modes::{Assemblies, Assembly, AssemblyError, Completeness};
use super::newton::Forward;
use super::polynomial::{extent, greater};
use crate::number::{Number, dot, perpendicular};
use crate::setpoint::Pose;
use nalgebra::Vector2;

/// Newton steps that polish a root: a few, but near a double root each gains one bit.
const POLISH: u32 = 40;

/// The two points at which the circles of two legs meet.
#[derive(Clone, Copy)]
struct Crossing<N> {
    /// Square of the sine of the angle at which they meet; negative if they miss.
    sine_sq: N,
    places: [Vector2<N>; 2],
}

/// A search for the poses of the isolated roots.
pub(super) struct PoseSearch<'a, N: Number> {
    forward: &'a Forward<N>,
    elbows: [Vector2<N>; 3],
    /// Largest length error that rounding of the joints' places can cause.
    closed: N,
    /// Poses whose joints are closer than this count as one.
    same: N,
    pub(super) found: Assemblies<N>,
}

impl<'a, N: Number> PoseSearch<'a, N> {
    pub(super) fn new(forward: &'a Forward<N>, elbows: [Vector2<N>; 3]) -> Self {
        let mut reach = N::ZERO;
        let mut shortest = forward.legs[0].l2;
        for (leg, &elbow) in forward.legs.iter().zip(&elbows) {
            reach = greater(reach, extent(elbow) + extent(leg.joint) + leg.l2);
            shortest = if leg.l2 < shortest { leg.l2 } else { shortest };
        }
        let eight = N::from_f64(8.0);
        let nowhere = Assembly {
            pose: Pose {
                position: Vector2::new(N::ZERO, N::ZERO),
                angle: N::angle(N::ZERO),
            },
            residual: N::ZERO,
            det_a: N::ZERO,
            distance: N::ZERO,
            double: false,
        };
        Self {
            forward,
            elbows,
            closed: eight * N::UNIT_ROUNDOFF * reach.div(shortest),
            same: N::HALF * N::UNIT_ROUNDOFF.sqrt() * reach,
            found: Assemblies {
                modes: [nowhere; 6],
                count: 0,
                completeness: Completeness::Complete,
                arcs: 0,
            },
        }
    }

    /// Adds the pose of the one root `alpha` on `arc`.
    pub(super) fn add_simple_root(&mut self, arc: &Arc<N>, alpha: N) {
        // Newton may leave the arc by roundings, but not for another root.
        let margin = (arc.high - arc.low) + N::UNIT_ROUNDOFF.sqrt();
        let Some([first, second]) = self.candidates(alpha) else {
            self.found.completeness = Completeness::Undecided;
            return;
        };
        for candidate in [first, second] {
            if let Some(pose) = self.polished(candidate, arc.low - margin, arc.high + margin)
                && self.insert(pose, false)
            {
                return;
            }
        }
        // Next to a double root Newton-Raphson may go to the neighbour; the candidate itself closes.
        if self.residual(&first) <= self.nearly_closed() && self.insert(first, false) {
            return;
        }
        self.found.completeness = Completeness::Undecided;
    }

    /// Adds the poses on an arc where f stays below its rounding bound: two that share an angle, or
    /// two that meet.
    pub(super) fn add_undecided(&mut self, arc: &Arc<N>) -> Result<(), AssemblyError> {
        let width = arc.high - arc.low;
        let margin = N::HALF * (N::HALF * width) + N::UNIT_ROUNDOFF.sqrt();
        let (low, high) = (arc.low - margin, arc.high + margin);
        let middle = arc.low + N::HALF * width;
        let before = self.found.count;
        let (mut touches, mut touching) = (None, 0);
        for alpha in [middle, arc.low, arc.high] {
            let Some(candidates) = self.candidates(alpha) else {
                continue;
            };
            for candidate in candidates {
                if let Some(pose) = self.polished(candidate, low, high) {
                    self.insert(pose, false);
                }
            }
            if self.residual(&candidates[0]) <= self.nearly_closed() {
                touches = touches.or(Some(candidates[0]));
                touching += 1;
            }
        }
        // Beside a double root f is below its rounding bound on an arc of the size of the square root
        // of the rounding. A wider arc on which the legs close is no root: the platform is loose.
        let wide = width > N::HALF;
        if (wide && touching == 3) || self.centres_coincide(middle) {
            return Err(AssemblyError::Loose);
        }
        let mut found = self.found.count - before;
        if found == 0
            && let Some(pose) = touches
            && self.insert(pose, true)
        {
            found = 1;
        }
        if found == 0 && self.misses(arc) {
            return Ok(());
        }
        let completeness = match (found, arc.odd) {
            (1, false) => {
                self.found.modes[before].double = true;
                Completeness::Double
            }
            (1, true) | (2, false) | (3, true) if self.are_certain(before, width) => {
                Completeness::Complete
            }
            _ => Completeness::Undecided,
        };
        if self.found.completeness != Completeness::Undecided
            && completeness != Completeness::Complete
        {
            self.found.completeness = completeness;
        }
        Ok(())
    }

    /// Returns `true` if the modes from number `first` on, found on an arc of `width`, are there whatever
    /// the rounding of the joints' places is, and are alone. A pose moves by that rounding over its
    /// distance from the parallel singularity, and has to stay nearer to where it was than to the
    /// singularity. A neighbour is about as far as the singularity: not on a narrower arc.
    fn are_certain(&self, first: usize, width: N) -> bool {
        self.found.modes()[first..]
            .iter()
            .all(|mode| mode.distance * mode.distance > self.closed && mode.distance > width)
    }

    /// The points B_i - R h_i.
    fn centres(&self, alpha: N) -> [Vector2<N>; 3] {
        let (sin, cos) = N::sin_cos(N::angle(alpha));
        let centre = |index: usize| {
            let joint = self.forward.legs[index].joint;
            self.elbows[index] - (joint * cos + perpendicular(joint) * sin)
        };
        [centre(0), centre(1), centre(2)]
    }

    /// The three circles are one: D can be anywhere on it.
    fn centres_coincide(&self, alpha: N) -> bool {
        let [a, b, c] = self.centres(alpha);
        let [first, second, third] = self.forward.legs.each_ref().map(|leg| leg.l2);
        let spread = extent(b - a) + extent(c - a) + (second - first).abs() + (third - first).abs();
        spread <= self.same
    }

    /// The length error of a pose beside a double root.
    fn nearly_closed(&self) -> N {
        N::from_f64(8.0) * self.closed
    }

    /// Intersections of the circles of the legs of `pair`; `None` for circles with one centre.
    fn crossing(&self, centres: &[Vector2<N>; 3], (i, j): (usize, usize)) -> Option<Crossing<N>> {
        let (li, lj) = (self.forward.legs[i].l2, self.forward.legs[j].l2);
        let d = centres[j] - centres[i];
        let (sum, difference, d_sq) = (li + lj, li - lj, dot(d, d));
        let inverse = N::ONE.div(d_sq);
        if !inverse.is_finite() {
            return None;
        }
        let four_s_sq = (sum * sum - d_sq) * (d_sq - difference * difference);
        // Circles that miss each other by rounding touch.
        let two_s = if four_s_sq > N::ZERO {
            four_s_sq.sqrt()
        } else {
            N::ZERO
        };
        let foot = centres[i] + d * (N::HALF * inverse * (d_sq + difference * sum));
        let across = perpendicular(d) * (N::HALF * inverse * two_s);
        Some(Crossing {
            sine_sq: (N::HALF * (N::HALF * four_s_sq)).div(li * lj * (li * lj)),
            places: [foot + across, foot - across],
        })
    }

    /// The two legs whose circles meet most nearly at right angles.
    fn best_pair(&self, centres: &[Vector2<N>; 3]) -> Option<((usize, usize), Crossing<N>)> {
        let mut best: Option<((usize, usize), Crossing<N>)> = None;
        for pair in [(0, 1), (1, 2), (0, 2)] {
            if let Some(crossing) = self.crossing(centres, pair)
                && best.is_none_or(|(_, best)| crossing.sine_sq > best.sine_sq)
            {
                best = Some((pair, crossing));
            }
        }
        best
    }

    /// Both poses with angle `alpha` at which two of the distal links have their lengths. The one that
    /// fits the third link better comes first.
    fn candidates(&self, alpha: N) -> Option<[Pose<N>; 2]> {
        let (_, crossing) = self.best_pair(&self.centres(alpha))?;
        let angle = N::angle(alpha);
        let [first, second] = crossing.places.map(|position| Pose { position, angle });
        Some(if self.residual(&second) < self.residual(&first) {
            [second, first]
        } else {
            [first, second]
        })
    }

    /// Returns `true` if no pose has its angle on the narrow arc, although f is below its rounding
    /// bound there, as beside a root or where the circles' centres nearly coincide. On both branches
    /// the third leg's length error then keeps its sign, by more than its dip between the samples.
    fn misses(&self, arc: &Arc<N>) -> bool {
        let middle = arc.low + N::HALF * (arc.high - arc.low);
        let Some((pair, _)) = self.best_pair(&self.centres(middle)) else {
            return false;
        };
        let third = 3 - pair.0 - pair.1;
        let errors = |alpha: N| {
            let centres = self.centres(alpha);
            let crossing = self.crossing(&centres, pair)?;
            // Branches that meet on the arc would have to be followed through one another.
            if !(crossing.sine_sq > N::from_f64(0.01)) {
                return None;
            }
            let l2 = self.forward.legs[third].l2;
            let error = |place: Vector2<N>| {
                let r2 = place - centres[third];
                N::HALF * (dot(r2, r2).div(l2 * l2) - N::ONE)
            };
            Some(crossing.places.map(error))
        };
        let (Some(low), Some(between), Some(high)) =
            (errors(arc.low), errors(middle), errors(arc.high))
        else {
            return false;
        };
        (0..2).all(|branch| {
            let [a, b, c] = [&low, &between, &high].map(|at| at[branch]);
            // A place is off by up to ten times as much as the circles' centres are, at a sine of 0.1.
            let dip = (a - (b + b) + c).abs() + self.nearly_closed() + self.closed + self.closed;
            let side = if b < N::ZERO { -N::ONE } else { N::ONE };
            [a, b, c].iter().all(|&error| error * side > dip)
        })
    }

    fn residual(&self, pose: &Pose<N>) -> N {
        self.forward.linearised(pose, &self.elbows).length_error
    }

    /// The pose that Newton-Raphson reaches from `candidate`, if it closes and its angle is between
    /// `low` and `high`.
    fn polished(&self, candidate: Pose<N>, low: N, high: N) -> Option<Pose<N>> {
        let found = self
            .forward
            .solve_elbows(&self.elbows, candidate, POLISH)
            .ok()?;
        let alpha = N::radians(found.pose.angle);
        (found.residual <= self.closed && alpha >= low && alpha <= high).then_some(found.pose)
    }

    /// Sorts the modes by angle; those of undecided arcs were added last.
    pub(super) fn sort(&mut self) {
        let modes = &mut self.found.modes[..self.found.count];
        for end in 1..modes.len() {
            for at in (0..end).rev() {
                let [a, b] = [at, at + 1].map(|index| N::radians(modes[index].pose.angle));
                if !(b < a) {
                    break;
                }
                modes.swap(at, at + 1);
            }
        }
    }

    /// Adds the pose. Returns `false` if it is in the list already, or the list is full.
    fn insert(&mut self, pose: Pose<N>, double: bool) -> bool {
        let known =
            |mode: &Assembly<N>| self.forward.joint_distance(&mode.pose, &pose) <= self.same;
        if self.found.modes().iter().any(known) {
            return false;
        }
        if self.found.count == self.found.modes.len() {
            self.found.completeness = Completeness::Undecided;
            return false;
        }
        let at = self.forward.linearised(&pose, &self.elbows);
        let (det_a, distance) = self.forward.det_a(&pose, &self.elbows);
        self.found.modes[self.found.count] = Assembly {
            pose,
            residual: at.length_error,
            det_a,
            distance,
            double,
        };
        self.found.count += 1;
        true
    }
}
