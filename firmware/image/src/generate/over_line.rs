//! Types that a scene needs of an image, and its values for an image that has them.

use super::drive::{DriveError, drive, kind};
use super::{COARSE, FIXED, SCALARS, of_scene, tool, units};
use std::error::Error;
use trirrr_core::number::{Coarse, Fixed};
use trirrr_protocol::message::{SceneNeed, SceneTypes};
use trirrr_scene::{Drive, DriveKind, Scene, Stepper, values};
use trirrr_service::coefficients::{SceneValues, needs_of_model};
use trirrr_service::key;

/// Scene for a board that takes one over its line.
#[derive(Clone, Debug, PartialEq)]
pub struct BoardScene {
    /// Types that it needs of the image.
    pub types: SceneTypes,
    /// Everything else.
    pub values: SceneValues,
}

impl BoardScene {
    /// The scene in the number type that its own image would have.
    ///
    /// # Errors
    /// What no image is built for: a quantity outside the range of the number type, drives that no board has.
    pub fn of(scene: &Scene) -> Result<Self, Box<dyn Error>> {
        let own = of_scene(scene.number);
        let named = SCALARS.iter().find(|(name, _)| *name == own);
        let (_, scalar) = named.ok_or("no image is built for the number type of the scene")?;
        let units = units(scene, scalar)?;
        let values = match *scalar {
            FIXED => values::<Fixed>(scene, &units),
            COARSE => values::<Coarse>(scene, &units),
            _ => values::<f32>(scene, &units),
        };
        Ok(Self {
            types: types(scene, scalar)?,
            values: values?,
        })
    }
}

/// Types and constants of an image of `scene`, for the Rust type `scalar`.
///
/// # Errors
/// A quantity outside the range of the number type, drives that no board has.
pub(super) fn types(scene: &Scene, scalar: &str) -> Result<SceneTypes, Box<dyn Error>> {
    let has_jerk = scene.limits.jerk_rad_s3.is_some();
    let mut room: Vec<SceneNeed> = needs_of_model(scene.model()).collect();
    for (is_needed, need) in [
        (has_jerk || scene.plays_quintics(), SceneNeed::Quintics),
        (has_jerk, SceneNeed::Jerk),
        (scene.service.plans_paths, SceneNeed::Paths),
        (scene.takes_batches(), SceneNeed::Batches),
    ] {
        if is_needed {
            room.push(need);
        }
    }
    let retreats = scene.contact.map(|contact| contact.retreat_s > 0.0);
    let homing = scene.homing.map(|it| (it.contact, it.active_high));
    let keys = [
        scalar.to_owned(),
        format!("{:?}", scene.tick_rate_hz),
        drives(scene, scalar)?,
        scene.power.has_brake.to_string(),
        tool::tool(scene),
        format!("{:?} {:?}", scene.inputs, scene.spare_pins),
        scene.has_lamp.to_string(),
        format!("{homing:?}"),
        scene.feedback.is_some().to_string(),
        format!("{retreats:?}"),
    ];
    let keys = keys.map(|text| key(text.as_bytes()));
    Ok(SceneTypes::with_room(
        &room,
        scene.service.power_lists,
        keys,
    ))
}

