//! Location of events: zero crossings of event functions along the dense output of a step.

use crate::dense::Dense;
use crate::stepper::shortest_step;
use crate::system::{Direction, System};

/// Looks at the event functions at these parts of a step; between them, where a parabola through
/// three of the points turns towards zero.
const LOOKS: [f64; 4] = [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0];
/// Looks at the turning point of such a parabola, which each look makes a better one.
const TURNS: usize = 4;
/// Iterations of the root finder: three to halve an interval of 2^52 floating-point numbers at worst,
/// six or so as a rule.
const ITERATIONS: usize = 160;

/// An event function at an instant of the step.
#[derive(Clone, Copy, Debug)]
struct Look {
    t: f64,
    value: f64,
}

/// An event that is located.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Crossing {
    pub(crate) event: usize,
    pub(crate) t: f64,
    /// The function came from below zero.
    pub(crate) rising: bool,
}

/// Watches the event functions of a system from step to step.
#[derive(Clone, Debug)]
pub(crate) struct Watch {
    /// Values at the start of the step.
    before: Vec<f64>,
    known: bool,
    /// Values at [`LOOKS`], the start apart.
    later: [Vec<f64>; LOOKS.len() - 1],
    scratch: Vec<f64>,
    /// The first crossing of each event function in the step.
    found: Vec<Option<Crossing>>,
}

impl Watch {
    pub(crate) fn new(events: usize) -> Self {
        let values = || vec![0.0; events];
        Self {
            before: values(),
            known: false,
            later: std::array::from_fn(|_| values()),
            scratch: values(),
            found: vec![None; events],
        }
    }

    /// Forgets the values at the start of the next step: the mode or the state has changed.
    pub(crate) fn restart(&mut self) {
        self.known = false;
    }

    /// Returns `true` if any event function is watched in the present mode.
    pub(crate) fn any<const N: usize, S: System<N>>(&self, system: &S) -> bool {
        (0..self.before.len()).any(|event| system.direction(event).is_some())
    }

    /// The time of the first crossing in a step; [`Watch::occurred`] says which. Without any, the
    /// values at the end are kept for the next step.
    pub(crate) fn first<const N: usize, S: System<N>>(
        &mut self,
        system: &S,
        dense: &Dense<N>,
    ) -> Option<f64> {
        if !self.known {
            system.event_values(dense.t0, &dense.y0, &mut self.before);
            self.known = true;
        }
        let length = dense.t1 - dense.t0;
        let at = |part: f64| {
            if part == 1.0 {
                dense.t1
            } else {
                dense.t0 + part * length
            }
        };
        for (part, values) in LOOKS[1..].iter().zip(&mut self.later) {
            let t = at(*part);
            system.event_values(t, &dense.at(t), values);
        }
        // What the clock cannot tell apart occurs together, when the last of it has occurred.
        let together = |first: f64| first + 2.0 * shortest_step(dense.t1, dense.t1);
        let mut first = f64::INFINITY;
        for event in 0..self.before.len() {
            self.found[event] = None;
            let Some(direction) = system.direction(event) else {
                continue;
            };
            let looks: [Look; LOOKS.len()] = std::array::from_fn(|i| Look {
                t: at(LOOKS[i]),
                value: match i {
                    0 => self.before[event],
                    _ => self.later[i - 1][event],
                },
            });
            let mut probe = Probe {
                system,
                dense,
                event,
                values: &mut self.scratch,
            };
            if let Some((from, to)) = probe.bracket(&looks, direction) {
                let rising = from.value < 0.0;
                if let Some(t) = probe.root(from, to, together(first)) {
                    self.found[event] = Some(Crossing { event, t, rising });
                    first = first.min(t);
                }
            }
        }
        if first == f64::INFINITY {
            std::mem::swap(&mut self.before, &mut self.later[LOOKS.len() - 2]);
            return None;
        }
        let together = together(first);
        let last = |last: f64, crossing: &Crossing| {
            if crossing.t <= together {
                last.max(crossing.t)
            } else {
                last
            }
        };
        Some(self.found.iter().flatten().fold(first, last))
    }

    /// The crossings that have occurred by the time that [`Watch::first`] has found.
    pub(crate) fn occurred(&self, by: f64) -> impl Iterator<Item = &Crossing> {
        self.found
            .iter()
            .flatten()
            .filter(move |crossing| crossing.t <= by)
    }

    /// Values at the start of the next step, after the events that occurred by `t`; those that have just occurred
    /// stand on their new side of zero, however the last bit of their values came out.
    pub(crate) fn resume<const N: usize, S: System<N>>(
        &mut self,
        system: &S,
        (t, y): (f64, &[f64; N]),
    ) {
        system.event_values(t, y, &mut self.before);
        self.known = true;
        for crossing in self
            .found
            .iter()
            .flatten()
            .filter(|crossing| crossing.t <= t)
        {
            let value = &mut self.before[crossing.event];
            *value = if crossing.rising {
                value.max(f64::MIN_POSITIVE)
            } else {
                value.min(-f64::MIN_POSITIVE)
            };
        }
    }
}

