//! Swings of rockers and strokes of sliders, their turning points, and the ratio of times forth and back.

use super::super::description::{FRAME, JointKind, Linkage};
use super::super::solve::Position;
use super::super::track::Track;
use super::sweep::Sweep;
use std::f64::consts::TAU;

/// Something that swings or slides.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Traveller {
    /// Links that turn alike: a slider turns with its guide.
    Links(Vec<usize>),
    /// Prismatic joint, or pin in a slot: the way along the guide.
    Slide(usize),
}

/// Range of an angle, rad, or of a way along a guide, m, over the motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Travel {
    /// That which moves.
    pub of: Traveller,
    /// Whole turns of a link over a motion of whole turns of its drive, with sign; 0 for what comes back as it went.
    pub turns: i32,
    /// Least and greatest value, each with its time, s.
    pub ends: [(f64, f64); 2],
    /// Times at which the motion turns back, s.
    pub turning_s: Vec<f64>,
    /// Longer time from end to end over the shorter one. Only where the drive makes whole turns at constant rate and the motion turns back
    /// twice in each.
    pub time_ratio: Option<f64>,
}

impl Travel {
    /// Greatest value less least one, rad or m.
    pub fn range(&self) -> f64 {
        self.ends[1].0 - self.ends[0].0
    }
}

/// The links that turn, those together that turn alike: sliders with their guides.
pub(in super::super) fn turning(linkage: &Linkage, track: &Track) -> Vec<Vec<usize>> {
    let motion = |position: &Position, link: usize| {
        let motion = &position.states[link].motion;
        [motion.rate, motion.acceleration]
    };
    let largest = |index: usize| {
        let all = track.positions.iter().flat_map(|position| {
            linkage
                .moving_links()
                .map(move |link| motion(position, link)[index].abs())
        });
        all.fold(0.0, f64::max)
    };
    let rounding = [1e-9 * largest(0), 1e-9 * largest(1)];
    let alike = |a: usize, b: usize| {
        track.positions.iter().all(|position| {
            let (a, b) = (motion(position, a), motion(position, b));
            (0..2).all(|i| (a[i] - b[i]).abs() <= rounding[i])
        })
    };
    let mut families: Vec<Vec<usize>> = Vec::new();
    for link in linkage.moving_links() {
        if alike(link, FRAME) {
            continue;
        }
        match families.iter_mut().find(|family| alike(link, family[0])) {
            Some(family) => family.push(link),
            None => families.push(vec![link]),
        }
    }
    families
}

/// Travels of all links that turn, then of all slides.
pub(super) fn travels(linkage: &Linkage, sweep: &Sweep<'_>) -> Vec<Travel> {
    let links = turning(linkage, sweep.track).into_iter().map(|links| {
        let link = links[0];
        let angle = move |position: &Position| position.states[link].angle;
        let rate = move |position: &Position| position.states[link].motion.rate;
        travel(sweep, Traveller::Links(links), angle, rate)
    });
    let is_slide = |joint: &usize| matches!(linkage.joints[*joint].kind, JointKind::Prismatic(_));
    let slides = (0..linkage.joints.len()).filter(is_slide).map(|joint| {
        let of = move |index: usize| {
            move |position: &Position| {
                position
                    .slide(linkage, joint)
                    .map_or(0.0, |slide| slide[index])
            }
        };
        travel(sweep, Traveller::Slide(joint), of(0), of(1))
    });
    links.chain(slides).collect()
}

fn travel(
    sweep: &Sweep<'_>,
    of: Traveller,
    value: impl Fn(&Position) -> f64,
    rate: impl Fn(&Position) -> f64,
) -> Travel {
    let positions = &sweep.track.positions;
    let (first, last) = (&positions[0], &positions[positions.len() - 1]);
    let net = value(last) - value(first);
    let turns = match (&of, sweep.turns) {
        (Traveller::Links(_), Some(_)) => (net / TAU).round() as i32,
        _ => 0,
    };
    let turning_s = sweep.zeros(&rate);
    let turned = turning_s.iter().filter_map(|t| sweep.at(*t));
    let mut ends = [(f64::INFINITY, 0.0), (f64::NEG_INFINITY, 0.0)];
    let mut extend = |position: &Position| {
        let value = value(position);
        if value < ends[0].0 {
            ends[0] = (value, position.t);
        }
        if value > ends[1].0 {
            ends[1] = (value, position.t);
        }
    };
    turned.for_each(|position| extend(&position));
    // The ends of a motion of whole turns are places like others.
    if sweep.turns.is_none() || turning_s.is_empty() {
        extend(first);
        extend(last);
    }
    let time_ratio = sweep.turns.and_then(|drive_turns| {
        (turns == 0 && turning_s.len() == 2 * drive_turns as usize)
            .then(|| ratio_of_times(&turning_s, sweep.duration()))
    });
    Travel {
        of,
        turns,
        ends,
        turning_s,
        time_ratio,
    }
}

/// Times between turning points, every other one together, the greater sum over the less.
fn ratio_of_times(turning_s: &[f64], duration: f64) -> f64 {
    let first = turning_s.first().map(|t| t + duration);
    let next = turning_s.iter().skip(1).copied().chain(first);
    let mut sums = [0.0; 2];
    for (index, (t, next)) in turning_s.iter().zip(next).enumerate() {
        sums[index % 2] += next - t;
    }
    f64::max(sums[0], sums[1]) / f64::min(sums[0], sums[1])
}
