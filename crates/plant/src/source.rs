//! What the joints are to do, tick by tick.

use super::refusal::Refusal;
use nalgebra::Vector3;
use trirrr_core::number::Number;
use trirrr_core::tick::Tick;
use trirrr_core::torque::links::{InPlane, Massive};
use trirrr_core::torque::payload::Offset;
use trirrr_core::units::Units;
use trirrr_drives::joint::Reference;
use trirrr_scene::{JobPlayer, Scene};

/// The core's tick with room for every mass that a machine may have.
pub(crate) type WholeTick<N> = Tick<N, Offset<N>, Massive<N, InPlane<N>>>;

/// What each joint is to do at a tick.
pub type JointReferences = [Reference<f64>; 3];

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

/// A job through the core's tick in the number type `N`.
pub struct Pipeline<N: Number> {
    player: JobPlayer<N>,
    tick: WholeTick<N>,
    units: Units,
}

impl<N: Number> Pipeline<N> {
    /// The job of `scene`.
    ///
    /// # Errors
    /// A machine that the core refuses.
    pub fn build(scene: &Scene) -> Result<Self, Refusal> {
        let refused = |error: &dyn std::fmt::Display| Refusal::Machine(error.to_string());
        let units = trirrr_scene::units::<N>(scene).map_err(|error| refused(&error))?;
        let tick = Tick::build(&units.parameters(&scene.parameters));
        Ok(Self {
            player: JobPlayer::new(&scene.job.in_units(&units), units.time(scene.period_s())),
            tick: tick.map_err(|error| refused(&error))?,
            units,
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
        let motion = self.tick.evaluate(&setpoint).map_err(Refusal::Setpoint)?;
        let units = &self.units;
        Ok(motion.motors.map(|motor| Reference {
            angle: N::angle_to_f64(motor.angle),
            rate: motor.rate.to_f64() * units.rate_rad_s(),
            acceleration: motor.acceleration.to_f64() * units.acceleration_rad_s2(),
            torque: motor.torque.to_f64() * units.torque_nm(),
        }))
    }
}
