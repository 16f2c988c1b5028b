//! The machine drawn to scale at several instants, with the path of the tool.

use crate::tick_record::AnyTick;
use trirrr_figures::canvas::Drawn;
use trirrr_figures::plane::View;
use trirrr_figures::scale::seconds;
use trirrr_figures::sketch::{SAMPLE, Sketch, SketchMark, Swatch};
use trirrr_figures::style::{CURVES, FRAME, GROUND, INK, LIMIT, PATH, RGBColor, WHITE, faded};
use trirrr_scene::record::LegRecord;

/// Widths of the links.
const PROXIMAL: f64 = 5.6;
const DISTAL: f64 = 3.2;
/// The drawing fits into a square of this side, and is at least a third of it wide and high.
const SIDE: f64 = 640.0;
/// Legs beside each other in the legend.
const LEGS_IN_ROW: usize = 3;

/// The machine at one instant.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct DrawnInstant {
    /// Time since the start of the job, s.
    pub(super) t: f64,
    pub(super) legs: Vec<LegRecord>,
}

impl From<&AnyTick> for DrawnInstant {
    fn from(record: &AnyTick) -> Self {
        let mut instant = Self {
            t: 0.0,
            legs: Vec::new(),
        };
        instant.set(record);
        instant
    }
}

impl DrawnInstant {
    /// Takes another instant in.
    pub(super) fn set(&mut self, record: &AnyTick) {
        self.t = record.t();
        self.legs.clear();
        self.legs.extend(record.each_leg());
    }
}

/// Contents of the drawing.
pub(super) struct Scenery {
    /// The machine at several instants in order of time; the first is the start, the last the end.
    pub(super) instants: Vec<DrawnInstant>,
    /// Both ends of each guide of a base joint, m.
    pub(super) guides: Vec<[[f64; 2]; 2]>,
    /// Positions of D, m.
    pub(super) path: Vec<[f64; 2]>,
    /// Parts of the path on which a limit is broken, m.
    pub(super) broken: Vec<Vec<[f64; 2]>>,
}

