//! Lines and curves that lie on one another: CAD programs leave them, and a tool would go over them again.

use super::stroke::point_at;
use super::{Drawing, Rgb, Stroke, StrokeCurve, layer};
use std::collections::HashMap;

/// Distance of points, m, that are one place.
const NEAR_M: f64 = 1e-6;

/// StrokePart of a stroke by its ends and its middle.
type StrokePart = [[f64; 2]; 3];

/// Parts that were seen, of each layer and colour, by the places of their middles.
#[derive(Default)]
struct SeenParts<'s> {
    keys: HashMap<(Option<Rgb>, &'s str), usize>,
    parts: HashMap<(usize, [i64; 2]), Vec<StrokePart>>,
}

impl<'s> SeenParts<'s> {
    fn key(&mut self, colour: Option<Rgb>, layer: &'s str) -> usize {
        let next = self.keys.len();
        *self.keys.entry((colour, layer)).or_insert(next)
    }

    fn has(&self, key: usize, part: &StrokePart) -> bool {
        let [x, y] = cell(part[2]);
        let around = (-1..=1).flat_map(|dx| (-1..=1).map(move |dy| [x + dx, y + dy]));
        let seen = around.filter_map(|cell| self.parts.get(&(key, cell)));
        seen.flatten().any(|other| is_same(part, other))
    }

    fn add(&mut self, key: usize, part: StrokePart) {
        self.parts
            .entry((key, cell(part[2])))
            .or_default()
            .push(part);
    }
}

fn cell(point: [f64; 2]) -> [i64; 2] {
    point.map(|value| (value / NEAR_M).round() as i64)
}

fn is_same(one: &StrokePart, other: &StrokePart) -> bool {
    let near = |a: [f64; 2], b: [f64; 2]| libm::hypot(a[0] - b[0], a[1] - b[1]) <= NEAR_M;
    let along = near(one[0], other[0]) && near(one[1], other[1]);
    let back = near(one[0], other[1]) && near(one[1], other[0]);
    near(one[2], other[2]) && (along || back)
}

/// Parts of a stroke, with their curves.
fn parts(stroke: &Stroke) -> impl Iterator<Item = (StrokePart, &StrokeCurve)> {
    let starts = std::iter::once(stroke.start).chain(stroke.curves.iter().map(StrokeCurve::end));
    let parts = starts.zip(&stroke.curves);
    parts.map(|(from, curve)| ([from, curve.end(), point_at(from, curve, 0.5)], curve))
}

/// Takes out of `strokes` those that lie on others of their layer and colour from end to end.
#[cfg(feature = "dxf")]
pub(super) fn take_doubles<'s>(
    strokes: &mut Vec<Stroke>,
    layer_of: impl Fn(&Stroke) -> &'s str,
) -> Vec<Stroke> {
    let mut seen = SeenParts::default();
    let (mut kept, mut doubles) = (Vec::new(), Vec::new());
    for stroke in std::mem::take(strokes) {
        let key = seen.key(stroke.colour, layer_of(&stroke));
        if parts(&stroke).all(|(part, _)| seen.has(key, &part)) {
            doubles.push(stroke);
        } else {
            parts(&stroke).for_each(|(part, _)| seen.add(key, part));
            kept.push(stroke);
        }
    }
    *strokes = kept;
    doubles
}

impl Drawing {
    /// Counts the lines and curves that lie on others of their layer and colour, and leaves them out if `drops`. Returns their number, and
    /// the place of the first one.
    pub fn doubles(&mut self, drops: bool) -> Option<(usize, String)> {
        let mut seen = SeenParts::default();
        let (mut count, mut first) = (0, None);
        let mut kept: Vec<Stroke> = Vec::new();
        for (index, stroke) in self.strokes.iter().enumerate() {
            let key = seen.key(stroke.colour, layer(&self.shapes, stroke.shape));
            let piece = |start| Stroke {
                start,
                curves: Vec::new(),
                ..stroke.clone()
            };
            let mut open: Option<Stroke> = None;
            for (part, curve) in parts(stroke) {
                if seen.has(key, &part) {
                    first.get_or_insert(index);
                    count += 1;
                    kept.extend(open.take());
                } else {
                    seen.add(key, part);
                    let open = open.get_or_insert_with(|| piece(part[0]));
                    open.curves.push(*curve);
                }
            }
            kept.extend(open);
        }
        let place = self.place_of(2 * first? as u32 + 2);
        if drops {
            self.strokes = kept;
        }
        Some((count, place))
    }
}
