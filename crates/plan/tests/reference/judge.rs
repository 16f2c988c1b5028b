//! The admission as the judge of planned moves.

use trirrr_core::model::Model;
use trirrr_core::number::Arithmetic;
use trirrr_core::setpoint::{Ends, Quintics};
use trirrr_protocol::message::{AnyMove, Move};
use trirrr_service::admission::{Admission, Enclose, Verdict};

/// Part of a limit by which the move is beyond it, or not proven to keep it; none for a move that is admitted.
pub(crate) fn excess<M: Model<N: Enclose>>(
    admission: &mut Admission<M, Quintics>,
    ends: &Ends<M::N, Quintics>,
    ticks: u32,
) -> Option<M::N> {
    let Ends {
        from,
        to,
        velocities,
        accelerations,
    } = *ends;
    let [start_velocity, end_velocity] = velocities.map(Into::into);
    let common = Move {
        start_velocity,
        end_velocity,
        ..Move::rest_to_rest(0, from, to, ticks)
    };
    assert!(admission.offer_any(&AnyMove::new(common, accelerations)));
    loop {
        if let Some(violation) = admission.violation() {
            return Some(violation.value.div(violation.limit) - M::N::ONE);
        }
        if admission.step() == Verdict::Admitted {
            return None;
        }
    }
}
