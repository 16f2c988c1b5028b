//! The longest stop of a job, known before the job starts.

use crate::Scene;
use crate::job::{Job, JobMove};
use crate::judge::judge_quickly;
use crate::levels::JobLevels;
use crate::planning::join;
use crate::words::short;
use core::ops::Range;
use std::fmt;
use trirrr_core::setpoint::Pose;
use trirrr_service::{MovePaces, each_stop};

/// Longest time and longest way of a hold or a stop, wherever on a job it comes at normal speed. They may belong to
/// different places. A job that is over before it comes to rest stands at its end.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LongestStop {
    /// Seconds until the machine stands.
    pub time_s: f64,
    /// Way of D until there, m, by chords of a tick.
    pub way_m: f64,
}

impl LongestStop {
    /// Takes the greater time and the greater way.
    fn merge(&mut self, other: Self) {
        self.time_s = self.time_s.max(other.time_s);
        self.way_m = self.way_m.max(other.way_m);
    }
}

impl fmt::Display for LongestStop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (time, way) = (short(self.time_s), short(self.way_m));
        write!(f, "at rest within {time} s and {way} m, wherever it comes")
    }
}

impl Scene {
    /// Finds the longest stop of the job, by the rates that the admission proves in the scene's number type. None if a move
    /// is not admitted; the reader refuses such a scene.
    pub fn longest_stop(&self) -> Option<LongestStop> {
        if let Some(spool) = &self.job.spool {
            return spool.longest_stop();
        }
        let moves = StopMoves::judged(self, self.job.moves.clone())?;
        Some(moves.stops(self, u64::MAX, true).longest)
    }
}

/// Moves of a job, and the rates that are proven for each.
#[derive(Clone, Debug, Default)]
pub(crate) struct StopMoves {
    moves: Vec<JobMove>,
    paces: Vec<MovePaces>,
}

/// Stops on a part of a job.
pub(crate) struct Stops {
    /// The longest of those that end in it.
    longest: LongestStop,
    /// Index of the first move from which a stop may go on behind the part; the number of moves where none does.
    open: usize,
}

impl StopMoves {
    /// Judges `moves` on the machine of `scene`. None if one is not admitted.
    pub(crate) fn judged(scene: &Scene, moves: Vec<JobMove>) -> Option<Self> {
        let job = Job {
            moves,
            path: None,
            spool: None,
            levels: JobLevels::default(),
            outputs: crate::JobOutputs::default(),
            start: scene.job.start,
        };
        let trial = Scene {
            job,
            ..scene.clone()
        };
        let judgements = judge_quickly(&trial, usize::MAX).ok()?;
        let paces: Option<_> = judgements.into_iter().map(Result::ok).collect();
        Some(Self {
            paces: paces?,
            moves: trial.job.moves,
        })
    }

    /// Looks at the stops that begin before the tick `before` of these moves. At their end the machine stands; the job is over there if
    /// it `ends`.
    pub(crate) fn stops(&self, scene: &Scene, before: u64, ends: bool) -> Stops {
        let ticks = || self.moves.iter().map(|each| each.duration_ticks);
        let paced: Vec<_> = ticks().zip(self.paces.iter().copied()).collect();
        let mut total = 0;
        let starts: Vec<u64> = ticks()
            .map(|ticks| {
                let start = total;
                total += u64::from(ticks);
                start
            })
            .collect();
        let mut stops = Stops {
            longest: LongestStop::default(),
            open: self.moves.len(),
        };
        each_stop(&paced, scene.ramp().ticks, |start, stop| {
            if start >= before {
                return;
            }
            if !ends && start + u64::from(stop.path_ticks) >= total {
                let index = starts.partition_point(|first| *first <= start);
                stops.open = stops.open.min(index.saturating_sub(1));
                return;
            }
            stops.longest.merge(LongestStop {
                time_s: f64::from(stop.ticks) * scene.period_s(),
                way_m: self.way_m(scene, &starts, start, stop.path_ticks),
            });
        });
        stops
    }

    /// Way of D during `ticks` from the tick `start` on; `starts` are the first ticks of the moves.
    fn way_m(&self, scene: &Scene, starts: &[u64], start: u64, mut ticks: u32) -> f64 {
        let mut index = starts.partition_point(|first| *first <= start);
        let mut way_m = 0.0;
        while index > 0 && index <= starts.len() && ticks > 0 {
            let each = &self.moves[index - 1];
            let first = start.saturating_sub(starts[index - 1]) as u32;
            let last = first.saturating_add(ticks).min(each.duration_ticks);
            let segment = each.segment::<f64>(each.duration_ticks, scene.period_s());
            let place = |tick| {
                let Pose { position, .. } = segment.at(tick).pose;
                position
            };
            for tick in first..last {
                let chord = place(tick + 1) - place(tick);
                way_m += chord.x.hypot(chord.y);
            }
            ticks -= last - first;
            index += 1;
        }
        way_m
    }

    fn ticks(&self) -> u64 {
        let ticks = self.moves.iter().map(|each| each.duration_ticks);
        ticks.map(u64::from).sum()
    }

    /// Adds `others` to the end.
    fn append(&mut self, others: &Self, range: Range<usize>) {
        self.moves.extend_from_slice(&others.moves[range.clone()]);
        self.paces.extend_from_slice(&others.paces[range]);
    }

    /// Lets the first move begin where `before` ends.
    pub(crate) fn join(&mut self, before: Option<&JobMove>) {
        join(before, self.moves.first_mut());
    }
}

/// Ticks behind a block in which a stop from it is looked for first.
const SEAM_TICKS: u64 = 1000;

/// Longest stop of a job whose moves come block by block.
#[derive(Debug, Default)]
pub(crate) struct StopsSoFar {
    longest: LongestStop,
    /// Moves from which a stop may go on into the next block.
    open: StopMoves,
}

impl StopsSoFar {
    /// Adds the next block; `stops` are those within it.
    pub(crate) fn add(&mut self, scene: &Scene, block: &StopMoves, stops: &Stops) {
        self.longest.merge(stops.longest);
        if self.open.moves.is_empty() || self.ends_in(scene, block) {
            self.open = StopMoves::default();
            self.open.append(block, stops.open..block.moves.len());
        }
    }

    /// Follows the stops from what is open into `block`. Returns false if one goes on behind that, a short one: it is open, too, then.
    fn ends_in(&mut self, scene: &Scene, block: &StopMoves) -> bool {
        let (count, before) = (self.open.moves.len(), self.open.ticks());
        let mut seam_ticks = SEAM_TICKS;
        let mut head = 0;
        let mut head_ticks = 0;
        loop {
            // As much of the block as the stops take.
            while head < block.moves.len() && head_ticks <= seam_ticks {
                self.open.append(block, head..head + 1);
                head_ticks += u64::from(block.moves[head].duration_ticks);
                head += 1;
            }
            let seam = self.open.stops(scene, before, false);
            if seam.open >= count {
                self.longest.merge(seam.longest);
                return true;
            }
            if head == block.moves.len() {
                self.longest.merge(seam.longest);
                self.open.moves.drain(..seam.open);
                self.open.paces.drain(..seam.open);
                return false;
            }
            seam_ticks *= 4;
        }
    }

    /// Ends the job.
    pub(crate) fn end(&self, scene: &Scene) -> LongestStop {
        let mut longest = self.longest;
        longest.merge(self.open.stops(scene, u64::MAX, true).longest);
        longest
    }
}
