//! Numbers with units, and transforms.

use kurbo::{Affine, Vec2};

/// Font size where none is given, px.
pub(super) const FONT_PX: f64 = 16.0;

/// Axis along which a percentage counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PartAxis {
    X,
    Y,
    /// Neither: of the diagonal, by the square root of 2.
    Both,
}

/// Lengths that units count by: sides of the viewport, and size of the font.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct UnitFrame {
    pub(super) view: [f64; 2],
    pub(super) font_px: f64,
}

impl UnitFrame {
    fn whole(&self, axis: PartAxis) -> f64 {
        let [x, y] = self.view;
        match axis {
            PartAxis::X => x,
            PartAxis::Y => y,
            PartAxis::Both => libm::hypot(x, y) / std::f64::consts::SQRT_2,
        }
    }

    /// Length in user units. None: no length, or one in another unit.
    pub(super) fn length(&self, text: &str, axis: PartAxis) -> Option<f64> {
        let (number, unit) = number(text.trim())?;
        Some(number * self.unit(unit, axis)?)
    }

    fn unit(&self, unit: &str, axis: PartAxis) -> Option<f64> {
        Some(match unit.to_ascii_lowercase().as_str() {
            "" | "px" => 1.0,
            "in" => 96.0,
            "cm" => 96.0 / 2.54,
            "mm" => 96.0 / 25.4,
            "q" => 96.0 / 101.6,
            "pt" => 96.0 / 72.0,
            "pc" => 16.0,
            "em" => self.font_px,
            "ex" | "ch" => 0.5 * self.font_px,
            "%" => 0.01 * self.whole(axis),
            _ => return None,
        })
    }

    /// Lengths of a list.
    pub(super) fn lengths(&self, text: &str, axis: PartAxis) -> Option<Vec<f64>> {
        let words = text.split([' ', ',', '\t', '\n', '\r']);
        let words = words.filter(|word| !word.is_empty());
        words.map(|word| self.length(word, axis)).collect()
    }

    /// Map of a `transform`. As style, lengths and angles have units.
    pub(super) fn transform(&self, text: &str, is_style: bool) -> Option<Affine> {
        let mut rest = text.trim();
        let mut map = Affine::IDENTITY;
        if rest == "none" {
            return Some(map);
        }
        while !rest.is_empty() {
            let (name, behind) = rest.split_once('(')?;
            let (values, behind) = behind.split_once(')')?;
            map *= self.function(name.trim(), values, is_style)?;
            rest = behind.trim_start_matches([' ', ',', '\t', '\n', '\r']);
        }
        let finite = map.as_coeffs().iter().all(|value| value.is_finite());
        finite.then_some(map)
    }

    fn function(&self, name: &str, values: &str, is_style: bool) -> Option<Affine> {
        let mut list = Vec::new();
        let mut rest = values.trim();
        while !rest.is_empty() {
            let (value, behind) = number(rest)?;
            let end = behind
                .find(|c: char| !(c.is_ascii_alphabetic() || c == '%'))
                .unwrap_or(behind.len());
            list.push((value, &behind[..end]));
            rest = behind[end..].trim_start();
            rest = rest.strip_prefix(',').map_or(rest, str::trim_start);
        }
        let plain = |index: usize| match list[index] {
            (value, "") => Some(value),
            _ => None,
        };
        let has_unit =
            |index: usize| !is_style || list[index].0 == 0.0 || !list[index].1.is_empty();
        let length = |index: usize, axis| {
            let (value, unit) = list[index];
            has_unit(index).then_some(value * self.unit(unit, axis)?)
        };
        let angle = |index: usize| angle(list[index]).filter(|_| has_unit(index));
        let factor = |index: usize| match list[index] {
            (value, "%") => Some(0.01 * value),
            _ => plain(index),
        };
        Some(match (name, list.len()) {
            ("matrix", 6) => {
                let values: Option<Vec<f64>> = (0..6).map(plain).collect();
                Affine::new(values?.try_into().ok()?)
            }
            ("translate", 1) | ("translateX", 1) => {
                Affine::translate((length(0, PartAxis::X)?, 0.0))
            }
            ("translate", 2) => {
                Affine::translate((length(0, PartAxis::X)?, length(1, PartAxis::Y)?))
            }
            ("translateY", 1) => Affine::translate((0.0, length(0, PartAxis::Y)?)),
            ("rotate" | "rotateZ", 1) => turn(angle(0)?),
            ("rotate", 3) if !is_style => {
                let centre = Vec2::new(plain(1)?, plain(2)?);
                Affine::translate(centre) * turn(angle(0)?) * Affine::translate(-centre)
            }
            ("scale", 1) => Affine::scale(factor(0)?),
            ("scale", 2) => Affine::scale_non_uniform(factor(0)?, factor(1)?),
            ("scaleX", 1) => Affine::scale_non_uniform(factor(0)?, 1.0),
            ("scaleY", 1) => Affine::scale_non_uniform(1.0, factor(0)?),
            ("skewX" | "skew", 1) => Affine::skew(libm::tan(angle(0)?), 0.0),
            ("skewY", 1) => Affine::skew(0.0, libm::tan(angle(0)?)),
            ("skew", 2) => Affine::skew(libm::tan(angle(0)?), libm::tan(angle(1)?)),
            _ => return None,
        })
    }

