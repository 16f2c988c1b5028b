//! Machine in the same program: the service of a scene behind one object. The scene names its model at
//! run time, the types of the service name the model at compile time.

use std::time::{Duration, Instant};
use trirrr_core::limits::LimitParameters;
use trirrr_core::machine::{Geometry, Parameters};
use trirrr_core::model::{Model, ModelKind, ModelVisitor};
use trirrr_core::number::{Coarse, Fixed};
use trirrr_core::setpoint::{Pose, Quintics};
use trirrr_core::tick::Motor;
use trirrr_core::units::Units;
use trirrr_plan::window::ServicePlanner;
use trirrr_protocol::message::{Hello, Message, PROTOCOL, Reply, Request, State};
use trirrr_protocol::wire::{self, schema};
use trirrr_scene::Scene;
use trirrr_scene::offer;
use trirrr_service::board::{InterlockReadings, Readings};
use trirrr_service::coefficients::{ContactCoefficients, FeedbackCoefficients, HomingCoefficients};
use trirrr_service::features::{DigitalParameters, InterlockParameters, NoImage, On, input_bits};
use trirrr_service::{
    Adjustable, Channels, Output, Played, SceneParts, Service, ServiceError, ServiceNumber,
    Settings, scene,
};

/// Places of the queue for moves, as on a board. One place stays empty.
const MOVES: usize = offer::CAPACITY + 1;

/// Levels of power for which there is memory, a power of two: as many as a scene may ask for.
const LEVELS: usize = 1 << 14;

/// Places of the queue for telemetry samples, which the owner fetches after every tick. One place
/// stays empty.
const SAMPLES: usize = 63 + 1;

/// Service of a scene, whatever model the scene has.
pub trait LocalService<N: ServiceNumber> {
    /// Computes one tick.
    fn tick(&mut self);

    /// Computes one tick. Returns its duration, which holds nothing of the caller.
    fn timed_tick(&mut self) -> Duration;

    /// Returns the state of the machine.
    fn state(&self) -> State;

    /// Sets the inputs of homing for the next ticks.
    fn inputs(&mut self, closed: [bool; 3]);

    /// Sets what the contacts of the inputs tell in the next tick. Says nothing to a machine whose scene names none.
    fn sense(&mut self, readings: InterlockReadings);

    /// Sets the spare inputs that are active in the next tick, a bit for each.
    fn sense_digital(&mut self, inputs: u8);

    /// Returns the spare outputs that are on, a bit for each.
    fn digital_outputs(&self) -> u8;

    /// Sets what the drives tell in the next ticks. Says nothing to a machine whose drives tell nothing.
    fn hear(&mut self, readings: Readings<N>);

    /// Returns the output of the last tick.
    fn output(&self) -> &Output<N>;

    /// Returns the commands of the last tick to the motors.
    fn motors(&self) -> &[Motor<N>; 3];

    /// Returns setpoint and motion of the last tick, if the platform had a setpoint.
    fn motion(&self) -> Option<&Played<N>>;

    /// Returns the angles that the last tick added to the commanded ones without a motion, rad.
    fn shift(&self) -> Option<[N::Angle; 3]>;

    /// Reports the duration of the last tick, ns. The service passes the duration on. A long tick is no
    /// fault: a host keeps no deadlines.
    fn report_timing(&mut self, duration_ns: u32);

    /// Counts a tick that came too late.
    fn count_late(&mut self);

    /// Makes the numbers of the conversations to come depend on `noise`, see [`Background::stir`](trirrr_service::board::Background::stir).
    fn stir(&mut self, noise: u32);

    /// Executes a request. Returns the answer.
    fn answer(&mut self, request: &Request<N>) -> Reply<N>;

    /// Executes the next request if it came before one that was missing. Returns its number and the answer.
    fn answer_kept(&mut self) -> Option<(u32, Reply<N>)>;

    /// Does a slice of the work below the tick. Returns false if nothing is left to do.
    fn step(&mut self) -> bool;

    /// Returns the next event or telemetry sample.
    fn outgoing(&mut self) -> Option<Message<N>>;
}

/// Error of a scene whose machine cannot be built in a number type.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("scene {scene}: {reason}")]
pub struct Unbuildable {
    /// Name of the scene.
    pub scene: String,
    /// Refused quantity, and the reason.
    pub reason: String,
}

/// Returns the first request of a client to the machine of `scene`.
pub fn hello<N: ServiceNumber>(scene: &Scene) -> Hello {
    Hello {
        protocol: PROTOCOL,
        schema: schema::key::<Request<N>, Message<N>>(),
        scene: scene.key,
    }
}

/// Number type whose machine this crate has compiled: who plays one links it and does not compile a service again.
pub trait HostNumber: ServiceNumber {
    #[doc(hidden)]
    fn play_machine(
        scene: &Scene,
        units: Units,
        how: Sensed<'_>,
        play: &mut Play<'_, Self>,
    ) -> Result<(), Unbuildable>;
}

