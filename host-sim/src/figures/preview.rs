//! Figure of a path before anything moves: its strokes, the ways between them, and the reach of the machine.

use trirrr_figures::canvas::Drawn;
use trirrr_figures::plane::View;
use trirrr_figures::sketch::{Cells, SAMPLE, Sketch, SketchMark, Swatch};
use trirrr_figures::style::{AREA, FRAME, INK, LIMIT, PATH, RGBColor, faded};
use trirrr_plan::piece::Piece;
use trirrr_scene::{JobPath, ReachMap};

const SIDE: f64 = 640.0;

/// Places on each curve that are joined by lines.
const PLACES: u32 = 16;

/// Pieces from which on strokes are thin.
const MANY: usize = 4_000;

/// Shades of the reach: from which distance to a singularity on, and how strong.
const SHADES: [(f64, f64); 4] = [(0.0, 0.12), (0.2, 0.22), (0.4, 0.34), (0.6, 0.46)];

/// Contents of the figure.
pub struct Preview<'a> {
    /// Name of the job.
    pub name: &'a str,
    /// The path.
    pub path: &'a JobPath,
    /// Place of D where it begins, m.
    pub start_m: [f64; 2],
    /// Places of D that the machine reaches.
    pub reach: &'a ReachMap,
    /// Place at which the path is refused, m.
    pub breach: Option<[f64; 2]>,
}

impl Preview<'_> {
    /// Draws the figure.
    pub fn draw(&self) -> Drawn {
        let pieces = self.path.pieces.iter();
        let curves: Vec<_> = pieces.map(|each| places(&each.piece)).collect();
        let corners = self.corners().into_iter();
        let shown: Vec<[f64; 2]> = corners.chain(curves.iter().flatten().copied()).collect();
        let mut over = self.motions(&curves, &shown);
        over.push(SketchMark::Dot(self.start_m, 3.6, INK));
        over.extend(self.breach.map(|at| SketchMark::Cross(at, LIMIT)));
        let sketch = Sketch {
            title: format!("{}: the path, and the reach of the machine", self.name),
            axes: ["x of D", "y of D"],
            side: SIDE,
            shown,
            under: vec![self.reach()],
            over,
            legend: self.legend(),
        };
        sketch.draw()
    }

    /// The ways, and on top of them what is worked, in the shade of its power.
    fn motions(&self, curves: &[Vec<[f64; 2]>], shown: &[[f64; 2]]) -> Vec<SketchMark> {
        let power = |source: usize| {
            let tool = self.path.tools.get(source).copied().flatten();
            tool.map_or(0.0, |tool| tool.power)
        };
        let pieces = self.path.pieces.iter().zip(curves);
        let powers = pieces.map(|(each, curve)| (power(each.source), curve));
        let ways = powers.clone().filter(|(power, _)| *power == 0.0);
        let mut marks: Vec<_> = ways
            .map(|(_, curve)| SketchMark::Ways(curve.clone(), FRAME))
            .collect();
        // Rows of an image lie closer to each other than a line is wide.
        let width = if curves.len() > MANY { 0.5 } else { 1.6 };
        // What is shorter than a pixel is not seen.
        let least = View::around(shown, "m", (0.0, 0.0), SIDE).pixel();
        let mut stroke = Stroke::default();
        for (power, curve) in powers {
            if power == 0.0 || stroke.length >= least {
                marks.extend(stroke.mark(width));
            }
            if power > 0.0 {
                stroke.add(curve, power);
            }
        }
        marks.extend(stroke.mark(width));
        marks
    }

    /// Places of the nodes that are reached.
    fn corners(&self) -> Vec<[f64; 2]> {
        let [columns, rows] = self.reach.size();
        let nodes = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
        let reached = nodes.filter(|(column, row)| self.reach.margin(*column, *row).is_some());
        let places = reached.map(|(column, row)| self.reach.place_m(column, row));
        places.collect()
    }

    fn reach(&self) -> SketchMark {
        let reach = self.reach;
        let [columns, rows] = reach.size();
        let colour = |index: usize| {
            let margin = reach.margin(index % columns, index / columns)?;
            Some(faded(AREA, SHADES[shade(margin)].1))
        };
        SketchMark::Cells(Cells {
            first: reach.place_m(0, 0),
            side: reach.step_m(),
            size: [columns, rows],
            colours: (0..columns * rows).map(colour).collect(),
        })
    }

    fn legend(&self) -> Vec<Vec<(Swatch, String)>> {
        let shades = SHADES.map(|(_, strength)| faded(AREA, strength)).into();
        let mut entries = vec![
            (
                Swatch::Line(PATH, 1.6, SAMPLE),
                "tool on, paler at less power",
            ),
            (Swatch::Way(FRAME), "tool off; the dot is the start"),
            (
                Swatch::Fields(shades),
                "reach at the angle of the start: distance to singularities from 0, 0.2, 0.4, 0.6",
            ),
        ];
        if self.breach.is_some() {
            entries.push((Swatch::Cross(LIMIT), "here the path is refused"));
        }
        let rows = entries.into_iter();
        rows.map(|(swatch, text)| vec![(swatch, text.into())])
            .collect()
    }
}

/// Chain of worked pieces without a gap, until it is long enough to be seen.
#[derive(Default)]
struct Stroke {
    points: Vec<[f64; 2]>,
    length: f64,
    /// Sum of length times power.
    work: f64,
}

impl Stroke {
    fn add(&mut self, curve: &[[f64; 2]], power: f64) {
        let length = curve.windows(2).map(|pair| {
            let [[x, y], [to_x, to_y]] = [pair[0], pair[1]];
            (to_x - x).hypot(to_y - y)
        });
        let length: f64 = length.sum();
        self.points.extend(curve);
        self.length += length;
        self.work += length * power;
    }

    /// Mark of the stroke, which is forgotten.
    fn mark(&mut self, width: f64) -> Option<SketchMark> {
        let Self {
            points,
            length,
            work,
        } = std::mem::take(self);
        (length > 0.0).then(|| SketchMark::Line(points, tone(work / length), width))
    }
}

/// Shade of a power, 0 to 1.
fn tone(power: f64) -> RGBColor {
    faded(PATH, 0.12 + 0.88 * power.clamp(0.0, 1.0))
}

fn shade(margin: f64) -> usize {
    SHADES
        .iter()
        .rposition(|(from, _)| margin >= *from)
        .unwrap_or(0)
}

fn places(piece: &Piece<f64>) -> Vec<[f64; 2]> {
    let place = |index: u32| {
        let at = piece.at(f64::from(index) / f64::from(PLACES));
        at.pose.position
    };
    // A line needs no places between.
    let middle = 0.5 * (place(0) + place(PLACES));
    let quarter = 0.5 * (place(0) + middle);
    let is_line = (place(PLACES / 2) - middle).amax() + (place(PLACES / 4) - quarter).amax() < 1e-9;
    let step = if is_line { PLACES } else { 1 };
    let indices = (0..=PLACES).step_by(step as usize);
    indices.map(|index| place(index).into()).collect()
}
