//! Stops along the moves of a job, wherever they begin.

use crate::Scene;
use crate::job::Job;
use crate::job_move::JobMove;
use crate::judge::judge_quickly;
use crate::longest_stop::LongestStop;
use crate::planning::join;
use crate::way::{MoveWay, way_m};
use crate::words::rounded_up;
use core::ops::Range;
use trirrr_service::paces::{PacedMove, StopJob, Stops};

impl Scene {
    /// Finds the longest stop of the job, by the rates that the admission proves in the scene's number type. None if a move
    /// is not admitted; the reader refuses such a scene.
    pub fn longest_stop(&self) -> Option<LongestStop> {
        if let Some(spool) = &self.job.spool {
            return spool.longest_stop();
        }
        let pass = StopMoves::judged(self, self.job.moves.clone(), true)?;
        let passes = self.service.autonomous.map_or(1, |own| own.passes);
        Some(pass.in_passes(self, passes).longest)
    }
}

/// Moves of a job, and the rates that are proven for each.
#[derive(Clone, Debug, Default)]
pub(crate) struct StopMoves {
    /// True if they are the first of the job.
    begins: bool,
    moves: Vec<JobMove>,
    paced: Vec<PacedMove>,
}

/// Stops on a part of a job.
pub(crate) struct FoundStops {
    /// The longest of those that end in it.
    longest: LongestStop,
    /// Index of the first move from which a stop may go on behind the part; the number of moves where none does.
    open: usize,
}

impl StopMoves {
    /// Judges `moves` on the machine of `scene`. None if one is not admitted.
    pub(crate) fn judged(scene: &Scene, moves: Vec<JobMove>, begins: bool) -> Option<Self> {
        let trial = Scene {
            job: Job::of(scene.job.start, moves),
            ..scene.clone()
        };
        let judgements = judge_quickly(&trial, usize::MAX).ok()?;
        let moves = trial.job.moves;
        let paced = moves.iter().zip(judgements).map(|(each, paces)| {
            Some(PacedMove {
                ticks: each.duration_ticks,
                paces: paces.ok()?,
                // Or may do so in the number type.
                rests: each.end_velocity.amax() < 1e-6,
            })
        });
        let paced = paced.collect::<Option<_>>()?;
        Some(Self {
            begins,
            moves,
            paced,
        })
    }

    /// Looks at the stops that begin in the first `count` of these moves. At their end the machine stands, and the job is over, if it
    /// `ends` there.
    pub(crate) fn stops(&self, scene: &Scene, count: usize, ends: bool) -> FoundStops {
        let moves = self.moves.iter();
        let ways: Vec<_> = moves
            .map(|each| MoveWay::of(each, scene.period_s()))
            .collect();
        let job = StopJob::new(&self.paced, scene.ramp().ticks, self.begins, ends);
        let mut found = FoundStops {
            longest: LongestStop::default(),
            open: self.moves.len(),
        };
        job.each(count, |stops| {
            let Stops { from, to, .. } = *stops;
            let Some(to) = to else {
                found.open = found.open.min(from.index);
                return false;
            };
            let [from, to] = [from, to].map(|place| (place.index, job.ticks(place.parts)));
            let stop = LongestStop {
                time_s: stops.ticks as f64 * scene.period_s(),
                way_m: way_m(&ways, from, to, job.ticks(stops.parts)),
            };
            let longest = found.longest;
            let longer = [stop.time_s > longest.time_s, stop.way_m > longest.way_m];
            let is_closer = |i: usize| longer[i] && !stops.is_narrow[i];
            if is_closer(0) || is_closer(1) {
                return true;
            }
            found.longest.merge(LongestStop {
                way_m: rounded_up(stop.way_m, 3),
                ..stop
            });
            false
        });
        found
    }

    /// Looks at all stops of a job that is played so many times without a stop between: a late one goes on into the next pass.
    fn in_passes(&self, scene: &Scene, passes: u32) -> FoundStops {
        let each = self.moves.len();
        let mut joined = self.clone();
        for pass in 1..passes {
            joined.append(self, 0..each);
            // Those of two passes, with as many behind them as they need. All later ones are as those of the second.
            let found = joined.stops(scene, 2 * each, false);
            if pass > 1 && found.open >= 2 * each {
                return found;
            }
        }
        joined.stops(scene, usize::MAX, true)
    }

    /// Adds `others` to the end.
    fn append(&mut self, others: &Self, range: Range<usize>) {
        self.moves.extend_from_slice(&others.moves[range.clone()]);
        self.paced.extend_from_slice(&others.paced[range]);
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
    pub(crate) fn add(&mut self, scene: &Scene, block: &StopMoves, stops: &FoundStops) {
        self.longest.merge(stops.longest);
        if self.open.moves.is_empty() || self.ends_in(scene, block) {
            self.open = StopMoves {
                begins: block.begins && stops.open == 0,
                ..StopMoves::default()
            };
            self.open.append(block, stops.open..block.moves.len());
        }
    }

    /// Follows the stops from what is open into `block`. Returns false if one goes on behind that, a short one: it is open, too, then.
    fn ends_in(&mut self, scene: &Scene, block: &StopMoves) -> bool {
        let count = self.open.moves.len();
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
            let seam = self.open.stops(scene, count, false);
            if seam.open >= count {
                self.longest.merge(seam.longest);
                return true;
            }
            if head == block.moves.len() {
                self.longest.merge(seam.longest);
                self.open.begins &= seam.open == 0;
                self.open.moves.drain(..seam.open);
                self.open.paced.drain(..seam.open);
                return false;
            }
            seam_ticks *= 4;
        }
    }

    /// Ends the job.
    pub(crate) fn end(&self, scene: &Scene) -> LongestStop {
        let mut longest = self.longest;
        longest.merge(self.open.stops(scene, usize::MAX, true).longest);
        longest
    }
}
