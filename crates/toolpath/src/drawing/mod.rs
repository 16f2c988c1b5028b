//! Drawings: strokes in the plane, the pens that draw them, and the order in which they are drawn.
//!
//! A drawing has x to the right and y upward, in m. `read_svg`
//! and `read_dxf` read one. [`Drawing::elements`] makes a tool path of it: the tool is off on the way to a stroke, and on along it.

mod doubles;
#[cfg(feature = "dxf")]
mod dxf;
mod flat;
mod hatch;
#[cfg(any(feature = "dxf", feature = "svg"))]
mod join;
#[cfg(feature = "offset")]
mod offset;
mod order;
mod outline;
mod stroke;
#[cfg(feature = "svg")]
mod svg;

#[cfg(feature = "dxf")]
pub use dxf::{DxfChoices, read_dxf};
pub use flat::FlatDrawing;
pub use order::OffTravel;
pub use stroke::{Stroke, StrokeCurve};
#[cfg(feature = "svg")]
pub use svg::read_svg;

use crate::{Act, Element, PathRemark, ToolCurve, ToolMotion, ToolPlace, ToolWork, short};

/// Largest distance of a chord from its curve, m, where a curve is measured or filled.
const FLATNESS_M: f64 = 1e-5;

/// Colour: red, green, blue.
pub type Rgb = [u8; 3];

/// Drawing: strokes, and the names of the shapes that they belong to.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drawing {
    /// Strokes, in the order in which they are drawn.
    pub strokes: Vec<Stroke>,
    /// Areas that [`Drawing::fill`] may fill with lines.
    pub(crate) areas: Vec<Area>,
    /// Shapes of the file.
    pub(crate) shapes: Vec<Shape>,
    /// Remarks of the reader: what is drawn, or left out, and hardly meant so.
    pub remarks: Vec<PathRemark>,
}

/// Shape of a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Shape {
    /// Name, as the file has it, possibly empty.
    pub(crate) name: String,
    /// Layer, possibly none: "".
    pub(crate) layer: String,
}

/// Area inside closed strokes.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Area {
    pub(crate) shape: usize,
    pub(crate) colour: Option<Rgb>,
    /// Inside is where the outlines wind around at all, else where they do an odd number of times.
    pub(crate) non_zero: bool,
    pub(crate) outlines: Vec<Stroke>,
    /// Shapes of the clips that leave a part of it.
    pub(crate) clips: Vec<AreaClip>,
    /// The outline is drawn as well, in a colour of its own.
    pub(crate) stroked: bool,
}

/// Shape of a clip. Those up to one that is the last make a region: of them the last that holds a point says whether the
/// point is in it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct AreaClip {
    pub(crate) outlines: Vec<Stroke>,
    pub(crate) non_zero: bool,
    /// True: it adds to the region. False: it takes away.
    pub(crate) adds: bool,
    pub(crate) is_last: bool,
}

/// Pen: feed and work of the tool for the strokes of a colour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pen {
    /// Greatest speed of the tool point, m/s, positive.
    pub feed_m_s: f64,
    /// Work of the tool. None: strokes with this pen are left out.
    pub work: Option<ToolWork>,
}

/// Strokes that a pen draws.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PenKey {
    /// Those of a colour.
    Colour(Rgb),
    /// Those of a layer.
    Layer(String),
}

/// Half the width of what the tool takes away, and the way on which it comes to an outline.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Kerf {
    /// Distance of the tool from closed outlines, m: away from the part, which is outward at an outer one and inward at a
    /// hole. Negative: into the part.
    pub offset_m: f64,
    /// Length of a straight way to and from each closed outline with the tool on, m; 0: none.
    pub lead_m: f64,
}

/// Pens, and the place of a drawing on the machine.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawingSetup {
    /// Zero point of the drawing in the fixed frame; alpha of the platform all along.
    pub origin: ToolPlace,
    /// Length on the machine of a length 1 in the drawing, positive.
    pub scale: f64,
    /// Pen of the strokes without an own one.
    pub pen: Pen,
    /// Pens of layers and colours.
    pub pens: Vec<(PenKey, Pen)>,
}

