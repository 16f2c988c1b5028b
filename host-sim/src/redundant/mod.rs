//! Redundant machines: `trirrr run` and `trirrr check` for their scenes.
//!
//! A job is played in f64 by the pipeline of the machine, without a service: there is no board that such a machine could
//! have. What is written has the names and units of a 3-RRR's run.

mod check;
mod document;
mod plant;
mod play;

pub use check::check;
pub use play::run;

use crate::failure::CliError;
use crate::job_file::JobFileArgs;
use crate::terminal::say;
use std::path::Path;
use trirrr_linkage::redundant::scene::RedundantScene;
use trirrr_scene::MachineKind;

/// Returns true if `file` is the scene of a redundant machine.
pub fn is_redundant(file: &Path, args: &JobFileArgs) -> bool {
    args.machine.is_none() && MachineKind::of_file(file, &args.set.set).is_redundant()
}

/// Reads the scene in `file`, and warns of limits that it lacks.
fn read(file: &Path, args: &JobFileArgs) -> Result<RedundantScene, CliError> {
    let scene = RedundantScene::read_set(file, &args.set.set)
        .map_err(|error| CliError::Refused(error.to_string()))?;
    let limits = [
        ("rate_rad_s", &scene.limits.rate_rad_s),
        ("torque_nm", &scene.limits.torque_nm),
    ];
    let missing = limits.iter().filter(|(_, limit)| limit.is_none());
    let missing: Vec<&str> = missing.map(|(key, _)| *key).collect();
    if !missing.is_empty() {
        say(&format!(
            "warning: scene {} has no {} in [limits]: a move is accepted whatever it asks of motors and gears",
            scene.name,
            missing.join(" and no ")
        ));
    }
    Ok(scene)
}

/// Names a kind with its numbers: `prrr-2rrr, 3 legs, 1 slider`.
fn kind_text(kind: MachineKind) -> String {
    let sliders = trirrr_scene::words::counted(kind.sliders(), "slider");
    format!("{}, {} legs, {sliders}", kind.name(), kind.legs())
}

/// Names the sliders and where they are at the start: `slider 1 at -0.03 m`.
fn slider_texts(scene: &RedundantScene) -> Vec<String> {
    let legs = scene.sliders.iter().enumerate();
    legs.filter_map(|(leg, slider)| {
        let slider = (*slider)?;
        let how = match slider.is_placed {
            true => ", placed for the job",
            false => "",
        };
        let at = trirrr_scene::words::short(slider.position_m);
        Some(format!("slider {} at {at} m{how}", leg + 1))
    })
    .collect()
}

/// Describes what the placement of the sliders brought.
fn placement_text(scene: &RedundantScene) -> Option<String> {
    let placement = scene.placement.as_ref()?;
    let after = trirrr_scene::words::short(placement.after);
    let looked_at = placement.looked_at;
    Some(match placement.before {
        Some(before) => format!(
            "least distance to a singularity {after}, with the sliders in the middle of their travels {}; {looked_at} \
             placements looked at",
            trirrr_scene::words::short(before)
        ),
        None => format!(
            "least distance to a singularity {after}; with the sliders in the middle of their travels the machine does \
             not reach the job; {looked_at} placements looked at"
        ),
    })
}
