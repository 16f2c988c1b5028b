//! Moves of a run: quintics that follow its [`Spline`], as long as they can be.

use crate::course::{PathPiece, Run};
use crate::moves::{PlannedMove, Sampling};
use crate::spline::Spline;
use core::ops::Range;
use nalgebra::Vector3;
use trirrr_core::setpoint::{Ends, Quintics, Segment, Setpoint};

/// Longest move, s.
const LONGEST_S: f64 = 0.128;
/// Part of the largest acceleration by which a move may differ from the spline.
const DIFFERENCE: f64 = 0.005;
/// Factor from a move that is too long to the next one that is tried.
const SHORTER: f64 = 0.75;
/// Instants at which a move is compared.
const INSTANTS: u32 = 8;
/// Part of the largest acceleration that the rounding of poses may make.
const ROUNDING: f64 = 0.01;
/// Part of the tolerances that moves may use at the instants that are looked at.
const PART_OF_TOLERANCE: f64 = 0.97;
/// Part of the feed by which a move may be faster than the spline.
const FASTER: f64 = 1e-4;
/// Part of the feed that moves may use at the instants that are looked at.
const FEED: f64 = 0.9997;
/// Ticks of a step of the spline at least, for moves that are as long.
const SMOOTHING_TICKS: f64 = 1.0;

/// A place of a run near which moves are shorter.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fine {
    /// Distance along the run.
    distance: f64,
    /// Ticks of a move there.
    ticks: f64,
}

/// Moves of a run before they are judged.
pub(crate) struct Draft<'a> {
    spline: Spline<'a>,
    pub(crate) moves: Vec<PlannedMove>,
    /// Ticks at which the moves begin, and the last one ends.
    knots: Vec<f64>,
    /// Ticks of the shortest move.
    least: f64,
    accelerations: Accelerations,
    sampling: Sampling,
}

impl<'a> Draft<'a> {
    pub(crate) fn new(
        run: &'a Run,
        pieces: &'a [PathPiece],
        lever_m: f64,
        sampling: Sampling,
        fine: &[Fine],
    ) -> Self {
        let accelerations = Accelerations::new(run, pieces, lever_m);
        // The position at an end, which is rounded, changes the acceleration within a quintic by at most 5.8 h / T^2.
        let least_s = (5.8 * sampling.resolution_m / (ROUNDING * accelerations.largest)).sqrt();
        let least = (least_s / sampling.period_s)
            .ceil()
            .max(f64::from(sampling.ticks_min));
        let step_s = least.max(SMOOTHING_TICKS) * sampling.period_s;
        let spline = Spline::new(run, pieces, step_s, sampling.period_s);
        let mut draft = Self {
            spline,
            moves: Vec::new(),
            knots: vec![0.0],
            least,
            accelerations,
            sampling,
        };
        let fine: Vec<(f64, f64)> = fine
            .iter()
            .map(|each| (draft.spline.tick_at(each.distance), each.ticks))
            .collect();
        let end = f64::from(draft.spline.ticks);
        let mut at = 0.0;
        let mut state = draft.rest(draft.spline.at(0.0));
        while at < end {
            let (to, state_there) = draft.longest(at, state, end, &fine);
            draft.push([at, to], [state, state_there]);
            (at, state) = (to, state_there);
        }
        draft
    }

    /// The setpoint without a motion: what is computed at an end of the spline is rounded.
    fn rest(&self, at: Setpoint<f64>) -> Setpoint<f64> {
        Setpoint {
            pose: at.pose,
            velocity: Vector3::zeros(),
            acceleration: Vector3::zeros(),
        }
    }

    /// The end of the longest move from `from` that follows the spline.
    fn longest(
        &self,
        from: f64,
        state: Setpoint<f64>,
        end: f64,
        fine: &[(f64, f64)],
    ) -> (f64, Setpoint<f64>) {
        let left = end - from;
        let mut ticks = (LONGEST_S / self.sampling.period_s).floor().min(left);
        loop {
            // What is left behind it is a move, too.
            if left - ticks < self.least && left > ticks {
                ticks = match left >= 2.0 * self.least {
                    true => (left - self.least).min(ticks),
                    false => left,
                };
            }
            let to = from + ticks;
            let there = match to >= end {
                true => self.rest(self.spline.at(to)),
                false => self.spline.at(to),
            };
            let shorter = (SHORTER * ticks).floor().max(self.least);
            let is_fine = |&(place, most): &(f64, f64)| ticks <= most || place < from || place > to;
            let follows =
                fine.iter().all(is_fine) && self.difference([from, to], [state, there]) <= 1.0;
            if follows || shorter >= ticks || left <= 2.0 * self.least {
                return (to, there);
            }
            ticks = shorter;
        }
    }

