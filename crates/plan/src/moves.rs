//! A plan as moves: quintics in time, a whole number of ticks long each, that a service admits.
//!
//! What is played is the plan smoothed over two steps of time, a few ticks. Each move has pose, velocity and acceleration
//! of the smoothed motion at its ends, so the chain has no jump in the acceleration, and is as long as it stays near
//! that motion. What the judge refuses is cut, or the limits are lowered there.

pub use crate::planned::{PlannedMove, Sampling};

use crate::cell::{Obstacle, Planner};
use crate::course::{Effort, Plan, plan};
use crate::draft::{Draft, Fine, leave_room, shortest_s};
use crate::even;
use crate::fit::MARGIN;
use crate::path::{PathPiece, PathRefusal};
use crate::run::Run;
use trirrr_core::model::Model;

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

/// Excess of a limit above which moves are cut before the pace is lowered.
const EXCESS_OF_FIT: f64 = 0.003;
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
    let mut plan = plan(planner, pieces, effort)?;
    let mut moves: Vec<PlannedMove> = Vec::new();
    for run in &mut plan.runs {
        let start = moves.len();
        moves.extend(moves_of(planner, run, pieces, sampling, &mut judge)?);
        // Pieces meet but for rounding; moves do exactly.
        if start > 0 {
            moves[start].ends.from = moves[start - 1].ends.to;
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
    if planner.jerk().is_some() {
        let step_s = f64::from(sampling.ticks_min) * sampling.period_s;
        *run = even::refined(planner, pieces, run, step_s)?;
    }
    let mut fine: Vec<Fine> = Vec::new();
    // The excess of the first instant that is not proven may be less than the largest one: what is refused again is
    // lowered by twice as much.
    let mut strikes = vec![MARGIN; run.cells.len()];
    let refusal = |place| PathRefusal::at(place, pieces, Obstacle::Refused);
    leave_room(run, pieces, &sampling);
    run.replan();
    let lever_m = planner.lever_m();
    let least_s = shortest_s(run, pieces, lever_m, &sampling);
    for _ in 0..ROUNDS {
        let draft = Draft::new(run, pieces, [lever_m, least_s], sampling, &fine);
        let mut mended = false;
        let mut slower = Vec::new();
        for index in 0..draft.moves.len() {
            let (deviation, speed) = (draft.deviation(index), draft.speed(index));
            // Where moves cannot be shorter, the smoothing itself leaves the path, by the square of the pace.
            let excess = match deviation > 1.0 && draft.splits(index) {
                true => {
                    fine.push(draft.closer(index));
                    mended = true;
                    speed * speed
                }
                false => deviation.max(speed * speed),
            };
            if excess > 1.0 {
                slower.push((draft.cells(index), excess - 1.0));
                mended = true;
            }
        }
        let verdicts = match mended {
            true => Vec::new(),
            false => judge(&draft.moves),
        };
        for (index, judged) in verdicts.into_iter().enumerate() {
            match judged {
                Judged::Kept => {}
                Judged::Refused => return Err(refusal(draft.moves[index].place)),
                Judged::Exceeded(by) if by > EXCESS_OF_FIT && draft.splits(index) => {
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
