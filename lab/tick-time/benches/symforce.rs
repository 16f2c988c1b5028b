//! Wall time of one tick beside code that SymForce generates from the same formulas and the same coefficients
//! (`symforce/generate.py`). The C++ compiler compiles that code with `-O3 -ffast-math`; it calls the platform's
//! functions and checks nothing. All run in one process, by turns, over the setpoints of the thesis's job. The results of
//! both are compared. Prints the best and the median of the turns.
//!
//! - for any x86-64: `cargo bench -p trirrr-tick-time --features symforce --bench symforce`
//! - for this processor: the same with `RUSTFLAGS=-Ctarget-cpu=native`, which the C++ compiler follows

use std::hint::black_box;
use std::time::Instant;
use trirrr_core::machine::{LegParameters, Parameters};
use trirrr_core::model::Dynamic;
use trirrr_core::number::Number;
use trirrr_core::setpoint::Setpoint;
use trirrr_core::tick::Tick;
use trirrr_core::torque::links::{Horizontal, Links, Massive, Massless};
use trirrr_core::torque::payload::Centred;
use trirrr_scene::{JobPlayer, Scene};
use trirrr_tick_time::peer;

/// Turns of each.
const TURNS: usize = 401;
/// Ticks of a turn, at least.
const TICKS: usize = 5000;
/// Results of a tick: angle, rate, acceleration and torque of each motor.
type Row<N> = [N; 12];

/// A scene file of the repository.
fn scene(name: &str) -> Scene {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/");
    Scene::read(format!("{folder}{name}.toml")).expect("a scene of the repository")
}

/// The ticks of a turn: the job, repeated.
fn setpoints<N: Number>(scene: &Scene) -> Vec<Setpoint<N>> {
    let job: Vec<_> = JobPlayer::new(&scene.job, scene.period_s())
        .setpoints()
        .collect();
    let times = TICKS.div_ceil(job.len());
    job.repeat(times)
}

/// Coefficients of the generated code, in the order of its struct: those that the tick is built with.
fn coefficients<const COUNT: usize>(
    machine: &Parameters,
    of_links: fn(&LegParameters) -> Vec<f64>,
) -> [f64; COUNT] {
    let mut all = Vec::new();
    for leg in &machine.legs {
        let (l1, l2) = (leg.proximal_m, leg.distal_m);
        let (sin, cos) = leg.joint_angle_rad.sin_cos();
        let (jx, jy) = (leg.joint_radius_m * cos, leg.joint_radius_m * sin);
        all.extend([leg.base_m.x, leg.base_m.y, jx, jy]);
        all.extend([
            (l1 - l2) * (l1 - l2),
            2.0 * l1 * l2,
            2.0 * l1 * (l2 - l1),
            leg.elbow.sign(),
        ]);
        all.extend([l1 * l1, l2 * l2]);
        all.extend(of_links(leg));
    }
    let (mass, inertia) = (machine.platform.mass_kg, machine.platform.inertia_kgm2);
    let force = -(machine.gravity_m_s2 * mass + machine.wrench_force_n);
    let l2 = machine.legs[0].distal_m;
    all.extend([
        mass,
        inertia,
        force.x,
        force.y,
        -machine.wrench_torque_nm,
        1.0 / (l2 * l2),
    ]);
    all.try_into().expect("as many as the struct has")
}

fn of_links(leg: &LegParameters) -> Vec<f64> {
    let (l1, l2) = (leg.proximal_m, leg.distal_m);
    let (m1, c1) = (leg.proximal.mass_kg, leg.proximal.com_m);
    let (m2, c2) = (leg.distal.mass_kg, leg.distal.com_m);
    let proximal = m1 * c1 * c1 + leg.proximal.inertia_kgm2 + m2 * l1 * l1 + leg.rotor_inertia_kgm2;
    let distal = (m2 * c2 * c2 + leg.distal.inertia_kgm2) / (l2 * l2);
    vec![proximal, m2 * c2 / l2, distal, m2 * c2 / (l2 * l2 * l2)]
}

