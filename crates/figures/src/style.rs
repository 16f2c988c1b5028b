//! Colours, each with one meaning in all figures; after Okabe and Ito's palette, which colour-blind readers can tell apart.
//!
//! | colour | meaning |
//! |---|---|
//! | [`MOTORS`]: blue, vermillion, green | motor, joint and leg 1, 2, 3 |
//! | [`X`] sky blue, [`Y`] orange | components along the axes of the base frame |
//! | [`ANGLE`] ink | angle of the platform, and what is of the machine as a whole: sums, distances |
//! | [`PATH`] purple | D, its path, and the platform |
//! | [`LIMIT`] crimson, dashed | limits; areas and crosses in it: where a limit is broken |
//! | [`AREA`] teal, paler and stronger | places that the machine reaches, in the plane |
//! | [`tone`]: yellow, green, blue, violet | size of a value in a map or along a path: violet is the most |
//! | [`NUMBERS`]: ink, sky blue, orange, purple | number types `f64`, `f32`, `fixed`, `micromath`, where there are no motors |
//! | [`CURVES`], in order | other things that are only told apart: links of a linkage, methods of integration |
//!
//! A dashed curve is what is asked for, beside what there is.

pub use plotters::prelude::{RGBColor, WHITE};

/// Colours of things that are only told apart, in order.
pub const CURVES: [RGBColor; 7] = [BLUE, VERMILLION, GREEN, INK, PURPLE, ORANGE, SKY];

/// Motor, joint and leg 1, 2 and 3.
pub const MOTORS: [RGBColor; 3] = [BLUE, VERMILLION, GREEN];
/// Component along x.
pub const X: RGBColor = SKY;
/// Component along y.
pub const Y: RGBColor = ORANGE;
/// Angle of the platform; the machine as a whole.
pub const ANGLE: RGBColor = INK;
/// D, its path, and the platform.
pub const PATH: RGBColor = PURPLE;
/// Limits, and where they are broken.
pub const LIMIT: RGBColor = RGBColor(190, 0, 50);
/// Places that the machine reaches.
pub const AREA: RGBColor = RGBColor(0, 128, 128);
/// Number types: `f64`, `f32`, `fixed`, `micromath`.
pub const NUMBERS: [RGBColor; 4] = [INK, SKY, ORANGE, PURPLE];

/// Motor 1.
pub const BLUE: RGBColor = RGBColor(0, 114, 178);
/// Motor 2.
pub const VERMILLION: RGBColor = RGBColor(213, 94, 0);
/// Motor 3.
pub const GREEN: RGBColor = RGBColor(0, 158, 115);
/// D, and the fifth of [`CURVES`].
pub const PURPLE: RGBColor = RGBColor(170, 51, 119);
/// Component along y, and the sixth of [`CURVES`].
pub const ORANGE: RGBColor = RGBColor(230, 159, 0);
/// Component along x, and the seventh of [`CURVES`].
pub const SKY: RGBColor = RGBColor(86, 180, 233);
/// Text.
pub const INK: RGBColor = RGBColor(40, 40, 40);
/// Frames of axes.
pub const FRAME: RGBColor = RGBColor(110, 110, 110);
/// Parts that are fixed to the base.
pub const GROUND: RGBColor = RGBColor(80, 80, 80);
/// Grid lines.
pub const GRID: RGBColor = RGBColor(226, 226, 226);

/// Stops of [`tone`], evenly spread: those of viridis, from its end.
const TONES: [RGBColor; 5] = [
    RGBColor(253, 231, 37),
    RGBColor(94, 201, 98),
    RGBColor(33, 145, 140),
    RGBColor(59, 82, 139),
    RGBColor(68, 1, 84),
];

/// Fades `colour` towards white: strength 1 keeps the colour, 0 gives white.
pub fn faded(colour: RGBColor, strength: f64) -> RGBColor {
    mixed(WHITE, colour, strength)
}

/// Returns the colour of a value that is `part` of the way from the least to the most, 0 to 1.
pub fn tone(part: f64) -> RGBColor {
    let place = part.clamp(0.0, 1.0) * (TONES.len() - 1) as f64;
    let low = (place as usize).min(TONES.len() - 2);
    mixed(TONES[low], TONES[low + 1], place - low as f64)
}

fn mixed(from: RGBColor, to: RGBColor, part: f64) -> RGBColor {
    let mix = |from: u8, to: u8| {
        (f64::from(from) + part * (f64::from(to) - f64::from(from))).round() as u8
    };
    RGBColor(mix(from.0, to.0), mix(from.1, to.1), mix(from.2, to.2))
}

/// Returns `colour` as `#rrggbb`.
pub fn hex(RGBColor(red, green, blue): RGBColor) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_colour_has_two_meanings_in_one_figure() {
        let meanings = [&MOTORS[..], &[X, Y, ANGLE, PATH, LIMIT, AREA]].concat();
        for (index, colour) in meanings.iter().enumerate() {
            assert!(!meanings[..index].contains(colour), "{colour:?}");
        }
        for number in NUMBERS {
            assert!(!MOTORS.contains(&number), "{number:?}");
        }
    }

    #[test]
    fn tones_run_from_light_to_dark() {
        let light = |part: f64| {
            let RGBColor(red, green, blue) = tone(part);
            0.3 * f64::from(red) + 0.59 * f64::from(green) + 0.11 * f64::from(blue)
        };
        for step in 0..20 {
            let part = f64::from(step) / 20.0;
            assert!(light(part) > light(part + 0.05), "{part}");
        }
        assert_eq!([tone(-1.0), tone(2.0)], [TONES[0], TONES[4]]);
        assert_eq!(hex(tone(1.0)), "#440154");
    }
}
