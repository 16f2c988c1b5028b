//! The job as a path in time: setpoints at every instant, not only at ticks.

use nalgebra::Vector3;
use trirrr_core::setpoint::{Quintics, Segment, Setpoint};
use trirrr_scene::{JobMove, Scene};

/// The moves of a job on the time axis.
#[derive(Clone, Debug)]
pub struct JobPath {
    moves: Vec<TimedMove>,
    /// Setpoint held after the last.
    rest: Setpoint<f64>,
}

#[derive(Clone, Copy, Debug)]
struct TimedMove {
    start: f64,
    end: f64,
    segment: Segment<f64, Quintics>,
}

impl JobPath {
    /// The job of `scene`, which starts at t = 0.
    pub fn new(scene: &Scene) -> Self {
        let mut tick = 0_u32;
        let mut timed = |each: &JobMove| {
            let start = f64::from(tick) / scene.tick_rate_hz;
            tick += each.duration_ticks;
            TimedMove {
                start,
                end: f64::from(tick) / scene.tick_rate_hz,
                segment: each.segment(each.duration_ticks, scene.period_s()),
            }
        };
        let last = scene.job.moves.last();
        Self {
            moves: scene.job.moves.iter().map(&mut timed).collect(),
            rest: Setpoint {
                pose: last.map_or(scene.job.start, |last| last.to),
                velocity: Vector3::zeros(),
                acceleration: Vector3::zeros(),
            },
        }
    }

    /// End of move `index`, s; `None` past the last.
    pub fn end_of(&self, index: usize) -> Option<f64> {
        self.moves.get(index).map(|each| each.end)
    }

    /// The setpoint at `t` by the formula of move `index`, beyond its ends too; past the last move
    /// the end of the job.
    pub fn in_move(&self, index: usize, t: f64) -> Setpoint<f64> {
        let Some(each) = self.moves.get(index) else {
            return self.rest;
        };
        let s = (t - each.start) / (each.end - each.start);
        each.segment.at_fraction(s)
    }

    /// The setpoint at `t`.
    pub fn at(&self, t: f64) -> Setpoint<f64> {
        self.in_move(self.moves.partition_point(|each| each.end <= t), t)
    }
}
