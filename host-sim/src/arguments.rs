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

/// Reason to refuse an argument; a number with a comma is told as it was meant.
pub(crate) fn expected(text: &str, what: &str) -> String {
    let meant = text.replacen(',', ".", 1);
    match meant != text && meant.parse::<f64>().is_ok() {
        true => format!("expected {what}; the decimal sign is a point, not a comma: {meant}"),
        false => format!("expected {what}"),
    }
}

/// Reads a positive number.
pub(crate) fn factor(text: &str) -> Result<f64, String> {
    match text.parse() {
        // Beyond these, no time is left to count or none to see.
        Ok(value) if (1e-3..=1e6).contains(&value) => Ok(value),
        _ => Err(expected(text, "a number from 0.001 to 1000000")),
    }
}

/// Reads a distance in mm.
pub(crate) fn distance(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(value) if (0.0..=100.0).contains(&value) => Ok(value),
        _ => Err(expected(text, "a distance from 0 to 100 (mm)")),
    }
}

/// Largest length, m, speed, m/s, or acceleration that is read.
pub(crate) const LARGEST: f64 = 1e6;

/// Reads x and y, m, and an angle in degrees; returns the angle in rad.
pub(crate) fn pose_deg(text: &str) -> Result<[f64; 3], String> {
    let bounds = [LARGEST, LARGEST, 3600.0];
    let [x, y, angle] = three(text, ["X", "Y", "ANGLE"], bounds, "m, m and degrees")?;
    Ok([x, y, angle.to_radians()])
}

/// Reads x and y, m, and an angle in rad.
pub(crate) fn pose_rad(text: &str) -> Result<[f64; 3], String> {
    let bounds = [LARGEST, LARGEST, 20.0 * std::f64::consts::PI];
    three(text, ["X", "Y", "ANGLE"], bounds, "m, m and rad")
}

/// Reads three numbers with commas, each within its bound to both sides.
pub(crate) fn three(
    text: &str,
    names: [&str; 3],
    bounds: [f64; 3],
    units: &str,
) -> Result<[f64; 3], String> {
    let parts: Vec<&str> = text.split(',').collect();
    let &[one, two, last] = parts.as_slice() else {
        let given = parts.len();
        return Err(format!(
            "expected three numbers with commas, {} in {units}; found {given}",
            names.join(",")
        ));
    };
    let mut values = [0.0; 3];
    for (index, part) in [one, two, last].into_iter().enumerate() {
        let (name, bound) = (names[index], bounds[index]);
        values[index] = match part.trim().parse::<f64>() {
            // NaN is within nothing.
            Ok(value) if (-bound..=bound).contains(&value) => value,
            Ok(value) => return Err(format!("{name} = {value} is not from -{bound} to {bound}")),
            Err(_) => {
                return Err(format!(
                    "{name} = `{part}` is no number; expected {} in {units}",
                    names.join(",")
                ));
            }
        };
    }
    Ok(values)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn angles(text: &str) -> Result<[f64; 3], String> {
        three(text, ["TH1", "TH2", "TH3"], [3600.0; 3], "degrees")
    }

    #[test]
    fn three_numbers_are_read_and_anything_else_is_named() {
        assert_eq!(angles("10, -20,30.5"), Ok([10.0, -20.0, 30.5]));
        for (text, said) in [
            ("1,2", "found 2"),
            ("1,2,3,4", "found 4"),
            ("1,two,3", "TH2 = `two` is no number"),
            ("1,,3", "TH2 = `` is no number"),
            ("1,2,nan", "TH3 = NaN is not from"),
            ("inf,2,3", "TH1 = inf is not from"),
            ("4000,2,3", "TH1 = 4000 is not from -3600 to 3600"),
        ] {
            let error = angles(text).unwrap_err();
            assert!(error.contains(said), "{error}");
        }
    }
}
