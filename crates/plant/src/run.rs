//! A run of a scene's plant, tick by tick.

use crate::clock::{RunClock, Stopwatch};
use crate::control::Continuous;
use crate::driven::{Driven, Sampled};
use crate::ledger::Ledger;
use crate::method::choose;
use crate::model::{Control, Plant, layout_of};
use crate::outcome::{Outcome, PlantEnd};
use crate::refusal::Refusal;
use crate::scene_drives::{self, samples_per_tick};
use crate::stability;
use crate::table::Row;
use crate::watch::{Cause, Ending};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use trirrr_core::number::Number;
use trirrr_drives::count::Countable;
use trirrr_drives::stepper::Line;
use trirrr_integrate::stability::Warning;
use trirrr_integrate::{self as integrate, Failure, Integrator, Method, Spectrum, System};
use trirrr_protocol::message::DriveReading;
use trirrr_scene::{Scene, Timing};
use trirrr_service::Output;

/// Simulates the plant of a scene while a service plays the scene's job.
///
/// The service gives [`tick`](Self::tick) the output of each tick, in its number type `N`. The
/// drives of the plant turn the outputs into torque, voltage or steps. The plant follows up to the
/// next tick. A continuous controller needs no ticks: [`finish`](Self::finish) runs it to the end.
pub struct PlantRun<'l, N: Number> {
    run: Box<dyn Simulation>,
    /// None under a continuous controller.
    driven: Option<Driven<'l, N>>,
}

impl<'l, N: Countable> PlantRun<'l, N> {
    /// Builds the plant of `scene`, at rest at the start of the job. `line` joins the two halves of
    /// stepper drives, as it does on a board.
    ///
    /// # Errors
    /// The scene is refused.
    pub fn build(scene: &Scene, line: &'l Line) -> Result<Self, Refusal> {
        let run = simulation(scene)?;
        let driven = match run.is_sampled() {
            false => None,
            true => {
                let units = trirrr_scene::units::<N>(scene)
                    .map_err(|error| Refusal::Machine(error.to_string()))?;
                Some(Driven::new(
                    scene_drives::build(scene, units, run.start(), line)?,
                    samples_per_tick(scene)?,
                    scene.ticks(),
                ))
            }
        };
        Ok(Self { run, driven })
    }
}

impl<N: Number> PlantRun<'_, N> {
    /// Returns what the drives tell before the next tick, for a service that watches them. None of drives that tell
    /// nothing.
    pub fn measure(&mut self) -> Option<[DriveReading<N>; 3]> {
        self.driven.as_mut()?.drives.measure()
    }

    /// Takes the output of the next tick, the first of the job at first, and simulates up to the
    /// tick after it. Rows of the table go to `sink`.
    ///
    /// The service ticks once more after the last setpoint of the job. From there on the plant is
    /// held as this last output says.
    pub fn tick(&mut self, output: &Output<N>, sink: &mut dyn FnMut(&Row)) {
        if let Some(driven) = &mut self.driven {
            driven.give(output);
        }
        self.run.tick(sampled(&mut self.driven), sink);
    }

    /// Simulates to the end, unless `stop` is raised, and returns the outcome. A run that lacks
    /// ticks of its job is interrupted at the first of them.
    pub fn finish(mut self, stop: &AtomicBool, sink: &mut dyn FnMut(&Row)) -> Outcome {
        self.run.finish(sampled(&mut self.driven), stop, sink)
    }
}

/// The drives without the number type of their ticks.
fn sampled<'d, N: Number>(driven: &'d mut Option<Driven<'_, N>>) -> Option<&'d mut dyn Sampled> {
    driven.as_mut().map(|driven| driven as &mut dyn Sampled)
}

/// The control that the scene describes.
///
/// # Errors
/// The scene is refused.
pub fn control_of(scene: &Scene) -> Result<Control, Refusal> {
    if let Some(controller) = scene.controller
        && controller.timing == Timing::Continuous
    {
        let continuous = Continuous::build(scene, controller)?;
        return Ok(Control::Continuous(Box::new(continuous)));
    }
    Ok(Control::Sampled {
        rate_hz: scene.tick_rate_hz * f64::from(samples_per_tick(scene)?),
    })
}

/// A run without its dimension.
trait Simulation: Send {
    /// Returns true if drives take samples.
    fn is_sampled(&self) -> bool;
    /// Joint angles at the start.
    fn start(&self) -> [f64; 3];
    fn tick(&mut self, driven: Option<&mut dyn Sampled>, sink: &mut dyn FnMut(&Row));
    fn finish(
        &mut self,
        driven: Option<&mut dyn Sampled>,
        stop: &AtomicBool,
        sink: &mut dyn FnMut(&Row),
    ) -> Outcome;
}

