//! Offset of closed outlines by the radius of the tool, and leads.

use super::outline::{ClosedOutline, distance};
use super::{Drawing, Kerf, Rgb, Stroke, StrokeCurve};
use crate::{PathFault, PathRemark};
use cavalier_contours::polyline::{PlineSource, PlineSourceMut, Polyline};
use cavalier_contours::shape_algorithms::{Shape, ShapeOffsetOptions};
use std::collections::BTreeMap;
use std::f64::consts::{FRAC_1_SQRT_2, PI};

/// Largest distance of an arc from the curve that it stands for, m.
const ARC_M: f64 = 2e-6;

/// Halvings of a curve into arcs.
const HALVINGS: u32 = 12;

/// Most vertices of all outlines.
const VERTICES_MAX: usize = 200_000;

/// Halvings of a lead that has no room.
const SHORTER: u32 = 3;

impl Drawing {
    /// Moves closed strokes beside themselves and adds leads, those of each layer and colour together. A closed stroke
    /// within another one is a hole, one in a hole is a part again. Open strokes stay.
    ///
    /// # Errors
    /// The outlines have too many vertices.
    pub fn offset(&mut self, kerf: &Kerf) -> Result<(), PathFault> {
        let mut groups: BTreeMap<_, Group> = BTreeMap::new();
        let mut strokes = Vec::new();
        for stroke in std::mem::take(&mut self.strokes) {
            let layer = super::layer(&self.shapes, stroke.shape).to_owned();
            match ClosedOutline::of(&stroke) {
                Some(outline) => {
                    let group = groups.entry((layer, stroke.colour)).or_default();
                    group.push((stroke, outline));
                }
                None => strokes.push(stroke),
            }
        }
        let (mut lost, mut unled) = (0, 0);
        for group in groups.into_values() {
            let count = group.len();
            let loops = moved(group, kerf.offset_m)?;
            lost += count.saturating_sub(loops.len());
            unled += led(loops, kerf.lead_m, &mut strokes);
        }
        strokes.sort_by_key(|stroke| stroke.shape);
        self.strokes = strokes;
        let mut remark = |count: usize, text: &str| {
            if count > 0 {
                let text = format!("{count} closed outlines {text}");
                self.remarks.push(PathRemark::new(0, text));
            }
        };
        remark(lost, "are narrower than --offset leaves, or join others");
        remark(unled, "have no room for --lead, and go without");
        Ok(())
    }
}

/// Closed strokes of a layer and a colour.
type Group = Vec<(Stroke, ClosedOutline)>;

/// Closed outline of arcs and lines with the waste on its right, mm.
struct Loop {
    polyline: Polyline<f64>,
    shape: usize,
    colour: Option<Rgb>,
}

/// Outlines beside those of a group.
fn moved(group: Group, offset_m: f64) -> Result<Vec<Loop>, PathFault> {
    let mut loops = Vec::new();
    let mut vertices = 0;
    for (stroke, outline) in &group {
        let depth = group
            .iter()
            .filter(|(_, other)| other.area() > outline.area() && other.holds(outline.points[0]));
        let mut polyline = polyline(stroke);
        vertices += polyline.vertex_count();
        if vertices > VERTICES_MAX {
            return Err(PathFault {
                line: 0,
                word: "--offset".into(),
                reason: format!("the outlines have more than {VERTICES_MAX} vertices"),
            });
        }
        // Counter-clockwise around a part, clockwise around a hole.
        if (polyline.area() > 0.0) != (depth.count() % 2 == 0) {
            polyline.invert_direction_mut();
        }
        loops.push(Loop {
            polyline,
            shape: stroke.shape,
            colour: stroke.colour,
        });
    }
    if offset_m == 0.0 {
        return Ok(loops);
    }
    let shape = Shape::from_plines(loops.iter().map(|each| each.polyline.clone()));
    let offset = shape.parallel_offset(-1e3 * offset_m, &ShapeOffsetOptions::new());
    let found = offset.ccw_plines.into_iter().chain(offset.cw_plines);
    let found = found.filter_map(|each| {
        let first = each.polyline.iter_vertexes().next()?;
        let place = [1e-3 * first.x, 1e-3 * first.y];
        let way = |(_, outline): &(Stroke, ClosedOutline)| {
            let to_edge = |pair: &[[f64; 2]]| to_line(place, pair[0], pair[1]);
            outline
                .points
                .windows(2)
                .map(to_edge)
                .fold(f64::INFINITY, f64::min)
        };
        let near = group
            .iter()
            .min_by(|one, other| way(one).total_cmp(&way(other)))?;
        Some(Loop {
            polyline: each.polyline,
            shape: near.0.shape,
            colour: near.0.colour,
        })
    });
    Ok(found.collect())
}

