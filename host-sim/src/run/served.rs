//! The ticks of a plant's drives from the core's own service, as a board would give them.

use super::End;
use super::player::Player;
use crate::failure::Failure;
use std::sync::atomic::AtomicBool;
use std::sync::mpsc::{Receiver, sync_channel};
use trirrr_client::describe::Units;
use trirrr_client::job;
use trirrr_client::local;
use trirrr_drives::joint::Reference;
use trirrr_plant::Refusal;
use trirrr_plant::simulate::Outcome;
use trirrr_plant::source::{JointReferences, Pipeline, TickSource};
use trirrr_protocol::message::Telemetry;
use trirrr_scene::Scene;
use trirrr_service::ServiceNumber;

/// Ticks that the service may be ahead of the drives.
const AHEAD: usize = 1024;

/// What the service tells the drives, tick by tick.
struct Served<N: ServiceNumber> {
    samples: Receiver<Telemetry<N>>,
    /// The sample of the first tick, until it is asked for.
    first: Option<Telemetry<N>>,
    units: Units,
    /// Ticks of the job.
    ticks: u32,
    /// Where the machine stands before and after.
    rest: Pipeline<N>,
}

impl<N: ServiceNumber> TickSource for Served<N> {
    fn start(&mut self) -> Result<JointReferences, Refusal> {
        // The service has judged the job and is on its way before the plant's time begins.
        self.first = Some(self.samples.recv().map_err(|_| Refusal::Service)?);
        self.rest.start()
    }

    fn tick(&mut self, tick: u32) -> Result<JointReferences, Refusal> {
        if tick >= self.ticks {
            // With its last tick the job is over: the machine stands, and the deceleration that
            // this tick still carries is that of the move before.
            return self.rest.tick(tick);
        }
        let sample = match self.first.take() {
            Some(first) => first,
            None => self.samples.recv().map_err(|_| Refusal::Service)?,
        };
        let rate = 1.0 / self.units.time_s;
        let speed = self.units.length_m * rate;
        let torque = self.units.mass_kg * speed * speed;
        Ok([0, 1, 2].map(|i| Reference {
            angle: N::angle_to_f64(sample.angles[i]),
            rate: sample.rates[i].to_f64() * rate,
            acceleration: sample.accelerations[i].to_f64() * (rate * rate),
            torque: sample.torques[i].to_f64() * torque,
        }))
    }
}

/// Plays the job of `scene` on the service in the number type `N`, in a thread of its own, while
/// `simulate` takes its ticks.
///
/// # Errors
/// Refused: what `simulate` refuses, or a scene that no service can be built of. Failed: the
/// service refuses the job or has a fault.
pub(super) fn with_service<N: ServiceNumber>(
    scene: &Scene,
    stop: &AtomicBool,
    simulate: impl FnOnce(Box<dyn TickSource>) -> Result<Outcome, Refusal>,
) -> Result<Outcome, Failure> {
    let refused = |reason: String| Failure::Refused(format!("scene {}: {reason}", scene.name));
    let si = trirrr_scene::units::<N>(scene).map_err(|error| refused(error.to_string()))?;
    let units = Units::of_scene(scene, &si);
    let rest = Pipeline::<N>::build(scene).map_err(|error| refused(error.to_string()))?;
    let (sender, samples) = sync_channel(AHEAD);
    let source = Box::new(Served {
        samples,
        first: None,
        units,
        ticks: scene.ticks(),
        rest,
    });
    let (outcome, played) = std::thread::scope(|scope| {
        let service = scope.spawn(move || {
            let moves = job::moves::<N>(scene, &si);
            local::with_machine::<N, _>(scene, |machine| {
                Player::new(machine, moves, units).play(scene, false, stop, sender)
            })
        });
        let outcome = simulate(source);
        // A panic there is a bug and goes on here.
        let played = service
            .join()
            .unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        (outcome, played)
    });
    // The service says more than a drive without ticks.
    match played?.end {
        End::Refused(why) | End::Fault(why) => return Err(Failure::Failed(why)),
        End::Complete | End::Stopped => {}
    }
    outcome.map_err(|refusal| refused(refusal.to_string()))
}
