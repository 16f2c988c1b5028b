//! A linkage followed over its motion: the branch is kept, and where it ends is said.

use super::constraint::wrapped;
use super::description::Linkage;
use super::solve::{Position, Solver, Unsolved};
use super::state::{LinkState, Reason};

/// Halvings of a step before a jump counts as one.
pub(super) const HALVINGS: u32 = 12;
/// Farthest that a link may be from where its motion was heading, in rad and in sizes of the
/// linkage, for the step to count as continuous.
const SURPRISE: f64 = 0.2;
/// A group that comes nearer than this to a singular position is at it: distances are square roots
/// of differences, so a dyad's is zero only to about the root of the rounding.
const AT_SINGULARITY: f64 = 1e-6;
/// Minima of the distance below this are looked at closely.
const NEAR_SINGULARITY: f64 = 0.1;

/// A linkage over its motion.
#[derive(Clone, Debug)]
pub struct Track {
    /// The positions in order of time; all of the motion unless `stop` says why not.
    pub positions: Vec<Position>,
    /// End of a motion that ended early.
    pub stop: Option<Stop>,
    /// Largest gap of the loops, m.
    pub closure: f64,
    /// For each group the least distance from a singular position and when, s.
    pub nearest: Vec<(f64, f64)>,
}

/// End of a motion that ended early.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop {
    /// The last time that has a position, s.
    pub t: f64,
    /// The group that has none after it, and why.
    pub unsolved: Unsolved,
}

/// Follows `linkage` over its motion.
pub fn track(linkage: &Linkage) -> Track {
    let mut track = Track {
        positions: Vec::new(),
        stop: None,
        closure: 0.0,
        nearest: vec![(f64::INFINITY, 0.0); linkage.groups.len()],
    };
    let (solver, first) = match Solver::start(linkage) {
        Ok(started) => started,
        Err(unsolved) => {
            track.stop = Some(Stop { t: 0.0, unsolved });
            return track;
        }
    };
    track.add(&solver, first);
    let motion = linkage.motion;
    for step in 1..=motion.steps {
        let t = motion.duration * (f64::from(step) / f64::from(motion.steps));
        let Some(last) = track.positions.last().cloned() else {
            return track;
        };
        match solver.advance(&last, t, HALVINGS) {
            Ok(position) => {
                track.add(&solver, position);
                if let Some(stop) = solver.passed_singularity(&track.positions) {
                    track.positions.retain(|position| position.t <= stop.t);
                    track.stop = Some(stop);
                    return track;
                }
            }
            Err(unsolved) => {
                track.stop = Some(solver.locate(last, t, unsolved));
                return track;
            }
        }
    }
    track
}

impl Track {
    fn add(&mut self, solver: &Solver, position: Position) {
        self.closure = self.closure.max(solver.closure(&position));
        for (nearest, solved) in self.nearest.iter_mut().zip(&position.groups) {
            if solved.distance < nearest.0 {
                *nearest = (solved.distance, position.t);
            }
        }
        self.positions.push(position);
    }
}

impl Solver<'_> {
    /// The position at `t`, reached from `last` without a jump.
    pub(super) fn advance(
        &self,
        last: &Position,
        t: f64,
        halvings: u32,
    ) -> Result<Position, Unsolved> {
        let dt = t - last.t;
        let predicted: Vec<_> = last
            .states
            .iter()
            .map(|state| state.predicted(dt))
            .collect();
        let found = self.position(predicted.clone(), t).and_then(|position| {
            match self.jumped(last, &predicted, &position) {
                Some(group) => Err(Unsolved {
                    group,
                    reason: Reason::Flipped,
                }),
                None => Ok(position),
            }
        });
        match found {
            Err(Unsolved { reason, .. }) if halvings > 0 && !matches!(reason, Reason::Dyad(_)) => {
                let middle = self.advance(last, last.t + 0.5 * dt, halvings - 1)?;
                self.advance(&middle, t, halvings - 1)
            }
            found => found,
        }
    }

    /// The first group that is not where it was heading or is on another branch.
    fn jumped(
        &self,
        last: &Position,
        predicted: &[LinkState],
        position: &Position,
    ) -> Option<usize> {
        let size = self.linkage.size();
        self.linkage
            .groups
            .iter()
            .enumerate()
            .position(|(index, group)| {
                let turned = last.groups[index].positive != position.groups[index].positive;
                turned
                    || group.links.iter().any(|&link| {
                        let (from, to) = (predicted[link].pose(), position.states[link].pose());
                        let missed = [
                            (to[0] - from[0]) / size,
                            (to[1] - from[1]) / size,
                            wrapped(to[2] - from[2]),
                        ];
                        missed.iter().any(|miss| miss.abs() > SURPRISE)
                    })
            })
    }

    /// The last time before `t` that can be reached from `last`.
    fn locate(&self, mut last: Position, t: f64, mut unsolved: Unsolved) -> Stop {
        let mut beyond = t;
        for _ in 0..60 {
            let middle = last.t + 0.5 * (beyond - last.t);
            if middle <= last.t || middle >= beyond {
                break;
            }
            match self.advance(&last, middle, 0) {
                Ok(position) => last = position,
                Err(other) => {
                    beyond = middle;
                    // Close to the end the reason may be rounding's; the first one stands.
                    if other.group != unsolved.group {
                        unsolved = other;
                    }
                }
            }
        }
        Stop {
            t: last.t,
            unsolved,
        }
    }

    /// Returns the stop at a singular position that a group passed within the last three positions.
    /// The branches meet there, and the branch after it is undetermined.
    fn passed_singularity(&self, positions: &[Position]) -> Option<Stop> {
        let [.., a, b, c] = positions else {
            return None;
        };
        (0..self.linkage.groups.len()).find_map(|group| {
            let distance = |position: &Position| position.groups[group].distance;
            let least = distance(b) <= distance(a) && distance(b) <= distance(c);
            if !least || distance(b) > NEAR_SINGULARITY {
                return None;
            }
            let (mut low, mut high) = (a.t, c.t);
            let at = |t: f64| {
                let predicted = a.states.iter().map(|state| state.predicted(t - a.t));
                self.position(predicted.collect(), t)
            };
            // The distance has one minimum here: thirds are cut off until nothing is left. What has
            // no position at all lies beyond a singular one.
            let reach = |t: f64| at(t).map_or(0.0, |position| distance(&position));
            let mut reached = f64::INFINITY;
            for _ in 0..90 {
                let third = (high - low) / 3.0;
                let (left, right) = (low + third, high - third);
                let (at_left, at_right) = (reach(left), reach(right));
                reached = reached.min(at_left).min(at_right);
                if at_left < at_right {
                    high = right;
                } else {
                    low = left;
                }
            }
            (reached < AT_SINGULARITY).then_some(Stop {
                t: low,
                unsolved: Unsolved {
                    group,
                    reason: Reason::Singular,
                },
            })
        })
    }
}
