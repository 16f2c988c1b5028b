//! What holds for every machine: random machines of 1 mm to 100 m with three different legs, in
//! all working modes, with and without link masses, rotors, payload offset, gravity and wrench, in
//! random states at least [`LEAST_DISTANCE`](trirrr_tests::random::LEAST_DISTANCE) away from
//! singularities. The cases are the same in every run.

mod closure;
mod derivatives;
mod forward;
mod robust;
mod shapes;
mod symmetry;
mod truth;
mod types;
