//! The machine drawn to scale at several instants, with the path of the tool.

use trirrr_figures::style::{RGBColor, WHITE};

use trirrr_figures::canvas::{BELOW, CENTRED, Canvas, Draw, Drawn, LEFT_OF, RIGHT_OF, Size, page};
use trirrr_figures::panel::{axis_title, range};
use trirrr_figures::scale::{Axis, Margin, seconds};
use trirrr_figures::style::{BLUE, FRAME, GREEN, GRID, INK, PURPLE, VERMILLION, faded};
use trirrr_scene::record::{LegRecord, Record};

const LEFT: f64 = 72.0;
const TOP: f64 = 56.0;
const BOTTOM: f64 = 62.0;
const LEGEND: f64 = 196.0;
/// The drawing fits into a square of this side, and is at least a third of it wide and high.
const SIDE: f64 = 640.0;
const GROUND: RGBColor = RGBColor(80, 80, 80);

/// The machine at one instant.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct DrawnInstant {
    /// Time since the start of the job, s.
    pub(super) t: f64,
    pub(super) legs: Vec<LegRecord>,
}

impl From<&Record> for DrawnInstant {
    fn from(record: &Record) -> Self {
        Self {
            t: record.t,
            legs: record.legs.to_vec(),
        }
    }
}

/// Contents of the drawing.
pub(super) struct Scenery {
    /// The machine at several instants in order of time; the first is the start, the last the end.
    pub(super) instants: Vec<DrawnInstant>,
    /// Both ends of each guide of a base joint, m.
    pub(super) guides: Vec<[[f64; 2]; 2]>,
    /// Positions of D, m.
    pub(super) path: Vec<(f64, f64)>,
}

/// Draws the machine. Nothing to draw gives an empty frame.
pub(super) fn draw(title: &str, scenery: &Scenery) -> Drawn {
    let view = View::around(scenery);
    let width = (LEFT + view.width + LEGEND).max(Size::Title.width(title) + 40.0);
    page(width, TOP + view.height + BOTTOM, |canvas| {
        canvas.text(title, (width / 2.0, 26.0), Size::Title, CENTRED, INK)?;
        view.grid(canvas)?;
        view.base(canvas, scenery)?;
        let last = scenery.instants.len().saturating_sub(1);
        // In between first, so that the start and the end lie on top.
        for (index, record) in scenery.instants.iter().enumerate() {
            if index != 0 && index != last {
                view.machine(canvas, record, Shade::Between)?;
            }
        }
        if let (true, Some(start)) = (last > 0, scenery.instants.first()) {
            view.machine(canvas, start, Shade::Start)?;
        }
        if let Some(end) = scenery.instants.last() {
            view.machine(canvas, end, Shade::End)?;
        }
        let path: Vec<_> = scenery.path.iter().map(|&(x, y)| view.at([x, y])).collect();
        canvas.line(&path, WHITE, 4.0)?;
        canvas.line(&path, PURPLE, 2.2)?;
        for point in path.first().into_iter().chain(path.last()) {
            canvas.dot(*point, 3.6, PURPLE)?;
        }
        view.legend(canvas, scenery)
    })
}

/// Strength in which an instant is drawn.
#[derive(Clone, Copy)]
enum Shade {
    Start,
    Between,
    End,
}

impl Shade {
    fn of(self, colour: RGBColor) -> RGBColor {
        faded(
            colour,
            match self {
                Shade::Start => 0.6,
                Shade::Between => 0.3,
                Shade::End => 1.0,
            },
        )
    }
}

/// Names of the base joints.
const NAMES: [&str; 6] = [
    "A\u{2081}",
    "A\u{2082}",
    "A\u{2083}",
    "A\u{2084}",
    "A\u{2085}",
    "A\u{2086}",
];

/// The points, and the first one again.
fn closed(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    points.iter().chain(points.first()).copied().collect()
}

/// The map from metres to logical pixels, the same scale both ways.
struct View {
    x: Axis,
    y: Axis,
    width: f64,
    height: f64,
}

