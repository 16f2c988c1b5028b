//! The program: every tick of the job, counted.

use super::counter;
use core::hint::black_box;
use nalgebra::Vector2;
use semihosting::{println, process};
use trirrr_core::dyad::{OutOfReach, Rrr};
use trirrr_core::number::Arithmetic;
use trirrr_core::setpoint::Setpoint;
use trirrr_image::{Checksum, Segment, segments};
use trirrr_insns::scene::{Curves, MOVES, PARAMETERS, PERIOD, Scalar};
use trirrr_insns::tick::{SceneTick, TickOutcome, evaluate, set, solve};

/// Result that [`solve`] leaves.
type SolvedLinks = Result<[Vector2<Scalar>; 2], OutOfReach>;

/// Stands in for [`evaluate`]: what a call and the counter's own reading cost.
#[inline(never)]
fn empty_evaluate(_: &SceneTick, _: &Setpoint<Scalar>, _: &mut TickOutcome) {}

/// Stands in for [`set`].
#[inline(never)]
fn empty_set(_: &Segment<Scalar, Curves>, _: u32, _: &mut Setpoint<Scalar>) {}

/// Stands in for [`solve`].
#[inline(never)]
fn empty_solve(_: &Rrr<Scalar>, _: &Vector2<Scalar>, _: &mut SolvedLinks) {}

/// Counts one call through a pointer that the compiler cannot see through, so that the empty call
/// costs the same as the full one.
#[inline(never)]
fn count_evaluate(
    function: fn(&SceneTick, &Setpoint<Scalar>, &mut TickOutcome),
    tick: &SceneTick,
    setpoint: &Setpoint<Scalar>,
    outcome: &mut TickOutcome,
) -> u32 {
    let before = counter::now();
    function(tick, setpoint, outcome);
    counter::elapsed(before, counter::now())
}

/// As [`count_evaluate`], for the setpoint.
#[inline(never)]
fn count_set(
    function: fn(&Segment<Scalar, Curves>, u32, &mut Setpoint<Scalar>),
    segment: &Segment<Scalar, Curves>,
    tick: u32,
    setpoint: &mut Setpoint<Scalar>,
) -> u32 {
    let before = counter::now();
    function(segment, tick, setpoint);
    counter::elapsed(before, counter::now())
}

/// As [`count_evaluate`], for the dyad.
#[inline(never)]
fn count_solve(
    function: fn(&Rrr<Scalar>, &Vector2<Scalar>, &mut SolvedLinks),
    dyad: &Rrr<Scalar>,
    end: &Vector2<Scalar>,
    links: &mut SolvedLinks,
) -> u32 {
    let before = counter::now();
    function(dyad, end, links);
    counter::elapsed(before, counter::now())
}

/// The whole program.
pub(crate) fn run() -> ! {
    counter::start();
    let tick = SceneTick::build(&black_box(PARAMETERS));
    let tick = tick.unwrap_or_else(|error| counter::fail(error));
    let mut outcome = TickOutcome::default();
    let mut checksum = Checksum::default();
    let mut first = true;
    // The dyad of the first leg, between the ends it has at each tick.
    let dyad = tick.geometry().legs()[0].dyad();
    let mut end = Vector2::new(0.0, 0.0).map(Scalar::from_f64);
    let mut links: SolvedLinks = Err(OutOfReach::Unreachable);
    for segment in segments::<Scalar, Curves>(&MOVES, PERIOD) {
        for index in 0..segment.ticks() {
            let mut setpoint = segment.at(index);
            if first {
                first = false;
                let evaluate =
                    count_evaluate(black_box(empty_evaluate), &tick, &setpoint, &mut outcome);
                let set = count_set(black_box(empty_set), &segment, index, &mut setpoint);
                let solve = count_solve(black_box(empty_solve), dyad, &end, &mut links);
                println!("empty {evaluate} {set} {solve}");
            }
            counter::announce();
            let set = count_set(black_box(set), &segment, index, &mut setpoint);
            let evaluate = count_evaluate(black_box(evaluate), &tick, &setpoint, &mut outcome);
            match outcome.status {
                Ok(()) => checksum.add(&outcome.motors),
                Err(status) => checksum.add_status(status),
            }
            if let Ok(position) = tick.geometry().position(&setpoint.pose) {
                end = position.legs[0].links.r1 + position.legs[0].links.r2;
            }
            let solve = count_solve(black_box(solve), dyad, &end, &mut links);
            println!("tick {evaluate} {set} {solve}");
        }
    }
    println!("bits {:016x}", checksum.value());
    process::exit(0)
}
