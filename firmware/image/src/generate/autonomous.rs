//! Job of an image without a host, as constants.

use super::constant::constant;
use super::kinds::{Machine, TickOf};
use super::source::File;
use std::error::Error;
use trirrr_core::limits::Limits;
use trirrr_core::machine::Geometry;
use trirrr_core::setpoint::Pose;
use trirrr_scene::{Autonomous, Scene};
use trirrr_service::ServiceNumber;
use trirrr_service::board::Recover;
use trirrr_service::coefficients::HomingCoefficients;

/// Writes what the tick plays by itself: its coefficients, the moves that were admitted in the number type `N`, the way from homing.
///
/// # Errors
/// A move that is not admitted; a start out of reach.
pub(super) fn write<N: ServiceNumber>(
    file: &mut File,
    scene: &Scene,
    own: &Autonomous,
    machine: Machine,
) -> Result<(), Box<dyn Error>> {
    let units = trirrr_scene::units::<N>(scene)?;
    let settings = trirrr_scene::settings::<N>(scene, &units);
    let tick = machine.kind.visit::<N, _>(TickOf(machine))?;
    file.global("TICK", "trirrr_core::tick::Tick<Model>", tick);
    let limits = Limits::<N>::build(machine.limits)?;
    file.global(
        "RESULT_LIMITS",
        "trirrr_core::limits::Limits<Scalar>",
        constant(&limits),
    );
    let moves = scene.own_moves::<N>()?;
    let count = moves.len();
    let moves: Vec<String> = moves.iter().map(constant).collect();
    file.global(
        "OWN_MOVES",
        &format!("[trirrr_service::board::QueuedMove<Scalar, Curves>; {count}]"),
        format!("[{}]", moves.join(",\n")),
    );
    file.constant("PASSES", "u32", own.passes.to_string());
    file.constant(
        "BEGINS",
        "trirrr_service::features::JobStart",
        constant(&own.begins),
    );
    file.constant("PACED", "bool", scene.may_slow_down().to_string());
    file.constant(
        "BUTTON",
        "Option<trirrr_service::features::ButtonInput>",
        constant(&scene.inputs.button),
    );
    let interlocks = constant(&scene.inputs.interlocks);
    file.constant(
        "INTERLOCKS",
        "trirrr_service::features::InterlockParameters",
        interlocks,
    );
    let geometry = Geometry::<N>::build(machine.parameters)?;
    let start = scene.job.in_units(&units).start;
    let start = Pose::<N>::from_f64(start.position.x, start.position.y, start.angle);
    let position = geometry.position(&start);
    let position = position.map_err(|status| format!("the start is out of reach: {status}"))?;
    let angles = geometry.motor_angles(&position);
    file.constant(
        "START_ANGLES",
        "[<Scalar as trirrr_core::number::Arithmetic>::Angle; 3]",
        constant(&angles),
    );
    let homing_type = "Option<(&trirrr_service::coefficients::HomingCoefficients<Scalar>, &trirrr_service::board::Recover<Scalar>)>";
    let Some(homing) = &scene.homing else {
        file.constant("OWN_HOMING", homing_type, "None".into());
        return Ok(());
    };
    let parameters = homing.parameters(scene, &units)?;
    let coefficients = HomingCoefficients::<N>::build(&parameters, machine.period);
    let way = Recover::from_homing(&coefficients, &geometry, settings.period)?;
    file.global(
        "FROM_HOMING",
        "trirrr_service::board::Recover<Scalar>",
        constant(&way),
    );
    file.constant(
        "OWN_HOMING",
        homing_type,
        "Some((&HOMING, &FROM_HOMING))".into(),
    );
    Ok(())
}