    /// Point of a `transform-origin` in a box: its corner, and its sides.
    pub(super) fn origin(&self, text: &str, corner: [f64; 2], sides: [f64; 2]) -> Option<[f64; 2]> {
        let words: Vec<&str> = text.split_whitespace().collect();
        let in_box = UnitFrame {
            view: sides,
            ..*self
        };
        let place = |word: &str, axis: PartAxis| {
            let part = match (word, axis) {
                ("center", _) => "50%",
                ("left", PartAxis::X) | ("top", PartAxis::Y) => "0%",
                ("right", PartAxis::X) | ("bottom", PartAxis::Y) => "100%",
                _ => word,
            };
            in_box.length(part, axis)
        };
        let [x, y] = match words[..] {
            [one @ ("top" | "bottom")] => ["center", one],
            [one] => [one, "center"],
            // Words may come in either order.
            [one @ ("top" | "bottom"), other] => [other, one],
            [one, other @ ("left" | "right")] => [other, one],
            [one, other, ..] => [one, other],
            [] => return None,
        };
        Some([
            corner[0] + place(x, PartAxis::X)?,
            corner[1] + place(y, PartAxis::Y)?,
        ])
    }
}

/// Turn by an angle, rad. Quarters are exact.
fn turn(angle: f64) -> Affine {
    let quarters = angle / std::f64::consts::FRAC_PI_2;
    let (sin, cos) = match quarters.fract() == 0.0 {
        true => match quarters.rem_euclid(4.0) as u8 {
            0 => (0.0, 1.0),
            1 => (1.0, 0.0),
            2 => (0.0, -1.0),
            _ => (-1.0, 0.0),
        },
        false => libm::sincos(angle),
    };
    Affine::new([cos, sin, -sin, cos, 0.0, 0.0])
}

/// Angle in rad: degrees where it has no unit.
fn angle((value, unit): (f64, &str)) -> Option<f64> {
    let factor = match unit {
        "" | "deg" => return Some(value.to_radians()),
        "rad" => 1.0,
        "grad" => std::f64::consts::PI / 200.0,
        "turn" => std::f64::consts::TAU,
        _ => return None,
    };
    Some(value * factor)
}

/// Angle of a marker, rad.
pub(super) fn angle_of(text: &str) -> Option<f64> {
    angle(number(text.trim())?)
}

/// A number at the start of a text, and what follows.
pub(super) fn number(text: &str) -> Option<(f64, &str)> {
    let bytes = text.as_bytes();
    let digits = |mut at: usize| {
        while bytes.get(at).is_some_and(u8::is_ascii_digit) {
            at += 1;
        }
        at
    };
    let is_sign = |at: usize| matches!(bytes.get(at), Some(b'+' | b'-'));
    let mut end = digits(usize::from(is_sign(0)));
    if bytes.get(end) == Some(&b'.') {
        end = digits(end + 1);
    }
    // An `e` without digits is that of a unit.
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let power = end + 1 + usize::from(is_sign(end + 1));
        if digits(power) > power {
            end = digits(power);
        }
    }
    let value: f64 = text[..end].trim_end_matches('.').parse().ok()?;
    value.is_finite().then(|| (value, &text[end..]))
}

/// Part from 0 to 1: a number or a percentage.
pub(super) fn part(text: &str) -> Option<f64> {
    let (value, unit) = number(text.trim())?;
    let value = match unit {
        "" => value,
        "%" => 0.01 * value,
        _ => return None,
    };
    Some(value.clamp(0.0, 1.0))
}
