//! Choice of alpha along a path, away from singularities and for speed.
//!
//! A tool may not care for the platform's angle. A dynamic program over places and values of alpha, with an estimate of
//! the time, finds the way through the workspace. A natural spline through its answer is smooth wherever the motion does
//! not stop. The planner itself then tries changes of the spline on coarse grids and keeps what is faster.

mod curve;
mod estimate;
mod improve;
mod knots;
mod search;

pub use estimate::Sampler;

use crate::cell::Planner;
use crate::corner::round_corners;
use crate::course::estimate;
use crate::path::{PathPiece, PathPlace, PathRefusal};
use core::ops::Range;
use curve::{lay, original};
use improve::improve;
use knots::{Knot, Stretch};
use search::search;
use trirrr_core::model::Model;

/// Length below which D stands, m.
const STANDS: f64 = 1e-12;
/// Knots along a short path, and at least so many along the reach of the machine.
const KNOTS: f64 = 8.0;
/// Most knots of a stretch, before the distance between them is lowered.
const KNOTS_MAX: f64 = 400.0;
/// Factors of the distance between knots and margins of the distances from singularities that are tried.
const TRIES: [(f64, f64); 4] = [(1.0, 0.1), (1.0, 0.0), (0.5, 0.02), (0.25, 0.0)];
/// Cells between two stops, about, by which a trial is judged.
const GRID: usize = 64;
/// Weights of turning that the search is tried with.
const TURNING: [f64; 2] = [1e-3, 10.0];
/// Cells without a power limit that take as long as one with.
const WITH_POWER: usize = 8;
/// Cells that all trials of a stretch may measure, about.
const CELLS: usize = 120_000;

/// A path whose alpha is to be chosen.
#[derive(Clone, Debug, PartialEq)]
pub struct FreePath {
    /// The pieces, corners rounded. alpha is constant where D moves, and as given where D stands.
    pub pieces: Vec<PathPiece>,
    /// alpha at the end of each piece, where it is fixed.
    ends: Vec<Option<f64>>,
}

impl FreePath {
    /// The path of `given` pieces. `ends` is alpha at the end of each, where it is fixed. Where D stands alpha is as
    /// given, before and behind. Corners of D's way are rounded within `corner_m`.
    pub fn new(given: &[PathPiece], ends: &[Option<f64>], corner_m: Option<f64>) -> Self {
        let start = given.first().map_or(0.0, |each| each.piece.angle);
        let numbered = given.iter().enumerate().map(|(number, each)| PathPiece {
            piece: match stands(each) {
                true => each.piece,
                false => each.piece.with_alpha(start, [0.0; 3]),
            },
            source: number,
            ..*each
        });
        let mut pieces: Vec<PathPiece> = numbered.collect();
        if let Some(corner_m) = corner_m {
            pieces = round_corners(&pieces, corner_m);
        }
        let end = |index: usize| {
            let number = pieces[index].source;
            let next = pieces.get(index + 1);
            match next.filter(|next| stands(next)) {
                Some(next) => Some(next.piece.angle),
                // The curve around the corner behind a piece belongs to it.
                None if next.is_some_and(|next| next.source == number) => None,
                None => ends[number],
            }
        };
        let ends = (0..pieces.len()).map(end).collect();
        for each in &mut pieces {
            each.source = given[each.source].source;
        }
        Self { pieces, ends }
    }

    /// Rows of pieces along which D moves, or stands.
    fn stretches(&self) -> Vec<Range<usize>> {
        let mut stretches = Vec::new();
        let mut first = 0;
        for next in 1..=self.pieces.len() {
            let here = stands(&self.pieces[first]);
            if self
                .pieces
                .get(next)
                .is_none_or(|each| stands(each) != here)
            {
                stretches.push(first..next);
                first = next;
            }
        }
        stretches
    }
}

fn stands(each: &PathPiece) -> bool {
    each.piece.length_m() <= STANDS
}

