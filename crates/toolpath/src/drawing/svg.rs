//! SVG files.

use super::{Area, Drawing, Rgb, Shape, Stroke, StrokeCurve};
use crate::PathFault;
use std::collections::HashMap;
use usvg::roxmltree::{Document, Node as XmlNode, ParsingOptions};
use usvg::tiny_skia_path::{PathSegment, Point};
use usvg::{Group, Node, Options, Paint, Tree};

/// Length of a pixel of SVG, m: 96 of them are an inch.
const PIXEL_M: f64 = 0.0254 / 96.0;

/// Names of Inkscape's attributes.
const INKSCAPE: &str = "http://www.inkscape.org/namespaces/inkscape";

/// Most elements of a file.
const ELEMENTS_MAX: u32 = 2_000_000;

/// Reads an SVG file. Lengths without a unit are pixels of 1/96 inch. Styles, transforms, `use` and basic shapes are
/// resolved by `usvg`. A shape gives its outline: in the colour of its stroke, without a stroke in that of its fill.
/// Hidden shapes are left out.
///
/// # Errors
/// No SVG, nothing to draw, or an element that cannot be drawn: text, an image, a shape behind a clip path or a mask.
pub fn read_svg(text: &str) -> Result<Drawing, PathFault> {
    let options = ParsingOptions {
        allow_dtd: true,
        nodes_limit: ELEMENTS_MAX,
        ..ParsingOptions::default()
    };
    let document = Document::parse_with_options(text, options).map_err(|error| PathFault {
        line: error.pos().row,
        word: String::new(),
        reason: format!("no SVG file: {error}"),
    })?;
    for node in document.root().descendants() {
        refuse_unknown(&document, node)?;
    }
    let tree = Tree::from_xmltree(&document, &Options::default())
        .map_err(|error| fault(String::new(), format!("no SVG drawing: {error}")))?;
    let mut drawing = Drawing::default();
    let height = f64::from(tree.size().height());
    let layers = layers(&document);
    add(tree.root(), (height, ""), &layers, &mut drawing)?;
    match drawing.strokes.is_empty() {
        true => Err(fault(String::new(), "nothing in the file is drawn".into())),
        false => Ok(drawing),
    }
}

fn fault(word: String, reason: String) -> PathFault {
    PathFault {
        line: 0,
        word,
        reason,
    }
}

/// Refuses an element that would be left out silently.
fn refuse_unknown(document: &Document, node: XmlNode) -> Result<(), PathFault> {
    let name = node.tag_name().name();
    let reason = match name {
        "text" => "text has no outline; convert it to paths (Inkscape: Path, Object to Path)",
        "image" => "an image has no outline; trace it to paths (Inkscape: Path, Trace Bitmap)",
        "foreignObject" => "foreign objects are no drawing; leave them out",
        _ => return Ok(()),
    };
    let unseen = |node: &XmlNode| matches!(node.tag_name().name(), "defs" | "metadata" | "switch");
    if node.tag_name().namespace() != Some("http://www.w3.org/2000/svg")
        || node.ancestors().any(|above| unseen(&above))
    {
        return Ok(());
    }
    Err(PathFault {
        line: document.text_pos_at(node.range().start).row,
        word: name.to_owned(),
        reason: reason.to_owned(),
    })
}

/// Names of layers by the `id` of their group: the layers of Inkscape with their labels, in other files all groups.
fn layers(document: &Document) -> HashMap<String, String> {
    let groups = |is_layer: &dyn Fn(&XmlNode) -> bool| -> HashMap<String, String> {
        let groups = document.root().descendants();
        let groups = groups.filter(|node| node.tag_name().name() == "g" && is_layer(node));
        let named = groups.filter_map(|node| {
            let id = node.attribute("id")?;
            let label = node.attribute((INKSCAPE, "label")).unwrap_or(id);
            Some((id.to_owned(), label.to_owned()))
        });
        named.collect()
    };
    let layers = groups(&|node| node.attribute((INKSCAPE, "groupmode")) == Some("layer"));
    match layers.is_empty() {
        true => groups(&|_| true),
        false => layers,
    }
}