fn simulation(scene: &Scene) -> Result<Box<dyn Simulation>, Refusal> {
    Ok(match layout_of(scene).dimension() {
        8 => Box::new(Run::<8>::build(scene)?),
        11 => Box::new(Run::<11>::build(scene)?),
        14 => Box::new(Run::<14>::build(scene)?),
        _ => Box::new(Run::<17>::build(scene)?),
    })
}

struct Run<const D: usize> {
    plant: Plant<D>,
    y: [f64; D],
    integrator: Integrator<D>,
    clock: RunClock,
    /// Force and moment of the push, and whether it acts.
    push: Option<[f64; 3]>,
    pushed: bool,
    tick_rate_hz: f64,
    ticks: u32,
    ended: Option<PlantEnd>,
    method: (Method, Option<String>),
    warnings: Vec<String>,
    /// The method cannot be stable with its step.
    unstable: Option<Warning>,
    /// Largest eigenvalue at the start, 1/s.
    fastest: f64,
    ledger: Ledger,
    elapsed: Duration,
}

impl<const D: usize> Run<D> {
    fn build(scene: &Scene) -> Result<Self, Refusal> {
        let (mut plant, mut y) = Plant::<D>::build(scene, control_of(scene)?)?;
        plant.choose_coordinates(&mut y)?;
        let scenario = scene.plant.as_ref();
        let rate = plant.sample_rate();
        let record_s = scenario.map_or(1e-3, |plant| plant.record_s);
        let settle_s = scenario.map_or(0.0, |plant| plant.settle_s);
        let end = f64::from(scene.ticks()) / scene.tick_rate_hz + settle_s;
        let push = scenario.and_then(|plant| plant.push);

        let spectrum = Spectrum::of(&plant, 0.0, &y)?;
        let (method, reason) = choose(scene, &spectrum, rate, record_s);
        stability::check(&plant, &y, &spectrum, scene.controller.as_ref(), end)?;
        let warning = integrate::stability::warning(&spectrum, &method, plant.positions(), end);
        let unstable = warning.filter(|warning| matches!(warning, Warning::Unstable { .. }));
        let integrator = Integrator::new(&plant, method).map_err(|unfit| Refusal::Scene {
            key: "plant.method".into(),
            reason: unfit.to_string(),
        })?;
        Ok(Self {
            ledger: Ledger::new(
                method,
                &plant.energies(&y)?,
                plant.energy_unit(&y)?,
                spectrum.radius(),
                unstable,
            ),
            plant,
            y,
            integrator,
            clock: RunClock {
                t: 0.0,
                sample: 0,
                row: 0,
                rate,
                record_s,
                end,
                push: push.map(|push| [push.at_s, push.at_s + push.duration_s]),
            },
            push: push.map(|push| [push.force_n[0], push.force_n[1], push.torque_nm]),
            pushed: false,
            tick_rate_hz: scene.tick_rate_hz,
            ticks: 0,
            ended: None,
            method: (method, reason),
            warnings: warning.iter().map(ToString::to_string).collect(),
            unstable,
            fastest: spectrum.radius(),
            elapsed: Duration::ZERO,
        })
    }

    /// Simulates until the run has ended, until a tick is missing, or up to `until` seconds.
    fn advance(
        &mut self,
        until: f64,
        mut driven: Option<&mut dyn Sampled>,
        stop: Option<&AtomicBool>,
        sink: &mut dyn FnMut(&Row),
    ) {
        let started = Stopwatch::start();
        while self.ended.is_none() && self.clock.t < until {
            match self.step(&mut driven, stop, sink) {
                Ok(true) => {}
                Ok(false) => break,
                Err(end) => self.ended = Some(self.audited(end)),
            }
        }
        self.elapsed += started.elapsed();
    }

    /// Notes the energies. Where they do not close, that is the `end` and not what the motion came to.
    fn audited(&mut self, end: PlantEnd) -> PlantEnd {
        // A leg at its very end has no state: the energies of the last row stand.
        if let Ok(energies) = self.plant.energies(&self.y) {
            self.ledger.note(&energies);
        }
        let singular = match &end {
            PlantEnd::Complete => false,
            PlantEnd::Ended(ending) => ending.cause.is_singularity(),
            _ => return end,
        };
        let steps = self.integrator.tally().steps;
        match (
            self.ledger.check(self.clock.t, steps, singular),
            &self.unstable,
        ) {
            (Some(loss), _) => PlantEnd::EnergyLost(loss),
            // Friction takes the energy of what shakes: it closes, and the motion is not the machine's.
            (None, Some(warning)) if singular => PlantEnd::Failed(warning.to_string()),
            _ => end,
        }
    }

