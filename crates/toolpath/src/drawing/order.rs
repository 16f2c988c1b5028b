//! Order of strokes: what is inside first, and short ways with the tool off.

use super::outline::{ClosedOutline, distance};
use super::{Drawing, Stroke};

/// Most strokes that are put into order: the work grows with the square of their number.
const STROKES_MAX: usize = 10_000;

/// Most turned parts of the order that are looked at.
const TURNS_MAX: u64 = 30_000_000;

/// Ways with the tool off, m, from the start to the last stroke.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OffTravel {
    /// In the order of the file.
    pub in_file_m: f64,
    /// In the order that is drawn.
    pub ordered_m: f64,
}

impl Drawing {
    /// Puts the strokes into an order with short ways between them, from `from` on, m in the drawing. A stroke within a
    /// closed one comes before that: a hole is cut while its part is held. Of the others the nearest is next, from either
    /// end; then parts of the order are turned round as long as that shortens the ways. A drawing with more than 10,000
    /// strokes keeps its order.
    pub fn order(&mut self, from: [f64; 2]) -> OffTravel {
        let in_file_m = ways(from, &self.strokes);
        if self.strokes.len() <= STROKES_MAX {
            let around = around(&self.strokes);
            let mut order = nearest(from, &self.strokes, &around);
            turn(from, &mut order, &self.strokes, &around);
            let mut left: Vec<Option<Stroke>> = self.strokes.drain(..).map(Some).collect();
            let taken = order.iter().filter_map(|next| {
                let stroke = left[next.index].take()?;
                Some(if next.is_back {
                    stroke.reversed()
                } else {
                    stroke
                })
            });
            self.strokes = taken.collect();
        }
        OffTravel {
            in_file_m,
            ordered_m: ways(from, &self.strokes),
        }
    }
}

/// Stroke in an order, and true if it is drawn from its end.
#[derive(Clone, Copy)]
struct Next {
    index: usize,
    is_back: bool,
}

impl Next {
    /// Start and end, as it is drawn.
    fn ends(self, strokes: &[Stroke]) -> [[f64; 2]; 2] {
        let stroke = &strokes[self.index];
        match self.is_back {
            true => [stroke.end(), stroke.start],
            false => [stroke.start, stroke.end()],
        }
    }
}

fn ways(from: [f64; 2], strokes: &[Stroke]) -> f64 {
    let mut at = from;
    let ways = strokes.iter().map(|stroke| {
        let way = distance(at, stroke.start);
        at = stroke.end();
        way
    });
    ways.sum()
}

/// Closed strokes around each stroke.
fn around(strokes: &[Stroke]) -> Vec<Vec<u32>> {
    let outlines: Vec<(u32, ClosedOutline)> = (0..)
        .zip(strokes)
        .filter_map(|(index, stroke)| Some((index, ClosedOutline::of(stroke)?)))
        .collect();
    let found = (0..).zip(strokes).map(|(index, stroke): (u32, &Stroke)| {
        let place = stroke.start;
        let own = outlines.binary_search_by_key(&index, |(other, _)| *other);
        let size = own.map_or(0.0, |own| outlines[own].1.area());
        let holds = |(other, outline): &&(u32, ClosedOutline)| {
            *other != index && outline.area() > size && outline.holds(place)
        };
        outlines
            .iter()
            .filter(holds)
            .map(|(other, _)| *other)
            .collect()
    });
    found.collect()
}

/// Order in which the nearest stroke is next, of those with nothing left inside.
fn nearest(from: [f64; 2], strokes: &[Stroke], around: &[Vec<u32>]) -> Vec<Next> {
    let mut inside = vec![0_u32; strokes.len()];
    for outer in around.iter().flatten() {
        inside[*outer as usize] += 1;
    }
    let mut left: Vec<usize> = (0..strokes.len()).collect();
    let mut at = from;
    let mut order = Vec::new();
    while !left.is_empty() {
        let free = left
            .iter()
            .enumerate()
            .filter(|(_, index)| inside[**index] == 0);
        let ways = free.map(|(place, &index)| {
            let stroke = &strokes[index];
            let [to_start, to_end] = [stroke.start, stroke.end()].map(|point| distance(at, point));
            (to_start.min(to_end), place, to_end < to_start)
        });
        // Of strokes that are as near, the first of the file.
        let Some((_, place, is_back)) = ways.min_by(|one, other| one.0.total_cmp(&other.0)) else {
            break;
        };
        let index = left.remove(place);
        for outer in &around[index] {
            inside[*outer as usize] -= 1;
        }
        let next = Next { index, is_back };
        at = next.ends(strokes)[1];
        order.push(next);
    }
    order
}

/// Turns parts of an order round where that shortens the ways, and no stroke comes before one inside it.
fn turn(from: [f64; 2], order: &mut [Next], strokes: &[Stroke], around: &[Vec<u32>]) {
    let mut looks = 0_u64;
    let mut is_shorter = true;
    while is_shorter && looks < TURNS_MAX {
        is_shorter = false;
        for first in 0..order.len() {
            let before = match first.checked_sub(1) {
                Some(index) => order[index].ends(strokes)[1],
                None => from,
            };
            // Strokes of the part, and their outlines: of two that hold one another the order stays.
            let mut outer: Vec<u32> = Vec::new();
            for last in first..order.len() {
                looks += 1;
                let index = order[last].index as u32;
                if outer.contains(&index) {
                    break;
                }
                outer.extend(&around[index as usize]);
                let start = order[first].ends(strokes)[0];
                let end = order[last].ends(strokes)[1];
                let behind = order.get(last + 1).map(|next| next.ends(strokes)[0]);
                let way = |to: [f64; 2], out: [f64; 2]| {
                    distance(before, to) + behind.map_or(0.0, |behind| distance(out, behind))
                };
                if way(end, start) < way(start, end) - 1e-9 {
                    let part = &mut order[first..=last];
                    part.reverse();
                    part.iter_mut()
                        .for_each(|next| next.is_back = !next.is_back);
                    is_shorter = true;
                    break;
                }
            }
            if looks >= TURNS_MAX {
                break;
            }
        }
    }
}
