//! The plan within limits of jerk.
//!
//! The passes find the fastest motion whose acceleration may jump. Here it is made slower until the acceleration of each
//! motor changes from the middle of a cell to the middle of the next by no more than the limit of jerk allows in the time
//! between. With x at the marks as unknowns the time is convex and the limits of the passes are linear. The time between
//! two middles is convex in x: what it allows is no convex set, and the motion found is the fastest nearby.
//!
//! An interior-point method from a motion that is slow everywhere: steps of Newton's method on the time less a barrier of
//! each limit. Each limit concerns three marks at most, so the matrix has five diagonals.

mod band;
mod problem;
mod slack;
#[cfg(test)]
mod tests;

pub(crate) use problem::limit;

use crate::cell::Planner;
use crate::path::{PathPiece, PathPlace};
use crate::rows::Cell;
use trirrr_core::model::Model;

/// Acceleration of the three motors in the middle of a cell, as coefficients of a and x.
pub(crate) type Turning = [[f64; 2]; 3];

/// Limits of jerk over the cells of a run.
#[derive(Clone, Debug)]
pub(crate) struct JerkLimits {
    /// rad/s^3.
    pub(crate) limits: [f64; 3],
    /// For each cell.
    pub(crate) turning: Vec<Turning>,
    /// Jump of the accelerations at the start of each cell where pieces join, as a coefficient of x.
    pub(crate) jumps: Vec<[f64; 3]>,
    /// Time over which moves spread such a jump, s.
    pub(crate) step_s: f64,
    /// Time over which the motion is a mean of the plan, s: about that of a cell.
    pub(crate) cell_s: f64,
}

/// Part of the limits that a plan uses; the rest is for what moves differ from it.
const SHARE: f64 = 0.97;

impl JerkLimits {
    /// The limits of `planner` over `cells` that begin at `places`; none where it has none.
    pub(crate) fn of<M: Model<N = f64>>(
        planner: &Planner<M>,
        pieces: &[PathPiece],
        cells: &[Cell<f64>],
        places: &[PathPlace],
        [cell_s, step_s]: [f64; 2],
    ) -> Option<Self> {
        let limits = planner.jerk()?.map(|limit| SHARE * limit);
        let at = |piece: usize, p: f64| planner.turning(&pieces[piece].piece.models(), p);
        let turning =
            |(cell, place): (&Cell<f64>, &PathPlace)| at(place.piece, place.p + 0.5 * cell.length);
        let turning: Option<_> = cells.iter().zip(places).map(turning).collect();
        let jump = |index: usize| {
            let place = places[index];
            if index == 0 || places[index - 1].piece == place.piece {
                return Some([0.0; 3]);
            }
            let [before, after] = [at(place.piece - 1, 1.0)?, at(place.piece, place.p)?];
            let jump = |motor: usize| after[motor][1] - before[motor][1] / cells[index].joint;
            Some([jump(0), jump(1), jump(2)])
        };
        let jumps: Option<_> = (0..cells.len()).map(jump).collect();
        Some(Self {
            limits,
            turning: turning?,
            jumps: jumps?,
            cell_s,
            step_s,
        })
    }
}