fn to_line(point: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let side = [b[0] - a[0], b[1] - a[1]];
    let size = side[0] * side[0] + side[1] * side[1];
    let along = (point[0] - a[0]) * side[0] + (point[1] - a[1]) * side[1];
    let t = if size > 0.0 {
        (along / size).clamp(0.0, 1.0)
    } else {
        0.0
    };
    distance(point, [a[0] + t * side[0], a[1] + t * side[1]])
}

/// Stroke as arcs and lines, mm.
fn polyline(stroke: &Stroke) -> Polyline<f64> {
    let mut polyline = Polyline::new_closed();
    let mut add = |[x, y]: [f64; 2], bulge: f64| polyline.add(1e3 * x, 1e3 * y, bulge);
    let mut at = stroke.start;
    for curve in &stroke.curves {
        match *curve {
            StrokeCurve::Line(_) => add(at, 0.0),
            StrokeCurve::Arc { centre, turn, .. } => {
                let parts = (turn.abs() / (0.5 * PI)).ceil().max(1.0);
                let step = turn / parts;
                let from = [at[0] - centre[0], at[1] - centre[1]];
                for part in 0..parts as u32 {
                    let (sin, cos) = libm::sincos(step * f64::from(part));
                    let place = [
                        centre[0] + cos * from[0] - sin * from[1],
                        centre[1] + sin * from[0] + cos * from[1],
                    ];
                    add(place, libm::tan(0.25 * step));
                }
            }
            StrokeCurve::Bezier([b, c, d]) => arcs([at, b, c, d], HALVINGS, &mut add),
        }
        at = curve.end();
    }
    polyline
}

/// Adds arcs along a cubic curve: each through its ends and its middle.
fn arcs(curve: [[f64; 2]; 4], halvings: u32, add: &mut dyn FnMut([f64; 2], f64)) {
    let at = |t: f64| super::stroke::at_parameter(curve, t);
    let [from, to, middle] = [at(0.0), at(1.0), at(0.5)];
    let chord = [to[0] - from[0], to[1] - from[1]];
    let length = libm::hypot(chord[0], chord[1]);
    let height = |point: [f64; 2]| {
        ((point[0] - from[0]) * chord[1] - (point[1] - from[1]) * chord[0]) / length
    };
    // The bulge is twice the height by the chord; the arc is counter-clockwise where the middle is on its right.
    let bulge = 2.0 * height(middle) / length;
    let off = |point: [f64; 2]| {
        if bulge.abs() < 1e-9 {
            return height(point).abs();
        }
        let radius = 0.25 * length * (bulge + 1.0 / bulge);
        let up = 0.5 * length * bulge - radius;
        let across = [chord[1] / length, -chord[0] / length];
        let centre = [0, 1].map(|i| 0.5 * (from[i] + to[i]) + up * across[i]);
        (distance(point, centre) - radius.abs()).abs()
    };
    let is_near = length > 0.0
        && bulge.abs() < 0.4
        && [0.125, 0.25, 0.375, 0.625, 0.75, 0.875]
            .iter()
            .all(|t| off(at(*t)) < ARC_M);
    if is_near || halvings == 0 {
        return add(from, if is_near { bulge } else { 0.0 });
    }
    let mix = |a: [f64; 2], b: [f64; 2]| [0, 1].map(|i| 0.5 * (a[i] + b[i]));
    let [a, b, c, d] = curve;
    let (ab, bc, cd) = (mix(a, b), mix(b, c), mix(c, d));
    let (abc, bcd) = (mix(ab, bc), mix(bc, cd));
    let centre = mix(abc, bcd);
    arcs([a, ab, abc, centre], halvings - 1, add);
    arcs([centre, bcd, cd, d], halvings - 1, add);
}

