//! The program: every move of the job offered, judged and counted.

use super::counter;
use core::hint::black_box;
use semihosting::{println, process};
use trirrr_core::limits::{LimitParameters, Limits};
use trirrr_insns::scene::{Curves, LIMITS, MOVES, Model, PARAMETERS, PERIOD, RAMP};
use trirrr_insns::service::offered;
use trirrr_service::admission::{Admission, Verdict};

type SceneAdmission = Admission<Model, Curves>;

#[inline(never)]
fn step(admission: &mut SceneAdmission) -> bool {
    admission.step() == Verdict::Undecided
}

fn judge_all(limits: &LimitParameters) {
    let built = Limits::build(limits)
        .and_then(|limits| SceneAdmission::build(&black_box(PARAMETERS), limits, RAMP, PERIOD));
    let mut admission = built.unwrap_or_else(|error| counter::fail(error));
    for index in 0..MOVES.len() {
        admission.offer_any(&offered(index, 0));
        let (mut total, mut longest, mut intervals) = (0, 0, 0);
        loop {
            counter::announce();
            let before = counter::now();
            let undecided = step(&mut admission);
            let count = counter::elapsed(before, counter::now());
            total += u64::from(count);
            longest = longest.max(count);
            intervals += 1;
            if !undecided {
                break;
            }
        }
        let verdict = match admission.verdict() {
            Verdict::Admitted => "admitted",
            Verdict::Refused(_) => "refused",
            Verdict::Nothing | Verdict::Undecided => "undecided",
        };
        println!("move {intervals} {total} {longest} {verdict}");
    }
}

/// The whole program.
pub(crate) fn run() -> ! {
    counter::start();
    judge_all(&LIMITS);
    // Whatever is not limited is given a limit that it keeps from afar, but has to be computed for.
    let far = Some([1e9; 3]);
    judge_all(&LimitParameters {
        rate_rad_s: LIMITS.rate_rad_s.or(far),
        acceleration_rad_s2: LIMITS.acceleration_rad_s2.or(far),
        torque_nm: LIMITS.torque_nm.or(far),
        power_w: LIMITS.power_w.or(far),
        ..LIMITS
    });
    process::exit(0)
}
