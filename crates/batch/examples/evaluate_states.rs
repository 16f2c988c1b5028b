//! Evaluates states of the thesis machine and prints the seconds: massless links and links of 0.05 kg, one thread and
//! all of them, `f64` and `f32`. The fastest of several runs counts. The argument is the number of states, 1000 by default.
//!
//! `cargo run --release -p trirrr-batch --example evaluate_states -- 1000000`

use std::error::Error;
use std::hint::black_box;
use std::time::Instant;
use trirrr_batch::{BatchMachine, Float, MotorRows, StateRows};
use trirrr_core::machine::{LinkParameters, Parameters, example};

const STATES: usize = 1000;
const RUNS: usize = 15;

/// Three columns without a pattern, evenly within `middle` +- `half`.
fn rows<F: Float>(states: usize, seed: usize, middle: [f64; 3], half: [f64; 3]) -> Vec<[F; 3]> {
    let part = |row: usize, column: usize| {
        let factor = [0.618_033_988_7, 0.414_213_562_3, 0.732_050_807_5][column];
        ((row + 1000 * seed) as f64 * factor).fract() * 2.0 - 1.0
    };
    let value = |row, column: usize| middle[column] + half[column] * part(row, column);
    let row = |row| [0, 1, 2].map(|column| F::from_f64(value(row, column)));
    (0..states).map(row).collect()
}

/// Seconds of the fastest run.
fn seconds<F: Float>(parameters: &Parameters, states: usize) -> Result<f64, Box<dyn Error>> {
    let machine = BatchMachine::<F>::build(parameters, true)?;
    let poses = rows(states, 0, [0.245, 0.25, 0.18], [0.035, 0.03, 0.05]);
    let velocities = rows(states, 1, [0.0; 3], [0.1; 3]);
    let accelerations = rows(states, 2, [0.0; 3], [0.5; 3]);
    let mut results = [(); 4].map(|()| vec![[F::ZERO; 3]; states]);
    let mut fastest = f64::INFINITY;
    for _ in 0..RUNS {
        let [angles, rates, motor_accelerations, torques] = &mut results;
        let start = Instant::now();
        let failed = machine.evaluate(
            StateRows {
                poses: &poses,
                velocities: &velocities,
                accelerations: &accelerations,
            },
            MotorRows {
                angles,
                rates,
                accelerations: motor_accelerations,
                torques,
            },
        )?;
        fastest = fastest.min(start.elapsed().as_secs_f64());
        assert!(failed.is_empty(), "{:?}", failed.first());
        black_box(&results);
    }
    Ok(fastest)
}

fn main() -> Result<(), Box<dyn Error>> {
    let massless = example();
    let mut links = massless;
    for leg in &mut links.legs {
        leg.proximal = LinkParameters::uniform_rod(0.05, leg.proximal_m);
        leg.distal = LinkParameters::uniform_rod(0.05, leg.distal_m);
    }
    let states = match std::env::args().nth(1) {
        Some(count) => count.parse()?,
        None => STATES,
    };
    println!("seconds for {states} states");
    for threads in [1, rayon::current_num_threads()] {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()?;
        for (name, parameters) in [("massless", &massless), ("with links", &links)] {
            let f64_s = pool.install(|| {
                seconds::<f64>(parameters, states).map_err(|error| error.to_string())
            })?;
            let f32_s = pool.install(|| {
                seconds::<f32>(parameters, states).map_err(|error| error.to_string())
            })?;
            println!("{threads} threads, {name:<10}  f64 {f64_s:.6}  f32 {f32_s:.6}");
        }
    }
    Ok(())
}
