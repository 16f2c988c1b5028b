//! Arguments that several commands share.

use crate::failure::CliError;
use crate::terminal::say;
use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use std::path::Path;
use trirrr_scene::read::{Setting, text_of};
use trirrr_scene::{NumberType, Scene};

/// Scene that is run when none is named.
pub(crate) const DEFAULT_SCENE: &str = "scenes/thesis.toml";

/// Scenes that are built in, by their names: a program that is installed has no folder of scenes. The first is the default.
pub(crate) const BUILT_IN: [(&str, &str); 4] = [
    ("thesis", include_str!("../../scenes/thesis.toml")),
    ("vertical", include_str!("../../scenes/vertical.toml")),
    (
        "pick-stepper",
        include_str!("../../scenes/pick-stepper.toml"),
    ),
    ("engraving", include_str!("../../scenes/engraving.toml")),
];

/// Values in place of those of a scene.
#[derive(Args, Clone, Debug, Default)]
pub struct SetArgs {
    /// Value in place of that of the scene: limits.rate_rad_s=3, machine.leg[1].elbow=-1. May stand several times
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<Setting>,
}

impl SetArgs {
    /// Reads a scene; where there is no file of the default one, that which is built in. Every line of a refusal names the file, or the argument, already.
    ///
    /// # Errors
    /// Refused: the scene.
    pub(crate) fn scene(&self, file: &Path) -> Result<Scene, CliError> {
        let (text, name) = scene_text(file)?;
        Scene::parse_set(&text, &name, &self.set)
            .map_err(|error| CliError::Refused(error.to_string()))
    }

    /// Reads a scene whose machine is to move, and warns of limits that it lacks.
    ///
    /// # Errors
    /// As [`scene`](Self::scene).
    pub(crate) fn scene_to_move(&self, file: &Path) -> Result<Scene, CliError> {
        let scene = self.scene(file)?;
        if let Some(warning) = scene.limits_warning() {
            say(&format!("warning: {warning}"));
        }
        Ok(scene)
    }
}

/// Text of a scene and its name in messages; where there is no file of the default one, that which is built in.
///
/// # Errors
/// Refused: the file cannot be read.
pub(crate) fn scene_text(file: &Path) -> Result<(String, String), CliError> {
    if file == Path::new(DEFAULT_SCENE) && !file.exists() {
        return Ok((BUILT_IN[0].1.into(), "the scene that is built in".into()));
    }
    let text = text_of(file).map_err(|error| CliError::Refused(error.to_string()))?;
    Ok((text, file.display().to_string()))
}

/// Parser of a number type by its name.
pub(crate) fn number_type() -> impl TypedValueParser<Value = NumberType> {
    let named = |number: NumberType| PossibleValue::new(number.name()).help(help(number));
    PossibleValuesParser::new(NumberType::ALL.map(named)).try_map(|name| name.parse::<NumberType>())
}

fn help(number: NumberType) -> &'static str {
    match number {
        NumberType::F64 => "IEEE binary64",
        NumberType::F32 => "IEEE binary32",
        NumberType::Fixed => "32-bit fixed point, in units chosen for the machine and its job",
        NumberType::Micromath => "binary32 with micromath's coarse functions",
    }
}

/// Reads a positive number.
pub(crate) fn factor(text: &str) -> Result<f64, String> {
    match text.parse() {
        // Beyond these, no time is left to count or none to see.
        Ok(value) if (1e-3..=1e6).contains(&value) => Ok(value),
        _ => Err("expected a number from 0.001 to 1000000".into()),
    }
}