/// Code that plays a machine.
type Play<'a, N> = dyn FnMut(&mut dyn LocalService<N>) + 'a;

macro_rules! host_numbers {
    ($($number:ty),+) => {$(
        impl HostNumber for $number {
            // A function that is inlined is compiled where it is called.
            #[inline(never)]
            fn play_machine(
                scene: &Scene,
                units: Units,
                how: Sensed<'_>,
                play: &mut Play<'_, Self>,
            ) -> Result<(), Unbuildable> {
                build(scene, units, how, play)
            }
        }
    )+};
}

host_numbers!(f64, f32, Fixed, Coarse);

/// Parts of a scene by which a machine finds out where it is; by default none.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sensed<'a> {
    homing: Option<&'a trirrr_scene::Homing>,
    feedback: Option<&'a trirrr_scene::Feedback>,
    contact: Option<&'a trirrr_scene::Contact>,
}

impl<'a> Sensed<'a> {
    /// Parts of a machine whose drives tell where they are: they have to be [heard](LocalService::hear) in every tick.
    pub fn drives(scene: &'a Scene) -> Self {
        Self {
            homing: None,
            feedback: scene.feedback.as_ref(),
            contact: scene.contact.as_ref(),
        }
    }

    /// All parts of the scene, for a machine that was just switched on.
    pub fn all(scene: &'a Scene) -> Self {
        Self {
            homing: scene.homing.as_ref(),
            ..Self::drives(scene)
        }
    }
}

/// Builds the machine of `scene` and hands the machine to `play`. The machine stands where the job
/// starts. The model has room for what the scene holds, and for nothing else.
///
/// # Errors
/// A machine, limits or a pose that the scene's reader would have refused, or that the number type
/// cannot hold.
pub fn with_machine<N: HostNumber, T>(
    scene: &Scene,
    play: impl FnOnce(&mut dyn LocalService<N>) -> T,
) -> Result<T, Unbuildable> {
    with_machine_in(scene, units::<N>(scene)?, Sensed::default(), play)
}

/// Builds as [`with_machine`], for a machine that was just switched on. Where the scene has homing, the
/// machine has to be homed. Where its drives tell where they are, they have to be [heard](LocalService::hear) in every tick.
///
/// # Errors
/// As [`with_machine`].
pub fn with_machine_switched_on<N: HostNumber, T>(
    scene: &Scene,
    play: impl FnOnce(&mut dyn LocalService<N>) -> T,
) -> Result<T, Unbuildable> {
    with_machine_in(scene, units::<N>(scene)?, Sensed::all(scene), play)
}

/// Builds as [`with_machine`], in the `units` of the scene, which the caller knows, for a machine that finds out by `how` where it is.
///
/// # Errors
/// As [`with_machine`].
pub fn with_machine_in<N: HostNumber, T>(
    scene: &Scene,
    units: Units,
    how: Sensed<'_>,
    play: impl FnOnce(&mut dyn LocalService<N>) -> T,
) -> Result<T, Unbuildable> {
    let mut play = Some(play);
    let mut played = None;
    N::play_machine(scene, units, how, &mut |machine| {
        played = play.take().map(|play| play(machine));
    })?;
    Ok(played.expect("a machine that is built is played once"))
}

/// Units of the machine of `scene` in a number type.
fn units<N: ServiceNumber>(scene: &Scene) -> Result<Units, Unbuildable> {
    trirrr_scene::units::<N>(scene).map_err(|error| Unbuildable {
        scene: scene.name.clone(),
        reason: error.to_string(),
    })
}

fn build<N: ServiceNumber>(
    scene: &Scene,
    units: Units,
    how: Sensed<'_>,
    play: &mut Play<'_, N>,
) -> Result<(), Unbuildable> {
    let Sensed {
        homing,
        feedback,
        contact,
    } = how;
    let refused = |reason: String| Unbuildable {
        scene: scene.name.clone(),
        reason,
    };
    let parameters = units.parameters(&scene.parameters);
    let start = offer::pose(&units.pose(&scene.job.start));
    let feedback = match feedback {
        Some(feedback) => {
            let feedback = feedback.parameters(scene.tick_rate_hz);
            let geometry =
                Geometry::build(&parameters).map_err(|error| refused(error.to_string()))?;
            let built = FeedbackCoefficients::build(&feedback, &parameters, &geometry, start);
            Some(built.ok_or_else(|| refused("the start is out of reach".into()))?)
        }
        None => None,
    };
    let contact = match contact {
        Some(contact) => {
            let contact = contact.parameters(scene.tick_rate_hz);
            let built = ContactCoefficients::build(&contact, scene.period_s());
            let why = "contact: needs a number type with a floating point: f32, micromath or f64";
            Some(built.ok_or_else(|| refused(why.into()))?)
        }
        None => None,
    };
    let described = Described {
        kind: scene.model(),
        parameters,
        limits: units.limits(&scene.limits),
        start,
        feedback,
        contact,
        levels: scene.service.power_lists,
        interlocks: scene.inputs.interlocks,
        digital: scene.spare_pins.parameters(),
        settings: trirrr_scene::settings(scene, &units),
        homing: match homing {
            Some(homing) => {
                let parameters = homing
                    .parameters(scene, &units)
                    .map_err(|status| refused(status.to_string()))?;
                let period = units.time(scene.period_s());
                Some(HomingCoefficients::build(&parameters, period))
            }
            None => None,
        },
    };
    let built = scene.model().visit(Playing { described, play });
    built.map_err(|error| refused(error.to_string()))
}

