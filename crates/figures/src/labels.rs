//! Names beside points, placed where they cover least of a drawing.
//!
//! Everything that should stay visible is given first, as lines and discs. Then each name takes the place, of some around its
//! point, that covers the least of these and of the names before it.

use crate::canvas::{CENTRED, Canvas, Draw, Size};
use crate::style::{FRAME, INK, WHITE};
use std::f64::consts::TAU;

/// Directions that are tried around a point.
const DIRECTIONS: u32 = 16;
/// Distances between the rim of a point and its name that are tried, in logical pixels.
const DISTANCES: [f64; 4] = [3.0, 10.0, 20.0, 34.0];
/// From this distance on a thin line leads from the point to its name.
const LEADER: f64 = 15.0;
/// Height of a name, in logical pixels.
const HEIGHT: f64 = 15.0;
/// Cost of a pixel of another name that is covered; a pixel of a line costs its weight.
const NAME_COST: f64 = 3.0;
/// Cost of a pixel beyond the edge.
const EDGE_COST: f64 = 40.0;

/// Upright rectangle on the page.
#[derive(Clone, Copy, Debug, PartialEq)]
struct PageBox {
    left: f64,
    top: f64,
    right: f64,
    bottom: f64,
}

impl PageBox {
    fn around((x, y): (f64, f64), width: f64, height: f64) -> Self {
        Self {
            left: x - 0.5 * width,
            top: y - 0.5 * height,
            right: x + 0.5 * width,
            bottom: y + 0.5 * height,
        }
    }

    fn shared_area(&self, other: &Self) -> f64 {
        let across = self.right.min(other.right) - self.left.max(other.left);
        let down = self.bottom.min(other.bottom) - self.top.max(other.top);
        across.max(0.0) * down.max(0.0)
    }

    /// Length of the part of a line that lies within.
    fn length_within(&self, [(ax, ay), (bx, by)]: [(f64, f64); 2]) -> f64 {
        let (dx, dy) = (bx - ax, by - ay);
        let (mut first, mut last) = (0.0_f64, 1.0_f64);
        // Liang and Barsky: the part of the line on the inner side of each edge.
        for (step, room) in [
            (-dx, ax - self.left),
            (dx, self.right - ax),
            (-dy, ay - self.top),
            (dy, self.bottom - ay),
        ] {
            if step == 0.0 {
                if room < 0.0 {
                    return 0.0;
                }
            } else if step < 0.0 {
                first = first.max(room / step);
            } else {
                last = last.min(room / step);
            }
        }
        (last - first).max(0.0) * dx.hypot(dy)
    }

    /// Pixels by which the edges of `within` are passed.
    fn beyond(&self, within: &Self) -> f64 {
        let sides = [
            within.left - self.left,
            self.right - within.right,
            within.top - self.top,
            self.bottom - within.bottom,
        ];
        sides.iter().map(|side| side.max(0.0)).sum()
    }
}

/// Names of one drawing, and what they should not cover.
pub struct Labels {
    edges: PageBox,
    lines: Vec<([(f64, f64); 2], f64)>,
    boxes: Vec<PageBox>,
    names: Vec<(String, (f64, f64), f64)>,
}

impl Labels {
    /// Names that stay within a rectangle of the page, from its upper left corner.
    pub fn within((left, top): (f64, f64), width: f64, height: f64) -> Self {
        Self {
            edges: PageBox {
                left,
                top,
                right: left + width,
                bottom: top + height,
            },
            lines: Vec::new(),
            boxes: Vec::new(),
            names: Vec::new(),
        }
    }

    /// Keeps names off the lines between `points`. A pixel of them costs `weight`, 1 for what must be seen.
    pub fn avoid_line(&mut self, points: &[(f64, f64)], weight: f64) {
        let pairs = points.windows(2).map(|pair| ([pair[0], pair[1]], weight));
        self.lines.extend(pairs);
    }

    /// Keeps names off a disc.
    pub fn avoid_disc(&mut self, centre: (f64, f64), radius: f64) {
        self.boxes
            .push(PageBox::around(centre, 2.0 * radius, 2.0 * radius));
    }

    /// Asks for `text` beside a point that is drawn with `radius`.
    pub fn name(&mut self, text: &str, at: (f64, f64), radius: f64) {
        self.avoid_disc(at, radius);
        self.names.push((text.to_owned(), at, radius));
    }

