//! `trirrr identify`: masses, inertias and friction of the machine that is there, from its angles and torques.

mod args;
mod document;
mod patch;

pub use args::{IdentifyArgs, MotionSource};

use crate::calibrate::{of_lines, text_file};
use crate::failure::CliError;
use crate::figures::write_torques;
use crate::results::ResultFolder;
use crate::terminal::show;
use patch::patch;
use std::path::{Path, PathBuf};
use trirrr_calibration::identify::{
    Identification, IdentificationRefusal, identify, read_telemetry,
};
use trirrr_scene::Scene;

/// Files that are written for an identification.
struct IdentifyFiles {
    files: Vec<PathBuf>,
    /// Reason for which the scene with the found values is refused, or is not written.
    refusal: Option<String>,
    /// Key of the scene that has the friction, too; none where there is none.
    friction_in: Option<&'static str>,
}

/// Identifies, writes and prints.
///
/// # Errors
/// Refused: the scene, the telemetry, or a motion that sees nothing. Failed: a file cannot be written.
pub fn command(args: &IdentifyArgs) -> Result<(), CliError> {
    let scene = args.set.scene(&args.scene)?;
    let file = &args.telemetry;
    let samples = read_telemetry(&text_file(file)?, args.columns())
        .map_err(|faults| of_lines(file, &faults))?;
    let start = scene.job.start;
    let start = [start.position.x, start.position.y, start.angle];
    let friction = known_friction(&scene);
    let found = identify(
        &scene.parameters,
        start,
        friction,
        &samples,
        &args.setup(&scene),
    );
    let found = found.map_err(|refusal| match refusal {
        IdentificationRefusal::Row(fault) => of_lines(file, &[fault]),
        other => CliError::Refused(format!("{}: {other}", file.display())),
    })?;

    let folder = match &args.out {
        Some(folder) => folder.clone(),
        None => Path::new("out").join(format!("{}-identification", scene.name)),
    };
    let mut results = ResultFolder::for_command(&folder, "identify")?;
    let mut written = IdentifyFiles {
        files: Vec::new(),
        refusal: None,
        friction_in: None,
    };
    if found.impossible.is_empty() {
        let (patched, friction_in) = patch(&scene, args, &found)?;
        written.friction_in = friction_in;
        let copies = patched.write(&mut results, &document::head(&found, args, friction_in))?;
        written.files.extend(copies.files);
        written.refusal = copies.refusal;
    } else {
        written.refusal = Some("not written: bodies that cannot be".into());
    }
    let drawn = write_torques(&mut results, &scene.name, &found.torques)?;
    written.files.push(drawn);
    let mut document = document::document(&scene, &found, &written);
    let json = format!("{:#}\n", document.json());
    written
        .files
        .push(results.write("identification.json", json)?);
    results.end(None)?;
    show(document.files(written.files), args.json)
}

/// Friction of the motors that the scene knows: viscous and Coulomb's.
fn known_friction(scene: &Scene) -> [[f64; 2]; 3] {
    let known = scene.contact.map(|contact| contact.friction);
    known.map_or([[0.0; 2]; 3], |friction| {
        [0, 1, 2].map(|motor| [friction.viscous_nm_s_rad[motor], friction.coulomb_nm[motor]])
    })
}

/// Friction that was found for the motors.
fn found_friction(found: &Identification) -> [[f64; 3]; 2] {
    let friction = found.values.friction();
    [0, 1].map(|kind| [0, 1, 2].map(|motor| friction[motor][kind]))
}
