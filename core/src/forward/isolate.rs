//! The real roots of f, each on an arc of its own.

use super::polynomial::Polynomial;
use crate::number::Number;

/// Six roots and, at worst, a few undecided arcs.
const MOST_ROOTS: usize = 12;
/// Arcs examined before the rest counts as undecided: many times the need of any machine tested.
const MOST_ARCS: u32 = 4096;
/// Arcs that the circle is divided into at first.
const FIRST_ARCS: u32 = 8;
/// Halvings of an arc. 64 go below the resolution of any number type; the rounding bound ends them
/// long before.
const MOST_HALVINGS: usize = 64;

/// An arc on which f has a root.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Arc<N> {
    pub(super) low: N,
    pub(super) high: N,
    /// Exactly one root, and a simple one. Otherwise f stays below its rounding bound on the arc: it
    /// may have two roots, or four, or none.
    pub(super) simple_root: bool,
    /// f has different signs at the ends: an odd number of roots.
    pub(super) odd: bool,
}

/// All arcs with a root, in ascending order, from -pi to pi. One that contains pi ends beyond it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Isolated<N> {
    arcs: [Arc<N>; MOST_ROOTS],
    count: usize,
    /// There were more arcs than there is room for, so that roots may be missing.
    pub(super) exhausted: bool,
    /// Arcs that were examined.
    pub(super) visited: u32,
}

impl<N: Number> Isolated<N> {
    pub(super) fn arcs(&self) -> &[Arc<N>] {
        &self.arcs[..self.count]
    }

    /// Appends `arc`. An undecided arc joins an undecided one that it continues.
    fn push(&mut self, arc: Arc<N>) {
        if let Some(last) = self.arcs[..self.count].last_mut()
            && !last.simple_root
            && !arc.simple_root
            && last.high == arc.low
        {
            last.high = arc.high;
            last.odd ^= arc.odd;
            return;
        }
        if self.count == MOST_ROOTS {
            self.exhausted = true;
            return;
        }
        self.arcs[self.count] = arc;
        self.count += 1;
    }

    /// Joins undecided arcs at pi and at -pi.
    fn join_ends(&mut self, turn: N) {
        if self.count < 2 {
            return;
        }
        let (first, last) = (self.arcs[0], self.arcs[self.count - 1]);
        if !first.simple_root && !last.simple_root && last.high - first.low >= turn {
            self.arcs[self.count - 1].high = last.high + (first.high - first.low);
            self.arcs[self.count - 1].odd ^= first.odd;
            self.arcs.copy_within(1..self.count, 0);
            self.count -= 1;
        }
    }
}

/// An end of an arc and the sign of f there. It is computed once and holds for the arcs on both
/// sides, so that a root at an end belongs to exactly one of them.
#[derive(Clone, Copy)]
struct ArcEnd<N> {
    alpha: N,
    positive: bool,
}

/// Divides the circle until every arc holds no root, holds one root, or is undecided.
pub(super) fn isolate<N: Number>(f: &Polynomial<N>) -> Isolated<N> {
    let none = Arc {
        low: N::ZERO,
        high: N::ZERO,
        simple_root: false,
        odd: false,
    };
    let mut found = Isolated {
        arcs: [none; MOST_ROOTS],
        count: 0,
        exhausted: false,
        visited: 0,
    };
    let pi = N::from_f64(core::f64::consts::PI);
    let end = |alpha: N| ArcEnd {
        alpha,
        positive: f.is_positive(alpha),
    };
    let start = end(-pi);
    let mut low = start;
    // Right ends of the arcs still to be examined, the next one on top. The left end of each is the
    // right end of the one above it.
    let mut ends = [start; MOST_HALVINGS + 1];
    for index in 1..=FIRST_ARCS {
        let high = if index == FIRST_ARCS {
            ArcEnd { alpha: pi, ..start }
        } else {
            let turns = N::ratio(index, FIRST_ARCS);
            end((turns + turns - N::ONE) * pi)
        };
        ends[0] = high;
        let mut waiting = 1;
        while waiting > 0 {
            let high = ends[waiting - 1];
            let half_width = N::HALF * (high.alpha - low.alpha);
            let middle = low.alpha + half_width;
            let (sin, cos) = N::sin_cos(N::angle(N::HALF * half_width));
            let on_arc = f.on_arc(middle, half_width, sin.div(cos));
            found.visited += 1;
            let odd = low.positive != high.positive;
            let arc = |simple_root| Arc {
                low: low.alpha,
                high: high.alpha,
                simple_root,
                odd,
            };
            let on_arc = on_arc.filter(|on_arc| !on_arc.is_clear());
            let Some(on_arc) = on_arc else {
                low = high;
                waiting -= 1;
                continue;
            };
            if on_arc.is_monotone() {
                if odd {
                    found.push(arc(true));
                }
            } else if on_arc.is_within_rounding()
                || waiting > MOST_HALVINGS
                || !(middle > low.alpha && middle < high.alpha)
                || found.visited >= MOST_ARCS
            {
                found.push(arc(false));
            } else {
                ends[waiting] = end(middle);
                waiting += 1;
                continue;
            }
            low = high;
            waiting -= 1;
        }
    }
    found.join_ends(pi + pi);
    found
}

/// Finds the root on an arc with a simple root, to the rounding of f. Secant steps keep the root
/// between two ends; a halving replaces them where they are slow.
pub(super) fn refine<N: Number>(f: &Polynomial<N>, arc: &Arc<N>) -> N {
    let (mut low, mut high) = (arc.low, arc.high);
    let (mut f_low, mut f_high) = (f.value(low), f.value(high));
    let four = N::ONE + N::ONE + N::ONE + N::ONE;
    let least = four * N::UNIT_ROUNDOFF;
    let mut before = high - low;
    for step in 0..3 * MOST_HALVINGS {
        let width = high - low;
        if !(width > least) || f_low == N::ZERO || (f_low > N::ZERO) == (f_high > N::ZERO) {
            break;
        }
        // Every third step halves unless the two before have.
        let halve = step % 3 == 2 && width + width > before;
        let secant = low + width * f_low.div(f_low - f_high);
        let next = if !halve && secant > low && secant < high {
            secant
        } else {
            low + N::HALF * width
        };
        if step % 3 == 2 {
            before = width;
        }
        let f_next = f.value(next);
        if !(next > low && next < high) || f_next == N::ZERO {
            return next;
        }
        // The end that stays counts half: the next secant will not stay on the same side.
        if (f_next > N::ZERO) == (f_low > N::ZERO) {
            (low, f_low, f_high) = (next, f_next, N::HALF * f_high);
        } else {
            (high, f_high, f_low) = (next, f_next, N::HALF * f_low);
        }
    }
    // The smaller of the two; they lie roundings apart.
    if f_low.abs() < f_high.abs() {
        low
    } else {
        high
    }
}
