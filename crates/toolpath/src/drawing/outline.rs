//! Outlines: closed strokes as polygons.

use super::{FLATNESS_M, Stroke, StrokeCurve};

/// Gap of ends that are one, m.
const MEET_M: f64 = 2e-6;

pub(super) fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    libm::hypot(b[0] - a[0], b[1] - a[1])
}

/// Closed stroke as a polygon, and its box.
pub(super) struct ClosedOutline {
    pub(super) points: Vec<[f64; 2]>,
    low: [f64; 2],
    high: [f64; 2],
}

impl ClosedOutline {
    /// Outline of a closed stroke, without the leads that it may have. None: it is open, or has no area.
    pub(super) fn of(stroke: &Stroke) -> Option<Self> {
        let meets = |a, b| distance(a, b) <= MEET_M;
        let points = match stroke.curves.as_slice() {
            _ if meets(stroke.start, stroke.end()) => stroke.points(FLATNESS_M),
            [first, inner @ .., StrokeCurve::Line(_)] => {
                let closed = Stroke {
                    start: first.end(),
                    curves: inner.to_vec(),
                    ..*stroke
                };
                let is_led = matches!(first, StrokeCurve::Line(_)) && !inner.is_empty();
                if !is_led || !meets(closed.start, closed.end()) {
                    return None;
                }
                closed.points(FLATNESS_M)
            }
            _ => return None,
        };
        let outline = Self::new(points);
        (outline.area() > 0.0).then_some(outline)
    }

    fn new(points: Vec<[f64; 2]>) -> Self {
        let side = |i: usize, start: f64, most: fn(f64, f64) -> f64| {
            points.iter().map(|point| point[i]).fold(start, most)
        };
        Self {
            low: [0, 1].map(|i| side(i, f64::INFINITY, f64::min)),
            high: [0, 1].map(|i| side(i, f64::NEG_INFINITY, f64::max)),
            points,
        }
    }

    /// Area of the box.
    pub(super) fn area(&self) -> f64 {
        (self.high[0] - self.low[0]) * (self.high[1] - self.low[1])
    }

    pub(super) fn holds(&self, [x, y]: [f64; 2]) -> bool {
        let in_box = x > self.low[0] && x < self.high[0] && y > self.low[1] && y < self.high[1];
        let crossings = self.points.windows(2).filter(|pair| {
            let [a, b] = [pair[0], pair[1]];
            (a[1] <= y) != (b[1] <= y) && a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]) > x
        });
        in_box && crossings.count() % 2 == 1
    }

    /// Returns true if the line between two points crosses the outline.
    #[cfg(feature = "offset")]
    pub(super) fn crosses(&self, from: [f64; 2], to: [f64; 2]) -> bool {
        let side = |a: [f64; 2], b: [f64; 2], point: [f64; 2]| {
            (b[0] - a[0]) * (point[1] - a[1]) - (b[1] - a[1]) * (point[0] - a[0]) > 0.0
        };
        self.points.windows(2).any(|pair| {
            side(from, to, pair[0]) != side(from, to, pair[1])
                && side(pair[0], pair[1], from) != side(pair[0], pair[1], to)
        })
    }
}
