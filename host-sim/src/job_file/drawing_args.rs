//! Arguments that say what a drawing, an image or a table of poses leaves open.

use super::kind::JobKind;
use crate::arguments::{distance, expected, factor};
use clap::{Args, ValueEnum};
use trirrr_jobs::{DrawingOptions, PenOption};
#[cfg(feature = "full")]
use trirrr_toolpath::drawing::DxfChoices;
use trirrr_toolpath::drawing::{Kerf, PenKey};

/// Feed, pens and place of a drawing; feed and place of an image; feed of a table.
#[derive(Args, Clone, Debug, Default)]
pub struct DrawingArgs {
    /// Drawing, image: speed along strokes or rows, mm/min, which it needs. Table: speed of the rows without one
    #[arg(long, value_name = "MM_PER_MIN", requires = "machine", value_parser = factor)]
    pub speed: Option<f64>,
    /// Drawing, image: power of the tool along strokes or at the full tone, 0 to 1 [default: 1]
    #[arg(long, value_name = "PART", requires = "machine", value_parser = part)]
    pub power: Option<f64>,
    /// Drawing, image, table: the power is the same at every speed. Without it the power is in proportion to the true speed
    #[arg(long, requires = "machine")]
    pub constant_power: bool,
    /// Drawing: power, and feed in mm/min, of the strokes of a colour or a layer; `off`: they are left out. For each once
    #[arg(long, value_name = "#RRGGBB|LAYER=POWER[@FEED]|off", requires = "machine", value_parser = pen)]
    pub pen: Vec<PenArg>,
    /// DXF: leave out entities of these kinds, without a word: text, dimension, hatch, point, or any other name in the file
    #[arg(long, value_name = "KIND,..", requires = "machine", value_delimiter = ',', value_parser = entity)]
    pub leave_out: Vec<String>,
    /// DXF: unit of its numbers, in place of the one that the file names
    #[arg(long, value_name = "UNIT", requires = "machine", value_enum)]
    pub unit: Option<UnitArg>,
    /// Drawing: leave out lines and curves that lie on others of their layer and colour
    #[arg(long, requires = "machine")]
    pub drop_doubles: bool,
    /// Drawing: fill areas with lines at this distance, mm. Areas of DXF are those inside closed outlines of a layer
    #[arg(long, value_name = "MM", requires = "machine", value_parser = factor)]
    pub hatch: Option<f64>,
    /// Drawing: distance of the tool from closed outlines, mm: outward, at holes inward; negative: into the part
    #[arg(long, value_name = "MM", requires = "machine", value_parser = offset, allow_hyphen_values = true)]
    pub offset: Option<f64>,
    /// Drawing: length of a way with the tool on, before and behind each closed outline, on the side of the waste, mm
    #[arg(long, value_name = "MM", requires = "machine", value_parser = distance)]
    pub lead: Option<f64>,
    /// Drawing, image: length on the machine of a length 1 in the drawing [default: 1]
    #[arg(long, value_name = "FACTOR", requires = "machine", value_parser = factor)]
    pub scale: Option<f64>,
    /// Drawing, image: put it where the machine has the most room for its shape, and make it smaller where it does not fit
    #[arg(long, requires = "machine", conflicts_with = "origin")]
    pub fit: bool,
}

impl DrawingArgs {
    /// Arguments that are given, each with the kinds of files that it is for.
    pub(super) fn given(&self) -> impl Iterator<Item = (&'static str, &'static [JobKind])> {
        use JobKind::{Drawing, Image, Table};
        let given: [(bool, &str, &[JobKind]); 12] = [
            (self.speed.is_some(), "--speed", &[Drawing, Image, Table]),
            (self.power.is_some(), "--power", &[Drawing, Image]),
            (
                self.constant_power,
                "--constant-power",
                &[Drawing, Image, Table],
            ),
            (!self.pen.is_empty(), "--pen", &[Drawing]),
            (!self.leave_out.is_empty(), "--leave-out", &[Drawing]),
            (self.unit.is_some(), "--unit", &[Drawing]),
            (self.drop_doubles, "--drop-doubles", &[Drawing]),
            (self.hatch.is_some(), "--hatch", &[Drawing]),
            (self.offset.is_some(), "--offset", &[Drawing]),
            (self.lead.is_some(), "--lead", &[Drawing]),
            (self.scale.is_some(), "--scale", &[Drawing, Image]),
            (self.fit, "--fit", &[Drawing, Image]),
        ];
        given
            .into_iter()
            .filter_map(|(is_given, name, kinds)| is_given.then_some((name, kinds)))
    }

    /// Speed of a drawing or a table, m/s.
    pub(super) fn speed_m_s(&self) -> Option<f64> {
        self.speed.map(metres_per_second)
    }

    /// Choices for a DXF file.
    #[cfg(feature = "full")]
    pub(super) fn dxf_choices(&self) -> DxfChoices {
        let layers = self
            .pen
            .iter()
            .filter_map(|each| match (&each.key, each.power) {
                (PenKey::Layer(name), None) => Some(name.clone()),
                _ => None,
            });
        DxfChoices {
            layers: layers.collect(),
            kinds: self.leave_out.clone(),
            unit_m: self.unit.map(UnitArg::metres),
        }
    }