/// Adds the strokes of outlines with their leads; returns how many have no room for one.
fn led(loops: Vec<Loop>, lead_m: f64, strokes: &mut Vec<Stroke>) -> usize {
    let closed: Vec<Stroke> = loops.iter().filter_map(stroke).collect();
    let outlines: Vec<ClosedOutline> = closed.iter().filter_map(ClosedOutline::of).collect();
    let mut unled = 0;
    for mut stroke in closed {
        if lead_m > 0.0 {
            begin_on_longest_line(&mut stroke);
            let lead = (0..=SHORTER).map(|halving| lead_m / f64::from(1 << halving));
            let ends = lead.map(|lead_m| leads(&stroke, lead_m));
            let mut fitting = ends.filter(|ends| {
                ends.iter().all(|end| {
                    // Two micrometres off its own edge, so that the start itself counts for nothing.
                    let near = [0, 1].map(|i| stroke.start[i] + 0.02 * (end[i] - stroke.start[i]));
                    !outlines.iter().any(|outline| outline.crosses(near, *end))
                })
            });
            match fitting.next() {
                Some([start, end]) => {
                    stroke.curves.insert(0, StrokeCurve::Line(stroke.start));
                    stroke.start = start;
                    stroke.curves.push(StrokeCurve::Line(end));
                }
                None => unled += 1,
            }
        }
        strokes.push(stroke);
    }
    unled
}

/// Stroke of an outline.
fn stroke(each: &Loop) -> Option<Stroke> {
    let vertices: Vec<_> = each.polyline.iter_vertexes().collect();
    let place = |index: usize| {
        let vertex = vertices[index % vertices.len()];
        [1e-3 * vertex.x, 1e-3 * vertex.y]
    };
    let start = (vertices.len() > 1).then(|| place(0))?;
    let curves = vertices.iter().enumerate().map(|(index, vertex)| {
        let (from, to) = (place(index), place(index + 1));
        if vertex.bulge.abs() < 1e-9 {
            return StrokeCurve::Line(to);
        }
        let turn = 4.0 * libm::atan(vertex.bulge);
        // From the middle of the chord to the centre: the chord turned by a quarter, by half the cotangent of half the turn.
        let up = 0.25 * (1.0 / vertex.bulge - vertex.bulge);
        let centre = [
            0.5 * (from[0] + to[0]) - up * (to[1] - from[1]),
            0.5 * (from[1] + to[1]) + up * (to[0] - from[0]),
        ];
        StrokeCurve::Arc { centre, turn, to }
    });
    Some(Stroke {
        shape: each.shape,
        colour: each.colour,
        start,
        curves: curves.collect(),
    })
}

/// Lets a closed stroke begin in the middle of its longest line, if it has one.
fn begin_on_longest_line(stroke: &mut Stroke) {
    let mut at = stroke.start;
    let mut longest: Option<(f64, usize, [f64; 2])> = None;
    for (index, curve) in stroke.curves.iter().enumerate() {
        if let StrokeCurve::Line(to) = *curve {
            let length = distance(at, to);
            if longest.is_none_or(|(most, ..)| length > most) {
                longest = Some((length, index, [0, 1].map(|i| 0.5 * (at[i] + to[i]))));
            }
        }
        at = curve.end();
    }
    if let Some((_, index, middle)) = longest {
        stroke.curves.rotate_left(index);
        stroke.curves.push(StrokeCurve::Line(middle));
        stroke.start = middle;
    }
}

/// Ends of the leads of a closed stroke, in the waste on its right: before its start, and behind its end.
fn leads(stroke: &Stroke, lead_m: f64) -> [[f64; 2]; 2] {
    let points = stroke.points(1e-7);
    let way = |a: [f64; 2], b: [f64; 2]| {
        let length = distance(a, b).max(f64::MIN_POSITIVE);
        [(b[0] - a[0]) / length, (b[1] - a[1]) / length]
    };
    let goes = way(points[0], points[1]);
    let comes = way(points[points.len() - 2], points[points.len() - 1]);
    let [x, y] = stroke.start;
    let step = FRAC_1_SQRT_2 * lead_m;
    [
        [
            x + step * (goes[1] - goes[0]),
            y - step * (goes[0] + goes[1]),
        ],
        [
            x + step * (comes[1] + comes[0]),
            y - step * (comes[0] - comes[1]),
        ],
    ]
}
