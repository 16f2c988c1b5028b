//! A whole run of a scene's plant.

use super::control::{Continuous, SampledController};
use crate::mechanics::Mechanics;
use crate::model::{Control, Plant, layout_of};
use crate::refusal::Refusal;
use crate::sampled::Sampled;
use crate::source::TickSource;
use crate::stability;
use crate::statistics::Statistics;
use crate::table::Row;
use crate::watch::Ending;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use trirrr_integrate::stability::Warning;
use trirrr_integrate::{self as integrate, Integrator, Method, Spectrum, System, Tally};
use trirrr_scene::{self as scene, NumberType, Scene, Timing};

/// How a run ended.
#[derive(Clone, Debug, PartialEq)]
pub enum End {
    /// At its end.
    Complete,
    /// It was stopped from outside.
    Interrupted {
        /// Time in s.
        t: f64,
    },
    /// The plant ended it.
    Ended(Ending),
    /// The integration could not go on.
    Failed(String),
}

/// Energies over a run, J.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Balance {
    /// Work of the motors' supply.
    pub work: f64,
    /// Losses.
    pub losses: f64,
    /// Change of kinetic, potential, elastic and magnetic energy.
    pub stored: f64,
    /// What the error is relative to: the largest size of work or losses on the way, or the
    /// largest kinetic energy where neither flows.
    pub scale: f64,
}

impl Balance {
    /// What is missing, relative to the energy that flowed; 0 where none did.
    pub fn error(&self) -> f64 {
        if self.scale == 0.0 {
            return 0.0;
        }
        (self.work - self.losses - self.stored) / self.scale
    }
}

/// What a run of a plant gives.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// How it ended.
    pub end: End,
    /// Time simulated, s.
    pub simulated_s: f64,
    /// Time that took.
    pub elapsed: Duration,
    /// The method and, where it was chosen by what was found, why.
    pub method: Method,
    /// Why this method.
    pub reason: Option<String>,
    /// What speaks against it.
    pub warnings: Vec<String>,
    /// Steps and derivatives.
    pub tally: Tally,
    /// Largest eigenvalue of the linearisation at the start, 1/s.
    pub fastest: f64,
    /// What was gathered.
    pub statistics: Statistics,
    /// Energies.
    pub balance: Balance,
    /// Number of state variables.
    pub dimension: usize,
}

impl Outcome {
    /// Times faster than real time.
    pub fn ratio(&self) -> f64 {
        self.simulated_s / self.elapsed.as_secs_f64().max(1e-9)
    }
}

/// Simulates the plant of `scene`; `source` gives the ticks of a sampled controller. Every row of
/// the table goes to `sink`; `stop` ends the run early.
///
/// # Errors
/// What the scene is refused for. Where the run itself fails, the outcome says so.
pub fn simulate(
    scene: &Scene,
    source: Box<dyn TickSource>,
    stop: &AtomicBool,
    mut sink: impl FnMut(&Row),
) -> Result<Outcome, Refusal> {
    match layout_of(scene).dimension() {
        8 => simulate_in::<8>(scene, source, stop, &mut sink),
        11 => simulate_in::<11>(scene, source, stop, &mut sink),
        14 => simulate_in::<14>(scene, source, stop, &mut sink),
        _ => simulate_in::<17>(scene, source, stop, &mut sink),
    }
}