/// Chooses alpha along `path`: the pieces with it. `reach_m` is the length of the shortest leg.
///
/// # Errors
/// The place that no alpha leads beyond, or the obstacle where a smooth curve of alpha does not keep the limits.
pub fn choose_alpha<M: Model<N = f64>>(
    planner: &Planner<M>,
    sampler: &Sampler<M>,
    path: &FreePath,
    reach_m: f64,
) -> Result<Vec<PathPiece>, PathRefusal> {
    let mut chosen = Vec::with_capacity(path.pieces.len());
    let mut angle = path.pieces.first().map_or(0.0, |each| each.piece.angle);
    for range in path.stretches() {
        let pieces = &path.pieces[range.clone()];
        if pieces.iter().all(stands) {
            chosen.extend_from_slice(pieces);
        } else {
            let stretch = Stretch::new(pieces, &path.ends[range.clone()]);
            let choice = Choice {
                planner,
                sampler,
                stretch,
                start: angle,
            };
            let laid = choice.best(reach_m).map_err(|refusal| PathRefusal {
                place: PathPlace {
                    piece: refusal.place.piece + range.start,
                    ..refusal.place
                },
                ..refusal
            })?;
            chosen.extend(laid);
        }
        angle = chosen.last().map_or(angle, |each| each.piece.end().angle);
    }
    Ok(chosen)
}

/// One stretch from alpha `start`.
struct Choice<'a, M: Model<N = f64>> {
    planner: &'a Planner<M>,
    sampler: &'a Sampler<M>,
    stretch: Stretch<'a>,
    start: f64,
}

impl<M: Model<N = f64>> Choice<'_, M> {
    fn best(&self, reach_m: f64) -> Result<Vec<PathPiece>, PathRefusal> {
        let way_m = self.stretch.way_m();
        let spacing = (reach_m.min(way_m) / KNOTS).max(way_m / KNOTS_MAX);
        let mut refused = None;
        for (factor, margin) in TRIES {
            let knots = self.stretch.knots(factor * spacing, self.start);
            let found = TURNING.map(|turning| {
                let found = search(self.sampler, &self.stretch, &knots, [margin, turning]);
                found.map_err(|dead_end| PathRefusal {
                    place: PathPlace {
                        piece: dead_end.piece,
                        p: dead_end.p,
                    },
                    pose: dead_end.pose,
                    obstacle: dead_end.obstacle,
                })
            });
            let given = Ok(straight(&knots));
            let mut best: Option<(f64, Vec<f64>)> = None;
            let mut first = None;
            for angles in found.into_iter().chain([given]) {
                match angles.and_then(|angles| Ok((self.duration(&knots, &angles)?, angles))) {
                    Ok((time, angles)) if best.as_ref().is_none_or(|(known, _)| time < *known) => {
                        best = Some((time, angles));
                    }
                    Ok(_) => {}
                    // The search says more than what was held.
                    Err(refusal) => first = first.or(Some(refusal)),
                }
            }
            // The last try has the most places and no margin.
            refused = first.or(refused);
            if let Some((time, mut angles)) = best {
                let fixed: Vec<bool> = knots.iter().map(|knot| knot.fixed.is_some()).collect();
                let laid = lay(&self.stretch, &knots, &angles);
                let cost = match self.planner.limits_power() {
                    true => WITH_POWER,
                    false => 1,
                };
                let trials = CELLS / (cost * laid.len().max(GRID));
                improve(&mut angles, &fixed, time, trials, |angles| {
                    self.duration(&knots, angles).unwrap_or(f64::INFINITY)
                });
                return Ok(lay(&self.stretch, &knots, &angles));
            }
        }
        Err(refused.expect("a refusal of every try"))
    }

    /// Duration on a coarse grid.
    fn duration(&self, knots: &[Knot], angles: &[f64]) -> Result<f64, PathRefusal> {
        let laid = lay(&self.stretch, knots, angles);
        estimate(self.planner, &laid, GRID).map_err(|refusal| PathRefusal {
            place: original(knots, refusal.place),
            ..refusal
        })
    }
}

/// alpha held where it is free, straight between two places where it is fixed.
fn straight(knots: &[Knot]) -> Vec<f64> {
    let mut angles: Vec<f64> = Vec::with_capacity(knots.len());
    let mut before = (0.0, 0.0);
    for (index, knot) in knots.iter().enumerate() {
        let next = knots[index..]
            .iter()
            .find_map(|knot| Some((knot.way_m, knot.fixed?)));
        let (way_m, angle) = next.unwrap_or((f64::INFINITY, before.1));
        let part = match knot.fixed {
            Some(_) => 1.0,
            None => (knot.way_m - before.0) / (way_m - before.0),
        };
        angles.push(before.1 + (angle - before.1) * part);
        if let Some(fixed) = knot.fixed {
            before = (knot.way_m, fixed);
        }
    }
    angles
}