    /// Largest difference of a move from the spline, in parts of what is allowed.
    fn difference(&self, [from, to]: [f64; 2], states: [Setpoint<f64>; 2]) -> f64 {
        let segment = Segment::new(&ends(&states), (to - from) as u32, self.sampling.period_s);
        let differences = (1..INSTANTS).map(|instant| {
            let part = f64::from(instant) / f64::from(INSTANTS);
            let played = segment.at_fraction(part);
            let spline = self.spline.at(from + part * (to - from));
            let off = played.pose.displacement(&spline.pose);
            let bent = played.acceleration - spline.acceleration;
            let faster = played.velocity.x.hypot(played.velocity.y)
                - spline.velocity.x.hypot(spline.velocity.y);
            let feed = self.spline.feed(from + part * (to - from));
            // Half of the tolerance is left to the spline itself.
            (2.0 * off.x.hypot(off.y) / self.sampling.tolerance_m)
                .max(2.0 * off.z.abs() / self.sampling.tolerance_rad)
                .max(faster / (FASTER * feed))
                .max(self.accelerations.size(bent) / (DIFFERENCE * self.accelerations.largest))
        });
        differences.fold(0.0, f64::max)
    }

    fn push(&mut self, [from, to]: [f64; 2], states: [Setpoint<f64>; 2]) {
        self.knots.push(to);
        self.moves.push(PlannedMove {
            ends: ends(&states),
            ticks: (to - from) as u32,
            place: self.spline.place(from),
            piece: self.spline.place(0.5 * (from + to)).piece,
        });
    }

    /// Returns true if move `index` can be cut.
    pub(crate) fn splits(&self, index: usize) -> bool {
        f64::from(self.moves[index].ticks) >= 2.0 * self.least
    }

    /// Returns the largest deviation of move `index` from the path, in parts of the tolerances, at a few instants; or
    /// its speed in parts of the feed, if that is more.
    pub(crate) fn deviation(&self, index: usize) -> f64 {
        let sampling = &self.sampling;
        let metres = PART_OF_TOLERANCE * sampling.tolerance_m;
        let tolerances = Vector3::new(metres, metres, PART_OF_TOLERANCE * sampling.tolerance_rad);
        let each = &self.moves[index];
        let segment = each.segment(sampling.period_s);
        let ticks = f64::from(each.ticks);
        // Speed that the rounding of both ends adds at most.
        let rounded = 3.0 * sampling.resolution_m / (ticks * sampling.period_s);
        let instants = 2 * INSTANTS;
        let deviations = (0..=instants).map(|instant| {
            let part = f64::from(instant) / f64::from(instants);
            let tick = self.knots[index] + part * ticks;
            let place = self.spline.place(tick);
            let point = self.spline.pieces()[place.piece].piece.at(place.p);
            let played = segment.at_fraction(part);
            let off = point.pose.displacement(&played.pose);
            let off = off.component_div(&tolerances);
            let along = point.first.component_div(&tolerances);
            // A difference along the path is one in time.
            let off = off - along * (off.dot(&along) / along.dot(&along));
            let speed = played.velocity.x.hypot(played.velocity.y) + rounded;
            let feed = FEED * self.spline.feed(tick);
            off.x.hypot(off.y).max(off.z.abs()).max(speed / feed)
        });
        deviations.fold(0.0, f64::max)
    }

    /// Moves half as long at move `index`.
    pub(crate) fn closer(&self, index: usize) -> Fine {
        Fine {
            distance: self
                .spline
                .distance(0.5 * (self.knots[index] + self.knots[index + 1])),
            ticks: (0.5 * f64::from(self.moves[index].ticks))
                .floor()
                .max(self.least),
        }
    }

    /// Cells of the plan that move `index` is made of.
    pub(crate) fn cells(&self, index: usize) -> Range<usize> {
        self.spline
            .cells([self.knots[index], self.knots[index + 1]])
    }
}

fn ends(states: &[Setpoint<f64>; 2]) -> Ends<f64, Quintics> {
    let [start, end] = states;
    Ends {
        from: start.pose,
        to: end.pose,
        velocities: [start.velocity, end.velocity],
        accelerations: Some([start.acceleration.into(), end.acceleration.into()]),
    }
}

/// Sizes of accelerations: that of D, m/s^2, and that of a point of the platform about D.
struct Accelerations {
    /// From D to the point.
    lever_m: f64,
    /// Of the plan.
    largest: f64,
}

impl Accelerations {
    fn new(run: &Run, pieces: &[PathPiece], lever_m: f64) -> Self {
        let mut accelerations = Self {
            lever_m,
            largest: 0.0,
        };
        for (index, (place, x)) in run.places.iter().zip(&run.squares).enumerate() {
            if index < run.cells.len() {
                let point = pieces[place.piece].piece.at(place.p);
                let acceleration = point.first * run.acceleration(index) + point.second * *x;
                let size = accelerations.size(acceleration);
                accelerations.largest = accelerations.largest.max(size);
            }
        }
        accelerations
    }

    fn size(&self, acceleration: Vector3<f64>) -> f64 {
        acceleration.x.hypot(acceleration.y) + self.lever_m * acceleration.z.abs()
    }
}