/// The control that the scene describes.
///
/// # Errors
/// What it is refused for.
pub fn control_of(scene: &Scene, source: Box<dyn TickSource>) -> Result<Control, Refusal> {
    let plant = scene.plant.as_ref();
    if let Some(controller) = plant.and_then(|plant| plant.controller)
        && controller.timing == Timing::Continuous
    {
        let continuous = Continuous::build(scene, controller)?;
        return Ok(Control::Continuous(Box::new(continuous)));
    }
    let rate_hz = plant
        .and_then(|plant| plant.sample_rate_hz(scene.tick_rate_hz))
        .unwrap_or(scene.tick_rate_hz);
    // Where the motors stand when they are switched on.
    let mechanics = Mechanics::build(&scene.parameters, true)?;
    let pose = scene.job.start;
    let legs = mechanics.legs([pose.position.x, pose.position.y, pose.angle], [0.0; 3])?;
    let start = [0, 1, 2].map(|leg| mechanics.motor_angle(leg, &legs[leg]));
    let controller: Box<dyn SampledController> = match scene.number {
        NumberType::F64 => Box::new(Sampled::<f64>::build(scene, source, start)?),
        // A drive computes in SI units, which fixed point has no room for.
        NumberType::F32 | NumberType::Fixed | NumberType::Micromath => {
            Box::new(Sampled::<f32>::build(scene, source, start)?)
        }
    };
    Ok(Control::Sampled {
        controller,
        rate_hz,
    })
}

fn simulate_in<const N: usize>(
    scene: &Scene,
    source: Box<dyn TickSource>,
    stop: &AtomicBool,
    sink: &mut dyn FnMut(&Row),
) -> Result<Outcome, Refusal> {
    let (mut plant, mut y) = Plant::<N>::build(scene, control_of(scene, source)?)?;
    let record_s = scene.plant.as_ref().map_or(1e-3, |plant| plant.record_s);
    let settle_s = scene.plant.as_ref().map_or(0.0, |plant| plant.settle_s);
    let end = f64::from(scene.ticks()) / scene.tick_rate_hz + settle_s;
    let rate = plant.sample_rate();

    let spectrum = Spectrum::of(&plant, 0.0, &y)?;
    let (method, reason) = choose(scene, &spectrum, rate, record_s);
    stability::check(&plant, &y, &spectrum, end)?;
    let warnings: Vec<Warning> =
        integrate::stability::warning(&spectrum, &method, plant.positions(), end)
            .into_iter()
            .collect();
    let mut integrator = Integrator::new(&plant, method).map_err(|unfit| Refusal::Scene {
        key: "plant.method".into(),
        reason: unfit.to_string(),
    })?;

    let start_energy = plant.energy(&y)?;
    let mut flow = 0.0_f64;
    let started = Instant::now();
    let mut clock = Clock {
        t: 0.0,
        sample: 0,
        row: 0,
        rate,
        record_s,
        end,
    };
    let ended = loop {
        if clock.samples_now() {
            match plant.sample(clock.sample, clock.t, &mut y) {
                Err(cause) => break End::Failed(format!("{cause} at t = {:.6} s", clock.t)),
                Ok(integrate::Action::Stop) => break ended_by(&plant, clock.t),
                Ok(_) => integrator.input_changed(),
            }
            clock.sample += 1;
        }
        if clock.records_now() {
            match Row::of(&mut plant, clock.t, &y) {
                Err(cause) => break End::Failed(format!("{cause} at t = {:.6} s", clock.t)),
                Ok(row) => sink(&row),
            }
            flow = flow.max(y[N - 2].abs()).max(y[N - 1].abs());
            clock.row += 1;
            if stop.load(Ordering::Relaxed) {
                break End::Interrupted { t: clock.t };
            }
        }
        if clock.t >= end {
            break End::Complete;
        }
        let next = clock.next();
        match integrator.advance(&mut plant, clock.t, &mut y, next, |_, _| {}) {
            Ok(integrate::End::Reached) => clock.t = next,
            Ok(integrate::End::Stopped { t }) => {
                clock.t = t;
                break ended_by(&plant, t);
            }
            Err(failure) => {
                clock.t = clock.t.min(end);
                break End::Failed(failure.to_string());
            }
        }
    };
    let elapsed = started.elapsed();
    plant.statistics.finish(clock.t);
    let stored = plant
        .energy(&y)
        .map_or(f64::NAN, |energy| energy - start_energy);
    Ok(Outcome {
        end: ended,
        simulated_s: clock.t,
        elapsed,
        method,
        reason,
        warnings: warnings.iter().map(ToString::to_string).collect(),
        tally: *integrator.tally(),
        fastest: spectrum.radius(),
        statistics: *plant.statistics(),
        balance: Balance {
            work: y[N - 2],
            losses: y[N - 1],
            stored,
            scale: if flow > 0.0 { flow } else { plant.kinetic_peak },
        },
        dimension: N,
    })
}

