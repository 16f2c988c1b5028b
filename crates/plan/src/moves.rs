//! A plan as moves: cubics in time, a whole number of ticks long each, that a service admits.
//!
//! What is played is the plan smoothed over a few steps of time: the cubic spline with a knot at each step whose
//! coefficients are the plan's poses there. Its acceleration is linear within a step; at a knot it is the plan's, averaged
//! with the weights of a hat from the knot before to the knot after. So it is continuous, where the plan's jumps, and
//! takes no value that the plan does not take nearby. Longer moves take pose and velocity at their ends from the spline.
//! A step is a tick, or as many as the number type needs: in binary32 the ends of a move of one tick are rounded by so
//! much that its acceleration means little.

use crate::cell::{Obstacle, Planner};
use crate::course::{Effort, PathPiece, PathPlace, PathRefusal, Plan, Run, plan};
use crate::timeline::Timeline;
use core::ops::Range;
use nalgebra::Vector3;
use trirrr_core::model::Model;
use trirrr_core::setpoint::{Hermite, Pose};

/// Tick and tolerances of the moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampling {
    /// Seconds per tick.
    pub period_s: f64,
    /// Largest distance of D from the path, m.
    pub tolerance_m: f64,
    /// Largest deviation of alpha from that on the path, rad.
    pub tolerance_rad: f64,
    /// Distance between neighbouring positions in the number type that the moves are played in, m.
    pub resolution_m: f64,
    /// Ticks that every move takes at least, 1 or more: a queue of so many moves has to last for a hold.
    pub ticks_min: u32,
}

impl Sampling {
    /// Ticks that every move of a motion with accelerations up to `acceleration` takes at least: so many that the
    /// rounding of its ends changes its acceleration by a small part only.
    fn least_ticks(&self, acceleration: f64) -> f64 {
        // A cubic's acceleration at an end is 6 h / T^2 and terms of the velocities.
        let least_s = (6.0 * self.resolution_m / (ROUNDING * acceleration)).sqrt();
        (least_s / self.period_s)
            .ceil()
            .max(f64::from(self.ticks_min))
    }
}

/// One move of a plan: a cubic in time in each coordinate, with pose and velocity given at both ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlannedMove {
    /// Pose at its start.
    pub from: Pose<f64>,
    /// Pose at its end.
    pub to: Pose<f64>,
    /// (vx, vy, alphadot) at its start, m/s and rad/s.
    pub start_velocity: Vector3<f64>,
    /// (vx, vy, alphadot) at its end.
    pub end_velocity: Vector3<f64>,
    /// Duration in ticks, positive.
    pub ticks: u32,
    /// Place on the path at its start.
    pub place: PathPlace,
    /// Index of the piece that holds its middle.
    pub piece: usize,
}

/// Judgement of a planned move by whoever plays it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Judged {
    /// It can be played.
    Kept,
    /// A limit of a motor is exceeded by this part, or not proven to be kept; slower would be better.
    Exceeded(f64),
    /// It cannot be played at any pace.
    Refused,
}

/// A plan with its moves.
#[derive(Clone, Debug)]
pub struct PlannedMoves {
    /// The plan.
    pub plan: Plan,
    /// The moves of all runs.
    pub moves: Vec<PlannedMove>,
}

impl PlannedMoves {
    /// Duration of the moves in ticks.
    pub fn ticks(&self) -> u64 {
        self.moves.iter().map(|each| u64::from(each.ticks)).sum()
    }
}

/// Part of the largest acceleration at whose jumps the knots of the spline are a tick apart.
const JUMP: f64 = 0.05;
/// Growth of the distance between knots with the distance from a jump.
const GROWTH: f64 = 0.25;
/// Greatest distance between knots, s.
const KNOT_DISTANCE_MAX_S: f64 = 0.032;
/// Excess of a limit above which knots are set closer before the pace is lowered.
const EXCESS_OF_FIT: f64 = 0.003;
/// Margin beyond an excess.
const MARGIN: f64 = 1e-3;
/// Part of the largest acceleration that the rounding of poses may make.
const ROUNDING: f64 = 0.01;
/// Part of the limits that a plan for moves uses; the rest is for what moves differ from it.
const SHARE: f64 = 0.999;
/// Part of the tolerances that moves may use at the instants that are looked at.
const PART_OF_TOLERANCE: f64 = 0.97;
/// Part of the feed that moves may use at the instants that are looked at.
const FEED: f64 = 0.9997;
/// Rounds of planning, judging and mending.
const ROUNDS: u32 = 60;

/// A place of a run near which the knots are closer together.
#[derive(Clone, Copy, Debug)]
struct Fine {
    /// Distance along the run.
    distance: f64,
    /// Ticks between knots there.
    ticks: f64,
}

