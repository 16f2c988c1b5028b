//! Courses of entities: start and curves, as they look from above.

use super::curves::{Outline, sweep};
use super::fault;
use super::names::Named;
use super::place::Affine;
use crate::PathFault;
use dxf::entities::{Ellipse, Polyline};
use dxf::{Point, Vector};

/// Flag of a vertex that only shapes a fitted curve.
const CONTROL_VERTEX: i32 = 16;

pub(super) fn xy(point: &Point) -> [f64; 2] {
    [point.x, point.y]
}

/// Frame of an entity that faces along `normal`: from below, x is mirrored.
pub(super) fn facing(normal: &Vector, named: &Named) -> Result<Affine, PathFault> {
    let flat = normal.x.abs().max(normal.y.abs()) <= 1e-9 * normal.z.abs();
    match flat {
        true if normal.z > 0.0 => Ok(Affine::scale(1.0)),
        true if normal.z < 0.0 => Ok(Affine::mirror_x()),
        _ => Err(fault(named.line, &named.name, TILTED)),
    }
}

/// Refuses points that do not lie at one height, by more than a millionth of their distance.
pub(super) fn level(points: &[&Point], named: &Named) -> Result<(), PathFault> {
    let spread = |value: fn(&Point) -> f64| {
        let values = points.iter().map(|point| value(point));
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
            (low.min(value), high.max(value))
        });
        high - low
    };
    let [x, y, z] = [
        spread(|point| point.x),
        spread(|point| point.y),
        spread(|point| point.z),
    ];
    match z > 1e-6 * x.max(y).max(z) {
        true => Err(fault(named.line, &named.name, TILTED)),
        false => Ok(()),
    }
}

const TILTED: &str = "it is tilted out of the plane of x and y; draw it flat";

/// Start and curves of a stroke.
pub(super) type Course = ([f64; 2], Vec<crate::drawing::StrokeCurve>);

pub(super) fn polygon(place: &Affine, corners: &[&Point], is_closed: bool) -> Course {
    let corners = corners.iter().map(|corner| (xy(corner), 0.0));
    polyline(place, corners.collect(), is_closed)
}

/// Outline of a solid: the file has its corners side by side, from below and from above.
pub(super) fn quadrangle(
    place: &Affine,
    below: [&Point; 2],
    above: [&Point; 2],
    named: &Named,
) -> Result<Course, PathFault> {
    let corners = [below[0], below[1], above[1], above[0]];
    level(&corners, named)?;
    Ok(polygon(place, &corners, true))
}

/// Line through vertices, each with the bulge of the way behind it.
pub(super) fn polyline(place: &Affine, vertices: Vec<([f64; 2], f64)>, is_closed: bool) -> Course {
    let Some((&(start, _), last)) = vertices.first().zip(vertices.last()) else {
        return ([0.0; 2], Vec::new());
    };
    let mut chain = Outline::new(place, start);
    for pair in vertices.windows(2) {
        chain.bulged(pair[0].1, pair[1].0);
    }
    if is_closed {
        chain.bulged(last.1, start);
    }
    (chain.start, chain.curves)
}

pub(super) fn round(place: &Affine, centre: &Point, radius: f64, [from, turn]: [f64; 2]) -> Course {
    let (sin, cos) = libm::sincos(from);
    let centre = xy(centre);
    let start = [centre[0] + radius * cos, centre[1] + radius * sin];
    let mut chain = Outline::new(place, start);
    if radius != 0.0 {
        chain.arc(centre, turn);
    }
    (chain.start, chain.curves)
}

pub(super) fn ellipse(place: &Affine, part: &Ellipse, named: &Named) -> Result<Course, PathFault> {
    facing(&part.normal, named)?;
    let size = part.major_axis.x.abs().max(part.major_axis.y.abs());
    if part.major_axis.z.abs() > 1e-6 * size {
        return Err(fault(named.line, &named.name, TILTED));
    }
    let along = [part.major_axis.x, part.major_axis.y];
    let ratio = part.minor_axis_ratio * part.normal.z.signum();
    let across = [-ratio * along[1], ratio * along[0]];
    let (from, centre) = (part.start_parameter, xy(&part.center));
    let (sin, cos) = libm::sincos(from);
    let start = [0, 1].map(|i| centre[i] + cos * along[i] + sin * across[i]);
    let mut chain = Outline::new(place, start);
    let to = from + sweep(from, part.end_parameter);
    chain.ellipse(centre, [along, across], [from, to]);
    Ok((chain.start, chain.curves))
}

/// Reason to leave a mesh out.
pub(super) const MESH: &str = "a mesh of surfaces is no line; explode it to lines and arcs";

/// Returns true for a polyline that has surfaces.
pub(super) fn is_mesh(line: &Polyline) -> bool {
    line.is_3d_polygon_mesh() || line.is_polyface_mesh()
}

pub(super) fn vertices(line: &Polyline, named: &Named) -> Result<Vec<([f64; 2], f64)>, PathFault> {
    let shown: Vec<_> = line
        .vertices()
        .filter(|vertex| vertex.flags & CONTROL_VERTEX == 0)
        .collect();
    let places: Vec<&Point> = shown.iter().map(|vertex| &vertex.location).collect();
    level(&places, named)?;
    Ok(shown
        .iter()
        .map(|vertex| (xy(&vertex.location), vertex.bulge))
        .collect())
}