/// Evaluates all setpoints.
#[inline(never)]
fn run<N: Number<Angle = N>, L: Links<N>>(
    tick: &Tick<Dynamic<N, Centred<N>, L>>,
    setpoints: &[Setpoint<N>],
    rows: &mut [Row<N>],
) {
    for (setpoint, row) in setpoints.iter().zip(rows) {
        if let Ok(motion) = tick.evaluate(setpoint) {
            for (motor, values) in motion.motors.iter().zip(row.chunks_exact_mut(4)) {
                values.copy_from_slice(&[
                    motor.angle,
                    motor.rate,
                    motor.acceleration,
                    motor.torque,
                ]);
            }
        }
    }
}

/// Times in ns per tick, the shortest first.
struct Times(Vec<f64>);

impl Times {
    fn best(&self) -> f64 {
        self.0[0]
    }

    fn median(&self) -> f64 {
        self.0[self.0.len() / 2]
    }
}

/// Runs all by turns.
fn by_turns(ticks: usize, all: &mut [&mut dyn FnMut()]) -> Vec<Times> {
    let mut times = vec![Vec::new(); all.len()];
    for _ in 0..TURNS {
        for (one, times) in all.iter_mut().zip(&mut times) {
            let start = Instant::now();
            one();
            times.push(start.elapsed().as_secs_f64() * 1e9 / ticks as f64);
        }
    }
    let sorted = |mut times: Vec<f64>| {
        times.sort_by(f64::total_cmp);
        Times(times)
    };
    times.into_iter().map(sorted).collect()
}

/// Measures the two number types and the peer, and prints a row for each.
fn measure<L: Links<f64>, L32: Links<f32>>(
    name: &str,
    scene: &Scene,
    mut peer: impl FnMut(&[[f64; 9]], &mut [Row<f64>]),
) {
    let tick: Tick<Dynamic<f64, Centred<f64>, L>> =
        Tick::build(&scene.parameters).expect("a machine");
    let tick32: Tick<Dynamic<f32, Centred<f32>, L32>> =
        Tick::build(&scene.parameters).expect("a machine");
    let (states, states32) = (setpoints::<f64>(scene), setpoints::<f32>(scene));
    let numbers: Vec<[f64; 9]> = states.iter().map(numbers).collect();
    let count = states.len();
    let (mut rows, mut rows32) = (vec![[0.0; 12]; count], vec![[0.0; 12]; count]);
    let mut rows_peer = vec![[0.0; 12]; count];
    let times = by_turns(
        count,
        &mut [
            &mut || run(black_box(&tick), black_box(&states), &mut rows),
            &mut || run(black_box(&tick32), black_box(&states32), &mut rows32),
            &mut || peer(black_box(&numbers), &mut rows_peer),
        ],
    );
    for (row, peer) in rows.iter().zip(&rows_peer) {
        for (value, peer) in row.iter().zip(peer) {
            assert!(
                (value - peer).abs() < 1e-11 * (1.0 + value.abs()),
                "{value} {peer}"
            );
        }
    }
    for (of, times, ratio) in [
        ("trirrr f64", &times[0], &times[2]),
        ("trirrr f32", &times[1], &times[2]),
        ("SymForce f64", &times[2], &times[2]),
    ] {
        let ratios = [times.best() / ratio.best(), times.median() / ratio.median()];
        println!(
            "{name:<12}{of:<14}{:>8.1}{:>8.1}{:>8.2}{:>8.2}",
            times.best(),
            times.median(),
            ratios[0],
            ratios[1]
        );
    }
}

fn numbers(setpoint: &Setpoint<f64>) -> [f64; 9] {
    let place = setpoint.pose.position;
    let [vx, vy, va] = setpoint.velocity.into();
    let [ax, ay, aa] = setpoint.acceleration.into();
    [
        place.x,
        place.y,
        setpoint.pose.angle,
        vx,
        vy,
        va,
        ax,
        ay,
        aa,
    ]
}

fn main() {
    println!(
        "{:<26}{:>8}{:>8}{:>16}",
        "ns per tick", "best", "median", "over SymForce"
    );
    let massless = scene("thesis");
    let k = coefficients::<36>(&massless.parameters, |_| Vec::new());
    measure::<Massless, Massless>("massless", &massless, |setpoints, rows| {
        peer::massless(setpoints, &k, rows);
    });
    let links = scene("thesis-links");
    let k = coefficients::<48>(&links.parameters, of_links);
    measure::<Massive<f64, Horizontal>, Massive<f32, Horizontal>>(
        "with links",
        &links,
        |setpoints, rows| {
            peer::links(setpoints, &k, rows);
        },
    );
}
