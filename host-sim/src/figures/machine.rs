//! The machine drawn to scale at several instants, with the path of the tool.

use crate::tick_record::AnyTick;
use trirrr_figures::canvas::{CENTRED, Canvas, Draw, Drawn, LEFT_OF, RIGHT_OF, Size, page};
use trirrr_figures::plane::View;
use trirrr_figures::scale::seconds;
use trirrr_figures::style::{CURVES, FRAME, GROUND, INK, LIMIT, PATH, RGBColor, WHITE, faded};
use trirrr_scene::record::LegRecord;

const LEFT: f64 = 84.0;
const TOP: f64 = 56.0;
const BOTTOM: f64 = 62.0;
const LEGEND: f64 = 196.0;
/// Widths of the links.
const PROXIMAL: f64 = 5.6;
const DISTAL: f64 = 3.2;
/// The drawing fits into a square of this side, and is at least a third of it wide and high.
const SIDE: f64 = 640.0;

/// The machine at one instant.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct DrawnInstant {
    /// Time since the start of the job, s.
    pub(super) t: f64,
    pub(super) legs: Vec<LegRecord>,
}

impl From<&AnyTick> for DrawnInstant {
    fn from(record: &AnyTick) -> Self {
        Self {
            t: record.t(),
            legs: record.each_leg().copied().collect(),
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
    /// Parts of the path on which a limit is broken, m.
    pub(super) broken: Vec<Vec<(f64, f64)>>,
}

/// Draws the machine. Nothing to draw gives an empty frame.
pub(super) fn draw(title: &str, scenery: &Scenery) -> Drawn {
    let drawing = MachineDrawing {
        view: view(scenery),
        scenery,
    };
    let view = &drawing.view;
    let width = (LEFT + view.width + LEGEND).max(Size::Title.width(title) + 40.0);
    page(width, TOP + view.height + BOTTOM, |canvas| {
        canvas.text(title, (width / 2.0, 26.0), Size::Title, CENTRED, INK)?;
        view.grid(canvas, ["x", "y"])?;
        drawing.base(canvas)?;
        let last = scenery.instants.len().saturating_sub(1);
        // In between first, so that the start and the end lie on top.
        for (index, record) in scenery.instants.iter().enumerate() {
            if index != 0 && index != last {
                drawing.machine(canvas, record, Shade::Between)?;
            }
        }
        if let (true, Some(start)) = (last > 0, scenery.instants.first()) {
            drawing.machine(canvas, start, Shade::Start)?;
        }
        if let Some(end) = scenery.instants.last() {
            drawing.machine(canvas, end, Shade::End)?;
        }
        let path: Vec<_> = scenery.path.iter().map(|&(x, y)| view.at([x, y])).collect();
        canvas.line(&path, WHITE, 4.0)?;
        canvas.line(&path, PATH, 2.2)?;
        for stretch in &scenery.broken {
            let line: Vec<_> = stretch.iter().map(|&(x, y)| view.at([x, y])).collect();
            canvas.line(&line, LIMIT, 3.4)?;
            if let Some(first) = line.first() {
                canvas.cross(*first, LIMIT)?;
            }
        }
        for point in path.first().into_iter().chain(path.last()) {
            canvas.dot(*point, 3.6, PATH)?;
        }
        drawing.legend(canvas)
    })
}

fn view(scenery: &Scenery) -> View {
    let joints = scenery.instants.iter().flat_map(|record| {
        let legs = record.legs.iter();
        legs.flat_map(|leg| [leg.base, leg.elbow(), leg.platform_joint()])
    });
    let guides = scenery.guides.iter().flatten().copied();
    let path = scenery.path.iter().map(|&(x, y)| [x, y]);
    let points: Vec<[f64; 2]> = joints.chain(guides).chain(path).collect();
    View::around(&points, "m", (LEFT, TOP), SIDE)
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

struct MachineDrawing<'a> {
    view: View,
    scenery: &'a Scenery,
}

impl MachineDrawing<'_> {
    /// The polygon of the base joints with the motors' numbers, and the guides of the joints that move.
    fn base(&self, canvas: &Canvas<'_>) -> Draw {
        let (view, scenery) = (&self.view, self.scenery);
        let Some(last) = scenery.instants.last() else {
            return Ok(());
        };
        for [from, to] in &scenery.guides {
            canvas.line(&[view.at(*from), view.at(*to)], GROUND, 1.5)?;
        }
        let joints: Vec<_> = last.legs.iter().map(|leg| view.at(leg.base)).collect();
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
            |point| self.view.at(point),
            &instant.legs,
            |colour| shade.of(colour),
        )
    }

    /// Returns `true` if the machine ends where it began.
    fn is_closed(&self) -> bool {
        let instants = &self.scenery.instants;
        let [Some(first), Some(last)] = [instants.first(), instants.last()] else {
            return false;
        };
        let mut legs = first.legs.iter().zip(&last.legs);
        let is_there = legs.all(|(one, other)| {
            let [a, b] = [one, other].map(|leg| self.view.at(leg.elbow()));
            (a.0 - b.0).hypot(a.1 - b.1) < 1.5
        });
        instants.len() > 1 && is_there
    }

    /// Beside the drawing, where it covers nothing.
    fn legend(&self, canvas: &Canvas<'_>) -> Draw {
        let x = LEFT + self.view.width + 16.0;
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
        let legs = self.scenery.instants.last().map_or(3, |at| at.legs.len());
        let colours = &CURVES[..legs.min(CURVES.len())];
        for (leg, colour) in colours.iter().enumerate() {
            entry(&mut y, &[*colour], 4.0, &format!("leg {}", leg + 1))?;
        }
        entry(&mut y, &[FRAME], PROXIMAL, "thick: A to B")?;
        entry(&mut y, &[FRAME], DISTAL, "thin: B to C")?;
        entry(&mut y, &[PATH], 2.2, "platform, path of D")?;
        if !self.scenery.broken.is_empty() {
            entry(&mut y, &[LIMIT], 3.4, "limit broken")?;
        }
        let instants = &self.scenery.instants;
        let [Some(first), Some(last)] = [instants.first(), instants.last()] else {
            return Ok(());
        };
        let is_closed = self.is_closed();
        let mut shades = vec![match is_closed {
            true => (
                Shade::End,
                format!("t = {} and {}", seconds(first.t), seconds(last.t)),
            ),
            false => (Shade::End, format!("t = {}", seconds(last.t))),
        }];
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
        if instants.len() > 1 && !is_closed {
            shades.insert(0, (Shade::Start, format!("t = {}", seconds(first.t))));
        }
        y += 12.0;
        for (shade, text) in shades {
            let colours: Vec<_> = colours
                .iter()
                .take(3)
                .map(|colour| shade.of(*colour))
                .collect();
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
    canvas.polygon(&platform, shade(faded(PATH, 0.3)))?;
    canvas.line(&closed(&platform), shade(PATH), 2.0)?;
    // The first three are the colours of the motors.
    for (leg, colour) in legs.iter().zip(CURVES) {
        let (base, elbow) = (at(leg.base), at(leg.elbow()));
        let joint = at(leg.platform_joint());
        canvas.line(&[base, elbow], shade(colour), PROXIMAL)?;
        canvas.line(&[elbow, joint], shade(colour), DISTAL)?;
        canvas.joint(elbow, 4.6, shade(INK))?;
        canvas.joint(joint, 3.8, shade(INK))?;
        canvas.joint(base, 5.6, GROUND)?;
    }
    Ok(())
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
                path: vec![(0.0, 0.0), (0.01 * size, 0.02 * size)],
                broken: vec![],
            };
            let view = view(&scenery);
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