impl View {
    fn around(scenery: &Scenery) -> Self {
        let joints = scenery.instants.iter().flat_map(|record| {
            record
                .legs
                .iter()
                .flat_map(|leg| [leg.base, leg.elbow(), leg.platform_joint()])
        });
        let points: Vec<[f64; 2]> = joints
            .chain(scenery.guides.iter().flatten().copied())
            .chain(scenery.path.iter().map(|&(x, y)| [x, y]))
            .collect();
        let (left, right) = range(points.iter().map(|p| p[0]));
        let (low, high) = range(points.iter().map(|p| p[1]));
        let span = f64::max(right - left, high - low);
        // A machine that is a single point still has a scale.
        let span = if span > 0.0 { span } else { 1.0 };
        let margin = 0.09 * span;
        let extent = |low: f64, high: f64| {
            let missing = f64::max(0.0, span / 3.0 - (high - low)) / 2.0;
            (low - margin - missing, high + margin + missing)
        };
        let ((left, right), (low, high)) = (extent(left, right), extent(low, high));
        let pixels = SIDE / f64::max(right - left, high - low);
        let (width, height) = ((right - left) * pixels, (high - low) * pixels);
        let interval = 80.0;
        Self {
            x: Axis::new(left, right, "m", Margin::Exact, width / interval),
            y: Axis::new(low, high, "m", Margin::Exact, height / interval),
            width,
            height,
        }
    }

    fn at(&self, [x, y]: [f64; 2]) -> (f64, f64) {
        (
            LEFT + self.x.fraction(x) * self.width,
            TOP + (1.0 - self.y.fraction(y)) * self.height,
        )
    }

    fn grid(&self, canvas: &Canvas<'_>) -> Draw {
        let (right, bottom) = (LEFT + self.width, TOP + self.height);
        for (value, label) in &self.x.ticks {
            let x = LEFT + self.x.fraction(*value) * self.width;
            canvas.line(&[(x, TOP), (x, bottom)], GRID, 1.0)?;
            canvas.text(label, (x, bottom + 8.0), Size::Tick, BELOW, INK)?;
        }
        for (value, label) in &self.y.ticks {
            let y = bottom - self.y.fraction(*value) * self.height;
            canvas.line(&[(LEFT, y), (right, y)], GRID, 1.0)?;
            canvas.text(label, (LEFT - 8.0, y), Size::Tick, LEFT_OF, INK)?;
        }
        let corners = [
            (LEFT, TOP),
            (right, TOP),
            (right, bottom),
            (LEFT, bottom),
            (LEFT, TOP),
        ];
        canvas.line(&corners, FRAME, 1.0)?;
        let middle = (LEFT + self.width / 2.0, bottom + 34.0);
        canvas.text(
            &axis_title("x", &self.x.unit),
            middle,
            Size::Label,
            BELOW,
            INK,
        )?;
        let middle = (20.0, TOP + self.height / 2.0);
        canvas.upright(&axis_title("y", &self.y.unit), middle, Size::Label, INK)
    }

    /// The polygon of the base joints with the motors' numbers, and the guides of the joints that move.
    fn base(&self, canvas: &Canvas<'_>, scenery: &Scenery) -> Draw {
        let Some(last) = scenery.instants.last() else {
            return Ok(());
        };
        for [from, to] in &scenery.guides {
            canvas.line(&[self.at(*from), self.at(*to)], GROUND, 1.5)?;
        }
        let joints: Vec<_> = last.legs.iter().map(|leg| self.at(leg.base)).collect();
        let count = joints.len() as f64;
        let centre = joints.iter().fold((0.0, 0.0), |sum, joint| {
            (sum.0 + joint.0 / count, sum.1 + joint.1 / count)
        });
        for pair in closed(&joints).windows(2) {
            canvas.dashed(pair[0], pair[1], FRAME)?;
        }
        for (joint, name) in joints.iter().zip(NAMES) {
            let foot = [
                *joint,
                (joint.0 - 10.0, joint.1 + 16.0),
                (joint.0 + 10.0, joint.1 + 16.0),
            ];
            canvas.polygon(&foot, GROUND)?;
            // Beside the foot, on the side away from the middle.
            let (dx, anchor) = if joint.0 > centre.0 {
                (14.0, RIGHT_OF)
            } else {
                (-14.0, LEFT_OF)
            };
            canvas.text(
                name,
                (joint.0 + dx, joint.1 + 10.0),
                Size::Label,
                anchor,
                INK,
            )?;
        }
        Ok(())
    }

    fn machine(&self, canvas: &Canvas<'_>, instant: &DrawnInstant, shade: Shade) -> Draw {
        draw_pose(
            canvas,
            |point| self.at(point),
            &instant.legs,
            |colour| shade.of(colour),
        )
    }

