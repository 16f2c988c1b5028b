//! The core against true values of 25 digits: |error| <= 2 u cond on every row, for f64 and f32.
//!
//! cond is the sum of |dq/dp p| over all inputs p: how far the result q moves when every input
//! moves by its own rounding. A result within 2 u cond is as good as the exact result for inputs
//! that are off by two roundings, and no implementation can be asked for much less. The reference
//! files give cond for angles, rates, accelerations (extreme.csv) and torques (all); for the other
//! results it comes from the derivatives of the independent model, after a test that the two
//! agree where both exist.
//!
//! Every bound is asserted from both sides: above the bracket is a defect, below it the core has
//! become better than the bracket knows.

mod closed_loop;
mod core_results;
mod job;
mod model;

use trirrr_core::machine::Parameters;
use trirrr_core::number::Number;
use trirrr_tests::machines;

/// Columns of the acceleration in the files about the move.
const MOVE: [&str; 3] = ["ax", "ay", "aalpha"];
/// And in extreme.csv.
const EXTREME: [&str; 3] = ["acx", "acy", "acalpha"];

/// The three files about the thesis's move, with their machines.
fn moves() -> [(&'static str, Parameters); 3] {
    let rods = machines::with_rods(machines::thesis(), 0.05);
    [
        ("true_massless.csv", machines::thesis()),
        ("true_links.csv", rods),
        (
            "true_links_gravity.csv",
            machines::under_gravity_and_wrench(rods),
        ),
    ]
}

fn is_f32<N: Number>() -> bool {
    N::UNIT_ROUNDOFF.to_f64() > 1e-10
}
