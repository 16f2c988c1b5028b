//! The service of a scene behind one object: the core's types say what its machine holds, a scene
//! says it at run time, and here the one is chosen by the other.

use crate::job;
use trirrr_core::limits::LimitParameters;
use trirrr_core::machine::{LinksKind, Parameters, PayloadKind};
use trirrr_core::setpoint::Pose;
use trirrr_core::tick::Motor;
use trirrr_core::torque::links::{Horizontal, InPlane, Links, Massive, Massless, Rotors};
use trirrr_core::torque::payload::{Centred, Offset, Payload, PositionOnly};
use trirrr_protocol::message::scene::Section;
use trirrr_protocol::message::{Hello, Message, PROTOCOL, Reply, Request};
use trirrr_protocol::wire::{self, schema};
use trirrr_scene::{Homing, Scene};
use trirrr_service::ServiceNumber;
use trirrr_service::{
    Adjustable, Background, Channels, Foreground, HomingCoefficients, Put, ServiceError, Settings,
    Setup, Take, WithHoming,
};

/// Moves that can wait, as on a board, and one place that stays empty.
const MOVES: usize = 16 + 1;

/// Telemetry samples that can wait, and one place that stays empty. They are fetched after every
/// tick.
const SAMPLES: usize = 63 + 1;

/// A machine that is talked to: the core's service, with both of its halves in one hand.
pub trait LocalService<N: ServiceNumber> {
    /// One tick.
    fn tick(&mut self);

    /// What the inputs of homing say from now on.
    fn inputs(&mut self, closed: [bool; 3]);

    /// What the motors were commanded in the last tick.
    fn motors(&self) -> &[Motor<N>; 3];

    /// What the last tick has added to their angles without moving them.
    fn shift(&self) -> Option<[N::Angle; 3]>;

    /// Says how long the last tick took, ns. It is told on and is no fault, however long: a host
    /// keeps no deadlines.
    fn took(&mut self, duration_ns: u32);

    /// Takes a request; the answer to it.
    fn receive(&mut self, request: &Request<N>) -> Reply<N>;

    /// A slice of the work below the tick; false where nothing is left to do at once.
    fn work(&mut self) -> bool;

    /// The oldest event or telemetry sample that nobody has fetched.
    fn outgoing(&mut self) -> Option<Message<N>>;
}

/// Error of a scene whose machine cannot be built in a number type.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("scene {scene}: {reason}")]
pub struct Unbuildable {
    /// Name of the scene.
    pub scene: String,
    /// Quantity that is refused, and why.
    pub reason: String,
}

/// What a client says first to the machine of `scene`.
pub fn hello<N: ServiceNumber>(scene: &Scene) -> Hello {
    Hello {
        protocol: PROTOCOL,
        schema: schema::key::<Request<N>, Message<N>>(),
        scene: scene.key,
    }
}

/// Builds the machine of `scene`, with room for what the scene holds and for nothing else, standing
/// where its job starts, and hands it to `play`.
///
/// # Errors
/// A machine, limits or a pose that the scene's reader would have refused, or that the number type
/// cannot hold.
pub fn with_machine<N: ServiceNumber, T>(
    scene: &Scene,
    play: impl FnOnce(&mut dyn LocalService<N>) -> T,
) -> Result<T, Unbuildable> {
    build(scene, None, play)
}

/// The same, just switched on: where the scene has homing, the machine has to be homed.
///
/// # Errors
/// As [`with_machine`].
pub fn with_machine_switched_on<N: ServiceNumber, T>(
    scene: &Scene,
    play: impl FnOnce(&mut dyn LocalService<N>) -> T,
) -> Result<T, Unbuildable> {
    build(scene, scene.homing.as_ref(), play)
}

