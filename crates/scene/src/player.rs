//! Plays a job: the setpoint of every tick.

use crate::job::Job;
use crate::job_move::JobMove;
use trirrr_core::number::Number;
use trirrr_core::setpoint::{Quintics, Segment, Setpoint};

/// A job's moves built in the number type `N`, ready to be asked for any tick.
///
/// ```
/// # let thesis = include_str!("../../../scenes/thesis.toml");
/// let scene = trirrr_scene::Scene::parse(thesis, "thesis.toml")?;
/// let player = trirrr_scene::JobPlayer::<f64>::new(&scene.job, scene.period_s());
/// assert_eq!(player.setpoints().count(), 101);
/// assert_eq!(player.at(0).pose, scene.job.start);
/// # Ok::<(), trirrr_scene::SceneError>(())
/// ```
#[derive(Clone, Debug)]
pub struct JobPlayer<N: Number> {
    /// Never empty.
    moves: Vec<TimedMove<N>>,
    ticks: u32,
}

#[derive(Clone, Copy, Debug)]
struct TimedMove<N: Number> {
    /// Tick of the job at which it starts.
    start: u32,
    segment: Segment<N, Quintics>,
}

impl<N: Number> JobPlayer<N> {
    /// Builds the moves of `job` for ticks of `period_s`.
    ///
    /// # Panics
    /// If the job has no moves in memory; one that a scene was read with has some.
    pub fn new(job: &Job, period_s: f64) -> Self {
        assert!(!job.moves.is_empty(), "a job without moves");
        let mut start = 0;
        let timed = |each: &JobMove| {
            let timed = TimedMove {
                start,
                segment: each.segment(each.duration_ticks, period_s),
            };
            start += each.duration_ticks;
            timed
        };
        Self {
            moves: job.moves.iter().map(timed).collect(),
            ticks: job.ticks(),
        }
    }

    /// Duration of the job in ticks; the tick of its last setpoint.
    pub fn ticks(&self) -> u32 {
        self.ticks
    }

    /// Returns the number, counted from 0, of the move under way at `tick`. The tick between two
    /// moves belongs to the later one. Beyond the end it stays the last.
    pub fn move_at(&self, tick: u32) -> usize {
        self.moves.partition_point(|each| each.start <= tick) - 1
    }

    /// The setpoint at `tick`, counted from the start of the job; beyond the end, the end. At the
    /// tick between two moves the acceleration is the later one's; pose and velocity are the same.
    pub fn at(&self, tick: u32) -> Setpoint<N> {
        let each = &self.moves[self.move_at(tick)];
        each.segment.at(tick - each.start)
    }

    /// The setpoints of all ticks, 0 to [`JobPlayer::ticks`] with both ends.
    pub fn setpoints(&self) -> impl Iterator<Item = Setpoint<N>> + '_ {
        (0..=self.ticks).map(|tick| self.at(tick))
    }
}