/// Adds the shapes of a group, on a page of a height, and on a layer.
fn add(
    group: &Group,
    (height, layer): (f64, &str),
    layers: &HashMap<String, String>,
    drawing: &mut Drawing,
) -> Result<(), PathFault> {
    let layer = layers.get(group.id()).map_or(layer, String::as_str);
    if group.clip_path().is_some() || group.mask().is_some() {
        return Err(fault(
            group.id().to_owned(),
            "a shape behind a clip path or a mask would be drawn whole; apply the clip in the drawing program".into(),
        ));
    }
    for node in group.children() {
        match node {
            Node::Group(group) => add(group, (height, layer), layers, drawing)?,
            Node::Path(path) if path.is_visible() => add_path(path, (height, layer), drawing),
            Node::Path(_) => {}
            Node::Image(node) => {
                return Err(fault(node.id().to_owned(), "images cannot be drawn".into()));
            }
            Node::Text(node) => {
                return Err(fault(node.id().to_owned(), "text has no outline".into()));
            }
        }
    }
    Ok(())
}

fn rgb(paint: &Paint) -> Option<Rgb> {
    match paint {
        Paint::Color(colour) => Some([colour.red, colour.green, colour.blue]),
        _ => None,
    }
}

fn add_path(path: &usvg::Path, (height, layer): (f64, &str), drawing: &mut Drawing) {
    let colours = [
        path.stroke().map(|stroke| rgb(stroke.paint())),
        path.fill().map(|fill| rgb(fill.paint())),
    ];
    let Some(colour) = colours[0].or(colours[1]) else {
        return;
    };
    let shape = drawing.shapes.len();
    let outlines = strokes(path, height, shape, colour);
    if outlines.is_empty() {
        return;
    }
    drawing.shapes.push(Shape {
        name: path.id().to_owned(),
        layer: layer.to_owned(),
    });
    if let Some(fill) = path.fill() {
        drawing.areas.push(Area {
            shape,
            colour: rgb(fill.paint()),
            non_zero: fill.rule() == usvg::FillRule::NonZero,
            outlines: outlines.clone(),
            stroked: path.stroke().is_some(),
        });
    }
    drawing.strokes.extend(outlines);
}

/// Outlines of a path. Quadratic curves become cubic ones, which are the same curves.
fn strokes(path: &usvg::Path, height: f64, shape: usize, colour: Option<Rgb>) -> Vec<Stroke> {
    let map = path.abs_transform();
    let place = |point: Point| {
        let [x, y] = [point.x, point.y].map(f64::from);
        let [sx, kx, tx] = [map.sx, map.kx, map.tx].map(f64::from);
        let [ky, sy, ty] = [map.ky, map.sy, map.ty].map(f64::from);
        [
            PIXEL_M * (sx * x + kx * y + tx),
            PIXEL_M * (height - (ky * x + sy * y + ty)),
        ]
    };
    let mut strokes: Vec<Stroke> = Vec::new();
    let mut at = [0.0; 2];
    for segment in path.data().segments() {
        let curve = match segment {
            PathSegment::MoveTo(to) => {
                at = place(to);
                strokes.push(Stroke {
                    shape,
                    colour,
                    start: at,
                    curves: Vec::new(),
                });
                continue;
            }
            PathSegment::LineTo(to) => StrokeCurve::Line(place(to)),
            PathSegment::QuadTo(control, to) => {
                let (control, to) = (place(control), place(to));
                let third = |end: [f64; 2]| [0, 1].map(|i| (end[i] + 2.0 * control[i]) / 3.0);
                StrokeCurve::Bezier([third(at), third(to), to])
            }
            PathSegment::CubicTo(first, second, to) => {
                StrokeCurve::Bezier([place(first), place(second), place(to)])
            }
            PathSegment::Close => match strokes.last() {
                Some(stroke) => StrokeCurve::Line(stroke.start),
                None => continue,
            },
        };
        // A line back to where the path already is has no length.
        if curve == StrokeCurve::Line(at) {
            continue;
        }
        at = curve.end();
        if let Some(stroke) = strokes.last_mut() {
            stroke.curves.push(curve);
        }
    }
    strokes.retain(|stroke| !stroke.curves.is_empty());
    strokes
}
