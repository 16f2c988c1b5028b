//! Drawings in a plane as data: marks at places of the plane, and a legend below. Title, window, axes and legend have one placement.

use crate::canvas::{CENTRED, Canvas, Draw, Drawn, RIGHT_OF, Size, page};
use crate::plane::View;
use crate::style::{INK, RGBColor};

/// Place in the plane, m.
pub type Place = [f64; 2];

/// One mark of a drawing.
pub enum Mark {
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
    /// Name beside a place, right of it and above.
    Name(Place, String),
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
    pub under: Vec<Mark>,
    /// Marks on the grid.
    pub over: Vec<Mark>,
    /// Rows of the legend; entries of a row stand side by side.
    pub legend: Vec<Vec<(Swatch, String)>>,
}

const LEFT: f64 = 84.0;
const TOP: f64 = 56.0;
/// From the window to the first row of the legend, and from row to row.
const BELOW_IT: f64 = 66.0;
const ROW: f64 = 20.0;
/// From one entry of a row to the next.
const COLUMN: f64 = 150.0;
/// Right margin.
const MARGIN: f64 = 40.0;

impl Sketch {
    /// Draws it.
    ///
    /// # Errors
    /// Failures of plotters.
    pub fn draw(&self) -> Drawn {
        let view = View::around(&self.shown, "m", (LEFT, TOP), self.side);
        let legend = self.legend.iter().map(|row| row_width(row));
        let widest = legend.fold(view.width, f64::max);
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
                    for (column, (swatch, text)) in entries.iter().enumerate() {
                        let at = (LEFT + COLUMN * column as f64, top + ROW * row as f64);
                        swatch.draw(canvas, at)?;
                        let at = (at.0 + swatch.room(), at.1);
                        canvas.text(text, at, Size::Tick, RIGHT_OF, INK)?;
                    }
                }
                Ok(())
            },
        )
    }
}

fn row_width(row: &[(Swatch, String)]) -> f64 {
    let entries = row.iter().enumerate();
    let ends = entries.map(|(column, (swatch, text))| {
        // Sentences are narrower than the estimate for a few letters; the margin takes the rest.
        COLUMN * column as f64 + swatch.room() + 0.85 * Size::Tick.width(text)
    });
    ends.fold(0.0, f64::max)
}

impl Mark {
    fn draw(&self, canvas: &Canvas<'_>, view: &View) -> Draw {
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
            Self::Name(at, text) => {
                let (x, y) = view.at(*at);
                canvas.text(text, (x + 9.0, y - 9.0), Size::Tick, RIGHT_OF, INK)
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
            under: vec![Mark::Cells(Cells {
                first: [0.25, 0.25],
                side: 0.5,
                size: [2, 1],
                colours: vec![Some(AREA), None],
            })],
            over: vec![
                Mark::Line(line, PATH, 2.0),
                Mark::Cross([1.0, 0.5], LIMIT),
                Mark::Name([0.0, 0.0], "A1".into()),
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