    /// Writes all names.
    ///
    /// # Errors
    /// Failures of plotters.
    pub fn draw(mut self, canvas: &Canvas<'_>) -> Draw {
        for (text, at, radius) in std::mem::take(&mut self.names) {
            let (middle, distance) = self.place(&text, at, radius);
            self.boxes.push(Self::extent(&text, middle));
            if distance >= LEADER {
                let (dx, dy) = (middle.0 - at.0, middle.1 - at.1);
                let length = dx.hypot(dy);
                let end = |along: f64| (at.0 + along / length * dx, at.1 + along / length * dy);
                canvas.line(&[end(radius), end(radius + distance)], FRAME, 0.8)?;
            }
            for (dx, dy) in [(-1.2, 0.0), (1.2, 0.0), (0.0, -1.2), (0.0, 1.2)] {
                let around = (middle.0 + dx, middle.1 + dy);
                canvas.text(&text, around, Size::Label, CENTRED, WHITE)?;
            }
            canvas.text(&text, middle, Size::Label, CENTRED, INK)?;
        }
        Ok(())
    }

    fn extent(text: &str, middle: (f64, f64)) -> PageBox {
        PageBox::around(middle, Size::Label.width(text), HEIGHT)
    }

    /// Middle of the best place for a name, and its distance from the rim.
    fn place(&self, text: &str, (x, y): (f64, f64), radius: f64) -> ((f64, f64), f64) {
        let (half_width, half_height) = (0.5 * Size::Label.width(text), 0.5 * HEIGHT);
        let mut best = ((x, y), 0.0, f64::INFINITY);
        for distance in DISTANCES {
            for direction in 0..DIRECTIONS {
                let (sin, cos) =
                    (TAU * (f64::from(direction) + 0.5) / f64::from(DIRECTIONS)).sin_cos();
                let off = radius + distance;
                let middle = (x + cos * (off + half_width), y - sin * (off + half_height));
                // Upper right is where names are looked for first.
                let taste = 2.0 * distance - 3.0 * (cos + sin);
                let cost = taste + self.cost(&Self::extent(text, middle));
                if cost < best.2 {
                    best = (middle, distance, cost);
                }
            }
        }
        (best.0, best.1)
    }

    fn cost(&self, name: &PageBox) -> f64 {
        let lines = self.lines.iter();
        let lines = lines.map(|(line, weight)| 4.0 * weight * name.length_within(*line));
        let boxes = self
            .boxes
            .iter()
            .map(|other| NAME_COST * name.shared_area(other));
        lines.sum::<f64>() + boxes.sum::<f64>() + EDGE_COST * name.beyond(&self.edges)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_measured_within_a_box() {
        let page = PageBox::around((5.0, 5.0), 10.0, 10.0);
        for (line, length) in [
            ([(-5.0, 5.0), (25.0, 5.0)], 10.0),
            ([(2.0, 2.0), (2.0, 6.0)], 4.0),
            ([(-5.0, 11.0), (25.0, 11.0)], 0.0),
            ([(-5.0, -5.0), (15.0, 15.0)], 200f64.sqrt()),
        ] {
            let found = page.length_within(line);
            assert!((found - length).abs() < 1e-12, "{line:?}: {found}");
        }
    }

    #[test]
    fn a_name_avoids_lines_names_and_edges() {
        let mut labels = Labels::within((0.0, 0.0), 200.0, 200.0);
        // Everything right of the point and above it is taken.
        labels.avoid_line(&[(100.0, 100.0), (200.0, 100.0)], 1.0);
        labels.avoid_line(&[(100.0, 100.0), (190.0, 20.0)], 1.0);
        labels.avoid_line(&[(100.0, 100.0), (100.0, 0.0)], 1.0);
        labels.name("A", (100.0, 100.0), 5.0);
        let (middle, _) = labels.place("A", (100.0, 100.0), 5.0);
        assert_eq!(labels.cost(&Labels::extent("A", middle)), 0.0, "{middle:?}");
        // Another name at the same point takes another place.
        labels.boxes.push(Labels::extent("A", middle));
        let (other, _) = labels.place("B", (100.0, 100.0), 5.0);
        assert_eq!(
            Labels::extent("A", middle).shared_area(&Labels::extent("B", other)),
            0.0
        );
        // In a corner the name stays within.
        let corner = Labels::within((0.0, 0.0), 200.0, 200.0);
        let (middle, _) = corner.place("corner", (199.0, 1.0), 2.0);
        assert_eq!(Labels::extent("corner", middle).beyond(&corner.edges), 0.0);
    }
}
