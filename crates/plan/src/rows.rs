//! Limits over a cell, as lines with their errors: what the passes compute with.

use crate::extreme::{greater, lesser};
use heapless::Vec;
use trirrr_core::number::Arithmetic;
use trirrr_service::admission::{Enclose, ModelLine, TaylorModel};

/// Most rows of a cell: rate, acceleration and torque of three motors, the speed of D, and the tolerance.
pub(crate) const ROWS: usize = 11;

/// A quantity that a limit bounds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Limited {
    /// Joint rate of a motor, 0 to 2.
    Rate(usize),
    /// Joint acceleration of a motor.
    Acceleration(usize),
    /// Torque of a motor.
    Torque(usize),
    /// Mechanical power of a motor.
    Power(usize),
    /// Joint jerk of a motor.
    Jerk(usize),
    /// Speed of the reference point D.
    Feed,
    /// Distance from the path by which moves smooth the motion.
    Tolerance,
    /// Rounding of the number type in which the moves are played, or what its proof cannot tell from it.
    Number,
}

/// Limits of a cell that were lowered for moves, and why.
#[cfg(feature = "std")]
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lowered<B> {
    /// Reason of the next lowering.
    next: Option<Limited>,
    /// Reason of most of it so far, and the part that it left of the limits.
    most: Option<(Limited, B)>,
}

/// |acceleration a + square x + rest| <= limit over a cell; each coefficient is a `T`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Row<T, B> {
    pub(crate) what: Limited,
    /// Coefficient of a; none where the quantity depends on x alone and is not negative.
    pub(crate) acceleration: Option<T>,
    /// Coefficient of x.
    pub(crate) square: T,
    /// Value at rest.
    pub(crate) rest: T,
    pub(crate) limit: B,
}

/// A row as it is measured.
pub(crate) type ModelRow<N> = Row<TaylorModel<N>, <N as Enclose>::Bound>;

/// Limit of the power of one motor: |torque| |theta'| u <= limit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PowerLimit<T, B> {
    /// Greatest |theta'| of the cell, and the least.
    pub(crate) rate: B,
    pub(crate) least_rate: B,
    /// The torque, with an unused limit.
    pub(crate) torque: Row<T, B>,
    pub(crate) limit: B,
}

/// All limits over a cell.
#[derive(Clone, Debug)]
pub(crate) struct Rows<T, B> {
    pub(crate) rows: Vec<Row<T, B>, ROWS>,
    pub(crate) powers: Vec<PowerLimit<T, B>, 3>,
}

/// Limits over a stretch of a piece.
#[derive(Clone, Debug)]
pub struct Cell<B> {
    /// Length of the stretch in p, positive.
    pub(crate) length: B,
    /// x at the start of this cell over x at the end of the cell before: not 1 where pieces join.
    pub(crate) joint: B,
    /// Part that the passes use of what the limits leave for motion, 0 to 1.
    pub(crate) share: B,
    /// Target of `share` at the next lowering, as a part of itself.
    tightened: B,
    /// r: rate of change of the pace that a hold may add, in paces per unit of time.
    pub(crate) ramp: B,
    /// A power is limited at the pace that the motion has and at each lower one, and not by the torque at rest alone.
    #[cfg(feature = "std")]
    pub(crate) is_paced: bool,
    #[cfg(feature = "std")]
    lowered: Lowered<B>,
    pub(crate) limits: Rows<ModelLine<B>, B>,
}

impl<N: Enclose> ModelRow<N> {
    /// square x <= limit^2.
    pub(crate) fn of_square(what: Limited, square: TaylorModel<N>, limit: N::Bound) -> Self {
        Self {
            what,
            acceleration: None,
            square,
            rest: TaylorModel::ZERO,
            limit: limit * limit,
        }
    }

    pub(crate) fn is_finite(&self) -> bool {
        self.acceleration.is_none_or(TaylorModel::is_finite)
            && self.square.is_finite()
            && self.rest.is_finite()
    }
}

impl<T: Copy, B: Copy> Row<T, B> {
    fn convert<U>(&self, each: impl Fn(T) -> U) -> Row<U, B> {
        Row {
            what: self.what,
            acceleration: self.acceleration.map(&each),
            square: each(self.square),
            rest: each(self.rest),
            limit: self.limit,
        }
    }
}

impl<T: Copy, B: Copy> Rows<T, B> {
    pub(crate) const fn new() -> Self {
        Self {
            rows: Vec::new(),
            powers: Vec::new(),
        }
    }

    /// There is room: each kind of row occurs once for each motor.
    pub(crate) fn push(&mut self, row: Row<T, B>) {
        let _ = self.rows.push(row);
    }

