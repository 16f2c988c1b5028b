//! Limits that a move breaks.

use crate::admission::Enclose;
use nalgebra::Vector3;
use trirrr_core::number::{Arithmetic, Number};
use trirrr_core::setpoint::{CurveKind, Ends, Pose};
use trirrr_protocol::message::{Bounded, Violation};

/// Bounds of the size of a quantity over an interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Extent<N> {
    /// It is nowhere less.
    pub(super) least: N,
    /// In the middle of the interval.
    pub(super) value: N,
    /// It is nowhere more.
    pub(super) greatest: N,
    /// Part of the bounds that is not linear in time: a quarter over each half of the interval.
    pub(super) curved: N,
}

impl<N: Arithmetic> Extent<N> {
    /// Returns the bounds of the greatest of two quantities.
    #[inline(never)]
    pub(super) fn or(self, other: Self) -> Self {
        Self {
            least: greater(self.least, other.least),
            value: greater(self.value, other.value),
            greatest: greater(self.greatest, other.greatest),
            curved: greater(self.curved, other.curved),
        }
    }

    /// Returns a bound of the distance from the value.
    fn error(&self) -> N {
        greater(self.greatest - self.value, self.value - self.least)
    }
}

/// The greater of the two; what is not a number counts as greater.
pub(super) fn greater<N: Arithmetic>(a: N, b: N) -> N {
    if a <= b { b } else { a }
}

/// A limit that is broken, or that is not certain to be kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Breach<N> {
    pub(super) what: Bounded,
    /// Leg, motor or coordinate, from 0.
    pub(super) index: Option<u8>,
    pub(super) value: N,
    /// Bound of the distance of the true value from `value`.
    pub(super) error: N,
    pub(super) limit: N,
    /// True if only a change of the speed along the path leads to the breach.
    pub(super) ramp: bool,
    /// True if the limit is broken all over the interval.
    pub(super) certain: bool,
    /// Halvings of the interval after which the limit would be kept if nothing but curvature mattered, 1 or 2.
    pub(super) halvings: u32,
}

/// As in a [`Breach`] that is `excess` beyond its limit. At most two: over long intervals the excess falls faster than
/// curvature.
#[inline(never)]
fn halvings<N: Arithmetic>(excess: N, curved: N) -> u32 {
    let room = curved - excess;
    let after_one = N::HALF * (N::HALF * curved);
    match room > N::ZERO && after_one > room {
        true => 2,
        false => 1,
    }
}

impl<N: Number> Breach<N> {
    /// A size of motor `index` that is not certain to be at most `limit`.
    #[inline(never)]
    pub(super) fn above(
        what: Bounded,
        index: usize,
        size: &Extent<N>,
        limit: N,
        ramp: bool,
    ) -> Self {
        let (value, error) = (size.value, size.error());
        Self {
            what,
            index: Some(index as u8),
            value,
            error,
            limit,
            ramp,
            certain: value - error > limit,
            halvings: halvings(size.greatest - limit, size.curved),
        }
    }

    /// A distance that is not certain to be positive and at least `limit`.
    #[inline(never)]
    pub(super) fn below(what: Bounded, leg: Option<usize>, size: &Extent<N>, limit: N) -> Self {
        let (value, error) = (size.value, size.error());
        let greatest = value + error;
        Self {
            what,
            index: leg.map(|leg| leg as u8),
            value,
            error,
            limit,
            ramp: false,
            certain: greatest < limit || greatest <= N::ZERO,
            halvings: halvings(limit - size.least, size.curved),
        }
    }

    pub(super) fn out_of_range() -> Self {
        Self {
            what: Bounded::Range,
            index: None,
            value: N::ZERO,
            error: N::ONE.div(N::ZERO),
            limit: N::ZERO,
            ramp: false,
            certain: false,
            halvings: 1,
        }
    }

    /// Returns whether a slower move might keep the limit.
    pub(super) fn is_of_speed(&self) -> bool {
        match self.what {
            Bounded::Rate
            | Bounded::Acceleration
            | Bounded::Torque
            | Bounded::Power
            | Bounded::Jerk
            | Bounded::AccelerationJump => true,
            Bounded::Reach
            | Bounded::SerialDistance
            | Bounded::ParallelDistance
            | Bounded::Range => false,
        }
    }

    /// In the type of the tick.
    #[inline(never)]
    pub(super) fn violation<M: Enclose<Bound = N>>(&self, at: N) -> Violation<M> {
        // The type of the tick may round the value and the error itself, and may end below them.
        let conversion = M::conversion(self.value.abs() + self.error);
        let value = M::from_bound(self.value);
        let error = M::from_bound(self.error + (conversion + conversion));
        let known = value.is_finite() && error.is_finite();
        Violation {
            what: self.what,
            index: self.index,
            at: M::from_bound(at),
            value: if known { value } else { M::ZERO },
            error: known.then_some(error),
            limit: M::from_bound(self.limit),
            certain: self.certain,
            ramp: self.ramp,
            shortest: None,
        }
    }
}

/// Returns the breach that makes `offered` no move at all, if there is one.
pub(super) fn of_input<N: Enclose, K: CurveKind>(
    ends: &Ends<N, K>,
    ticks: u32,
) -> Option<Breach<N::Bound>> {
    let (zero, one) = (<N::Bound>::ZERO, <N::Bound>::ONE);
    let breach = |index, value, limit| Breach {
        what: Bounded::Range,
        index,
        value,
        error: zero,
        limit,
        ramp: false,
        certain: true,
        halvings: 1,
    };
    if ticks == 0 {
        return Some(breach(None, zero, one));
    }
    let angle = |pose: &Pose<N>| <N::Bound>::radians(N::angle_bound(pose.angle));
    let coordinates = |pose: &Pose<N>| {
        let [x, y] = [pose.position.x, pose.position.y].map(N::bound);
        [x, y, angle(pose)]
    };
    let bounds = |v: &Vector3<N>| [N::bound(v.x), N::bound(v.y), N::bound(v.z)];
    let [start, end] = &ends.velocities;
    let groups = [
        coordinates(&ends.from),
        coordinates(&ends.to),
        bounds(start),
        bounds(end),
    ];
    let mut found = first_not_finite(&groups);
    if let Some([start, end]) = K::given(&ends.accelerations) {
        let groups = [start.map(N::bound), end.map(N::bound)];
        found = found.or(first_not_finite(&groups));
    }
    if let Some((index, value)) = found {
        return Some(breach(Some(index), value, zero));
    }
    // An angle is known to its roundoff: beyond this one, to less than a ten-thousandth of a
    // radian.
    let finest = <N::Bound>::from_f64(1e-4);
    for angle in [angle(&ends.from), angle(&ends.to)] {
        if N::roundoff(angle.abs()) > finest {
            let limit = finest.div(<N::Bound>::UNIT_ROUNDOFF);
            return Some(breach(Some(2), angle, limit));
        }
    }
    None
}

/// The first value that is infinite or not a number, and its coordinate.
#[inline(never)]
fn first_not_finite<B: Arithmetic>(groups: &[[B; 3]]) -> Option<(u8, B)> {
    for group in groups {
        for (index, value) in group.iter().enumerate() {
            if !value.is_finite() {
                return Some((index as u8, *value));
            }
        }
    }
    None
}
