//! The longest stop of a job, known before the job starts.

use crate::Scene;
use crate::judge::judge_quickly;
use crate::words::short;
use std::fmt;
use trirrr_core::setpoint::Pose;
use trirrr_service::each_stop;

/// Longest time and longest way of a hold or a stop, wherever on a job it comes at normal speed. They may belong to
/// different places. A job that is over before it comes to rest stands at its end.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LongestStop {
    /// Seconds until the machine stands.
    pub time_s: f64,
    /// Way of D until there, m, by chords of a tick.
    pub way_m: f64,
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
        let judgements = judge_quickly(self, usize::MAX).ok()?;
        let durations = self.job.moves.iter().map(|each| each.duration_ticks);
        let moves = durations
            .zip(judgements)
            .map(|(ticks, judgement)| Some((ticks, judgement.ok()?)));
        let moves: Vec<_> = moves.collect::<Option<_>>()?;
        let starts: Vec<u64> = moves
            .iter()
            .scan(0, |sum, (ticks, _)| {
                let start = *sum;
                *sum += u64::from(*ticks);
                Some(start)
            })
            .collect();
        let mut longest = LongestStop::default();
        each_stop(&moves, self.ramp().ticks, |start, stop| {
            let way_m = self.way_m(&starts, start, stop.path_ticks);
            longest.time_s = longest.time_s.max(f64::from(stop.ticks) * self.period_s());
            longest.way_m = longest.way_m.max(way_m);
        });
        Some(longest)
    }

    /// Way of D during `ticks` of the job from its tick `start` on; `starts` are the first ticks of its moves.
    fn way_m(&self, starts: &[u64], start: u64, mut ticks: u32) -> f64 {
        let mut index = starts.partition_point(|first| *first <= start);
        let mut way_m = 0.0;
        while index > 0 && index <= starts.len() && ticks > 0 {
            let each = &self.job.moves[index - 1];
            let first = start.saturating_sub(starts[index - 1]) as u32;
            let last = first.saturating_add(ticks).min(each.duration_ticks);
            let segment = each.segment::<f64>(each.duration_ticks, self.period_s());
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
}
