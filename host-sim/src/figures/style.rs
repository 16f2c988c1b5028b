//! Colours: after Okabe and Ito's palette, which the colour-blind can tell apart.

use plotters::prelude::RGBColor;

/// Curves, in order.
pub(super) const CURVES: [RGBColor; 4] = [BLUE, VERMILLION, GREEN, INK];

pub(super) const BLUE: RGBColor = RGBColor(0, 114, 178);
pub(super) const VERMILLION: RGBColor = RGBColor(213, 94, 0);
pub(super) const GREEN: RGBColor = RGBColor(0, 158, 115);
pub(super) const PURPLE: RGBColor = RGBColor(170, 51, 119);
pub(super) const INK: RGBColor = RGBColor(40, 40, 40);
pub(super) const FRAME: RGBColor = RGBColor(110, 110, 110);
pub(super) const GRID: RGBColor = RGBColor(226, 226, 226);

/// `colour` faded towards white: 1 leaves it, 0 gives white.
pub(super) fn faded(colour: RGBColor, strength: f64) -> RGBColor {
    let fade = |channel: u8| (255.0 - strength * f64::from(255 - channel)).round() as u8;
    RGBColor(fade(colour.0), fade(colour.1), fade(colour.2))
}
