//! The admission of a move: every instant of the path is proven to keep the limits, or the move is refused
//! with what breaks, where, and the shortest duration that passes.
//!
//! Run with `cargo run -p trirrr-service --example admit_move`.

use std::error::Error;
use trirrr_core::limits::{LimitParameters, Limits};
use trirrr_core::machine::example;
use trirrr_core::model::Dynamic;
use trirrr_core::setpoint::Pose;
use trirrr_protocol::message::Move;
use trirrr_service::admission::{Admission, Verdict};
use trirrr_service::paces::Ramp;

/// Tick rate, Hz.
const RATE_HZ: f64 = 100.0;

fn main() -> Result<(), Box<dyn Error>> {
    let limits = LimitParameters {
        rate_rad_s: Some([3.0; 3]),
        torque_nm: Some([0.05; 3]),
        ..LimitParameters::default()
    };
    // A stop on the path takes 10 ticks; a stop anywhere keeps the limits too.
    let mut admission = Admission::<Dynamic<f64>>::build(
        &example(),
        Limits::build(&limits)?,
        Ramp::within(10, None),
        1.0 / RATE_HZ,
    )?;

    let from = Pose::from_f64(0.21, 0.22, 0.157);
    let to = Pose::from_f64(0.28, 0.28, 0.209);
    for ticks in [100, 40] {
        admission.offer(&Move::rest_to_rest(0, from, to, ticks));
        // One step is a bounded amount of work: a board does them between its other duties.
        let mut steps = 0;
        let verdict = loop {
            steps += 1;
            match admission.step() {
                Verdict::Undecided => {}
                verdict => break verdict,
            }
        };
        match verdict {
            Verdict::Admitted => println!("{ticks} ticks: admitted in {steps} steps"),
            Verdict::Refused(violation) => println!(
                "{ticks} ticks: refused in {steps} steps; {:?} of motor {:?} reaches {:.4}, the limit is {:.4}; \
                 shortest duration {:?} ticks",
                violation.what,
                violation.index.map(|index| index + 1),
                violation.value,
                violation.limit,
                violation.shortest,
            ),
            Verdict::Nothing | Verdict::Undecided => unreachable!("a move was offered"),
        }
    }
    Ok(())
}
