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
        let ways = self.ways();
        let mut longest = LongestStop::default();
        each_stop(&moves, self.ramp().ticks, |start, stop| {
            let start = start as usize;
            let end = (start + stop.path_ticks as usize).min(ways.len() - 1);
            longest.time_s = longest.time_s.max(f64::from(stop.ticks) * self.period_s());
            longest.way_m = longest.way_m.max(ways[end] - ways[start]);
        });
        Some(longest)
    }

    /// Way of D from the start of the job to each of its ticks.
    fn ways(&self) -> Vec<f64> {
        let mut way = 0.0;
        let mut ways = vec![way];
        for each in &self.job.moves {
            let ticks = each.duration_ticks;
            let segment = each.segment::<f64>(ticks, self.period_s());
            let place = |tick| {
                let Pose { position, .. } = segment.at(tick).pose;
                position
            };
            for tick in 0..ticks {
                let chord = place(tick + 1) - place(tick);
                way += chord.x.hypot(chord.y);
                ways.push(way);
            }
        }
        ways
    }
}