/// Description of a service in the units of the machine.
struct Described<N: ServiceNumber> {
    kind: ModelKind,
    parameters: Parameters,
    limits: LimitParameters,
    start: Pose<N>,
    settings: Settings<N>,
    homing: Option<HomingCoefficients<N>>,
    feedback: Option<FeedbackCoefficients<N>>,
    contact: Option<ContactCoefficients<N>>,
    /// Levels of power for which there is room.
    levels: u16,
    /// Emergency stop, door, probe and limit switches.
    interlocks: InterlockParameters,
    /// Spare outputs and inputs.
    digital: DigitalParameters,
}

struct Playing<'a, 'b, N: ServiceNumber> {
    described: Described<N>,
    play: &'a mut Play<'b, N>,
}

impl<N: ServiceNumber> ModelVisitor<N> for Playing<'_, '_, N> {
    type Output = Result<(), ServiceError>;

    fn visit<M: Model<N = N>>(self) -> Self::Output {
        let Self { described, play } = self;
        let machine = Adjustable::new(described.parameters, described.limits);
        let scene = SceneParts {
            machine: machine.of_kind(described.kind),
            update: NoImage,
            levels: described.levels,
            homing: described.homing.as_ref(),
            feedback: described.feedback.as_ref(),
            contact: described.contact.as_ref(),
            interlocks: described.interlocks,
            digital: described.digital,
        };
        // The queues are some 100 KB.
        let mut channels = Box::new(Channels::<HostScene<N, M>, MOVES, SAMPLES, LEVELS>::new());
        let mut service = channels.service(scene, described.start, described.settings)?;
        play(&mut service);
        Ok(())
    }
}

/// Planner of paths of a host.
type HostPlanner<N> = ServicePlanner<N, { offer::PIECES }, { offer::CELLS }>;

scene! {
    /// Scene with all features: a host's values choose among them.
    HostScene [N: ServiceNumber, M: Model<N = N>] [N, M]: Adjustable<M, Quintics, HostPlanner<N>>,
    batches = On, update = NoImage, levels = On, homing = On, feedback = On, contact = On, retreat = On,
    interlocks = On<{ input_bits::ALL }>, probe = On, digital = On
}

impl<N: ServiceNumber, M: Model<N = N>> LocalService<N> for Service<'_, HostScene<N, M>> {
    fn tick(&mut self) {
        Service::tick(self);
    }

    fn timed_tick(&mut self) -> Duration {
        let begin = Instant::now();
        Service::tick(self);
        begin.elapsed()
    }

    fn state(&self) -> State {
        Service::state(self)
    }

    fn inputs(&mut self, closed: [bool; 3]) {
        self.set_inputs(closed);
    }

    fn sense(&mut self, readings: InterlockReadings) {
        Service::sense(self, readings);
    }

    fn sense_digital(&mut self, inputs: u8) {
        Service::sense_digital(self, inputs);
    }

    fn digital_outputs(&self) -> u8 {
        Service::digital_outputs(self)
    }

    fn hear(&mut self, readings: Readings<N>) {
        Service::hear(self, readings);
    }

    fn output(&self) -> &Output<N> {
        Service::output(self)
    }

    fn motors(&self) -> &[Motor<N>; 3] {
        &Service::output(self).motors
    }

    fn motion(&self) -> Option<&Played<N>> {
        Service::motion(self)
    }

    fn shift(&self) -> Option<[N::Angle; 3]> {
        Service::shift(self)
    }

    fn report_timing(&mut self, duration_ns: u32) {
        Service::report_timing(self, duration_ns, u32::MAX);
    }

    fn count_late(&mut self) {
        Service::count_late(self);
    }

    fn stir(&mut self, noise: u32) {
        Service::stir(self, noise);
    }

    fn answer(&mut self, request: &Request<N>) -> Reply<N> {
        // Every request has a length that is known beforehand.
        let checksum = wire::checksum(request).unwrap_or_default();
        Service::answer(self, request, checksum)
    }

    fn answer_kept(&mut self) -> Option<(u32, Reply<N>)> {
        Service::answer_kept(self)
    }

    fn step(&mut self) -> bool {
        Service::step(self)
    }

    fn outgoing(&mut self) -> Option<Message<N>> {
        Service::outgoing(self)
    }
}
