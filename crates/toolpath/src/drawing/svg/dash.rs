//! Dashes of a stroke.

use super::chain::CurveChain;
use super::curve::PathCurve;

/// Most dashes of a shape.
pub(super) const DASHES_MAX: f64 = 1e6;

/// Cuts chains into dashes: lengths with and without a line, in turn, from `offset` on. Nothing where they are too many.
pub(super) fn dashes(
    chains: &[CurveChain],
    lengths: &[f64],
    offset: f64,
) -> Option<Vec<CurveChain>> {
    let period: f64 = lengths.iter().sum();
    let way: f64 = chains.iter().map(CurveChain::length).sum();
    // Of an empty list, or one with numbers beyond counting, no part is a number.
    let count = way / period * lengths.len() as f64;
    if count.is_nan() || count > DASHES_MAX {
        return None;
    }
    let mut found = Vec::new();
    for chain in chains {
        let mut pen = DashPen::new(lengths, offset.rem_euclid(period), chain.start);
        for (from, curve) in chain.curves() {
            let ends = curve.lengths(from);
            let whole = ends.last().copied().unwrap_or(0.0);
            let (mut at, mut t) = (0.0, 0.0);
            while pen.left <= whole - at {
                at += pen.left;
                let next = curve.at_length(from, &ends, at);
                pen.draw(from, curve, [t, next]);
                pen.turn(curve.at(from, next), &mut found);
                t = next;
            }
            pen.left -= whole - at;
            pen.draw(from, curve, [t, 1.0]);
        }
        pen.lift(&mut found);
    }
    Some(found)
}

/// Pen along a chain: the dash that it is in.
struct DashPen<'l> {
    lengths: &'l [f64],
    /// Number of the dash or gap.
    index: usize,
    /// Length that is left of it.
    left: f64,
    dash: CurveChain,
}

impl<'l> DashPen<'l> {
    fn new(lengths: &'l [f64], mut offset: f64, start: [f64; 2]) -> Self {
        let mut index = 0;
        while offset >= lengths[index % lengths.len()] && index < 2 * lengths.len() {
            offset -= lengths[index % lengths.len()];
            index += 1;
        }
        Self {
            lengths,
            index,
            left: lengths[index % lengths.len()] - offset,
            dash: CurveChain::new(start),
        }
    }

    fn draw(&mut self, from: [f64; 2], curve: &PathCurve, [t0, t1]: [f64; 2]) {
        // What rounding leaves at an end is no dash.
        if self.index.is_multiple_of(2) && t1 - t0 > 1e-9 {
            self.dash.curves.push(curve.part(from, [t0, t1]).1);
        }
    }

    /// Ends a dash or a gap.
    fn turn(&mut self, at: [f64; 2], found: &mut Vec<CurveChain>) {
        self.lift(found);
        self.dash = CurveChain::new(at);
        self.index += 1;
        self.left = self.lengths[self.index % self.lengths.len()];
    }

    fn lift(&mut self, found: &mut Vec<CurveChain>) {
        if !self.dash.curves.is_empty() {
            let next = CurveChain::new(self.dash.end());
            found.push(std::mem::replace(&mut self.dash, next));
        }
    }
}
