//! Edges of a region: chords of its outlines.

use super::chain::CurveChain;
use super::curve::distance;

/// Largest distance of a chord from an edge of a region, m.
pub(super) const FLATNESS_M: f64 = 5e-7;

/// Distance within which a point is on an edge, m: chords of two like curves are that near.
pub(super) const NEAR_M: f64 = 2.0 * FLATNESS_M;

/// Most rows by which edges are found.
const ROWS_MAX: usize = 4096;

/// Chords around a shape, by rows along y.
#[derive(Debug)]
pub(super) struct Edges {
    edges: Vec<[[f64; 2]; 2]>,
    rows: Vec<Vec<u32>>,
    /// Lower left and upper right corner of all.
    pub(super) low: [f64; 2],
    pub(super) high: [f64; 2],
}

impl Edges {
    pub(super) fn new(chains: &[CurveChain]) -> Self {
        let mut edges = Vec::new();
        for chain in chains {
            let mut points = chain.points(FLATNESS_M);
            points.push(chain.start);
            edges.extend(points.windows(2).map(|pair| [pair[0], pair[1]]));
        }
        let all = || edges.iter().flatten();
        let low = [0, 1].map(|i| all().map(|point| point[i]).fold(f64::INFINITY, f64::min));
        let high = [0, 1].map(|i| {
            all()
                .map(|point| point[i])
                .fold(f64::NEG_INFINITY, f64::max)
        });
        let mut found = Self {
            rows: vec![Vec::new(); edges.len().clamp(1, ROWS_MAX)],
            edges,
            low,
            high,
        };
        for index in 0..found.edges.len() {
            let [a, b] = found.edges[index];
            let rows = found.rows_of(a[1].min(b[1]), a[1].max(b[1]));
            for row in rows {
                found.rows[row].push(index as u32);
            }
        }
        found
    }

    /// Rows that hold the heights between two.
    fn rows_of(&self, low: f64, high: f64) -> std::ops::RangeInclusive<usize> {
        let count = self.rows.len();
        let height = (self.high[1] - self.low[1]).max(f64::MIN_POSITIVE);
        let row = |y: f64| {
            ((y - self.low[1]) / height * count as f64).clamp(0.0, (count - 1) as f64) as usize
        };
        row(low - NEAR_M)..=row(high + NEAR_M)
    }

    pub(super) fn winding(&self, [x, y]: [f64; 2]) -> i32 {
        if !(self.low[1]..=self.high[1]).contains(&y) {
            return 0;
        }
        let row = *self.rows_of(y + NEAR_M, y - NEAR_M).start();
        let mut winding = 0;
        for &index in &self.rows[row] {
            let [a, b] = self.edges[index as usize];
            if (a[1] <= y) == (b[1] <= y) {
                continue;
            }
            let at = a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
            if at > x {
                winding += if a[1] < b[1] { 1 } else { -1 };
            }
        }
        winding
    }

    pub(super) fn is_near(&self, point: [f64; 2]) -> bool {
        let outside = [0, 1]
            .iter()
            .any(|&i| point[i] < self.low[i] - NEAR_M || point[i] > self.high[i] + NEAR_M);
        !outside
            && self.rows_of(point[1], point[1]).any(|row| {
                self.rows[row].iter().any(|&index| {
                    let [a, b] = self.edges[index as usize];
                    let side = [b[0] - a[0], b[1] - a[1]];
                    let size = side[0] * side[0] + side[1] * side[1];
                    let dot = (point[0] - a[0]) * side[0] + (point[1] - a[1]) * side[1];
                    let t = if size > 0.0 {
                        (dot / size).clamp(0.0, 1.0)
                    } else {
                        0.0
                    };
                    distance(point, [a[0] + t * side[0], a[1] + t * side[1]]) <= NEAR_M
                })
            })
    }

    /// Tells the places, 0 to 1 of a chord, at which it meets an edge.
    pub(super) fn crossings(&self, p: [f64; 2], q: [f64; 2], tell: &mut dyn FnMut(f64)) {
        let (low, high) = (
            [p[0].min(q[0]), p[1].min(q[1])],
            [p[0].max(q[0]), p[1].max(q[1])],
        );
        if [0, 1]
            .iter()
            .any(|&i| high[i] < self.low[i] - NEAR_M || low[i] > self.high[i] + NEAR_M)
        {
            return;
        }
        let r = [q[0] - p[0], q[1] - p[1]];
        let length = libm::hypot(r[0], r[1]);
        if length == 0.0 {
            return;
        }
        let cross = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
        let rows = self.rows_of(low[1], high[1]);
        let first = *rows.start();
        for row in rows {
            for &index in &self.rows[row] {
                let [a, b] = self.edges[index as usize];
                // An edge of several rows is met in the first of them.
                if row > first && *self.rows_of(a[1].min(b[1]), a[1].max(b[1])).start() != row {
                    continue;
                }
                if [0, 1]
                    .iter()
                    .any(|&i| a[i].max(b[i]) < low[i] - NEAR_M || a[i].min(b[i]) > high[i] + NEAR_M)
                {
                    continue;
                }
                let s = [b[0] - a[0], b[1] - a[1]];
                let size = libm::hypot(s[0], s[1]);
                let to = [a[0] - p[0], a[1] - p[1]];
                let across = cross(r, s);
                let mut tell_in = |place: f64| {
                    let near = NEAR_M / length;
                    if (-near..=1.0 + near).contains(&place) {
                        tell(place.clamp(0.0, 1.0));
                    }
                };
                if across.abs() > 1e-9 * length * size {
                    let along = cross(to, r) / across * size;
                    if (-NEAR_M..=size + NEAR_M).contains(&along) {
                        tell_in(cross(to, s) / across);
                    }
                } else if (cross(r, to) / length).abs() <= NEAR_M {
                    for end in [a, b] {
                        let dot = (end[0] - p[0]) * r[0] + (end[1] - p[1]) * r[1];
                        tell_in(dot / (length * length));
                    }
                }
            }
        }
    }
}