impl DrawingSetup {
    /// Pen of a layer and a colour. That of the layer goes before that of the colour.
    pub fn pen_of(&self, layer: &str, colour: Option<Rgb>) -> Pen {
        let of = |is_own: &dyn Fn(&PenKey) -> bool| self.pens.iter().find(|(key, _)| is_own(key));
        let own = of(&|key| matches!(key, PenKey::Layer(name) if name == layer))
            .or_else(|| of(&|key| matches!(key, PenKey::Colour(rgb) if Some(*rgb) == colour)));
        own.map_or(self.pen, |(_, pen)| *pen)
    }

    fn place(&self, point: [f64; 2]) -> [f64; 2] {
        let [x, y] = self.origin.position_m;
        [x + self.scale * point[0], y + self.scale * point[1]]
    }
}

impl Drawing {
    /// Lower left and upper right corner of what is drawn, m in the drawing. None: nothing is drawn.
    pub fn bounds_m(&self) -> Option<[[f64; 2]; 2]> {
        let mut points = self
            .strokes
            .iter()
            .flat_map(|stroke| stroke.points(FLATNESS_M));
        let first = points.next()?;
        let grown = |[low, high]: [[f64; 2]; 2], point: [f64; 2]| {
            [
                [low[0].min(point[0]), low[1].min(point[1])],
                [high[0].max(point[0]), high[1].max(point[1])],
            ]
        };
        Some(points.fold([first, first], grown))
    }

    /// Leaves out the strokes and areas that no pen draws.
    pub fn leave_out(&mut self, setup: &DrawingSetup) {
        let shapes = &self.shapes;
        let drawn =
            |shape: usize, colour| setup.pen_of(layer(shapes, shape), colour).work.is_some();
        self.strokes
            .retain(|stroke| drawn(stroke.shape, stroke.colour));
        self.areas.retain(|area| drawn(area.shape, area.colour));
    }

    /// Tool path of the drawing. The numbers of its elements are places for [`Drawing::place_of`].
    pub fn elements(&self, setup: &DrawingSetup) -> Vec<Element> {
        let mut elements = Vec::new();
        let motion = |to, curve, feed_m_s| {
            Act::Motion(ToolMotion {
                curve,
                to: ToolPlace {
                    position_m: setup.place(to),
                    alpha_rad: setup.origin.alpha_rad,
                },
                feed_m_s,
                stops: false,
            })
        };
        for (index, stroke) in self.strokes.iter().enumerate() {
            let pen = setup.pen_of(layer(&self.shapes, stroke.shape), stroke.colour);
            let line = 2 * index as u32 + 1;
            elements.push(Element {
                line,
                tool: None,
                act: motion(stroke.start, ToolCurve::Line, None),
            });
            for curve in &stroke.curves {
                let (to, kind) = match *curve {
                    StrokeCurve::Line(to) => (to, ToolCurve::Line),
                    StrokeCurve::Arc { centre, turn, to } => {
                        let centre_m = setup.place(centre);
                        let turn_rad = turn;
                        (to, ToolCurve::Arc { centre_m, turn_rad })
                    }
                    StrokeCurve::Bezier([first, second, to]) => {
                        let controls_m = [first, second].map(|point| setup.place(point));
                        (to, ToolCurve::Bezier { controls_m })
                    }
                };
                elements.push(Element {
                    line: line + 1,
                    tool: pen.work,
                    act: motion(to, kind, Some(pen.feed_m_s)),
                });
            }
        }
        elements
    }

    /// Shape of an element, by the number of the element: its number in the file, and its name.
    pub fn place_of(&self, line: u32) -> String {
        let stroke = self.strokes.get((line.max(1) as usize - 1) / 2);
        let Some(stroke) = stroke else {
            return String::new();
        };
        let way = if line % 2 == 1 { "way to " } else { "" };
        let number = stroke.shape + 1;
        let shape = self.shapes.get(stroke.shape);
        let names = shape.map_or(Default::default(), |shape| {
            [&shape.name, &shape.layer].map(|name| short(name))
        });
        match names.each_ref().map(String::as_str) {
            ["", ""] => format!("{way}shape {number}"),
            [name, ""] => format!("{way}shape {number} ({name})"),
            ["", layer] => format!("{way}shape {number} (layer {layer})"),
            [name, layer] => format!("{way}shape {number} ({name}, layer {layer})"),
        }
    }
}

/// Layer of a shape, possibly none: "".
fn layer(shapes: &[Shape], shape: usize) -> &str {
    shapes.get(shape).map_or("", |shape| &shape.layer)
}
