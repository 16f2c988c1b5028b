//! Arguments that say what a drawing, an image or a table of poses leaves open.

use super::kind::JobKind;
use crate::arguments::factor;
use clap::Args;
use trirrr_jobs::{DrawingOptions, PenOption};
use trirrr_toolpath::drawing::PenKey;

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
    /// Drawing: fill areas with lines at this distance, mm. Areas of DXF are those inside closed outlines of a layer
    #[arg(long, value_name = "MM", requires = "machine", value_parser = factor)]
    pub hatch: Option<f64>,
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
        let given: [(bool, &str, &[JobKind]); 7] = [
            (self.speed.is_some(), "--speed", &[Drawing, Image, Table]),
            (self.power.is_some(), "--power", &[Drawing, Image]),
            (
                self.constant_power,
                "--constant-power",
                &[Drawing, Image, Table],
            ),
            (!self.pen.is_empty(), "--pen", &[Drawing]),
            (self.hatch.is_some(), "--hatch", &[Drawing]),
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

    /// Returns true for a layer that is left out.
    pub(super) fn leaves_out(&self, layer: &str) -> bool {
        self.pen.iter().any(|each| {
            each.power.is_none() && matches!(&each.key, PenKey::Layer(name) if name == layer)
        })
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
            scale: self.scale,
            fit: self.fit,
        }
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

fn part(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(value) if (0.0..=1.0).contains(&value) => Ok(value),
        _ => Err("expected a part from 0 to 1".into()),
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
