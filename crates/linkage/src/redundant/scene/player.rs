//! Plays the job of a redundant scene: platform and sliders at every tick.

use super::RedundantScene;
use super::pipeline::RedundantPipeline;
use super::record::RedundantRecord;
use crate::redundant::SliderState;
use trirrr_core::setpoint::Setpoint;
use trirrr_core::status::Status;
use trirrr_scene::JobPlayer;

/// Job of a scene, tick by tick.
///
/// A slider moves from rest to rest in each move, by a cubic in time.
pub struct RedundantPlayer<'a> {
    scene: &'a RedundantScene,
    platform: JobPlayer<f64>,
    /// Tick at which each move starts.
    starts: Vec<u32>,
    at_start: Vec<f64>,
}

impl<'a> RedundantPlayer<'a> {
    /// Player of the job of `scene`.
    pub fn new(scene: &'a RedundantScene) -> Self {
        let mut next = 0;
        let start = |ticks: u32| {
            let start = next;
            next += ticks;
            start
        };
        let ticks = scene.job.moves.iter().map(|each| each.duration_ticks);
        Self {
            scene,
            platform: JobPlayer::new(&scene.job, scene.period_s()),
            starts: ticks.map(start).collect(),
            at_start: scene.slider_starts(),
        }
    }

    /// Ticks of the job; it has one setpoint more.
    pub fn ticks(&self) -> u32 {
        self.platform.ticks()
    }

    /// Number of the move under way at `tick`, from 0.
    pub fn move_at(&self, tick: u32) -> usize {
        self.platform.move_at(tick)
    }

    /// Time of `tick` since the start of its move, s.
    pub fn time_in_move(&self, tick: u32) -> f64 {
        f64::from(tick - self.starts[self.move_at(tick)]) / self.scene.tick_rate_hz
    }

    /// Setpoint of the platform.
    pub fn platform(&self, tick: u32) -> Setpoint<f64> {
        self.platform.at(tick)
    }

    /// State of each leg's slider; at rest at 0 for a leg without one.
    pub fn sliders(&self, tick: u32) -> Vec<SliderState<f64>> {
        let number = self.move_at(tick);
        let duration_s =
            f64::from(self.scene.job.moves[number].duration_ticks) * self.scene.period_s();
        let part = (self.time_in_move(tick) / duration_s).min(1.0);
        let from = match number {
            0 => &self.at_start,
            number => &self.scene.slider_moves[number - 1],
        };
        let to = &self.scene.slider_moves[number];
        let state = |(&from, &to): (&f64, &f64)| {
            let way = to - from;
            let done = part * part * (3.0 - 2.0 * part);
            SliderState {
                // Exact at both ends.
                position: from * (1.0 - done) + to * done,
                velocity: way * 6.0 * part * (1.0 - part) / duration_s,
                acceleration: way * (6.0 - 12.0 * part) / (duration_s * duration_s),
            }
        };
        from.iter().zip(to).map(state).collect()
    }

    /// Record of `tick` on `machine`.
    ///
    /// # Errors
    /// [`Status`] of a setpoint without a motion.
    pub fn record(
        &self,
        machine: &dyn RedundantPipeline,
        tick: u32,
    ) -> Result<RedundantRecord, Status> {
        let t = f64::from(tick) / self.scene.tick_rate_hz;
        machine.evaluate(
            t,
            &self.platform(tick),
            &self.sliders(tick),
            &self.scene.preload_nm,
        )
    }
}

impl RedundantScene {
    /// Position of each leg's slider at the start of the job, m; 0 for a leg without one.
    pub fn slider_starts(&self) -> Vec<f64> {
        let sliders = self.sliders.iter();
        let starts = sliders.map(|slider| slider.map_or(0.0, |slider| slider.position_m));
        starts.collect()
    }
}
