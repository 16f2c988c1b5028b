//! Figure of a path before anything moves: its strokes, the ways between them, and the reach of the machine.

use trirrr_figures::canvas::{CENTRED, Canvas, Draw, Drawn, RIGHT_OF, Size, page};
use trirrr_figures::plane::View;
use trirrr_figures::style::{AREA, FRAME, INK, LIMIT, PATH, RGBColor, faded};
use trirrr_plan::piece::Piece;
use trirrr_scene::{JobPath, ReachMap};

const LEFT: f64 = 84.0;
const TOP: f64 = 56.0;
const BOTTOM: f64 = 150.0;
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
        let curves: Vec<_> = self
            .path
            .pieces
            .iter()
            .map(|each| places(&each.piece))
            .collect();
        let shown: Vec<[f64; 2]> = self
            .corners()
            .into_iter()
            .chain(curves.iter().flatten().copied())
            .collect();
        let view = View::around(&shown, "m", (LEFT, TOP), SIDE);
        let title = format!("{}: the path, and the reach of the machine", self.name);
        let width = (LEFT + view.width + 40.0)
            .max(Size::Title.width(&title) + 40.0)
            .max(600.0);
        page(width, TOP + view.height + BOTTOM, |canvas| {
            canvas.text(&title, (width / 2.0, 26.0), Size::Title, CENTRED, INK)?;
            self.reach(canvas, &view)?;
            view.grid(canvas, ["x of D", "y of D"])?;
            let curves: Vec<Vec<_>> = curves
                .iter()
                .map(|curve| curve.iter().map(|place| view.at(*place)).collect())
                .collect();
            self.motions(canvas, &curves)?;
            canvas.dot(view.at(self.start_m), 3.6, INK)?;
            if let Some(breach) = self.breach {
                canvas.cross(view.at(breach), LIMIT)?;
            }
            self.legend(canvas, TOP + view.height + 66.0)
        })
    }

    /// The ways, and on top of them what is worked, in the shade of its power.
    fn motions(&self, canvas: &Canvas<'_>, curves: &[Vec<(f64, f64)>]) -> Draw {
        let powers: Vec<f64> = self
            .path
            .pieces
            .iter()
            .map(|each| self.path.tools.get(each.source).copied().flatten())
            .map(|tool| tool.map_or(0.0, |tool| tool.power))
            .collect();
        for (curve, _) in curves
            .iter()
            .zip(&powers)
            .filter(|(_, power)| **power == 0.0)
        {
            way(canvas, curve)?;
        }
        // Rows of an image lie closer to each other than a line is wide.
        let width = if curves.len() > MANY { 0.5 } else { 1.6 };
        let mut stroke = Stroke::default();
        for (curve, &power) in curves.iter().zip(&powers) {
            if power == 0.0 || stroke.is_seen() {
                stroke.draw(canvas, width)?;
            }
            if power > 0.0 {
                stroke.add(curve, power);
            }
        }
        stroke.draw(canvas, width)
    }

    /// Lower left and upper right corner of the nodes that are reached.
    fn corners(&self) -> Vec<[f64; 2]> {
        let [columns, rows] = self.reach.size();
        let nodes = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
        let reached = nodes.filter(|(column, row)| self.reach.margin(*column, *row).is_some());
        let places = reached.map(|(column, row)| self.reach.place_m(column, row));
        places.collect()
    }

    fn reach(&self, canvas: &Canvas<'_>, view: &View) -> Draw {
        let reach = self.reach;
        view.cells(
            canvas,
            (reach.size(), reach.step_m()),
            |column, row| reach.place_m(column, row),
            |column, row| {
                let shade = shade(reach.margin(column, row)?);
                Some(faded(AREA, SHADES[shade].1))
            },
        )
    }

    fn legend(&self, canvas: &Canvas<'_>, top: f64) -> Draw {
        let line = |row: f64| top + 20.0 * row;
        let text = |row: f64, text: &str| {
            canvas.text(text, (LEFT + 48.0, line(row)), Size::Tick, RIGHT_OF, INK)
        };
        canvas.line(&[(LEFT, line(0.0)), (LEFT + 36.0, line(0.0))], PATH, 1.6)?;
        text(0.0, "tool on, paler at less power")?;
        canvas.dashed((LEFT, line(1.0)), (LEFT + 36.0, line(1.0)), FRAME)?;
        text(1.0, "tool off; the dot is the start")?;
        for (index, (_, strength)) in SHADES.iter().enumerate() {
            let (left, right) = (LEFT + 9.0 * index as f64, LEFT + 9.0 * (index + 1) as f64);
            let (low, high) = (line(2.0) + 6.0, line(2.0) - 6.0);
            let corners = [(left, low), (right, low), (right, high), (left, high)];
            canvas.polygon(&corners, faded(AREA, *strength))?;
        }
        text(
            2.0,
            "reach at the angle of the start: distance to singularities from 0, 0.2, 0.4, 0.6",
        )?;
        if self.breach.is_some() {
            canvas.cross((LEFT + 18.0, line(3.0)), LIMIT)?;
            text(3.0, "here the path is refused")?;
        }
        Ok(())
    }
}

/// Chain of worked pieces without a gap, until it is long enough to be seen.
#[derive(Default)]
struct Stroke {
    points: Vec<(f64, f64)>,
    length: f64,
    /// Sum of length times power.
    work: f64,
}

impl Stroke {
    fn add(&mut self, curve: &[(f64, f64)], power: f64) {
        let length = curve.windows(2).map(|pair| {
            let [(x, y), (to_x, to_y)] = [pair[0], pair[1]];
            (to_x - x).hypot(to_y - y)
        });
        let length: f64 = length.sum();
        self.points.extend(curve);
        self.length += length;
        self.work += length * power;
    }

    fn is_seen(&self) -> bool {
        self.length >= 1.0
    }

    /// Draws the stroke, and forgets it.
    fn draw(&mut self, canvas: &Canvas<'_>, width: f64) -> Draw {
        let Self {
            points,
            length,
            work,
        } = std::mem::take(self);
        match length > 0.0 {
            true => canvas.line(&points, tone(work / length), width),
            false => Ok(()),
        }
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

fn way(canvas: &Canvas<'_>, points: &[(f64, f64)]) -> Draw {
    for pair in points.windows(2) {
        canvas.dashed(pair[0], pair[1], FRAME)?;
    }
    Ok(())
}
