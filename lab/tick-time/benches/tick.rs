//! Wall time of one tick on this machine: the twelve results that the motors need (angle, rate,
//! acceleration and torque of each), over the setpoints of the thesis's job, in binary64 and
//! binary32, with massless links and with links of 0.05 kg. At the end, the fastest samples, which
//! other load on the machine disturbs least, and their ratios.
//!
//! `cargo bench -p trirrr-tick-time`

use criterion::{Bencher, Criterion, Throughput};
use std::hint::black_box;
use std::time::{Duration, Instant};
use trirrr_core::machine::Parameters;
use trirrr_core::model::Dynamic;
use trirrr_core::number::Number;
use trirrr_core::setpoint::Setpoint;
use trirrr_core::tick::Tick;
use trirrr_core::torque::links::{Horizontal, Links, Massive, Massless};
use trirrr_core::torque::payload::Centred;
use trirrr_scene::{JobPlayer, Scene};

/// A scene file of the repository.
fn scene(name: &str) -> Scene {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/");
    Scene::read(format!("{folder}{name}.toml")).expect("a scene of the repository")
}

/// The pipeline and what it is fed.
struct Work<N: Number, L: Links<N>> {
    tick: Tick<Dynamic<N, Centred<N>, L>>,
    setpoints: Vec<Setpoint<N>>,
}

impl<N: Number, L: Links<N>> Work<N, L> {
    fn new(scene: &Scene) -> Self {
        let parameters: &Parameters = &scene.parameters;
        Self {
            tick: Tick::build(parameters).expect("a machine of the repository"),
            setpoints: JobPlayer::new(&scene.job, scene.period_s())
                .setpoints()
                .collect(),
        }
    }

    /// Runs the job `iterations` times.
    fn run(&self, iterations: u64) -> Duration {
        let tick = black_box(&self.tick);
        let start = Instant::now();
        for _ in 0..iterations {
            for setpoint in &self.setpoints {
                // Only the motors are taken: what nobody reads is not computed, as on the target.
                let _ = black_box(
                    tick.evaluate(black_box(setpoint))
                        .map(|motion| motion.motors),
                );
            }
        }
        start.elapsed()
    }

    /// Measures under `name` and returns the time of one tick in the fastest sample, ns.
    fn measure(&self, criterion: &mut Criterion, name: &str) -> f64 {
        let ticks = self.setpoints.len() as u64;
        let mut fastest = f64::INFINITY;
        let mut group = criterion.benchmark_group("tick");
        group.throughput(Throughput::Elements(ticks));
        group.bench_function(name, |bencher: &mut Bencher<'_>| {
            bencher.iter_custom(|iterations| {
                let elapsed = self.run(iterations);
                fastest = fastest.min(elapsed.as_secs_f64() * 1e9 / (iterations * ticks) as f64);
                elapsed
            });
        });
        group.finish();
        // Infinite if a filter left this one out.
        fastest
    }
}

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    let massless = scene("thesis");
    let links = scene("thesis-links");
    let rows = [
        (
            "massless",
            Work::<f64, Massless>::new(&massless).measure(&mut criterion, "f64 massless"),
            Work::<f32, Massless>::new(&massless).measure(&mut criterion, "f32 massless"),
        ),
        (
            "with links",
            Work::<f64, Massive<f64, Horizontal>>::new(&links)
                .measure(&mut criterion, "f64 with links"),
            Work::<f32, Massive<f32, Horizontal>>::new(&links)
                .measure(&mut criterion, "f32 with links"),
        ),
    ];
    criterion.final_summary();
    println!(
        "{:<12}{:>10}{:>10}{:>10}",
        "ns per tick", "f64", "f32", "f64/f32"
    );
    for (name, f64_ns, f32_ns) in rows {
        if f64_ns.is_infinite() || f32_ns.is_infinite() {
            continue;
        }
        println!(
            "{name:<12}{f64_ns:>10.1}{f32_ns:>10.1}{:>10.2}",
            f64_ns / f32_ns
        );
    }
}
