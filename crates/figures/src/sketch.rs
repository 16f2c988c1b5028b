//! Drawings in a plane as data: marks at places of the plane, and a legend below. Title, window, axes and legend have one placement.

use crate::canvas::{CENTRED, Canvas, Draw, Drawn, LEFT_OF, RIGHT_OF, Size, page};
use crate::plane::View;
use crate::style::{GROUND, INK, RGBColor};

/// Place in the plane, m.
pub type Place = [f64; 2];

/// One mark of a drawing.
pub enum SketchMark {
    /// Line through the places, with its width in logical pixels.
    Line(Vec<Place>, RGBColor, f64),
    /// The same in dashes that go on round corners.
    Dashes(Vec<Place>, RGBColor, f64),
    /// Dashed straight lines from place to place.
    Ways(Vec<Place>, RGBColor),
    /// Disc with its radius in logical pixels.
    Dot(Place, f64, RGBColor),
    /// Revolute joint with its radius in logical pixels.
    Joint(Place, f64, RGBColor),
    /// Cross at a place that is wrong.
    Cross(Place, RGBColor),
    /// Filled polygon.
    Polygon(Vec<Place>, RGBColor),
    /// Foot of a joint that stands on the base.
    Foot(Place),
    /// Name beside a place, so many logical pixels to the right, or left, and down.
    Name(Place, (f64, f64), String),
    /// Cells of a grid.
    Cells(Cells),
}

/// Square cells of a grid, some with a colour.
pub struct Cells {
    /// Centre of the first cell.
    pub first: Place,
    /// Side of a cell, m.
    pub side: f64,
    /// Columns and rows.
    pub size: [usize; 2],
    /// Colours of all cells, row by row.
    pub colours: Vec<Option<RGBColor>>,
}

/// Sample of a mark in the legend.
pub enum Swatch {
    /// Nothing: the text alone.
    None,
    /// Line of a width and, where that tells a size, a length in logical pixels.
    Line(RGBColor, f64, f64),
    /// Lines of a width, one above the other.
    Lines(Vec<RGBColor>, f64),
    /// Line in dashes.
    Dashes(RGBColor, f64),
    /// Dashed line.
    Way(RGBColor),
    /// Fields beside each other.
    Fields(Vec<RGBColor>),
    /// Cross.
    Cross(RGBColor),
}

/// Length of a line of the legend, in logical pixels.
pub const SAMPLE: f64 = 36.0;

/// A drawing.
pub struct Sketch {
    /// Title.
    pub title: String,
    /// Titles of the axes.
    pub axes: [&'static str; 2],
    /// The longer side of the window, in logical pixels.
    pub side: f64,
    /// Places that the window shows.
    pub shown: Vec<Place>,
    /// Marks below the grid.
    pub under: Vec<SketchMark>,
    /// Marks on the grid.
    pub over: Vec<SketchMark>,
    /// Rows of the legend; entries of a row stand side by side.
    pub legend: Vec<Vec<(Swatch, String)>>,
}

const LEFT: f64 = 84.0;
const TOP: f64 = 56.0;
/// From the window to the first row of the legend, and from row to row.
const BELOW_IT: f64 = 66.0;
const ROW: f64 = 20.0;
/// From one entry of a row to the next, at least, and between them.
const COLUMN: f64 = 150.0;
const GAP: f64 = 20.0;
/// Right margin.
const MARGIN: f64 = 40.0;

impl Sketch {
    /// Draws it.
    ///
    /// # Errors
    /// Failures of plotters.
    pub fn draw(&self) -> Drawn {
        let view = View::around(&self.shown, "m", (LEFT, TOP), self.side);
        let ends = self.legend.iter().flat_map(|row| across(row));
        let widest = ends.map(|end| end - GAP).fold(view.width, f64::max);
        let width = (LEFT + widest + MARGIN).max(Size::Title.width(&self.title) + MARGIN);
        let top = TOP + view.height + BELOW_IT;
        page(
            width,
            top + ROW * (self.legend.len() as f64 + 0.5),
            |canvas| {
                canvas.text(&self.title, (width / 2.0, 26.0), Size::Title, CENTRED, INK)?;
                self.under
                    .iter()
                    .try_for_each(|mark| mark.draw(canvas, &view))?;
                view.grid(canvas, self.axes)?;
                self.over
                    .iter()
                    .try_for_each(|mark| mark.draw(canvas, &view))?;
                for (row, entries) in self.legend.iter().enumerate() {
                    let y = top + ROW * row as f64;
                    for ((swatch, text), x) in entries.iter().zip(across(entries)) {
                        swatch.draw(canvas, (LEFT + x, y))?;
                        let at = (LEFT + x + swatch.room(), y);
                        canvas.text(text, at, Size::Tick, RIGHT_OF, INK)?;
                    }
                }
                Ok(())
            },
        )
    }
}

/// Places of the entries of a row, from its left end, and its right end.
fn across(row: &[(Swatch, String)]) -> Vec<f64> {
    let mut places = vec![0.0];
    for (swatch, text) in row {
        // Sentences are narrower than the estimate for a few letters; the margin takes the rest.
        let width = swatch.room() + 0.85 * Size::Tick.width(text);
        let from = places.last().copied().unwrap_or_default();
        places.push(from + f64::max(COLUMN, width + GAP));
    }
    places
}

impl SketchMark {
    /// Draws the mark in a window.
    ///
    /// # Errors
    /// Failures of plotters.
    pub fn draw(&self, canvas: &Canvas<'_>, view: &View) -> Draw {
        let all = |places: &[Place]| -> Vec<_> { places.iter().map(|at| view.at(*at)).collect() };
        match self {
            Self::Line(places, colour, width) => canvas.line(&all(places), *colour, *width),
            Self::Dashes(places, colour, width) => canvas.dashes(&all(places), *colour, *width),
            Self::Ways(places, colour) => all(places)
                .windows(2)
                .try_for_each(|pair| canvas.dashed(pair[0], pair[1], *colour)),
            Self::Dot(at, radius, colour) => canvas.dot(view.at(*at), *radius, *colour),
            Self::Joint(at, radius, rim) => canvas.joint(view.at(*at), *radius, *rim),
            Self::Cross(at, colour) => canvas.cross(view.at(*at), *colour),
            Self::Polygon(places, colour) => canvas.polygon(&all(places), *colour),
            Self::Foot(at) => {
                let (x, y) = view.at(*at);
                canvas.polygon(
                    &[(x, y), (x - 10.0, y + 16.0), (x + 10.0, y + 16.0)],
                    GROUND,
                )
            }
            Self::Name(at, (across, down), text) => {
                let (x, y) = view.at(*at);
                let anchor = if *across < 0.0 { LEFT_OF } else { RIGHT_OF };
                canvas.text(text, (x + across, y + down), Size::Tick, anchor, INK)
            }
            Self::Cells(cells) => view.cells(canvas, cells),
        }
    }
}

impl Swatch {
    /// Width with the gap to the text.
    fn room(&self) -> f64 {
        match self {
            Self::None => 0.0,
            Self::Line(_, _, length) => length + 12.0,
            Self::Fields(colours) if colours.len() < 2 => 32.0,
            _ => SAMPLE + 12.0,
        }
    }