    /// Beside the drawing, where it covers nothing.
    fn legend(&self, canvas: &Canvas<'_>, scenery: &Scenery) -> Draw {
        let x = LEFT + self.width + 16.0;
        let mut y = TOP + 12.0;
        let entry = |y: &mut f64, colours: &[RGBColor], width: f64, text: &str| -> Draw {
            for (i, colour) in colours.iter().enumerate() {
                let y = *y + 5.0 * (i as f64 - (colours.len() as f64 - 1.0) / 2.0);
                canvas.line(&[(x, y), (x + 24.0, y)], *colour, width)?;
            }
            canvas.text(text, (x + 33.0, *y), Size::Label, RIGHT_OF, INK)?;
            *y += 23.0;
            Ok(())
        };
        entry(&mut y, &[BLUE], 5.0, "proximal links")?;
        entry(&mut y, &[VERMILLION], 3.6, "distal links")?;
        entry(&mut y, &[GREEN], 3.0, "platform")?;
        entry(&mut y, &[PURPLE], 2.2, "path of D")?;
        let instants = &scenery.instants;
        let [Some(first), Some(last)] = [instants.first(), instants.last()] else {
            return Ok(());
        };
        let mut shades = vec![(Shade::End, format!("t = {}", seconds(last.t)))];
        if instants.len() > 2 {
            let between: Vec<String> = instants[1..instants.len() - 1]
                .iter()
                .map(|r| seconds(r.t))
                .collect();
            let text = match between.as_slice() {
                [one] => one.clone(),
                [from, .., to] => format!("{from} to {to}"),
                [] => String::new(),
            };
            shades.insert(0, (Shade::Between, text));
        }
        if instants.len() > 1 {
            shades.insert(0, (Shade::Start, format!("t = {}", seconds(first.t))));
        }
        y += 12.0;
        for (shade, text) in shades {
            let colours = [shade.of(BLUE), shade.of(VERMILLION)];
            entry(&mut y, &colours, 4.0, &text)?;
        }
        Ok(())
    }
}

/// Draws links, platform and joints of one instant; `at` maps metres to the page.
pub(crate) fn draw_pose(
    canvas: &Canvas<'_>,
    at: impl Fn([f64; 2]) -> (f64, f64),
    legs: &[LegRecord],
    shade: impl Fn(RGBColor) -> RGBColor,
) -> Draw {
    let platform: Vec<_> = legs.iter().map(|leg| at(leg.platform_joint())).collect();
    canvas.polygon(&platform, shade(faded(GREEN, 0.55)))?;
    canvas.line(&closed(&platform), shade(GREEN), 2.0)?;
    for leg in legs {
        let (base, elbow) = (at(leg.base), at(leg.elbow()));
        let joint = at(leg.platform_joint());
        canvas.line(&[base, elbow], shade(BLUE), 5.0)?;
        canvas.line(&[elbow, joint], shade(VERMILLION), 3.6)?;
        canvas.joint(elbow, 4.6, shade(INK))?;
        canvas.joint(joint, 3.8, shade(INK))?;
        canvas.joint(base, 5.6, GROUND)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use trirrr_scene::record::LegRecord;

    fn record(t: f64, size: f64) -> Record {
        let leg = |x: f64, y: f64| LegRecord {
            base: [x * size, y * size],
            r1: [0.1 * size, 0.1 * size],
            r2: [0.1 * size, -0.1 * size],
            ..LegRecord::default()
        };
        Record {
            t,
            legs: [leg(0.0, 0.0), leg(0.5, 0.0), leg(0.2, 0.4)],
            ..Record::default()
        }
    }

    #[test]
    fn a_metre_is_as_long_across_as_up() {
        for size in [1e-6, 1.0, 1e6] {
            let scenery = Scenery {
                instants: [0.0, 1.0].map(|t| (&record(t, size)).into()).into(),
                guides: vec![],
                path: vec![(0.0, 0.0), (0.01 * size, 0.02 * size)],
            };
            let view = View::around(&scenery);
            let (origin, x, y) = (
                view.at([0.0, 0.0]),
                view.at([0.1 * size, 0.0]),
                view.at([0.0, 0.1 * size]),
            );
            assert!((x.0 - origin.0 - (origin.1 - y.1)).abs() < 1e-6);
            assert!(x.0 - origin.0 > 50.0);
            assert!(
                draw("machine", &scenery)
                    .unwrap()
                    .contains("proximal links")
            );
        }
    }

    #[test]
    fn nothing_and_a_point_are_drawn_too() {
        for instants in [vec![], vec![(&Record::default()).into()]] {
            let scenery = Scenery {
                instants,
                guides: vec![],
                path: vec![],
            };
            assert!(draw("machine", &scenery).unwrap().ends_with("</svg>\n"));
        }
    }
}
