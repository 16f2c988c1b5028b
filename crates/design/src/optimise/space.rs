//! Values that a study varies, and their bounds.

use crate::modes::MODES;
use std::fmt;
use std::str::FromStr;
use trirrr_core::machine::Elbow;
use trirrr_scene::read::Setting;

/// Keys of a scene that take one number within bounds, as `KEY[,KEY...]=LOW..HIGH`; or `mode` for the working mode,
/// as `mode` or `mode=+++,---`.
#[derive(Clone, Debug, PartialEq)]
pub enum VariedKey {
    /// One number for all keys.
    Range(SpaceRange),
    /// Working modes.
    Mode(Vec<StudyMode>),
}

/// One number for one key or several.
#[derive(Clone, Debug, PartialEq)]
pub struct SpaceRange {
    /// Paths of keys, as `--set` takes them.
    pub keys: Vec<String>,
    /// Least value.
    pub low: f64,
    /// Greatest value.
    pub high: f64,
}

/// Working mode by its elbows, such as `+-+`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StudyMode(pub [Elbow; 3]);

impl fmt::Display for StudyMode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let signs = self.0.iter().map(|elbow| match elbow {
            Elbow::Positive => '+',
            Elbow::Negative => '-',
        });
        f.write_str(&signs.collect::<String>())
    }
}

impl FromStr for StudyMode {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut modes = MODES.into_iter().map(Self);
        modes
            .find(|mode| mode.to_string() == text)
            .ok_or_else(|| format!("mode: `{text}` is no working mode, such as +-+"))
    }
}

impl fmt::Display for SpaceRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}={}..{}", self.name(), self.low, self.high)
    }
}

impl fmt::Display for VariedKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Range(range) => range.fmt(f),
            Self::Mode(modes) => {
                let names: Vec<_> = modes.iter().map(StudyMode::to_string).collect();
                write!(f, "mode={}", names.join(","))
            }
        }
    }
}

impl SpaceRange {
    /// The keys, with commas between them.
    pub fn name(&self) -> String {
        self.keys.join(",")
    }

    /// Value at a part of the way from `low` to `high`: six digits, so that a file shows what was looked at.
    pub fn at(&self, part: f64) -> f64 {
        let exact = self.low + part.clamp(0.0, 1.0) * (self.high - self.low);
        let rounded = format!("{exact:.5e}").parse().unwrap_or(exact);
        f64::clamp(rounded, self.low, self.high)
    }

    /// Part of the way from `low` to `high` at which `value` is, within the bounds.
    pub fn part_of(&self, value: f64) -> f64 {
        ((value - self.low) / (self.high - self.low)).clamp(0.0, 1.0)
    }

    /// Settings of a scene that give all keys `value`.
    pub fn settings(&self, value: f64) -> Vec<Setting> {
        let set = |key: &String| format!("{key}={value:?}").parse().ok();
        self.keys.iter().filter_map(set).collect()
    }
}

fn range(text: &str) -> Result<SpaceRange, String> {
    let (keys, bounds) = text
        .split_once('=')
        .ok_or("expected KEY=LOW..HIGH, such as machine.leg[*].distal_m=0.2..0.4, or mode")?;
    let keys: Vec<String> = keys.split(',').map(|key| key.trim().to_owned()).collect();
    for key in &keys {
        let checked = format!("{key}=0").parse::<Setting>();
        checked.map_err(|reason| format!("`{key}`: {reason}"))?;
    }
    let name = keys.join(",");
    let (low, high) = bounds
        .split_once("..")
        .ok_or_else(|| format!("{name}: `{bounds}` is no LOW..HIGH"))?;
    let number = |name_of: &str, text: &str| match text.trim().parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(format!(
            "{name}: {name_of} = `{}` is no finite number",
            text.trim()
        )),
    };
    let (low, high) = (number("LOW", low)?, number("HIGH", high)?);
    match low < high {
        true => Ok(SpaceRange { keys, low, high }),
        false => Err(format!(
            "{name}: LOW = {low} must be less than HIGH = {high}"
        )),
    }
}

fn modes(text: &str) -> Result<Vec<StudyMode>, String> {
    let mut modes: Vec<StudyMode> = Vec::new();
    for name in text.split(',') {
        let mode: StudyMode = name.trim().parse()?;
        if modes.contains(&mode) {
            return Err(format!("mode: {mode} stands twice"));
        }
        modes.push(mode);
    }
    Ok(modes)
}

impl FromStr for VariedKey {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.split_once('=') {
            None if text.trim() == "mode" => Ok(Self::Mode(MODES.map(StudyMode).into())),
            Some((key, names)) if key.trim() == "mode" => Ok(Self::Mode(modes(names)?)),
            _ => Ok(Self::Range(range(text)?)),
        }
    }
}

/// All values that a study varies.
#[derive(Clone, Debug, PartialEq)]
pub struct DesignSpace {
    /// Numbers.
    pub ranges: Vec<SpaceRange>,
    /// Working modes; empty: that of the scene alone.
    pub modes: Vec<StudyMode>,
}

