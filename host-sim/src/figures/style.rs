//! Colours: after Okabe and Ito's palette, which the colour-blind can tell apart.

use plotters::prelude::RGBColor;

/// Curves, in order.
pub(crate) const CURVES: [RGBColor; 7] = [BLUE, VERMILLION, GREEN, INK, PURPLE, ORANGE, SKY];

pub(crate) const BLUE: RGBColor = RGBColor(0, 114, 178);
pub(crate) const VERMILLION: RGBColor = RGBColor(213, 94, 0);
pub(crate) const GREEN: RGBColor = RGBColor(0, 158, 115);
pub(crate) const PURPLE: RGBColor = RGBColor(170, 51, 119);
pub(crate) const ORANGE: RGBColor = RGBColor(230, 159, 0);
pub(crate) const SKY: RGBColor = RGBColor(86, 180, 233);
pub(crate) const INK: RGBColor = RGBColor(40, 40, 40);
pub(crate) const FRAME: RGBColor = RGBColor(110, 110, 110);
pub(crate) const GRID: RGBColor = RGBColor(226, 226, 226);

/// `colour` faded towards white: 1 leaves it, 0 gives white.
pub(crate) fn faded(colour: RGBColor, strength: f64) -> RGBColor {
    let fade = |channel: u8| (255.0 - strength * f64::from(255 - channel)).round() as u8;
    RGBColor(fade(colour.0), fade(colour.1), fade(colour.2))
}
