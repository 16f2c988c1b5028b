//! Colours after Okabe and Ito's palette, which colour-blind readers can tell apart.

pub use plotters::prelude::{RGBColor, WHITE};

/// Colours of the curves of a panel, in order.
pub const CURVES: [RGBColor; 7] = [BLUE, VERMILLION, GREEN, INK, PURPLE, ORANGE, SKY];

/// First curve.
pub const BLUE: RGBColor = RGBColor(0, 114, 178);
/// Second curve.
pub const VERMILLION: RGBColor = RGBColor(213, 94, 0);
/// Third curve.
pub const GREEN: RGBColor = RGBColor(0, 158, 115);
/// Fifth curve.
pub const PURPLE: RGBColor = RGBColor(170, 51, 119);
/// Sixth curve.
pub const ORANGE: RGBColor = RGBColor(230, 159, 0);
/// Seventh curve.
pub const SKY: RGBColor = RGBColor(86, 180, 233);
/// Text and the fourth curve.
pub const INK: RGBColor = RGBColor(40, 40, 40);
/// Frames of axes.
pub const FRAME: RGBColor = RGBColor(110, 110, 110);
/// Grid lines.
pub const GRID: RGBColor = RGBColor(226, 226, 226);

/// Fades `colour` towards white: strength 1 keeps the colour, 0 gives white.
pub fn faded(colour: RGBColor, strength: f64) -> RGBColor {
    let fade = |channel: u8| (255.0 - strength * f64::from(255 - channel)).round() as u8;
    RGBColor(fade(colour.0), fade(colour.1), fade(colour.2))
}
