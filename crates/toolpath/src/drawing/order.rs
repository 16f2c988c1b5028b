//! Order of strokes: short ways with the tool off.

use super::Drawing;

/// Most strokes that are put into order: the work grows with the square of their number.
const STROKES_MAX: usize = 10_000;

impl Drawing {
    /// Draws next the stroke whose start or end is nearest, from `from` on, m in the drawing. A stroke is turned round
    /// where its end is nearer. A drawing with more than 10,000 strokes keeps its order.
    pub fn order(&mut self, from: [f64; 2]) {
        if self.strokes.len() > STROKES_MAX {
            return;
        }
        let mut at = from;
        let mut left = std::mem::take(&mut self.strokes);
        while !left.is_empty() {
            let way = |point: [f64; 2]| libm::hypot(point[0] - at[0], point[1] - at[1]);
            let ways = left
                .iter()
                .map(|stroke| (way(stroke.start), way(stroke.end())));
            let nearest = ways
                .enumerate()
                .min_by(|(_, one), (_, other)| one.0.min(one.1).total_cmp(&other.0.min(other.1)));
            let Some((index, (to_start, to_end))) = nearest else {
                break;
            };
            // Of strokes that are as near, the first of the file: `remove` keeps the order of the others.
            let stroke = left.remove(index);
            let stroke = match to_end < to_start {
                true => stroke.reversed(),
                false => stroke,
            };
            at = stroke.end();
            self.strokes.push(stroke);
        }
    }
}
