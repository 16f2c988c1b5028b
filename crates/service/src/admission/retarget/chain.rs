//! A candidate: a chain of quintics from the start to the target.

use super::super::taylor::Float;
use super::profile::{Brake, Rest, Transfer};
use crate::admission::Enclose;
use heapless::Vec;
use nalgebra::Vector3;
use trirrr_core::number::Arithmetic;
use trirrr_core::setpoint::{Ends, Pose, Quintics, Setpoint};

/// Most joints of a chain, its ends included.
pub(super) const JOINTS: usize = 16;

/// Composition of a motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Shape {
    /// One quintic.
    Direct,
    /// To rest from an end: the start, 0, or with time reversed the target, 1. Then the parts of
    /// [`Rest`](super::profile::Rest).
    Brake(usize, u32),
    /// The way from rest to rest, and on top of it what the ends have of velocity and acceleration, brought to rest in
    /// twice the least time. The number: 32nds of the time in which it speeds up.
    Joined(u32),
    /// To rest, from rest to rest, and from rest to the target, one after the other. The number likewise; 0 for a way that
    /// is one quintic.
    Apart(u32),
}

/// A motion to be tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Candidate {
    pub(super) shape: Shape,
    /// Duration; of [`Shape::Apart`], that of the way from rest to rest.
    pub(super) ticks: u32,
    /// 32nds by which the ends take longer to rest than the least.
    pub(super) slack: u32,
}

/// Start, target, and how fast their motion comes to rest.
#[derive(Clone, Copy, Debug)]
pub(super) struct Problem<N: Enclose> {
    pub(super) ends: [Setpoint<N>; 2],
    pub(super) period: Float<N>,
    /// Way to rest of either end. None where it has none.
    pub(super) stops: [Option<Rest>; 2],
    /// Most moves of a motion.
    pub(super) most: usize,
    /// Fewest ticks of a motion.
    pub(super) least: u32,
}

/// The candidate, ready to be evaluated at its joints.
#[derive(Clone, Debug)]
pub(super) struct Chain<N: Enclose> {
    origin: Setpoint<N>,
    /// None where it is what comes out.
    last: Option<Setpoint<N>>,
    period: Float<N>,
    joints: Vec<u32, JOINTS>,
    brakes: [Brake<Float<N>>; 2],
    /// Part that the second brake leaves out at the start.
    back: Vector3<Float<N>>,
    way: Vector3<Float<N>>,
    transfer: Option<(u32, Transfer)>,
}

type Vector<N> = Vector3<Float<N>>;

fn bounds<N: Enclose>(v: &Vector3<N>) -> Vector<N> {
    v.map(N::bound)
}

impl<N: Enclose> Problem<N> {
    /// The state at one end; that of the target as it is with time reversed.
    pub(super) fn end(&self, index: usize) -> Setpoint<N> {
        let end = self.ends[index];
        match index {
            0 => end,
            _ => Setpoint {
                velocity: -end.velocity,
                ..end
            },
        }
    }

    fn brake(&self, index: usize, rest: Rest) -> Brake<Float<N>> {
        let Setpoint {
            velocity,
            acceleration,
            ..
        } = self.end(index);
        Brake {
            velocity: bounds(&velocity) * self.period,
            acceleration: bounds(&acceleration) * (self.period * self.period),
            rest,
        }
    }

    /// Ticks of the whole motion; none where its ends do not come to rest, or it is too long.
    pub(super) fn duration(&self, candidate: Candidate) -> Option<u32> {
        match candidate.shape {
            Shape::Direct | Shape::Brake(..) | Shape::Joined(_) => Some(candidate.ticks),
            Shape::Apart(_) => {
                let [first, last] = self.rests(candidate)?;
                first
                    .ticks
                    .checked_add(candidate.ticks)?
                    .checked_add(last.ticks)
            }
        }
    }

    /// Way to rest of either end in the candidate.
    fn rests(&self, candidate: Candidate) -> Option<[Rest; 2]> {
        let rest = |least: Rest| {
            let ticks = match candidate.shape {
                Shape::Joined(_) => 2 * least.ticks,
                _ => least.ticks,
            };
            let slack = u64::from(ticks) * u64::from(candidate.slack);
            Rest {
                ticks: ticks + slack.div_ceil(32) as u32,
                ..least
            }
        };
        let [first, last] = self.stops;
        Some([rest(first?), rest(last?)])
    }

    /// The end whose motion comes to rest in a move of a chain, if it does not before or behind.
    pub(super) fn resting(
        &self,
        candidate: Candidate,
        chain: &Chain<N>,
        piece: usize,
    ) -> Option<usize> {
        let [first, last] = self.rests(candidate)?;
        let [start, end] = [chain.joints[piece], chain.joints[piece + 1]];
        let duration = chain.joints[chain.len()];
        match start < first.ticks {
            true => Some(0),
            false => (end + last.ticks > duration).then_some(1),
        }
    }