fn ended_by<const N: usize>(plant: &Plant<N>, t: f64) -> End {
    match plant.ending() {
        Some(ending) => End::Ended(ending),
        None => End::Interrupted { t },
    }
}

/// Samples, rows and the end, in the order of time.
struct Clock {
    t: f64,
    /// The next sample and row.
    sample: u64,
    row: u64,
    rate: Option<f64>,
    record_s: f64,
    end: f64,
}

impl Clock {
    /// Instants closer than this are one.
    fn together(&self) -> f64 {
        1e-9 * self
            .record_s
            .min(self.rate.map_or(f64::INFINITY, |rate| 1.0 / rate))
    }

    fn sample_t(&self) -> f64 {
        self.rate
            .map_or(f64::INFINITY, |rate| self.sample as f64 / rate)
    }

    /// The next row; on a sample where it is one within rounding.
    fn row_t(&self) -> f64 {
        let t = self.row as f64 * self.record_s;
        let Some(rate) = self.rate else { return t };
        let sample = (t * rate).round() / rate;
        if (sample - t).abs() <= self.together() {
            sample
        } else {
            t
        }
    }

    fn samples_now(&self) -> bool {
        self.sample_t() <= self.t
    }

    fn records_now(&self) -> bool {
        self.row_t() <= self.t + self.together()
    }

    fn next(&self) -> f64 {
        let next = self.sample_t().min(self.row_t());
        // A last interval too short for a step belongs to the one before.
        if self.end - next <= self.together() {
            self.end
        } else {
            next
        }
    }
}

/// Tolerance of the implicit method under a sampled controller, where none is chosen. Every sample
/// excites the windings, and to follow that to the method's own tolerance takes several steps a sample;
/// the motion, which integrates currents twice, gains nothing.
const SAMPLED_TOLERANCE: f64 = 1e-7;

/// The method that the scene chooses, or that its stiffness does. Results are asked for at `rate_hz`
/// or, without samples, every `record_s`.
fn choose(
    scene: &Scene,
    spectrum: &Spectrum,
    rate_hz: Option<f64>,
    record_s: f64,
) -> (Method, Option<String>) {
    let chosen = scene
        .plant
        .as_ref()
        .map_or(scene::Method::Auto { tolerance: None }, |plant| {
            plant.method
        });
    let implicit = match rate_hz {
        Some(_) => SAMPLED_TOLERANCE,
        None => Method::RADAU_IIA_TOLERANCE,
    };
    let method = match chosen {
        scene::Method::SemiImplicitEuler { step_s } => Method::SemiImplicitEuler { step_s },
        scene::Method::Rk4 { step_s } => Method::Rk4 { step_s },
        scene::Method::DormandPrince { tolerance } => Method::DormandPrince {
            tolerance: tolerance.unwrap_or(Method::DORMAND_PRINCE_TOLERANCE),
        },
        scene::Method::RadauIia { tolerance } => Method::RadauIia {
            tolerance: tolerance.unwrap_or(implicit),
        },
        scene::Method::Auto { tolerance } => {
            let resolution_s = rate_hz.map_or(record_s, |rate| 1.0 / rate);
            let mut choice = integrate::stability::choose(spectrum, resolution_s, tolerance);
            if let (Method::RadauIia { tolerance: own }, None) = (&mut choice.method, tolerance) {
                *own = implicit;
            }
            return (choice.method, Some(choice.to_string()));
        }
    };
    (method, None)
}
