//! A plan as moves: quintics in time, a whole number of ticks long each, that a service admits.
//!
//! The distance along the path is a smooth function of time, the law. Each move has pose, velocity and acceleration of the path under
//! the law at its ends, so the chain has no jump in the acceleration, and is as long as it stays near that motion. Where a move is
//! beyond a limit, or is refused, cells are cut and their limits lowered.

pub use crate::planned::{PlannedMove, Sampling};

use crate::cell::{Limited, Obstacle, Planner};
use crate::course::{self, Effort, Plan};
use crate::draft::{Draft, Fine, leave_room, shortest_s, spare_at_start};
use crate::even;
use crate::grid::{Easing, Grid, easings};
use crate::jerk::JerkLimits;
use crate::path::{PathPiece, PathPlace, PathRefusal};
use crate::run::Run;
use trirrr_core::model::Model;

/// Judgement of a planned move by whoever plays it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Judged {
    /// It can be played.
    Kept,
    /// A limit of a motor is exceeded by this part, or not proven to be kept: then the [number type](Limited::Number) is what limits it.
    /// Slower would be better.
    Exceeded(f64, Limited),
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
        ticks_of(&self.moves)
    }
}

fn ticks_of(moves: &[PlannedMove]) -> u64 {
    moves.iter().map(|each| u64::from(each.ticks)).sum()
}

/// Duration of a cell that is not cut any more, s.
const SHORT_S: f64 = 0.002;
/// Margin beyond an excess, at first.
const LEAST: f64 = 1e-4;
/// Rounds without a lower pace of the whole run, and the part by which each further one lowers its limits.
const PATIENCE: u32 = 8;
const IMPATIENCE: f64 = 5e-4;
/// Rounds of planning, judging and mending.
const ROUNDS: u32 = 60;

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
    let paced = planner.paced();
    let mut plan = course::plan(planner, pieces, effort)?;
    let other = match plan.runs.iter().any(is_limited_by_power) {
        true => course::plan(&paced, pieces, effort).ok(),
        false => None,
    };
    let mut moves: Vec<PlannedMove> = Vec::new();
    let mut spare = spare_at_start(&sampling);
    let runs = std::mem::take(&mut plan.runs);
    for (index, run) in runs.into_iter().enumerate() {
        let start = moves.len();
        let duration_s = run.duration_s;
        let mut of_run = RunMoves::of(planner, run, pieces, sampling, spare, &mut judge);
        // Neither is the faster one everywhere: where the power at rest acts, what is mended may be slow.
        if let Some(other) = other.as_ref().and_then(|plan| plan.runs.get(index))
            && other.duration_s < FASTER * duration_s
        {
            let paced = RunMoves::of(&paced, other.clone(), pieces, sampling, spare, &mut judge);
            of_run = RunMoves::faster(of_run, paced);
        }
        let of_run = of_run?;
        spare = of_run.spare;
        plan.runs.push(of_run.run);
        moves.extend(of_run.moves);
        // Pieces meet but for rounding; moves do exactly.
        if start > 0 {
            moves[start].ends.from = moves[start - 1].ends.to;
        }
    }
    Ok(PlannedMoves { plan, moves })
}

/// Part of the duration of a run below which another plan of it is worth its moves.
const FASTER: f64 = 0.999;

fn is_limited_by_power(run: &Run) -> bool {
    let acting = |cell| matches!(run.acting(cell), Some(Limited::Power(_)));
    (0..run.cells.len()).any(acting)
}

/// Moves of a run, and the run as it was mended for them.
struct RunMoves {
    run: Run,
    moves: Vec<PlannedMove>,
    /// Time that is left of the last tick, s.
    spare: f64,
}

impl RunMoves {
    fn of<M: Model<N = f64>>(
        planner: &Planner<M>,
        mut run: Run,
        pieces: &[PathPiece],
        sampling: Sampling,
        mut spare: f64,
        judge: &mut impl FnMut(&[PlannedMove]) -> Vec<Judged>,
    ) -> Result<Self, PathRefusal> {
        let moves = moves_of(planner, &mut run, pieces, sampling, &mut spare, judge)?;
        Ok(Self { run, moves, spare })
    }

