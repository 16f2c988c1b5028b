//! The program: a plan of the straight way between the ends of the job's first move, counted.

use super::counter;
use core::hint::black_box;
use heapless::Vec;
use nalgebra::Vector2;
use semihosting::{println, process};
use trirrr_core::limits::Limits;
use trirrr_core::number::Arithmetic;
use trirrr_insns::scene::{Curves, LIMITS, MOVES, Model, PARAMETERS, PERIOD, RAMP, Scalar};
use trirrr_plan::cell::{Cell, Planner};
use trirrr_plan::passes::{controllable, fastest};
use trirrr_plan::piece::{Piece, PlaneCurve};
use trirrr_service::admission::{Enclose, Path};

type CellNumber = <Scalar as Enclose>::Bound;

/// Cells of the path.
const CELLS: usize = 100;

fn stage(name: &str, mut act: impl FnMut()) {
    counter::announce();
    let before = counter::now();
    act();
    let count = counter::elapsed(before, counter::now());
    println!("{name} {count}");
}

/// The whole program.
pub(crate) fn run() -> ! {
    counter::start();
    let limits = Limits::build(&LIMITS).map(|limits: Limits<Scalar>| limits.map(Enclose::bound));
    let built = limits
        .and_then(|limits| Path::<Model>::build(&black_box(PARAMETERS), limits, RAMP, PERIOD));
    let path = built.unwrap_or_else(|error| counter::fail(error));
    let planner = Planner::over(&path, CellNumber::ZERO);
    let ends = MOVES[0].ends::<Scalar, Curves>();
    let way = ends.from.displacement(&ends.to).map(Enclose::bound);
    let piece = Piece::<CellNumber> {
        curve: PlaneCurve::Line {
            start: ends.from.position.map(Enclose::bound),
            displacement: Vector2::new(way.x, way.y),
        },
        angle: Scalar::angle_bound(ends.from.angle),
        turning: [way.z, CellNumber::ZERO, CellNumber::ZERO],
    };
    let models = piece.models::<Scalar>();
    let mut cells: Vec<Cell<CellNumber>, CELLS> = Vec::new();
    let mut side = None;
    let mark = |index: usize| CellNumber::ratio(index as u32, CELLS as u32);
    for index in 0..CELLS {
        stage("cell", || {
            let ends = [mark(index), mark(index + 1)];
            if let Ok(measured) = planner.measure(&models, ends, None, &mut side) {
                let _ = cells.push(measured.cell());
            }
        });
    }
    let mut squares = [CellNumber::ZERO; CELLS + 1];
    stage("backward", || {
        controllable(&cells, CellNumber::ZERO, &mut squares)
    });
    stage("forward", || {
        fastest(&cells, CellNumber::ZERO, &mut squares)
    });
    println!("{} of {CELLS}", cells.len());
    process::exit(0)
}