/// Plans `pieces` and turns the plan into moves that `judge` keeps, which gets the moves of one run in order.
///
/// # Errors
/// The first obstacle on the path.
pub fn plan_moves<M: Model<N = f64>>(
    planner: &Planner<M>,
    pieces: &[PathPiece],
    effort: Effort,
    sampling: Sampling,
    mut judge: impl FnMut(&[PlannedMove]) -> Vec<Judged>,
) -> Result<PlannedMoves, PathRefusal> {
    let mut plan = plan(planner, pieces, effort)?;
    let mut moves: Vec<PlannedMove> = Vec::new();
    for run in &mut plan.runs {
        let start = moves.len();
        moves.extend(moves_of(planner, run, pieces, sampling, &mut judge)?);
        // Pieces meet but for rounding; moves do exactly.
        if start > 0 {
            moves[start].from = moves[start - 1].to;
        }
    }
    Ok(PlannedMoves { plan, moves })
}

fn moves_of<M: Model<N = f64>>(
    planner: &Planner<M>,
    run: &mut Run,
    pieces: &[PathPiece],
    sampling: Sampling,
    judge: &mut impl FnMut(&[PlannedMove]) -> Vec<Judged>,
) -> Result<Vec<PlannedMove>, PathRefusal> {
    let mut fine: Vec<Fine> = Vec::new();
    // The excess of the first instant that is not proven may be less than the largest one: what is refused again is
    // lowered by twice as much.
    let mut strikes = vec![MARGIN; run.cells.len()];
    let refusal = |place| PathRefusal::at(place, pieces, Obstacle::Refused);
    run.tighten(0..run.cells.len(), SHARE);
    run.replan();
    for _ in 0..ROUNDS {
        let timeline = Timeline::of(run);
        let step = sampling.least_ticks(path_acceleration(run, pieces, planner.lever_m()));
        let draft = Draft::new(run, &timeline, pieces, sampling, step, &fine);
        let splits = |each: &PlannedMove| f64::from(each.ticks) > step;
        let mut mended = false;
        let mut slower = Vec::new();
        for (index, each) in draft.moves.iter().enumerate() {
            let deviation = draft.deviation(index, pieces, sampling);
            if !(deviation > 1.0) {
                continue;
            }
            // Where moves cannot be shorter, the smoothing itself leaves the path, by the square of the pace.
            match splits(each) {
                true => fine.push(draft.closer(index)),
                false => slower.push((draft.cells(index), deviation - 1.0)),
            }
            mended = true;
        }
        let verdicts = match mended {
            true => Vec::new(),
            false => judge(&draft.moves),
        };
        for (index, judged) in verdicts.into_iter().enumerate() {
            let each = &draft.moves[index];
            match judged {
                Judged::Kept => {}
                Judged::Refused => return Err(refusal(each.place)),
                Judged::Exceeded(by) if by > EXCESS_OF_FIT && splits(each) => {
                    fine.push(draft.closer(index));
                    mended = true;
                }
                Judged::Exceeded(by) => {
                    slower.push((draft.cells(index), by.max(0.0)));
                    mended = true;
                }
            }
        }
        if !mended {
            return Ok(draft.moves);
        }
        // Moves overlap in their cells: each cell takes one step a round.
        let before = strikes.clone();
        for (cells, by) in slower {
            let margins = before[cells.clone()].iter().copied();
            let margin = margins.fold(MARGIN, f64::max);
            strikes[cells.clone()].fill(2.0 * margin);
            run.tighten(cells, 1.0 / (1.0 + by + margin));
        }
        run.replan();
    }
    Err(refusal(run.places[0]))
}

/// Moves of a run before they are judged.
struct Draft<'a> {
    run: &'a Run,
    timeline: &'a Timeline,
    moves: Vec<PlannedMove>,
    /// Ticks at which the moves begin, and the last one ends.
    knots: Vec<f64>,
    period_s: f64,
    /// Ticks of a step: the smoothed plan moves so long before the plan begins and after it ends.
    step: f64,
}

impl<'a> Draft<'a> {
    fn new(
        run: &'a Run,
        timeline: &'a Timeline,
        pieces: &[PathPiece],
        sampling: Sampling,
        step: f64,
        fine: &[Fine],
    ) -> Self {
        let period_s = sampling.period_s;
        let knots = knots(timeline, sampling, step, fine);
        let end = knots.len() - 1;
        let distance = |tick: f64| timeline.distance_at((tick - step) * period_s);
        let pose = |tick: f64| {
            let place = timeline.place_at(distance(tick), &run.places);
            pieces[place.piece].piece.at(place.p).pose
        };
        let state = |(index, &tick): (usize, &f64)| {
            let poses = [tick - step, tick, tick + step].map(pose);
            let [back, ahead] = [0, 2].map(|other: usize| poses[1].displacement(&poses[other]));
            let velocity = (ahead - back) * (0.5 / (step * period_s));
            // The spline rests at both ends; what is computed there is rounded.
            match index == 0 || index == end {
                true => (distance(tick), poses[1], Vector3::zeros()),
                false => (
                    distance(tick),
                    poses[1].displaced((ahead + back) / 6.0),
                    velocity,
                ),
            }
        };
        let states: Vec<_> = knots.iter().enumerate().map(state).collect();
        let spans = states.windows(2).zip(knots.windows(2));
        let moves = spans.map(|(states, knots)| {
            let [(before, from, start_velocity), (after, to, end_velocity)] =
                [states[0], states[1]];
            let place = |distance| timeline.place_at(distance, &run.places);
            PlannedMove {
                from,
                to,
                start_velocity,
                end_velocity,
                ticks: (knots[1] - knots[0]) as u32,
                place: place(before),
                piece: place(0.5 * (before + after)).piece,
            }
        });
        Self {
            run,
            timeline,
            moves: moves.collect(),
            knots,
            period_s,
            step,
        }
    }

