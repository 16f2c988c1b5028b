//! SVG files.
//!
//! Every element is drawn, or is seen by nobody by a rule that stands here, or is refused by its line and name. Numbers are
//! those of the file in 64 bits, all the way.

mod chain;
mod clip;
mod copies;
mod css;
mod curve;
mod dash;
mod drawn;
mod edges;
mod enter;
mod figure;
mod marker;
mod paint;
mod path;
mod refused;
mod region;
mod server;
mod shape;
mod state;
mod style;
mod text;
mod values;
mod viewport;
mod walk;

use super::Drawing;
use crate::PathFault;
use css::{Sheet, SheetText};
use kurbo::Affine;
use roxmltree::{Document, ParsingOptions};
use std::collections::HashMap;
use walk::FileWalk;

type XmlNode<'a, 'd> = roxmltree::Node<'a, 'd>;

/// Length of a pixel of SVG, m: 96 of them are an inch.
const PIXEL_M: f64 = 0.0254 / 96.0;

/// Name of the elements of SVG.
const SVG: &str = "http://www.w3.org/2000/svg";

/// Names of Inkscape's attributes.
const INKSCAPE: &str = "http://www.inkscape.org/namespaces/inkscape";

/// Most elements of a file.
const ELEMENTS_MAX: u32 = 2_000_000;

/// Most elements that are drawn once more as copies.
const COPIES_MAX: u32 = 100_000;

/// Reads an SVG file: its bytes, plain or packed (svgz). Lengths without a unit are pixels of 1/96 inch. A shape gives its
/// outline: in the colour of its stroke, without a stroke in that of its fill. Dashes are strokes of their own; clips and
/// masks cut. Elements that nobody sees are left out.
///
/// # Errors
/// No SVG, nothing to draw, or an element that cannot be drawn as it looks: text, an image, an unknown paint.
pub fn read_svg(file: impl AsRef<[u8]>) -> Result<Drawing, PathFault> {
    let text = text::decode(file.as_ref())?;
    let options = ParsingOptions {
        allow_dtd: true,
        nodes_limit: ELEMENTS_MAX,
        ..ParsingOptions::default()
    };
    let document = Document::parse_with_options(&text, options).map_err(|error| PathFault {
        line: error.pos().row,
        word: String::new(),
        reason: format!("no SVG file: {error}"),
    })?;
    let texts = sheets(&document);
    let sheet = Sheet::read(&texts)?;
    let walk = FileWalk::new(&document, &sheet)?;
    let (page, map) = walk.page()?;
    let mut drawing = Drawing::default();
    let page_m = page.map(|side| PIXEL_M * side);
    let upward = Affine::new([PIXEL_M, 0.0, 0.0, -PIXEL_M, 0.0, PIXEL_M * page[1]]);
    walk.draw(upward * map, &mut |figure| {
        drawn::add(&walk, &figure, page_m, &mut drawing)
    })?;
    match drawing.strokes.is_empty() {
        true => Err(PathFault {
            line: 0,
            word: String::new(),
            reason: "nothing in the file is drawn: no shape has a stroke or a fill that is seen"
                .into(),
        }),
        false => Ok(drawing),
    }
}

/// Style sheets of a file.
fn sheets(document: &Document) -> Vec<SheetText> {
    let styles = document.descendants().filter(|node| {
        let of_svg = matches!(node.tag_name().namespace(), None | Some(SVG));
        let kind = node.attribute("type").unwrap_or_default();
        let is_css = kind.is_empty() || kind.eq_ignore_ascii_case("text/css");
        let media = node.attribute("media").unwrap_or_default().trim();
        of_svg
            && node.tag_name().name() == "style"
            && is_css
            && !media.eq_ignore_ascii_case("print")
    });
    let texts = styles.map(|node| {
        let text: String = node.children().filter_map(|part| part.text()).collect();
        let at = node.first_child().unwrap_or(node).range().start;
        SheetText::new(&text, document.text_pos_at(at).row)
    });
    texts.collect()
}

/// Names of layers by the `id` of their group: the layers of Inkscape with their labels, in other files all groups.
fn layers<'d>(document: &'d Document) -> HashMap<&'d str, &'d str> {
    let groups = |is_layer: &dyn Fn(&XmlNode) -> bool| -> HashMap<&'d str, &'d str> {
        let groups = document.root().descendants();
        let groups = groups.filter(|node| node.tag_name().name() == "g" && is_layer(node));
        let named = groups.filter_map(|node| {
            let id = node.attribute("id")?;
            Some((id, node.attribute((INKSCAPE, "label")).unwrap_or(id)))
        });
        named.collect()
    };
    let layers = groups(&|node| node.attribute((INKSCAPE, "groupmode")) == Some("layer"));
    match layers.is_empty() {
        true => groups(&|_| true),
        false => layers,
    }
}
