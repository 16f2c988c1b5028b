//! The limit that a refusal of the pipeline stands for.

use super::breach::{Breach, Extent, greater};
use super::path::Path;
use super::taylor::{Float, TaylorModel};
use crate::admission::Enclose;
use trirrr_core::inverse::Rotation;
use trirrr_core::model::Model;
use trirrr_core::number::{Arithmetic, dot};
use trirrr_core::setpoint::Setpoint;
use trirrr_core::status::Status;
use trirrr_protocol::message::Bounded;

impl<N: Enclose, M: Model<N = N>> Path<M> {
    /// Returns the limit that is broken where the pipeline ends without a value.
    pub(super) fn breach(
        &self,
        status: Status,
        setpoint: &Setpoint<TaylorModel<N>>,
        rotation: &Rotation<TaylorModel<N>>,
    ) -> Breach<Float<N>> {
        match status {
            Status::Unreachable { leg } | Status::SerialSingular { leg } => {
                let geometry = &self.tick.geometry().legs()[leg];
                let c = rotation.apply(geometry.joint());
                let d = (setpoint.pose.position - geometry.base()) + c;
                let squared = dot(d, d);
                let (shortest, longest) = geometry.dyad().reach();
                let (shortest, longest) = (shortest.middle(), longest.middle());
                // The span that is on the wrong side, or may be, of the nearer of the two bounds.
                let zero = <Float<N>>::ZERO;
                let root = |square: Float<N>| greater(zero, square).sqrt();
                let size = Extent {
                    least: root(squared.middle() - squared.radius()),
                    value: root(squared.middle()),
                    greatest: root(squared.middle() + squared.radius()),
                    curved: zero,
                };
                let stretched = !(squared.middle()
                    <= <Float<N>>::HALF * (shortest * shortest + longest * longest));
                let (limit, beyond) = if stretched {
                    (longest, size.least - longest)
                } else {
                    (shortest, shortest - size.greatest)
                };
                // The roots and the reach itself are rounded.
                let rounding = N::roundoff(longest + longest);
                Breach {
                    certain: beyond > (rounding + rounding) + (rounding + rounding),
                    ..Breach::above(Bounded::Reach, leg, &size, limit, false)
                }
            }
            // det A cannot be told from zero, in the number type of the tick.
            Status::ParallelSingular => {
                let size = Extent {
                    least: <Float<N>>::ZERO,
                    value: <Float<N>>::ZERO,
                    greatest: <Float<N>>::ONE,
                    curved: <Float<N>>::ZERO,
                };
                let least = self.limits.parallel_distance;
                Breach::below(Bounded::ParallelDistance, None, &size, least)
            }
            Status::OutOfRange => Breach::out_of_range(),
        }
    }
}