/// Place in a [`DesignSpace`].
#[derive(Clone, Debug, PartialEq)]
pub struct DesignPoint {
    /// Working mode; none: that of the scene.
    pub mode: Option<StudyMode>,
    /// A value for each range.
    pub values: Vec<f64>,
}

impl DesignSpace {
    /// Puts the keys together.
    ///
    /// # Errors
    /// A key that stands twice.
    pub fn of(varied: &[VariedKey]) -> Result<Self, String> {
        let mut space = Self {
            ranges: Vec::new(),
            modes: Vec::new(),
        };
        for each in varied {
            match each {
                VariedKey::Mode(modes) if space.modes.is_empty() => space.modes.clone_from(modes),
                VariedKey::Mode(_) => return Err("mode: stands twice in --vary".into()),
                VariedKey::Range(range) => space.ranges.push(range.clone()),
            }
        }
        let keys: Vec<&String> = space.ranges.iter().flat_map(|range| &range.keys).collect();
        for (index, key) in keys.iter().enumerate() {
            if keys[..index].contains(key) {
                return Err(format!("{key}: stands twice in --vary"));
            }
        }
        Ok(space)
    }

    /// The keys as they are given on the command line.
    pub fn names(&self) -> Vec<String> {
        let mode = (!self.modes.is_empty()).then(|| VariedKey::Mode(self.modes.clone()));
        let ranges = self.ranges.iter().map(SpaceRange::to_string);
        ranges.chain(mode.map(|mode| mode.to_string())).collect()
    }

    /// Point at parts of the way from the least values to the greatest.
    pub fn point(&self, mode: Option<StudyMode>, parts: &[f64]) -> DesignPoint {
        let values = self.ranges.iter().zip(parts);
        DesignPoint {
            mode,
            values: values.map(|(range, part)| range.at(*part)).collect(),
        }
    }

    /// Parts of the way from the least values to the greatest.
    pub fn parts(&self, values: &[f64]) -> Vec<f64> {
        let ranges = self.ranges.iter().zip(values);
        ranges.map(|(range, value)| range.part_of(*value)).collect()
    }

    /// Settings of a scene that make a candidate.
    pub fn settings(&self, point: &DesignPoint) -> Vec<Setting> {
        let mut settings = Vec::new();
        for (range, value) in self.ranges.iter().zip(&point.values) {
            settings.extend(range.settings(*value));
        }
        let signs = point.mode.map(|mode| mode.0.map(Elbow::sign));
        for (leg, sign) in signs.into_iter().flatten().enumerate() {
            settings.extend(format!("machine.leg[{}].elbow={sign}", leg + 1).parse());
        }
        settings
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_has_bounds_and_several_keys_share_one_number() {
        let varied: VariedKey = "machine.leg[1].distal_m, machine.leg[2].distal_m=-0.2..4e-1"
            .parse()
            .unwrap();
        let VariedKey::Range(range) = &varied else {
            panic!("a mode");
        };
        assert_eq!((range.keys.len(), range.low, range.high), (2, -0.2, 0.4));
        assert_eq!(range.settings(0.25).len(), 2);
        assert_eq!(range.at(0.5), 0.1);
        assert_eq!([-1.0, 2.0].map(|part| range.at(part)), [-0.2, 0.4]);
        assert!((range.part_of(0.1) - 0.5).abs() < 1e-15);
        let names = varied.to_string();
        assert_eq!(names.parse::<VariedKey>().as_ref(), Ok(&varied));
        let VariedKey::Mode(modes) = "mode".parse().unwrap() else {
            panic!("a range");
        };
        assert_eq!(modes.len(), 8);
        assert_eq!(
            "mode=+-+,---".parse::<VariedKey>().unwrap().to_string(),
            "mode=+-+,---"
        );
    }

    #[test]
    fn wrong_bounds_are_refused_with_key_and_reason() {
        for (text, parts) in [
            ("platform.mass_kg", ["KEY=LOW..HIGH", "mode"]),
            ("a=2..1", ["a: LOW = 2", "less than HIGH = 1"]),
            ("a=1..1", ["a: LOW", "less than"]),
            ("a=x..1", ["a: LOW = `x`", "number"]),
            ("a=1..nan", ["a: HIGH = `nan`", "finite"]),
            ("a=1..inf", ["a: HIGH", "finite"]),
            ("a=1", ["a: `1`", "LOW..HIGH"]),
            ("a[0]=1..2", ["`a[0]`", "counted from 1"]),
            ("a,,b=1..2", ["``", "path"]),
            ("mode=++", ["mode: `++`", "+-+"]),
            ("mode=+++,+++", ["mode: +++", "twice"]),
        ] {
            let reason = text.parse::<VariedKey>().expect_err(text);
            for part in parts {
                assert!(reason.contains(part), "{part:?} of {text} in {reason}");
            }
        }
        let twice = ["a=1..2", "b,a=0..1"].map(|text| text.parse().unwrap());
        assert!(DesignSpace::of(&twice).unwrap_err().contains("a: stands"));
        let twice = ["mode", "mode=+++"].map(|text| text.parse().unwrap());
        assert!(DesignSpace::of(&twice).is_err());
    }
}