    /// Takes the sample and the row that are due and integrates to the next; `false` where a tick
    /// is missing.
    ///
    /// # Errors
    /// The end of the run.
    fn step(
        &mut self,
        driven: &mut Option<&mut dyn Sampled>,
        stop: Option<&AtomicBool>,
        sink: &mut dyn FnMut(&Row),
    ) -> Result<bool, PlantEnd> {
        let t = self.clock.t;
        self.push();
        let failed = |cause: Refusal| PlantEnd::Failed(format!("{cause} at t = {t:.6} s"));
        if self.clock.samples_now() && !self.sample(driven).map_err(failed)? {
            return Ok(false);
        }
        if let Some(ending) = self.plant.ending() {
            return Err(PlantEnd::Ended(ending));
        }
        if self.clock.records_now() {
            sink(&Row::of(&mut self.plant, t, &self.y).map_err(failed)?);
            self.clock.row += 1;
            self.ledger
                .note(&self.plant.energies(&self.y).map_err(failed)?);
            if let Some(loss) = self.ledger.check(t, self.integrator.tally().steps, false) {
                return Err(PlantEnd::EnergyLost(loss));
            }
            if stop.is_some_and(|stop| stop.load(Ordering::Relaxed)) {
                return Err(PlantEnd::Interrupted { t });
            }
        }
        if t >= self.clock.end {
            return Err(PlantEnd::Complete);
        }
        let next = self.clock.next();
        let (plant, y) = (&mut self.plant, &mut self.y);
        match self.integrator.advance(plant, t, y, next, |_, _| {}) {
            Ok(integrate::End::Reached) => {
                self.clock.t = next;
                Ok(true)
            }
            Ok(integrate::End::Stopped { t }) => {
                self.clock.t = t;
                Err(match self.plant.ending() {
                    Some(ending) => PlantEnd::Ended(ending),
                    None => PlantEnd::Interrupted { t },
                })
            }
            Err(failure) => Err(match (&failure, self.plant.stretched(&self.y)) {
                // A leg without inertia stops the platform at its full length. Where methods take no
                // step beyond, each shorter one has brought them nearer.
                (Failure::Refused { t, .. } | Failure::Underflow { t, .. }, Some(leg)) => {
                    let (t, cause) = (*t, Cause::Serial(leg));
                    self.clock.t = t;
                    PlantEnd::Ended(Ending { t, cause })
                }
                _ => PlantEnd::Failed(failure.to_string()),
            }),
        }
    }

    /// Lets the push begin or end.
    fn push(&mut self) {
        let Some(push) = self.push else {
            return;
        };
        let pushes = self.clock.pushes_now();
        if pushes != self.pushed {
            self.pushed = pushes;
            let now = if pushes { push } else { [0.0; 3] };
            self.plant.mechanics.set_push(now);
            self.integrator.input_changed();
        }
    }

    /// Lets the drives measure and command; `false` where the tick is missing that they follow.
    fn sample(&mut self, driven: &mut Option<&mut dyn Sampled>) -> Result<bool, Refusal> {
        let Some(driven) = driven else {
            return Ok(true);
        };
        let slot = (self.clock.sample % u64::from(driven.per_tick())) as u32;
        if slot == 0 && !driven.begin()? {
            return Ok(false);
        }
        let sensed = self.plant.measure(&self.y)?;
        let commands = driven.sample(slot, &sensed.measured);
        let ends = self.plant.command(self.clock.t, &self.y, &sensed, commands);
        if !ends {
            self.integrator.input_changed();
        }
        self.clock.sample += 1;
        Ok(true)
    }
}

impl<const D: usize> Simulation for Run<D> {
    fn is_sampled(&self) -> bool {
        self.clock.rate.is_some()
    }

    fn start(&self) -> [f64; 3] {
        self.plant.start
    }

    fn tick(&mut self, driven: Option<&mut dyn Sampled>, sink: &mut dyn FnMut(&Row)) {
        self.ticks += 1;
        let until = f64::from(self.ticks) / self.tick_rate_hz;
        self.advance(until, driven, None, sink);
    }

    fn finish(
        &mut self,
        driven: Option<&mut dyn Sampled>,
        stop: &AtomicBool,
        sink: &mut dyn FnMut(&Row),
    ) -> Outcome {
        self.advance(f64::INFINITY, driven, Some(stop), sink);
        let t = self.clock.t;
        self.plant.statistics.finish(t);
        let (method, reason) = self.method.clone();
        Outcome {
            end: self.ended.take().unwrap_or(PlantEnd::Interrupted { t }),
            simulated_s: t,
            elapsed: self.elapsed,
            method,
            reason,
            warnings: std::mem::take(&mut self.warnings),
            tally: *self.integrator.tally(),
            fastest: self.fastest,
            statistics: *self.plant.statistics(),
            balance: *self.ledger.balance(),
            dimension: D,
        }
    }
}