    pub(crate) fn convert<U: Copy>(&self, each: impl Fn(T) -> U + Copy) -> Rows<U, B> {
        let power = |power: &PowerLimit<T, B>| PowerLimit {
            rate: power.rate,
            least_rate: power.least_rate,
            torque: power.torque.convert(each),
            limit: power.limit,
        };
        Rows {
            rows: self.rows.iter().map(|row| row.convert(each)).collect(),
            powers: self.powers.iter().map(power).collect(),
        }
    }
}

impl<B: Arithmetic> Cell<B> {
    /// The cell of `length` with these limits.
    pub(crate) fn new(length: B, limits: Rows<ModelLine<B>, B>) -> Self {
        Self {
            length,
            joint: B::ONE,
            share: B::ONE,
            tightened: B::ONE,
            ramp: B::ZERO,
            #[cfg(feature = "std")]
            is_paced: false,
            #[cfg(feature = "std")]
            lowered: Lowered {
                next: None,
                most: None,
            },
            limits,
        }
    }

    /// Sets the scale of the pace at the start of this cell: x here over x at the end of the cell before.
    pub fn join(&mut self, joint: B) {
        self.joint = joint;
    }

    /// Takes the coefficients in the middle of the cell for all of it: an estimate, no proof.
    #[cfg(feature = "std")]
    pub(crate) fn flatten(&mut self) {
        self.limits = self.limits.convert(|line| ModelLine {
            slope: B::ZERO,
            error: B::ZERO,
            ..line
        });
    }

    /// Returns true if a power is limited at each pace from rest on.
    pub(crate) fn is_paced(&self) -> bool {
        #[cfg(feature = "std")]
        return self.is_paced;
        #[cfg(not(feature = "std"))]
        false
    }

    /// Uses the limits as `whole` does, of which this cell is a part.
    #[cfg(feature = "std")]
    pub(crate) fn limit_as(&mut self, whole: &Self) {
        (self.share, self.tightened, self.ramp) = (whole.share, whole.tightened, whole.ramp);
        self.lowered = whole.lowered;
    }

    /// Leaves room for a hold at the rate `ramp` in the passes from now on; a cell is measured without.
    pub fn reserve(&mut self, ramp: B) {
        self.ramp = ramp;
    }

    /// Notes that the passes are to use no more than `share` of what they use of the limits now. Of several shares
    /// the least counts, from the next [`apply_tightening`](Self::apply_tightening) on.
    pub fn tighten(&mut self, share: B) {
        self.tightened = lesser(self.tightened, share);
    }

    /// The same, because of `why`.
    #[cfg(feature = "std")]
    pub(crate) fn tighten_for(&mut self, share: B, why: Limited) {
        if share < self.tightened {
            self.lowered.next = Some(why);
        }
        self.tighten(share);
    }

    /// Returns why moves leave more than a twentieth of the limits unused, if they do: the pace goes with the root.
    #[cfg(feature = "std")]
    pub(crate) fn lowered_for(&self) -> Option<Limited> {
        let (why, part) = self.lowered.most?;
        (part < B::ratio(19, 20)).then_some(why)
    }

    /// Lowers the part of the limits that the passes use, down to 1e-8 at most: the pace goes with its root.
    pub fn apply_tightening(&mut self) {
        self.share = greater(self.share * self.tightened, B::ratio(1, 100_000_000));
        #[cfg(feature = "std")]
        if let Some(why) = self.lowered.next.take() {
            let part = self.tightened;
            self.lowered.most = match self.lowered.most {
                Some((before, all)) if before == why => Some((why, all * part)),
                Some(more) if more.1 <= part => Some(more),
                _ => Some((why, part)),
            };
        }
        self.tightened = B::ONE;
    }

    /// Length in p.
    pub fn length(&self) -> B {
        self.length
    }
}

#[cfg(all(test, feature = "std"))]
mod tests {
    use super::{Cell, Limited, Rows};

    /// The reason that left the least of the limits is told, and little of any reason is none.
    #[test]
    fn a_cell_tells_why_its_limits_are_lowered() {
        let mut cell = Cell::<f64>::new(1.0, Rows::new());
        let mut lower = |share, why| {
            cell.tighten_for(share, why);
            cell.apply_tightening();
            cell.lowered_for()
        };
        assert_eq!(lower(0.98, Limited::Number), None);
        assert_eq!(lower(0.96, Limited::Number), Some(Limited::Number));
        assert_eq!(lower(0.97, Limited::Tolerance), Some(Limited::Number));
        assert_eq!(lower(0.7, Limited::Tolerance), Some(Limited::Tolerance));
        assert_eq!(lower(0.9, Limited::Torque(1)), Some(Limited::Tolerance));
    }
}