    /// The chain; none where there is none of this shape and duration.
    pub(super) fn chain(&self, candidate: Candidate) -> Option<Chain<N>> {
        let zero = Vector3::from([<Float<N>>::ZERO; 3]);
        let at_rest = Brake {
            velocity: zero,
            acceleration: zero,
            rest: Rest::NONE,
        };
        let mut chain = Chain {
            origin: self.ends[0],
            last: Some(self.ends[1]),
            period: self.period,
            joints: Vec::new(),
            brakes: [at_rest; 2],
            back: zero,
            way: zero,
            transfer: None,
        };
        let duration = self.duration(candidate)?;
        chain.join(0);
        chain.join(duration);
        let (part, apart) = match candidate.shape {
            Shape::Direct => return Some(chain),
            Shape::Brake(index, parts) => {
                let ticks = candidate.ticks;
                chain.brakes[0] = self.brake(index, Rest { ticks, parts });
                chain.origin = self.end(index);
                chain.last = None;
                for knot in chain.brakes[0].knots() {
                    chain.join(knot);
                }
                return Some(chain);
            }
            Shape::Joined(part) => (part, false),
            Shape::Apart(part) => (part, true),
        };
        let rests = self.rests(candidate)?;
        if rests.iter().any(|rest| rest.ticks > duration) || candidate.ticks < Transfer::SHORTEST {
            return None;
        }
        let mut from_to = [zero; 2];
        for (index, rest) in rests.into_iter().enumerate() {
            if rest == Rest::NONE {
                continue;
            }
            let brake = self.brake(index, rest);
            from_to[index] = brake.at(rest.ticks)[0];
            for knot in brake.knots() {
                chain.join(if index == 0 { knot } else { duration - knot });
            }
            chain.brakes[index] = brake;
        }
        chain.back = from_to[1];
        let [from, to] = self.ends;
        chain.way = bounds(&from.pose.displacement(&to.pose)) + from_to[1] - from_to[0];
        let begin = if apart { rests[0].ticks } else { 0 };
        let transfer = Transfer::new(candidate.ticks, part);
        for knot in [0, transfer.ticks].into_iter().chain(transfer.knots()) {
            chain.join(begin + knot);
        }
        chain.transfer = Some((begin, transfer));
        Some(chain)
    }
}

impl<N: Enclose> Chain<N> {
    /// Poses between which the way from rest to rest is straight.
    pub(super) fn way(&self) -> [Pose<N>; 2] {
        let from = self.brakes[0].at(self.brakes[0].rest.ticks)[0];
        [from, from + self.way].map(|way| self.origin.pose.displaced(way.map(N::from_bound)))
    }

    fn join(&mut self, tick: u32) {
        let place = self.joints.iter().position(|&joint| joint >= tick);
        let place = place.unwrap_or(self.joints.len());
        if self.joints.get(place) != Some(&tick) {
            // Room for every shape.
            let _ = self.joints.insert(place, tick);
        }
    }

    /// Number of moves.
    pub(super) fn len(&self) -> usize {
        self.joints.len().saturating_sub(1)
    }

    /// The state at joint `index`, in the numbers of the machine.
    fn state(&self, index: usize) -> Setpoint<N> {
        let tick = self.joints[index];
        let ticks = self.joints[self.len()];
        match self.last {
            _ if index == 0 => return self.origin,
            Some(last) if index == self.len() => return last,
            _ => {}
        }
        let [mut way, mut velocity, mut acceleration] = self.brakes[0].at(tick);
        // Backwards in time a velocity changes its sign.
        let [back, against, added] = self.brakes[1].at(ticks - tick);
        way += back - self.back;
        velocity -= against;
        acceleration += added;
        if let Some((begin, transfer)) = &self.transfer {
            let [part, rate, gain] = transfer.at(tick.saturating_sub(*begin));
            way += self.way * part;
            velocity += self.way * rate;
            acceleration += self.way * gain;
        }
        let per_tick = <Float<N>>::ONE.div(self.period);
        let number = |v: Vector<N>| v.map(N::from_bound);
        Setpoint {
            pose: self.origin.pose.displaced(number(way)),
            velocity: number(velocity * per_tick),
            acceleration: number(acceleration * (per_tick * per_tick)),
        }
    }

    /// Move `index` and its ticks.
    pub(super) fn piece<const JERK: bool>(&self, index: usize) -> (Ends<N, Quintics<JERK>>, u32) {
        let [from, to] = [self.state(index), self.state(index + 1)];
        let ends = Ends {
            from: from.pose,
            to: to.pose,
            velocities: [from.velocity, to.velocity],
            accelerations: Some([from.acceleration.into(), to.acceleration.into()]),
        };
        (ends, self.joints[index + 1] - self.joints[index])
    }
}