    /// Returns the largest deviation of move `index` from the path, in parts of the tolerances, at a few instants; or
    /// its speed in parts of the feed, if that is more.
    fn deviation(&self, index: usize, pieces: &[PathPiece], sampling: Sampling) -> f64 {
        const INSTANTS: u32 = 16;
        let metres = PART_OF_TOLERANCE * sampling.tolerance_m;
        let tolerances = Vector3::new(metres, metres, PART_OF_TOLERANCE * sampling.tolerance_rad);
        let each = &self.moves[index];
        let hermite = Hermite::<f64>::new(
            each.from,
            each.start_velocity,
            each.to,
            each.end_velocity,
            each.ticks,
            self.period_s,
        );
        let ticks = f64::from(each.ticks);
        // Speed that the rounding of both ends adds at most.
        let rounded = 3.0 * sampling.resolution_m / (ticks * self.period_s);
        let deviations = (0..=INSTANTS).map(|instant| {
            let part = f64::from(instant) / f64::from(INSTANTS);
            let distance = self.distance(self.knots[index] + part * ticks);
            let place = self.timeline.place_at(distance, &self.run.places);
            let point = pieces[place.piece].piece.at(place.p);
            let played = hermite.at_fraction(part);
            let off = point
                .pose
                .displacement(&played.pose)
                .component_div(&tolerances);
            let along = point.first.component_div(&tolerances);
            // A difference along the path is one in time.
            let off = off - along * (off.dot(&along) / along.dot(&along));
            let speed = played.velocity.x.hypot(played.velocity.y) + rounded;
            let feed = pieces[place.piece]
                .feed_m_s
                .map_or(f64::INFINITY, |feed| FEED * feed);
            off.x.hypot(off.y).max(off.z.abs()).max(speed / feed)
        });
        deviations.fold(0.0, f64::max)
    }

    /// Knots half as far apart at move `index`.
    fn closer(&self, index: usize) -> Fine {
        Fine {
            distance: self.distance(0.5 * (self.knots[index] + self.knots[index + 1])),
            ticks: (0.5 * f64::from(self.moves[index].ticks))
                .floor()
                .max(self.step),
        }
    }

    /// Distance of the plan at a tick.
    fn distance(&self, tick: f64) -> f64 {
        self.timeline
            .distance_at((tick - self.step) * self.period_s)
    }

    /// Cells of the plan that move `index` is made of.
    fn cells(&self, index: usize) -> Range<usize> {
        let cell = |tick| self.timeline.cell_at(self.distance(tick));
        cell(self.knots[index] - 2.0 * self.step)..cell(self.knots[index + 1] + 2.0 * self.step) + 1
    }
}

/// Ticks at which the moves begin, and the last one ends: multiples of `step`.
fn knots(timeline: &Timeline, sampling: Sampling, step: f64, fine: &[Fine]) -> Vec<f64> {
    let per_step = 1.0 / (step * sampling.period_s);
    let end = (1.0 + timeline.duration() * per_step).ceil() + 1.0;
    let greatest = (KNOT_DISTANCE_MAX_S * per_step).floor().max(1.0);
    let jumps = timeline.jumps(JUMP).into_iter();
    let mut near: Vec<(f64, f64)> = jumps.map(|time| (1.0 + time * per_step, 1.0)).collect();
    near.extend([(0.0, 1.0), (end, 1.0)]);
    near.extend(fine.iter().map(|each| {
        let time = timeline.time_at(each.distance);
        (1.0 + time * per_step, each.ticks / step)
    }));
    let mut knots = vec![0.0];
    let mut at = 0.0;
    while at < end {
        let allowed =
            |(place, steps): &(f64, f64)| steps + GROWTH * ((at - place).abs() - 2.0).max(0.0);
        let distance = near.iter().map(allowed).fold(greatest, f64::min);
        at = (at + distance.floor().max(1.0)).min(end);
        knots.push(at * step);
    }
    knots
}

/// Largest acceleration in the plan of `run`, m/s^2: that of D, and that of a point of the platform `lever_m` from it
/// about D.
fn path_acceleration(run: &Run, pieces: &[PathPiece], lever_m: f64) -> f64 {
    let of_cell = |index: usize| {
        let (place, x) = (run.places[index], run.squares[index]);
        let point = pieces[place.piece].piece.at(place.p);
        let acceleration = point.first * run.acceleration(index) + point.second * x;
        acceleration.x.hypot(acceleration.y) + lever_m * acceleration.z.abs()
    };
    (0..run.cells.len()).map(of_cell).fold(0.0, f64::max)
}
