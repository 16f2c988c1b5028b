//! Identified values in the files of the scene.

use super::{IdentifyArgs, found_friction};
use crate::failure::CliError;
use crate::patched_scene::PatchedScene;
use nalgebra::Vector2;
use trirrr_calibration::identify::{BodyGroup, Identification};
use trirrr_scene::Scene;

/// Puts what was found into copies of the scene's files. Returns the key that has the friction of the motors, too; none where the scene has no
/// place for it.
///
/// # Errors
/// Refused: a file of the scene cannot be read again.
pub(super) fn patch(
    scene: &Scene,
    args: &IdentifyArgs,
    found: &Identification,
) -> Result<(PatchedScene, Option<&'static str>), CliError> {
    let mut patched = PatchedScene::of(scene, &args.scene)?;
    let is_found = |group: BodyGroup| {
        found
            .free
            .iter()
            .any(|index| BodyGroup::of(*index) == group)
    };
    let (machine, _) = found.values.put_into(&scene.parameters);
    if is_found(BodyGroup::Platform) {
        // The file has the bare platform.
        let body = match &scene.tools {
            Some(rack) => rack.without_mounted(&machine.platform),
            None => machine.platform.at_tool_point(Vector2::zeros()),
        };
        let files = patched.at("platform");
        files.put_number("platform.mass_kg", body.mass_kg);
        files.put_number("platform.inertia_kgm2", body.inertia_kgm2);
        files.put_numbers("platform.com_m", &[body.com_m.x, body.com_m.y]);
    }
    if is_found(BodyGroup::Links) {
        let files = patched.at("machine");
        for (number, leg) in (1..).zip(&machine.legs) {
            for (name, link) in [("proximal", &leg.proximal), ("distal", &leg.distal)] {
                let values = [
                    ("mass_kg", link.mass_kg),
                    ("com_m", link.com_m),
                    ("inertia_kgm2", link.inertia_kgm2),
                ];
                files.add_table(&format!("machine.leg[{number}].links.{name}"), &values);
            }
        }
    }
    if !is_found(BodyGroup::Motors) || scene.contact.is_none() {
        return Ok((patched, None));
    }
    let [viscous, coulomb] = found_friction(found);
    let key = "contact.friction";
    let files = patched.at("contact");
    let has_table = files.has(key) || files.add_table(key, &[]);
    let is_put = has_table
        && files.put_numbers("contact.friction.viscous_nm_s_rad", &viscous)
        && files.put_numbers("contact.friction.coulomb_nm", &coulomb);
    Ok((patched, is_put.then_some(key)))
}
