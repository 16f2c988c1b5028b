//! What the joints are to do, tick by tick.

use super::refusal::Refusal;
use crate::evaluator::{self, Evaluator};
use crate::record::Record;
use nalgebra::Vector3;
use trirrr_core::number::Number;
use trirrr_drives::command::joint::Reference;
use trirrr_scene::{JobPlayer, Scene};

/// What each joint is to do at a tick.
pub type JointReferences = [Reference<f64>; 3];

fn joints(record: &Record) -> JointReferences {
    record.legs.map(|leg| Reference {
        angle: leg.th1,
        rate: leg.dth1,
        acceleration: leg.ddth1,
        torque: leg.torque,
    })
}

/// Gives the ticks one after the other.
pub trait TickSource: Send {
    /// Where the joints stand before the first tick.
    ///
    /// # Errors
    /// [`Refusal::Setpoint`].
    fn start(&mut self) -> Result<JointReferences, Refusal>;

    /// The tick after the last, `tick` counted from 0; after the end of the job, its end at rest.
    ///
    /// # Errors
    /// [`Refusal::Setpoint`].
    fn tick(&mut self, tick: u32) -> Result<JointReferences, Refusal>;
}

/// A job through the pipeline of the core in the number type `N`.
pub struct Pipeline<N: Number> {
    player: JobPlayer<N>,
    evaluator: Box<dyn Evaluator<N>>,
    period_s: f64,
}

impl<N: Number> Pipeline<N> {
    /// The job of `scene`.
    ///
    /// # Errors
    /// A machine that the core refuses.
    pub fn build(scene: &Scene) -> Result<Self, Refusal> {
        let played = evaluator::scene::<N>(scene).map_err(Refusal::Machine)?;
        Ok(Self {
            player: played.player,
            evaluator: played.machine,
            period_s: scene.period_s(),
        })
    }
}

impl<N: Number> TickSource for Pipeline<N> {
    fn start(&mut self) -> Result<JointReferences, Refusal> {
        self.tick(0)
    }

    fn tick(&mut self, tick: u32) -> Result<JointReferences, Refusal> {
        let mut setpoint = self.player.at(tick);
        if tick >= self.player.ticks() {
            // The cubic arrives decelerating; the hold that follows does not.
            setpoint.acceleration = Vector3::from([N::ZERO; 3]);
        }
        let t = f64::from(tick) * self.period_s;
        self.evaluator
            .evaluate(t, &setpoint)
            .map(|record| joints(&record))
            .map_err(Refusal::Setpoint)
    }
}