    /// First argument that is given and is for DXF alone.
    #[cfg(feature = "full")]
    pub(super) fn for_dxf(&self) -> Option<&'static str> {
        let given = [
            (!self.leave_out.is_empty(), "--leave-out"),
            (self.unit.is_some(), "--unit"),
        ];
        let first = given.into_iter().find(|(is_given, _)| *is_given);
        first.map(|(_, name)| name)
    }

    /// The options that the arguments give, in SI units.
    pub(super) fn options(&self) -> DrawingOptions {
        let pens = self.pen.iter().map(|each| PenOption {
            key: each.key.clone(),
            power: each.power,
            speed_m_s: each.feed.map(metres_per_second),
        });
        DrawingOptions {
            speed_m_s: self.speed_m_s(),
            power: self.power,
            constant_power: self.constant_power,
            pens: pens.collect(),
            hatch_m: self.hatch.map(|pitch_mm| 1e-3 * pitch_mm),
            kerf: (self.offset.is_some() || self.lead.is_some()).then(|| Kerf {
                offset_m: 1e-3 * self.offset.unwrap_or(0.0),
                lead_m: 1e-3 * self.lead.unwrap_or(0.0),
            }),
            scale: self.scale,
            fit: self.fit,
            drop_doubles: self.drop_doubles,
        }
    }
}

/// Unit of a drawing's numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum UnitArg {
    /// Micrometres.
    Um,
    /// Millimetres.
    Mm,
    /// Centimetres.
    Cm,
    /// Metres.
    M,
    /// Thousandths of an inch.
    Mil,
    /// Inches.
    #[value(alias = "in")]
    Inch,
    /// Feet.
    #[value(alias = "foot")]
    Ft,
}

impl UnitArg {
    /// Length of the unit, m.
    #[cfg(feature = "full")]
    fn metres(self) -> f64 {
        match self {
            Self::Um => 1e-6,
            Self::Mm => 1e-3,
            Self::Cm => 1e-2,
            Self::M => 1.0,
            Self::Mil => 2.54e-5,
            Self::Inch => 0.0254,
            Self::Ft => 0.3048,
        }
    }
}

fn entity(text: &str) -> Result<String, String> {
    match text.trim() {
        name if !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_') => {
            Ok(name.to_owned())
        }
        _ => Err("expected names of entities with commas between, as text,dimension".into()),
    }
}

fn metres_per_second(mm_per_min: f64) -> f64 {
    1e-3 * mm_per_min / 60.0
}

/// Pen of a colour or a layer.
#[derive(Clone, Debug, PartialEq)]
pub struct PenArg {
    /// The strokes.
    pub key: PenKey,
    /// Power, 0 to 1. None: the strokes are left out.
    pub power: Option<f64>,
    /// Speed along the strokes, mm/min. None: that of all strokes.
    pub feed: Option<f64>,
}

fn offset(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(value) if (-100.0..=100.0).contains(&value) => Ok(value),
        _ => Err("expected a distance from -100 to 100 (mm)".into()),
    }
}

fn part(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(value) if (0.0..=1.0).contains(&value) => Ok(value),
        _ => Err(expected(text, "a part from 0 to 1")),
    }
}

fn pen(text: &str) -> Result<PenArg, String> {
    // The name of a layer may have a sign of equality itself.
    let (key, work) = text
        .rsplit_once('=')
        .filter(|(key, _)| !key.is_empty())
        .ok_or("expected a colour or a layer, = and a power, as #ff0000=0.5")?;
    let (power, feed) = match work.split_once('@') {
        None if work == "off" => (None, None),
        None => (Some(part(work)?), None),
        Some((power, feed)) => (Some(part(power)?), Some(factor(feed)?)),
    };
    Ok(PenArg {
        key: pen_key(key)?,
        power,
        feed,
    })
}

fn pen_key(text: &str) -> Result<PenKey, String> {
    let Some(digits) = text.strip_prefix('#') else {
        return Ok(PenKey::Layer(text.to_owned()));
    };
    let is_colour = digits.len() == 6 && digits.bytes().all(|byte| byte.is_ascii_hexdigit());
    match u32::from_str_radix(digits, 16) {
        Ok(value) if is_colour => {
            let [_, red, green, blue] = value.to_be_bytes();
            Ok(PenKey::Colour([red, green, blue]))
        }
        _ => Err(format!(
            "{text:?} is no colour; one has six digits, as #ff0000"
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pen_is_a_colour_or_a_layer_a_power_and_a_feed() {
        let of = |key, power, feed| PenArg { key, power, feed };
        let orange = || PenKey::Colour([255, 128, 0]);
        let layer = |name: &str| PenKey::Layer(name.into());
        assert_eq!(pen("#ff8000=0.5"), Ok(of(orange(), Some(0.5), None)));
        assert_eq!(
            pen("#FF8000=1@1500"),
            Ok(of(orange(), Some(1.0), Some(1500.0)))
        );
        assert_eq!(pen("#ff8000=off"), Ok(of(orange(), None, None)));
        assert_eq!(
            pen("cut 1=0.5@9"),
            Ok(of(layer("cut 1"), Some(0.5), Some(9.0)))
        );
        assert_eq!(pen("a=b=off"), Ok(of(layer("a=b"), None, None)));
        for wrong in [
            "",
            "=1",
            "#ff8000",
            "red",
            "#ff800=1",
            "#+f8000=1",
            "#ff8000=2",
            "cut=2",
            "#ff8000=1@0",
            "#ff8000=off@9",
        ] {
            assert!(pen(wrong).is_err(), "{wrong}");
        }
    }
}
