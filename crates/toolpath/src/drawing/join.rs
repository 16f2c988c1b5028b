//! Joining of strokes that meet: CAD programs draw an outline line by line.

use super::Stroke;
use std::collections::HashMap;

/// Joins strokes whose ends are at most `near` apart, of those with the same `key`. A joined stroke has the shape of its
/// first part, and stands where that stood.
pub(super) fn join<K: PartialEq>(
    strokes: Vec<Stroke>,
    near: f64,
    key: impl Fn(&Stroke) -> K,
) -> Vec<Stroke> {
    let cell = |point: [f64; 2]| point.map(|value| (value / near).round() as i64);
    let mut ends: HashMap<[i64; 2], Vec<usize>> = HashMap::new();
    for (index, stroke) in strokes.iter().enumerate() {
        for end in [stroke.start, stroke.end()] {
            ends.entry(cell(end)).or_default().push(index);
        }
    }
    let mut left: Vec<Option<Stroke>> = strokes.into_iter().map(Some).collect();
    // Takes a stroke that begins or ends at the end of `chain`, in the sense in which it goes on from there.
    let next = |left: &mut Vec<Option<Stroke>>, chain: &Stroke| -> Option<Stroke> {
        let at = chain.end();
        let meets = |point: [f64; 2]| libm::hypot(point[0] - at[0], point[1] - at[1]) <= near;
        if meets(chain.start) {
            return None;
        }
        let [x, y] = cell(at);
        let around = (-1..=1).flat_map(|dx| (-1..=1).map(move |dy| [x + dx, y + dy]));
        for index in around.filter_map(|place| ends.get(&place)).flatten() {
            // A closed stroke, both of whose ends meet here, stays an outline of its own.
            let fits = left[*index].as_ref().is_some_and(|stroke| {
                key(stroke) == key(chain) && meets(stroke.start) != meets(stroke.end())
            });
            if fits {
                let stroke = left[*index].take()?;
                return Some(match meets(stroke.start) {
                    true => stroke,
                    false => stroke.reversed(),
                });
            }
        }
        None
    };
    let mut joined = Vec::new();
    for index in 0..left.len() {
        let Some(mut chain) = left[index].take() else {
            continue;
        };
        let shape = chain.shape;
        for _ in 0..2 {
            while let Some(stroke) = next(&mut left, &chain) {
                chain.curves.extend(stroke.curves);
            }
            // Then on from the start.
            chain = chain.reversed();
        }
        chain.shape = shape;
        joined.push(chain);
    }
    joined
}
