//! Limits that a move breaks.

use crate::admission::Enclose;
use trirrr_core::number::{Arithmetic, Number};
use trirrr_core::setpoint::Pose;
use trirrr_protocol::message::{Bounded, Move, Violation};

/// A limit that is broken, or cannot be told from broken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Breach<N> {
    pub(super) what: Bounded,
    /// Leg, motor or coordinate, from 0.
    pub(super) index: Option<u8>,
    /// The bound that was found: never on the good side of the limit.
    pub(super) value: N,
    pub(super) limit: N,
    /// True if only a change of the speed along the path leads to the breach.
    pub(super) ramp: bool,
}

impl<N: Number> Breach<N> {
    /// A distance of at least `value`.
    pub(super) fn distance(what: Bounded, leg: Option<usize>, value: N, limit: N) -> Self {
        Self {
            what,
            index: leg.map(|leg| leg as u8),
            value: if value > N::ZERO { value } else { N::ZERO },
            limit,
            ramp: false,
        }
    }

    pub(super) fn out_of_range() -> Self {
        Self {
            what: Bounded::Range,
            index: None,
            value: N::ZERO,
            limit: N::ZERO,
            ramp: false,
        }
    }

    /// Returns whether a slower move might keep the limit.
    pub(super) fn is_of_speed(&self) -> bool {
        match self.what {
            Bounded::Rate | Bounded::Acceleration | Bounded::Torque | Bounded::Power => true,
            Bounded::Reach
            | Bounded::SerialDistance
            | Bounded::ParallelDistance
            | Bounded::Range => false,
        }
    }

    /// In the type of the tick.
    pub(super) fn violation<M: Enclose<Bound = N>>(&self, at: N) -> Violation<M> {
        Violation {
            what: self.what,
            index: self.index,
            at: M::from_bound(at),
            value: M::from_bound(self.value),
            limit: M::from_bound(self.limit),
            ramp: self.ramp,
            shortest: None,
        }
    }
}

/// Returns the breach that makes `offered` no move at all, if there is one.
pub(super) fn of_input<N: Enclose>(offered: &Move<N>) -> Option<Breach<N::Bound>> {
    let breach = |index, value, limit| Breach {
        what: Bounded::Range,
        index,
        value,
        limit,
        ramp: false,
    };
    let (zero, one) = (<N::Bound>::ZERO, <N::Bound>::ONE);
    if offered.ticks == 0 {
        return Some(breach(None, zero, one));
    }
    let angle = |pose: &Pose<N>| <N::Bound>::radians(N::angle_bound(pose.angle));
    let coordinates = |pose: &Pose<N>| {
        let [x, y] = [pose.position.x, pose.position.y].map(N::bound);
        [x, y, angle(pose)]
    };
    let groups = [
        coordinates(&offered.from),
        coordinates(&offered.to),
        offered.start_velocity.map(N::bound),
        offered.end_velocity.map(N::bound),
    ];
    for group in groups {
        for (index, value) in group.into_iter().enumerate() {
            if !value.is_finite() {
                return Some(breach(Some(index as u8), value, zero));
            }
        }
    }
    // An angle is known to its roundoff: beyond this one, to less than a ten-thousandth of a
    // radian.
    let finest = <N::Bound>::from_f64(1e-4);
    for angle in [angle(&offered.from), angle(&offered.to)] {
        if N::roundoff(angle.abs()) > finest {
            let limit = finest.div(<N::Bound>::UNIT_ROUNDOFF);
            return Some(breach(Some(2), angle, limit));
        }
    }
    None
}