/// Constants of the drives but those that are values: the steps of steppers.
fn drives(scene: &Scene, scalar: &str) -> Result<String, Box<dyn Error>> {
    // Of this scene, to refuse what no board does.
    let units = units(scene, scalar)?;
    drive(scene, &units)?;
    let without_steps = |drive: Drive| match drive.kind {
        DriveKind::Stepper(stepper) => Drive {
            kind: DriveKind::Stepper(Stepper {
                steps_per_rev: 1,
                microsteps: 1,
                ..stepper
            }),
            gear_ratio: 1.0,
            reversed: false,
            ..drive
        },
        DriveKind::Bldc(_) | DriveKind::Can(_) => drive,
    };
    let scene = Scene {
        drives: scene.drives.map(|drives| drives.map(without_steps)),
        ..scene.clone()
    };
    let constants: Result<String, DriveError> = drive(&scene, &units);
    Ok(format!("{} {}", kind(&scene), constants?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;
    use trirrr_service::Settings;

    fn shipped(name: &str) -> Scene {
        let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
        Scene::read(scenes.join(name)).expect("a shipped scene is good")
    }

    fn lacks(image: &Scene, scene: &Scene) -> Vec<SceneNeed> {
        let of = |scene| BoardScene::of(scene).expect("a scene for a board").types;
        of(image).lacks(&of(scene)).iter().collect()
    }

    #[test]
    fn a_scene_lacks_nothing_for_itself_and_a_leaner_machine_nothing_for_a_richer() {
        let (thesis, vertical) = (shipped("thesis.toml"), shipped("vertical.toml"));
        assert_eq!(lacks(&thesis, &thesis), []);
        assert_eq!(lacks(&vertical, &vertical), []);
        use SceneNeed::{Gravity, LinkMasses, Rotors};
        let rich = lacks(&thesis, &vertical);
        for need in [Rotors, LinkMasses, Gravity] {
            assert!(rich.contains(&need), "{rich:?}");
        }
        let model_alone = Scene {
            parameters: thesis.parameters,
            ..vertical.clone()
        };
        assert_eq!(lacks(&vertical, &model_alone), []);
    }

    #[test]
    fn steps_of_steppers_are_values_and_their_rate_is_not() {
        let image = shipped("pick-stepper.toml");
        let mut drives = image.drives.expect("steppers");
        drives[1].gear_ratio *= 2.0;
        drives[2].reversed = !drives[2].reversed;
        let scene = |drives| Scene {
            drives: Some(drives),
            ..image.clone()
        };
        let geared = scene(drives);
        assert_eq!(lacks(&image, &geared), []);
        let values = BoardScene::of(&geared).expect("a scene for a board").values;
        let steppers = values.steppers.expect("steppers");
        assert_eq!(steppers[1].gear_ratio, drives[1].gear_ratio);
        assert_eq!(steppers[2].reversed, drives[2].reversed);
        for drive in &mut drives {
            if let DriveKind::Stepper(stepper) = &mut drive.kind {
                stepper.step_rate_limit_hz = stepper.step_rate_limit_hz.map(|limit| limit / 2.0);
            }
        }
        assert_eq!(lacks(&image, &scene(drives)), [SceneNeed::Drives]);
    }

    #[test]
    fn what_is_wired_and_what_is_timed_is_named() {
        let image = shipped("thesis.toml");
        let other = Scene {
            tick_rate_hz: 2.0 * image.tick_rate_hz,
            has_lamp: true,
            number: trirrr_scene::NumberType::Fixed,
            ..image.clone()
        };
        use SceneNeed::{Lamp, Number, TickRate};
        assert_eq!(lacks(&image, &other), [Number, TickRate, Lamp]);
        let inputs = lacks(&image, &shipped("inputs/guarded.toml"));
        for need in [SceneNeed::Inputs, SceneNeed::Drives] {
            assert!(inputs.contains(&need), "{inputs:?}");
        }
    }

    /// Machine, limits, start and settings from the values are those that an image has as constants.
    #[test]
    fn the_values_give_what_the_image_of_the_scene_has_as_constants() {
        for name in [
            "thesis.toml",
            "vertical.toml",
            "pick-stepper.toml",
            "paths/raster.toml",
        ] {
            let scene = Scene {
                number: trirrr_scene::NumberType::F32,
                ..shipped(name)
            };
            let values = BoardScene::of(&scene).expect("a scene for a board").values;
            let units = units(&scene, "f32").expect("SI");
            assert_eq!(
                values.parameters(),
                units.parameters(&scene.parameters),
                "{name}"
            );
            assert_eq!(values.limits(), units.limits(&scene.limits), "{name}");
            let own: Settings<f32> = trirrr_scene::settings(&scene, &units);
            // As in the image of another scene at the same rate.
            let image = Settings {
                ramp: trirrr_service::paces::Ramp::fixed(1),
                host_timeout_ticks: 1,
                telemetry_every: 9,
                planning: None,
                scene: trirrr_service::SceneIdentity {
                    key: 1,
                    name: trirrr_service::name("image"),
                    ..own.scene
                },
                ..own
            };
            assert_eq!(values.settings(&image), own, "{name}");
            let start = scene.job.start;
            let start = trirrr_core::setpoint::Pose::<f32>::from_f64(
                start.position.x,
                start.position.y,
                start.angle,
            );
            assert_eq!(values.start::<f32>(), start, "{name}");
        }
    }

    #[test]
    fn the_values_of_fixed_point_are_in_the_units_of_the_scene() {
        let scene = Scene {
            number: trirrr_scene::NumberType::Fixed,
            ..shipped("thesis.toml")
        };
        let values = BoardScene::of(&scene).expect("a scene for a board").values;
        let units = units(&scene, FIXED).expect("a scene within the range");
        assert_ne!(units, trirrr_core::units::Units::SI);
        assert_eq!(values.parameters(), units.parameters(&scene.parameters));
        let own: Settings<Fixed> = trirrr_scene::settings(&scene, &units);
        assert_eq!(values.settings(&own), own);
        let start = units.pose(&scene.job.start);
        let start = trirrr_core::setpoint::Pose::<Fixed>::from_f64(
            start.position.x,
            start.position.y,
            start.angle,
        );
        assert_eq!(values.start::<Fixed>(), start);
    }
}
