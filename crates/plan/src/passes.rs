//! The fastest motion through a row of cells, in two passes.
//!
//! x is given at the start of every cell and at the end of the last: one value more than there are
//! cells. The backward pass finds the greatest x at each place from which the end can still be
//! reached: below it every x can, for the limits are convex, and rest is within them in every cell that was measured. The
//! forward pass
//! takes the greatest x that stays below.

use crate::cell::{Cell, Limited};
use crate::extreme::{greater, lesser, unbounded};
use crate::program;
use trirrr_core::number::Arithmetic;

/// Backward pass: writes to `squares` the greatest x at each place from which x = `end` can be reached at the
/// end of the last cell. `squares` has one value more than `cells`; what it holds before is where searches begin.
pub fn controllable<B: Arithmetic>(cells: &[Cell<B>], end: B, squares: &mut [B]) {
    let mut at_end = end;
    squares[cells.len()] = at_end;
    for (index, cell) in cells.iter().enumerate().rev() {
        let start = greatest_start(cell, at_end, squares[index]);
        squares[index] = start;
        at_end = start.div(cell.joint);
    }
}

/// Forward pass: lowers `squares`, as [`controllable`] has left them, to the fastest motion that begins with
/// x = `start`, or as near below it as the limits allow.
pub fn fastest<B: Arithmetic>(cells: &[Cell<B>], start: B, squares: &mut [B]) {
    squares[0] = lesser(squares[0], start);
    for (index, cell) in cells.iter().enumerate() {
        let joint = next_joint(cells, index);
        let cap = squares[index + 1].div(joint);
        let end = greatest_end(cell, squares[index], cap);
        squares[index + 1] = lesser(squares[index + 1], end * joint);
    }
}

/// Time that the motion takes.
pub fn duration<B: Arithmetic>(cells: &[Cell<B>], squares: &[B]) -> B {
    let mut total = B::ZERO;
    for (index, cell) in cells.iter().enumerate() {
        let [start, end] = ends_of(cells, squares, index);
        total += time_between(cell.length, start, end);
    }
    total
}

/// The limit that is nearest in cell `index` of a motion.
pub fn acting<B: Arithmetic>(cells: &[Cell<B>], squares: &[B], index: usize) -> Option<Limited> {
    let [start, end] = ends_of(cells, squares, index);
    crate::program::acting(&cells[index], start, end)
}

/// Time over the length `length` for x linear in p from `start` to `end`.
pub(crate) fn time_between<B: Arithmetic>(length: B, start: B, end: B) -> B {
    (length + length).div(start.sqrt() + end.sqrt())
}

/// x at the start and at the end of cell `index` of a motion, by the parameter of its own piece.
pub(crate) fn ends_of<B: Arithmetic>(cells: &[Cell<B>], squares: &[B], index: usize) -> [B; 2] {
    [
        squares[index],
        squares[index + 1].div(next_joint(cells, index)),
    ]
}

/// Scale of x from the end of cell `index` to the start of the next.
pub(crate) fn next_joint<B: Arithmetic>(cells: &[Cell<B>], index: usize) -> B {
    cells.get(index + 1).map_or(B::ONE, |next| next.joint)
}

/// Steps towards the greatest x that a hold's share and a power limit leave.
const STEPS: u32 = 32;

/// Change of x, as a part of it, at which the steps end.
const SETTLED: u32 = 1 << 16;

/// Greatest x at the start of `cell` from which x <= `end` can be reached; `guess` may be near it.
pub(crate) fn greatest_start<B: Arithmetic>(cell: &Cell<B>, end: B, guess: B) -> B {
    best(cell, B::ZERO, guess, |allowed, cap| {
        program::greatest_start(cell, allowed, [cap, lesser(end, cap)])
    })
}

/// Greatest x <= `cap` at the end of `cell` that can be reached from x = `start`.
pub(crate) fn greatest_end<B: Arithmetic>(cell: &Cell<B>, start: B, cap: B) -> B {
    best(cell, start, start, |allowed, bound| {
        let is_certain = !(allowed > start);
        program::greatest_end(cell, allowed, [start, lesser(cap, bound)], is_certain)
    })
}

/// The best that `reach` finds over all x, from `from`, that the limits of the cell may allow for; `reach` gets that x and a
/// cap. The search begins at `guess` if that is not 0.
fn best<B: Arithmetic>(cell: &Cell<B>, from: B, guess: B, reach: impl Fn(B, B) -> Option<B>) -> B {
    let (zero, half) = (B::ZERO, B::HALF);
    let far = || reach(zero, unbounded()).unwrap_or(zero);
    let holds = cell.ramp > zero;
    if cell.limits.powers.is_empty() && !holds {
        return far();
    }
    let mut best = zero;
    if cell.limits.powers.is_empty() {
        // What a hold takes of a limit is bounded by the tangent of a root: allowing for what was reached reaches
        // more, as by Newton's method. The start itself can always be allowed for.
        let mut x = if guess > zero { guess } else { far() };
        for _ in 0..STEPS {
            let Some(reached) = reach(x, unbounded()) else {
                x = half * half * x + (half + half * half) * from;
                continue;
            };
            best = greater(best, reached);
            if (reached - x).abs() <= x * B::ratio(1, SETTLED) || !(reached > zero) {
                break;
            }
            x = reached;
        }
        return best;
    }
    // A power limit leaves less of a torque the more x is allowed for: the best lies where that x is reached.
    let (mut low, mut high) = (from, greater(from, far()));
    best = reach(from, from).unwrap_or(zero);
    for _ in 0..STEPS {
        if high - low <= high * B::ratio(1, SETTLED) {
            break;
        }
        let middle = half * (low + high);
        let reached = reach(middle, middle);
        best = reached.map_or(best, |reached| greater(best, reached));
        match reached.is_some_and(|reached| reached >= middle) {
            true => low = middle,
            false => high = middle,
        }
    }
    best
}
