//! Ticks of a job without a service: for studies and tests, whose jobs nobody holds or slows.

use crate::refusal::Refusal;
use trirrr_core::setpoint::Setpoint;
use trirrr_scene::{Scene, pipeline};
use trirrr_service::{Output, Power};

/// Outputs of a service in binary64 that plays the job of `scene` at normal speed: one for each
/// setpoint, then one of the machine at rest.
///
/// # Errors
/// A machine that the core refuses, or a setpoint without a motion.
pub fn outputs(scene: &Scene) -> Result<Vec<Output<f64>>, Refusal> {
    let played = pipeline::scene::<f64>(scene).map_err(Refusal::Machine)?;
    let mut rest = played.player.at(played.player.ticks());
    rest.velocity.fill(0.0);
    rest.acceleration.fill(0.0);
    let output = |setpoint: Setpoint<f64>| {
        let motors = played.machine.motors(&setpoint);
        Ok(Output {
            motors: motors.map_err(Refusal::Setpoint)?,
            tool: 0.0,
            power: Power::On,
            brake_released: true,
        })
    };
    let setpoints = played.player.setpoints();
    setpoints.chain([rest]).map(output).collect()
}