    fn draw(&self, canvas: &Canvas<'_>, (left, y): (f64, f64)) -> Draw {
        let ends = [(left, y), (left + SAMPLE, y)];
        match self {
            Self::None => Ok(()),
            Self::Line(colour, width, length) => {
                canvas.line(&[(left, y), (left + length, y)], *colour, *width)
            }
            Self::Lines(colours, width) => {
                let middle = (colours.len() as f64 - 1.0) / 2.0;
                let mut lines = colours.iter().zip(0..);
                lines.try_for_each(|(colour, index): (_, u32)| {
                    let y = y + 5.0 * (f64::from(index) - middle);
                    canvas.line(&[(left, y), (left + SAMPLE, y)], *colour, *width)
                })
            }
            Self::Dashes(colour, width) => canvas.dashes(&ends, *colour, *width),
            Self::Way(colour) => canvas.dashed(ends[0], ends[1], *colour),
            Self::Fields(colours) => {
                let width = (self.room() - 10.0) / colours.len() as f64;
                let (low, high) = (y - 6.0, y + 6.0);
                let mut fields = colours.iter().zip(0..);
                fields.try_for_each(|(colour, index): (_, u32)| {
                    let from = left + width * f64::from(index);
                    let to = from + width;
                    canvas.polygon(&[(from, low), (to, low), (to, high), (from, high)], *colour)
                })
            }
            Self::Cross(colour) => canvas.cross((left + 0.5 * SAMPLE, y), *colour),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::style::{AREA, LIMIT, PATH};

    #[test]
    fn marks_and_legend_are_drawn_and_the_page_is_as_wide_as_its_texts() {
        let line = vec![[0.0, 0.0], [1.0, 0.5]];
        let mut sketch = Sketch {
            title: "path".into(),
            axes: ["x", "y"],
            side: 300.0,
            shown: line.clone(),
            under: vec![SketchMark::Cells(Cells {
                first: [0.25, 0.25],
                side: 0.5,
                size: [2, 1],
                colours: vec![Some(AREA), None],
            })],
            over: vec![
                SketchMark::Line(line, PATH, 2.0),
                SketchMark::Cross([1.0, 0.5], LIMIT),
                SketchMark::Name([0.0, 0.0], (9.0, -9.0), "A1".into()),
            ],
            legend: vec![vec![
                (Swatch::Line(PATH, 2.0, SAMPLE), "the path".into()),
                (Swatch::Fields(vec![AREA]), "reached".into()),
            ]],
        };
        let drawn = sketch.draw().unwrap();
        for text in ["path", "A1", "the path", "reached", "x (m)"] {
            assert!(drawn.contains(&format!(">\n{text}\n<")), "{text}");
        }
        // A cell, and its field in the legend.
        assert_eq!(drawn.matches("<polygon").count(), 2);
        let width = |drawn: &str| -> f64 {
            let digits = drawn.split("width=\"").nth(1).unwrap();
            digits.split('"').next().unwrap().parse().unwrap()
        };
        let before = width(&drawn);
        sketch.legend.push(vec![(Swatch::None, "word ".repeat(40))]);
        assert!(width(&sketch.draw().unwrap()) > before + 500.0);
    }
}