    fn faster(
        one: Result<Self, PathRefusal>,
        other: Result<Self, PathRefusal>,
    ) -> Result<Self, PathRefusal> {
        match (one, other) {
            (Ok(one), Ok(other)) => {
                let least_s = one.run.least_s.max(other.run.least_s);
                let mut faster = match ticks_of(&other.moves) < ticks_of(&one.moves) {
                    true => other,
                    false => one,
                };
                faster.run.least_s = least_s;
                Ok(faster)
            }
            (Err(_), Ok(other)) => Ok(other),
            (one, _) => one,
        }
    }
}

fn moves_of<M: Model<N = f64>>(
    planner: &Planner<M>,
    run: &mut Run,
    pieces: &[PathPiece],
    sampling: Sampling,
    spare: &mut f64,
    judge: &mut impl FnMut(&[PlannedMove]) -> Vec<Judged>,
) -> Result<Vec<PlannedMove>, PathRefusal> {
    if planner.jerk().is_some() {
        let step_s = f64::from(sampling.ticks_min) * sampling.period_s;
        *run = even::refined(planner, pieces, run, step_s)?;
    }
    let mut fine: Vec<Fine> = Vec::new();
    // The excess of the first instant that is not proven may be less than the largest one: what is refused again is
    // lowered by twice as much.
    let mut strikes = vec![LEAST; run.cells.len()];
    let refusal = |place| PathRefusal::at(place, pieces, Obstacle::Refused);
    let lever_m = planner.lever_m();
    let least_s = shortest_s(run, pieces, lever_m, &sampling);
    let easings = easings(
        run,
        pieces,
        (sampling.shortest(least_s) + 1.0) * sampling.period_s,
    );
    if !easings.is_empty() {
        let cuts = cuts_of(&easings, run);
        split(planner, pieces, run, &mut strikes, &easings, cuts)?;
    }
    leave_room(run, pieces, &sampling);
    run.replan();
    for round in 0..ROUNDS {
        let draft = Draft::new(run, pieces, [lever_m, least_s], sampling, &fine, *spare);
        let mut mended = false;
        let mut slower: Vec<Slower> = Vec::new();
        for index in 0..draft.moves.len() {
            let deviation = draft.deviation(index);
            // Where moves cannot be shorter, they leave the path by the square of the pace.
            if deviation > 1.0 {
                match draft.closer(index, &fine) {
                    Some(closer) => {
                        fine.push(closer);
                        mended = true;
                    }
                    None => slower.push(Slower {
                        span: draft.span(index),
                        by: deviation - 1.0,
                        why: Limited::Tolerance,
                    }),
                }
            }
            for beyond in draft.parts_of_limits(planner, index) {
                if beyond.most > 1.0 {
                    slower.push(Slower {
                        span: draft.span_between(beyond.knots),
                        by: beyond.most - 1.0,
                        why: beyond.what,
                    });
                }
            }
        }
        mended |= !slower.is_empty();
        let verdicts = match mended {
            true => Vec::new(),
            false => judge(&draft.moves),
        };
        for (index, judged) in verdicts.into_iter().enumerate() {
            match judged {
                Judged::Kept => {}
                Judged::Refused => return Err(refusal(draft.moves[index].place)),
                Judged::Exceeded(by, why) => {
                    let (span, by) = (draft.span(index), by.max(0.0));
                    slower.push(Slower { span, by, why });
                    mended = true;
                }
            }
        }
        if !mended {
            *spare = draft.spare;
            return Ok(draft.moves);
        }
        drop(draft);
        if run.jerk.is_none() {
            let cuts = cuts(run, &slower);
            split(planner, pieces, run, &mut strikes, &easings, cuts)?;
        }
        if round >= PATIENCE {
            run.tighten(0..run.cells.len(), 1.0 - IMPATIENCE);
        }
        // Moves overlap in their cells: each cell takes one step a round.
        let before = strikes.clone();
        for Slower { span, by, why } in slower {
            let cells = run.cells_between(span);
            let margins = before[cells.clone()].iter().copied();
            let margin = margins.fold(LEAST, f64::max);
            strikes[cells.clone()].fill(2.0 * margin);
            run.tighten_for(cells, 1.0 / (1.0 + by + margin), why);
        }
        run.replan();
    }
    Err(refusal(run.places[0]))
}

