//! Colours and layers of DXF.

use super::names::Names;
use crate::drawing::Rgb;
use dxf::entities::EntityCommon;
use dxf::tables::Layer;

/// Look of a layer.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct LayerLook {
    /// It is on, plotted, and not frozen.
    pub(super) shows: bool,
    pub(super) colour: Option<Rgb>,
    /// Name of its line type.
    pub(super) line_type: String,
}

/// Name, in small letters, and look of a layer.
pub(super) fn layer_look(layer: &Layer, names: &Names) -> (String, LayerLook) {
    let name = layer.name.to_lowercase();
    let look = LayerLook {
        shows: layer.is_layer_on && layer.is_layer_plotted && !names.frozen.contains(&name),
        colour: layer.color.index().map(indexed),
        line_type: layer.line_type_name.clone(),
    };
    (name, look)
}

/// Colour of an entity, on a layer and in a block of such colours.
pub(super) fn colour(entity: &EntityCommon, layer: Option<Rgb>, block: Option<Rgb>) -> Option<Rgb> {
    if entity.color_24_bit > 0 {
        let [_, red, green, blue] = entity.color_24_bit.to_be_bytes();
        return Some([red, green, blue]);
    }
    match &entity.color {
        colour if colour.is_by_layer() => layer,
        colour if colour.is_by_block() => block,
        colour => colour.index().map(indexed),
    }
}

/// The basic colours, 1 to 9. Number 7 is that of the pen: black on paper.
const BASIC: [Rgb; 9] = [
    [255, 0, 0],
    [255, 255, 0],
    [0, 255, 0],
    [0, 255, 255],
    [0, 0, 255],
    [255, 0, 255],
    [0, 0, 0],
    [128, 128, 128],
    [192, 192, 192],
];

/// The greys, 250 to 255.
const GREYS: [u8; 6] = [51, 80, 105, 130, 190, 255];

/// Colour of a number of the AutoCAD index. From 10 to 249, tens are steps of 15 degrees of the hue, ones are shades, of
/// which the odd ones have half the saturation.
fn indexed(number: u8) -> Rgb {
    match number {
        0 => BASIC[6],
        1..=9 => BASIC[usize::from(number) - 1],
        250.. => [GREYS[usize::from(number) - 250]; 3],
        _ => {
            let value = [1.0, 0.65, 0.5, 0.3, 0.15][usize::from(number % 10 / 2)];
            let least = if number % 2 == 1 { 0.5 } else { 0.0 };
            let hue = f64::from(number / 10 - 1) * 15.0 / 60.0;
            // Each channel is full within 1 of its own hue, and gone beyond 2; hues count to 6.
            [0.0, 2.0, 4.0].map(|own: f64| {
                let off = (hue - own + 3.0).rem_euclid(6.0) - 3.0;
                let part = (2.0 - off.abs()).clamp(0.0, 1.0);
                (255.0 * value * (least + (1.0 - least) * part)) as u8
            })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows of the table that AutoCAD's documentation prints.
    #[test]
    fn numbers_are_the_colours_of_the_table() {
        for (number, colour) in [
            (1, [255, 0, 0]),
            (5, [0, 0, 255]),
            (7, [0, 0, 0]),
            (10, [255, 0, 0]),
            (11, [255, 127, 127]),
            (12, [165, 0, 0]),
            (20, [255, 63, 0]),
            (30, [255, 127, 0]),
            (90, [0, 255, 0]),
            (140, [0, 191, 255]),
            (171, [127, 127, 255]),
            (230, [255, 0, 127]),
            (18, [38, 0, 0]),
            (251, [80, 80, 80]),
        ] {
            assert_eq!(indexed(number), colour, "{number}");
        }
    }
}