/// One event function along a step.
struct Probe<'a, const N: usize, S> {
    system: &'a S,
    dense: &'a Dense<N>,
    event: usize,
    values: &'a mut [f64],
}

impl<const N: usize, S: System<N>> Probe<'_, N, S> {
    fn look(&mut self, t: f64) -> Look {
        self.system.event_values(t, &self.dense.at(t), self.values);
        Look {
            t,
            value: self.values[self.event],
        }
    }

    /// The first two neighbouring looks between which the function crosses zero.
    fn bracket(
        &mut self,
        looks: &[Look; LOOKS.len()],
        direction: Direction,
    ) -> Option<(Look, Look)> {
        for i in 0..looks.len() - 1 {
            let (from, to) = (looks[i], looks[i + 1]);
            if direction.crossed(from.value, to.value) {
                return Some((from, to));
            }
            // Zero may be crossed twice between the looks: towards it and back again.
            for middle in [i, i + 1] {
                let (Some(left), Some(right)) = (
                    middle.checked_sub(1).map(|left| looks[left]),
                    looks.get(middle + 1),
                ) else {
                    continue;
                };
                let Some(turn) = self.turn([left, looks[middle], *right]) else {
                    continue;
                };
                if !(from.t..=to.t).contains(&turn.t) {
                    continue;
                }
                if direction.crossed(from.value, turn.value) {
                    return Some((from, turn));
                }
                if direction.crossed(turn.value, to.value) {
                    return Some((turn, to));
                }
            }
        }
        None
    }

    /// A point where the function is beyond zero although it is on one side of it at three points,
    /// searched at the turning points of parabolas.
    fn turn(&mut self, mut looks: [Look; 3]) -> Option<Look> {
        let side = looks[1].value.signum();
        if looks.iter().any(|look| look.value * side <= 0.0) {
            return None;
        }
        for _ in 0..TURNS {
            let [left, middle, right] = looks;
            let (a, b) = (left.t - middle.t, right.t - middle.t);
            let (da, db) = (
                (left.value - middle.value) / a,
                (right.value - middle.value) / b,
            );
            let curvature = (db - da) / (b - a);
            let slope = da - curvature * a;
            // Only a parabola that turns towards zero, and not far above it, is worth a look.
            if curvature * side <= 0.0 {
                return None;
            }
            let offset = -0.5 * slope / curvature;
            let expected = middle.value + 0.5 * slope * offset;
            if offset <= a || offset >= b || expected * side > 0.5 * middle.value * side {
                return None;
            }
            let turn = self.look(middle.t + offset);
            if turn.value * side <= 0.0 {
                return Some(turn);
            }
            if turn.t == left.t || turn.t == middle.t || turn.t == right.t {
                return None;
            }
            looks = if offset < 0.0 {
                [left, turn, middle]
            } else {
                [middle, turn, right]
            };
        }
        None
    }

    /// The end beyond zero of the smallest interval around a crossing that the clock resolves, or
    /// `None` once it is known to come after `limit`: false position with the weight of an end
    /// that stays halved (Illinois), and bisection where three of its looks do not halve the
    /// interval.
    fn root(&mut self, mut from: Look, mut to: Look, limit: f64) -> Option<f64> {
        let resolution = 0.25 * shortest_step(from.t, self.dense.t1);
        let (mut weight_from, mut weight_to) = (from.value, to.value);
        let mut stayed = None;
        let (mut looks, mut last_width) = (0, f64::INFINITY);
        for _ in 0..ITERATIONS {
            if from.t > limit {
                return None;
            }
            let width = to.t - from.t;
            // The two floating-point numbers next to the ends, inside.
            let (least, most) = (from.t.next_up(), to.t.next_down());
            if width <= resolution || to.value == 0.0 || least > most {
                break;
            }
            looks += 1;
            let mut part = weight_from / (weight_from - weight_to);
            if looks == 3 {
                if width > 0.5 * last_width {
                    part = 0.5;
                }
                (looks, last_width) = (0, width);
            }
            if !part.is_finite() {
                part = 0.5;
            }
            // Not onto the ends: a point just beyond the root closes the interval.
            let inset = 0.5 * resolution;
            let next = (from.t + width * part).clamp(from.t + inset, to.t - inset);
            let next = self.look(next.clamp(least, most));
            // Beyond zero, or not yet?
            if (next.value < 0.0) == (from.value < 0.0) && next.value != 0.0 {
                (from, weight_from) = (next, next.value);
                if stayed == Some(IntervalEnd::To) {
                    weight_to *= 0.5;
                }
                stayed = Some(IntervalEnd::To);
            } else {
                (to, weight_to) = (next, next.value);
                if stayed == Some(IntervalEnd::From) {
                    weight_from *= 0.5;
                }
                stayed = Some(IntervalEnd::From);
            }
        }
        Some(to.t)
    }
}

/// An end of an interval.
#[derive(Clone, Copy, PartialEq)]
enum IntervalEnd {
    From,
    To,
}