/// A part of the path that is to be slower.
struct Slower {
    span: [PathPlace; 2],
    /// Part of the limits by which it is beyond them.
    by: f64,
    why: Limited,
}

/// Places at which the cells of `run` are cut, so that no more of it becomes slower than has to.
fn cuts(run: &Run, slower: &[Slower]) -> Vec<Vec<f64>> {
    // Part of a cell below which no other is cut off.
    let sliver = |cell: usize| 0.25 * (SHORT_S / run.cell_duration_s(cell)).min(1.0);
    let mut cuts: Vec<Vec<f64>> = vec![Vec::new(); run.cells.len()];
    for place in slower.iter().flat_map(|each| &each.span) {
        let cell = run.cells_between([*place; 2]).start;
        let part = (place.p - run.places[cell].p) / run.cells[cell].length();
        let is_within = (sliver(cell)..1.0 - sliver(cell)).contains(&part);
        let is_of_cell = run.places[cell].piece == place.piece;
        if is_of_cell && is_within && run.cell_duration_s(cell) > SHORT_S {
            cuts[cell].push(place.p);
        }
    }
    for (cell, cuts) in cuts.iter_mut().enumerate() {
        cuts.sort_by(f64::total_cmp);
        cuts.dedup_by(|b, a| *b - *a < sliver(cell) * run.cells[cell].length());
    }
    cuts
}

/// Places at which the cells of `run` are cut so that each lies in an easing or outside: one that lies in it is measured again.
fn cuts_of(easings: &[Easing], run: &Run) -> Vec<Vec<f64>> {
    let mut cuts: Vec<Vec<f64>> = vec![Vec::new(); run.cells.len()];
    for Easing { piece, ends, .. } in easings {
        let places = ends.map(|p| PathPlace { piece: *piece, p });
        for cell in run.cells_between(places) {
            let (from, to) = (
                run.places[cell].p,
                run.places[cell].p + run.cells[cell].length(),
            );
            let is_within = |p: &&f64| from < **p && **p < to;
            let inner = ends.iter().filter(is_within).copied();
            match run.places[cell].piece == *piece {
                true if inner.clone().count() == 0 => cuts[cell].push(0.5 * (from + to)),
                true => cuts[cell].extend(inner),
                false => {}
            }
        }
    }
    for cuts in &mut cuts {
        cuts.sort_by(f64::total_cmp);
        cuts.dedup();
    }
    cuts
}

/// Cuts the cells of `run`. Each part takes over what the passes use of the limits, those of jerk, and the strikes.
fn split<M: Model<N = f64>>(
    planner: &Planner<M>,
    pieces: &[PathPiece],
    run: &mut Run,
    strikes: &mut Vec<f64>,
    easings: &[Easing],
    cuts: Vec<Vec<f64>>,
) -> Result<(), PathRefusal> {
    if cuts.iter().all(Vec::is_empty) {
        return Ok(());
    }
    let whole = run.clone();
    let grid = Grid::split(planner, pieces, whole.clone(), &cuts, easings)?;
    *run = grid.plan(whole.pieces.clone()).0;
    run.jerk = whole.jerk.as_ref().and_then(|jerk| {
        let (cells, places) = (&run.cells, &run.places);
        JerkLimits::of(planner, pieces, cells, places, [jerk.cell_s, jerk.step_s])
    });
    // An easing has the feed of another piece: what it bounds is no bound of the path.
    run.least_s = match easings.is_empty() {
        true => run.least_s.max(whole.least_s),
        false => whole.least_s,
    };
    let of_whole = |place: &PathPlace| strikes[whole.cells_between([*place; 2]).start];
    *strikes = run.places[..run.cells.len()].iter().map(of_whole).collect();
    Ok(())
}
