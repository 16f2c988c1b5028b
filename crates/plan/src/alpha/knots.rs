//! Places on a stretch of a path at which alpha is chosen; between them it is a spline.

use crate::path::PathPiece;
use crate::piece::length;

/// Part of the distance between knots within which a joint of pieces attracts one.
const SNAP: f64 = 0.1;

/// Extent of a piece.
#[derive(Clone, Copy, Debug)]
struct Extent {
    /// D's way from the start of the stretch, and along the piece.
    start_m: f64,
    length_m: f64,
    /// A distance whose derivative by D's way has no jump where D moves on, and its change along the piece.
    start: f64,
    scale: f64,
}

/// A place at which alpha is chosen.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Knot {
    /// Index of the piece that it ends or lies on; 0 at the start.
    pub(crate) piece: usize,
    /// Parameter of the piece.
    pub(crate) p: f64,
    /// D's way from the start.
    pub(crate) way_m: f64,
    /// The distance by which alpha is a spline.
    pub(crate) distance: f64,
    /// alpha, where the user gives it.
    pub(crate) fixed: Option<f64>,
    /// The motion stops here, and alpha need not go on in the same direction.
    pub(crate) breaks: bool,
}

/// Pieces along which D moves, and their knots.
pub(crate) struct Stretch<'a> {
    pub(crate) pieces: &'a [PathPiece],
    /// alpha at the end of each piece, where it is fixed.
    ends: &'a [Option<f64>],
    extents: Vec<Extent>,
    /// D's way to each stop, both ends among them.
    stops: Vec<f64>,
}

impl<'a> Stretch<'a> {
    pub(crate) fn new(pieces: &'a [PathPiece], ends: &'a [Option<f64>]) -> Self {
        let mut extents: Vec<Extent> = Vec::with_capacity(pieces.len());
        let mut stops = vec![0.0];
        for (index, each) in pieces.iter().enumerate() {
            let length_m = each.piece.length_m();
            let extent = match (index.checked_sub(1), extents.last()) {
                (Some(before), Some(last)) => {
                    let start_m = last.start_m + last.length_m;
                    let before = &pieces[before];
                    let is_joint = each.joint(before).is_some();
                    if !is_joint {
                        stops.push(start_m);
                    }
                    let speeds = [before.piece.at(1.0).first, each.piece.at(0.0).first].map(length);
                    Extent {
                        start_m,
                        length_m,
                        start: last.start + last.scale,
                        scale: match is_joint {
                            true => last.scale * speeds[1] / speeds[0],
                            false => length_m,
                        },
                    }
                }
                _ => Extent {
                    start_m: 0.0,
                    length_m,
                    start: 0.0,
                    scale: length_m,
                },
            };
            extents.push(extent);
        }
        let mut stretch = Self {
            pieces,
            ends,
            extents,
            stops,
        };
        stretch.stops.push(stretch.way_m());
        stretch
    }

    /// D's way along the whole stretch.
    pub(crate) fn way_m(&self) -> f64 {
        self.extents
            .last()
            .map_or(0.0, |last| last.start_m + last.length_m)
    }

    /// Length of D's way along piece `index`.
    pub(crate) fn length_m(&self, index: usize) -> f64 {
        self.extents[index].length_m
    }

    /// Distance from piece `index` at `p`, and its derivative by p.
    pub(crate) fn distance(&self, index: usize, p: f64) -> [f64; 2] {
        let extent = &self.extents[index];
        [extent.start + extent.scale * p, extent.scale]
    }

    /// D's way to the nearest stop.
    pub(crate) fn to_stop_m(&self, way_m: f64) -> f64 {
        let next = self.stops.partition_point(|stop| *stop < way_m);
        let around = [next.saturating_sub(1), next.min(self.stops.len() - 1)];
        let ways = around.map(|stop| (self.stops[stop] - way_m).abs());
        ways[0].min(ways[1])
    }

    /// Piece and parameter at `way_m`, with p linear in the way along the piece.
    pub(crate) fn place(&self, way_m: f64) -> (usize, f64) {
        let next = self
            .extents
            .partition_point(|extent| extent.start_m <= way_m);
        let index = next.saturating_sub(1);
        let extent = &self.extents[index];
        let p = (way_m - extent.start_m) / extent.length_m;
        (index, p.clamp(0.0, 1.0))
    }

    fn knot(&self, piece: usize, p: f64) -> Knot {
        let extent = &self.extents[piece];
        Knot {
            piece,
            p,
            way_m: extent.start_m + extent.length_m * p,
            distance: extent.start + extent.scale * p,
            fixed: None,
            breaks: false,
        }
    }

    /// Knots about `spacing` apart, from one at the start with alpha `start`.
    pub(crate) fn knots(&self, spacing: f64, start: f64) -> Vec<Knot> {
        let whole = self.way_m();
        let mut knots = vec![Knot {
            fixed: Some(start),
            breaks: true,
            ..self.knot(0, 0.0)
        }];
        // Way to the last anchor, and to the last place where the direction may change.
        let (mut anchor, mut broken) = (0.0, 0.0);
        for (index, fixed) in self.ends.iter().enumerate() {
            let end = Knot {
                fixed: *fixed,
                ..self.knot(index, 1.0)
            };
            let is_last = index + 1 == self.pieces.len();
            let is_stop = self.to_stop_m(end.way_m) == 0.0;
            // Stops that follow each other closely leave no room for a turn between them.
            let apart = end.way_m - broken >= spacing && whole - end.way_m >= spacing;
            let breaks = is_last || (is_stop && apart);
            if !breaks && fixed.is_none() {
                continue;
            }
            self.fill(&mut knots, [anchor, end.way_m], spacing);
            knots.push(Knot { breaks, ..end });
            anchor = end.way_m;
            if breaks {
                broken = anchor;
            }
        }
        knots
    }

    /// Adds knots between two places.
    fn fill(&self, knots: &mut Vec<Knot>, [from, to]: [f64; 2], spacing: f64) {
        let count = ((to - from) / spacing).ceil().max(1.0);
        let apart = (to - from) / count;
        for part in 1..count as u32 {
            let (piece, p) = self.place(from + f64::from(part) * apart);
            let near = SNAP * apart / self.extents[piece].length_m;
            // A sliver between a knot and a joint would be a piece of its own.
            knots.push(match (p < near, p > 1.0 - near) {
                (true, _) if piece > 0 => self.knot(piece - 1, 1.0),
                (false, true) => self.knot(piece, 1.0),
                _ => self.knot(piece, p),
            });
        }
    }
}