fn build<N: ServiceNumber, T>(
    scene: &Scene,
    homing: Option<&Homing>,
    play: impl FnOnce(&mut dyn LocalService<N>) -> T,
) -> Result<T, Unbuildable> {
    let refused = |reason: String| Unbuildable {
        scene: scene.name.clone(),
        reason,
    };
    let units = trirrr_scene::units::<N>(scene).map_err(|error| refused(error.to_string()))?;
    let described = Described {
        parameters: units.parameters(&scene.parameters),
        limits: units.limits(&scene.limits),
        start: job::pose(&units.pose(&scene.job.start)),
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
    let played = match PayloadKind::of(&scene.parameters) {
        _ if !scene.torque => with_links::<N, PositionOnly, Massless, T>(described, play),
        PayloadKind::Centred => with_payload::<N, Centred<N>, T>(described, play),
        PayloadKind::Offset => with_payload::<N, Offset<N>, T>(described, play),
    };
    played.map_err(|error| refused(error.to_string()))
}

/// What a service is built from, in the machine's units.
struct Described<N: ServiceNumber> {
    parameters: Parameters,
    limits: LimitParameters,
    start: Pose<N>,
    settings: Settings<N>,
    homing: Option<HomingCoefficients<N>>,
}

fn with_payload<N, P, T>(
    described: Described<N>,
    play: impl FnOnce(&mut dyn LocalService<N>) -> T,
) -> Result<T, ServiceError>
where
    N: ServiceNumber,
    P: Payload<N> + Send + 'static,
{
    match LinksKind::of(&described.parameters) {
        LinksKind::Massless => with_links::<N, P, Massless, T>(described, play),
        LinksKind::Rotors => with_links::<N, P, Rotors<N>, T>(described, play),
        LinksKind::MassiveHorizontal => {
            with_links::<N, P, Massive<N, Horizontal>, T>(described, play)
        }
        LinksKind::MassiveInPlane => with_links::<N, P, Massive<N, InPlane<N>>, T>(described, play),
    }
}

fn with_links<N, P, L, T>(
    described: Described<N>,
    play: impl FnOnce(&mut dyn LocalService<N>) -> T,
) -> Result<T, ServiceError>
where
    N: ServiceNumber,
    P: Payload<N> + Send + 'static,
    L: Links<N> + Send + 'static,
{
    // The queues are some 100 KB.
    let mut channels =
        Box::new(Channels::<N, P, L, WithHoming<N, Adjustable>, MOVES, SAMPLES>::new());
    let scene = WithHoming {
        scene: Adjustable::new(described.parameters, described.limits),
        homing: described.homing.as_ref(),
    };
    let (foreground, background) = channels.split(scene, described.start, described.settings)?;
    Ok(play(&mut Service {
        foreground,
        background,
        inputs: [false; 3],
    }))
}

/// Both halves.
struct Service<F, B> {
    foreground: F,
    background: B,
    inputs: [bool; 3],
}

impl<'q, N, P, L, S, T, U, H> LocalService<N>
    for Service<Foreground<'q, N, P, L, T, H>, Background<'q, N, P, L, S, U>>
where
    N: ServiceNumber,
    P: Payload<N>,
    L: Links<N>,
    S: trirrr_service::Scene<N, P, L, Replacement = Section, Part = Section>,
    T: Take<Setup<N, P, L>>,
    U: Put<Setup<N, P, L>>,
    H: trirrr_service::Homing<N, Inputs = [bool; 3]>,
{
    fn tick(&mut self) {
        self.foreground.tick_with(self.inputs);
    }

    fn inputs(&mut self, closed: [bool; 3]) {
        self.inputs = closed;
    }

    fn motors(&self) -> &[Motor<N>; 3] {
        &self.foreground.output().motors
    }

    fn shift(&self) -> Option<[N::Angle; 3]> {
        self.foreground.shift()
    }

    fn took(&mut self, duration_ns: u32) {
        self.foreground.took(duration_ns, u32::MAX);
    }

    fn receive(&mut self, request: &Request<N>) -> Reply<N> {
        // Every request has a length that is known beforehand.
        let checksum = wire::checksum(request).unwrap_or_default();
        self.background.receive(request, checksum)
    }

    fn work(&mut self) -> bool {
        self.background.step()
    }

    fn outgoing(&mut self) -> Option<Message<N>> {
        self.background.outgoing()
    }
}