/// Draws the machine. Nothing to draw gives an empty frame.
pub(super) fn draw(title: &str, scenery: &Scenery) -> Drawn {
    let mut over = scenery.base();
    let pose =
        |instant: &DrawnInstant, shade: Shade| pose_marks(&instant.legs, |colour| shade.of(colour));
    // In between first, so that the start and the end lie on top.
    if let [start, between @ .., end] = &scenery.instants[..] {
        let between = between.iter().flat_map(|at| pose(at, Shade::Between));
        over.extend(
            between
                .chain(pose(start, Shade::Start))
                .chain(pose(end, Shade::End)),
        );
    } else if let [only] = &scenery.instants[..] {
        over.extend(pose(only, Shade::End));
    }
    let path = &scenery.path;
    over.push(SketchMark::Line(path.clone(), WHITE, 4.0));
    over.push(SketchMark::Line(path.clone(), PATH, 2.2));
    for stretch in &scenery.broken {
        over.push(SketchMark::Line(stretch.clone(), LIMIT, 3.4));
        over.extend(
            stretch
                .first()
                .map(|first| SketchMark::Cross(*first, LIMIT)),
        );
    }
    let ends = path.first().into_iter().chain(path.last());
    over.extend(ends.map(|end| SketchMark::Dot(*end, 3.6, PATH)));
    let sketch = Sketch {
        title: title.into(),
        axes: ["x", "y"],
        side: SIDE,
        shown: scenery.shown(),
        under: Vec::new(),
        over,
        legend: scenery.legend(),
    };
    sketch.draw()
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
fn closed(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    points.iter().chain(points.first()).copied().collect()
}

impl Scenery {
    /// Places that the window shows.
    fn shown(&self) -> Vec<[f64; 2]> {
        let legs = self.instants.iter().flat_map(|at| &at.legs);
        let joints = legs.flat_map(|leg| [leg.base, leg.elbow(), leg.platform_joint()]);
        let guides = self.guides.iter().flatten();
        joints.chain(guides.chain(&self.path).copied()).collect()
    }

    /// The polygon of the base joints with the motors' numbers, and the guides of the joints that move.
    fn base(&self) -> Vec<SketchMark> {
        let Some(last) = self.instants.last() else {
            return Vec::new();
        };
        let guides = self.guides.iter();
        let mut marks: Vec<SketchMark> = guides
            .map(|ends| SketchMark::Line(ends.to_vec(), GROUND, 1.5))
            .collect();
        let joints: Vec<[f64; 2]> = last.legs.iter().map(|leg| leg.base).collect();
        let middle = joints.iter().map(|[x, _]| x).sum::<f64>() / joints.len() as f64;
        marks.push(SketchMark::Ways(closed(&joints), FRAME));
        for (joint, name) in joints.iter().zip(NAMES) {
            // Beside the foot, on the side away from the middle.
            let across = if joint[0] > middle { 14.0 } else { -14.0 };
            marks.push(SketchMark::Foot(*joint));
            marks.push(SketchMark::Name(*joint, (across, 10.0), name.into()));
        }
        marks
    }

    /// Returns `true` if the machine ends where it began, as far as the drawing shows it.
    fn is_closed(&self) -> bool {
        let [first, .., last] = &self.instants[..] else {
            return false;
        };
        let seen = 1.5 * View::around(&self.shown(), "m", (0.0, 0.0), SIDE).pixel();
        let mut legs = first.legs.iter().zip(&last.legs);
        legs.all(|(one, other)| {
            let [[x, y], [to_x, to_y]] = [one.elbow(), other.elbow()];
            (to_x - x).hypot(to_y - y) < seen
        })
    }

    fn legend(&self) -> Vec<Vec<(Swatch, String)>> {
        let line = |colour, width, text: &str| (Swatch::Line(colour, width, SAMPLE), text.into());
        let legs = self.instants.last().map_or(3, |at| at.legs.len());
        let colours = &CURVES[..legs.min(CURVES.len())];
        let legs: Vec<(&RGBColor, u32)> = colours.iter().zip(1..).collect();
        let leg = |(colour, leg): &(&RGBColor, u32)| line(**colour, 4.0, &format!("leg {leg}"));
        let rows = legs.chunks(LEGS_IN_ROW);
        let mut rows: Vec<Vec<_>> = rows.map(|row| row.iter().map(leg).collect()).collect();
        rows.push(vec![
            line(FRAME, PROXIMAL, "thick: A to B"),
            line(FRAME, DISTAL, "thin: B to C"),
            line(PATH, 2.2, "platform, path of D"),
        ]);
        if !self.broken.is_empty() {
            rows.push(vec![line(LIMIT, 3.4, "limit broken")]);
        }
        let shades = self.shades().into_iter();
        let shade = |(shade, text): (Shade, String)| {
            let first = colours.iter().take(3);
            (
                Swatch::Lines(first.map(|colour| shade.of(*colour)).collect(), 4.0),
                text,
            )
        };
        rows.push(shades.map(shade).collect());
        rows
    }

    /// Instants that are drawn, in their shades.
    fn shades(&self) -> Vec<(Shade, String)> {
        let [first, between @ .., last] = &self.instants[..] else {
            let only = self.instants.iter();
            return only
                .map(|at| (Shade::End, format!("t = {}", seconds(at.t))))
                .collect();
        };
        let between: Vec<String> = between.iter().map(|at| seconds(at.t)).collect();
        let between = match between.as_slice() {
            [] => None,
            [one] => Some(one.clone()),
            [from, .., to] => Some(format!("{from} to {to}")),
        };
        let (start, end) = (seconds(first.t), seconds(last.t));
        let is_closed = self.is_closed();
        let mut shades = Vec::new();
        if !is_closed {
            shades.push((Shade::Start, format!("t = {start}")));
        }
        shades.extend(between.map(|text| (Shade::Between, text)));
        shades.push(match is_closed {
            true => (Shade::End, format!("t = {start} and {end}")),
            false => (Shade::End, format!("t = {end}")),
        });
        shades
    }
}

/// Links, platform and joints of one instant.
pub(crate) fn pose_marks(
    legs: &[LegRecord],
    shade: impl Fn(RGBColor) -> RGBColor,
) -> Vec<SketchMark> {
    let platform: Vec<_> = legs.iter().map(LegRecord::platform_joint).collect();
    let mut marks = vec![
        SketchMark::Polygon(platform.clone(), shade(faded(PATH, 0.3))),
        SketchMark::Line(closed(&platform), shade(PATH), 2.0),
    ];
    // The first three are the colours of the motors.
    for (leg, colour) in legs.iter().zip(CURVES) {
        let (elbow, joint) = (leg.elbow(), leg.platform_joint());
        marks.extend([
            SketchMark::Line(vec![leg.base, elbow], shade(colour), PROXIMAL),
            SketchMark::Line(vec![elbow, joint], shade(colour), DISTAL),
            SketchMark::Joint(elbow, 4.6, shade(INK)),
            SketchMark::Joint(joint, 3.8, shade(INK)),
            SketchMark::Joint(leg.base, 5.6, GROUND),
        ]);
    }
    marks
}

#[cfg(test)]
mod tests {
    use super::*;
    use trirrr_scene::record::Record;

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

    fn instant(record: &Record) -> DrawnInstant {
        (record as &AnyTick).into()
    }

    #[test]
    fn a_metre_is_as_long_across_as_up() {
        for size in [1e-6, 1.0, 1e6] {
            let scenery = Scenery {
                instants: [0.0, 1.0].map(|t| instant(&record(t, size))).into(),
                guides: vec![],
                path: vec![[0.0, 0.0], [0.01 * size, 0.02 * size]],
                broken: vec![],
            };
            let view = View::around(&scenery.shown(), "m", (0.0, 0.0), SIDE);
            let (origin, x, y) = (
                view.at([0.0, 0.0]),
                view.at([0.1 * size, 0.0]),
                view.at([0.0, 0.1 * size]),
            );
            assert!((x.0 - origin.0 - (origin.1 - y.1)).abs() < 1e-6);
            assert!(x.0 - origin.0 > 50.0);
            assert!(draw("machine", &scenery).unwrap().contains("path of D"));
        }
    }

    #[test]
    fn a_start_under_the_end_is_named_with_it() {
        for (end, text) in [(1.0, "t = 0 s and 2 s"), (1.2, "t = 2 s")] {
            let scenery = Scenery {
                instants: [record(0.0, 1.0), record(1.0, 1.5), record(2.0, end)]
                    .iter()
                    .map(instant)
                    .collect(),
                guides: vec![],
                path: vec![],
                broken: vec![],
            };
            let drawn = draw("machine", &scenery).unwrap();
            assert!(drawn.contains(&format!(">\n{text}\n<")), "{text}");
        }
    }

    #[test]
    fn nothing_and_a_point_are_drawn_too() {
        for instants in [vec![], vec![instant(&Record::default())]] {
            let scenery = Scenery {
                instants,
                guides: vec![],
                path: vec![],
                broken: vec![],
            };
            assert!(draw("machine", &scenery).unwrap().ends_with("</svg>\n"));
        }
    }
}
