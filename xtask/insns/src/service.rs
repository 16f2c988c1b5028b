//! The service of the scene with its drives, and their tick as a caller sees it.

use crate::drives::{self, Drives};
use crate::scene::{
    self, COEFFICIENTS, Curves, MOVES, Model, PARTS, Planner, SETTINGS, START, Scalar,
};
use trirrr_core::number::Arithmetic;
use trirrr_core::setpoint::{Pose, Quintics};
use trirrr_protocol::message::{AnyMove, Move, Reply};
use trirrr_service::board::{Background, CommandOf, Compiled, Foreground, PartOf};
use trirrr_service::features::Feature;
use trirrr_service::{Channels, SceneParts, Settings};

/// Feedback that is counted: of drives in the MIT mode no answers are imitated.
#[cfg(drive = "odrive")]
type CountedFeedback = scene::Feedback;
#[cfg(not(drive = "odrive"))]
type CountedFeedback = ();

/// Detection of contacts on it.
#[cfg(drive = "odrive")]
type CountedContact = scene::Contact;
#[cfg(not(drive = "odrive"))]
type CountedContact = ();

trirrr_service::scene! {
    /// The scene that is counted: one that does not change, without retreats and spare pins.
    pub CountedScene: Compiled<'static, Model, Curves, Planner>,
    batches = scene::Batches,
    levels = scene::Levels,
    homing = scene::Homing,
    feedback = CountedFeedback,
    contact = CountedContact,
    interlocks = scene::Interlocks,
    probe = scene::Probe
}

/// Sixteen moves and samples less one each.
pub type SceneChannels = Channels<CountedScene, 16, 16, { scene::LEVELS }>;

/// The half that ticks.
pub type SceneForeground = Foreground<'static, CountedScene>;

/// The half that talks.
pub type SceneBackground = Background<'static, CountedScene>;

/// Command that the service receives.
pub type SceneCommand = CommandOf<CountedScene>;

/// Reply that the service gives.
pub type SceneReply = Reply<Scalar, PartOf<CountedScene>>;

/// The scene.
pub fn scene() -> SceneParts<'static, CountedScene> {
    let machine = Compiled {
        coefficients: &COEFFICIENTS,
        parts: PARTS,
        types: core::marker::PhantomData,
    };
    scene::parts(machine, ())
}

/// Returns the pose at which the job starts.
pub fn start() -> Pose<Scalar> {
    START
}

/// The settings, with a telemetry sample in each tick: the most there is to do.
pub fn settings() -> Settings<Scalar> {
    Settings {
        telemetry_every: 1,
        ..SETTINGS
    }
}

/// Move `index` of the job, called `number`; past its end, the last. The tool is on.
pub fn offered(index: usize, number: u32) -> AnyMove<Scalar> {
    let Some(each) = MOVES.get(index).or(MOVES.last()) else {
        return AnyMove::Cubic(Move::rest_to_rest(number, START, START, 0));
    };
    let ends = each.ends::<Scalar, Quintics>();
    let [start_velocity, end_velocity] = ends.velocities.map(Into::into);
    let common = Move {
        number,
        from: ends.from,
        to: ends.to,
        start_velocity,
        end_velocity,
        ticks: each.ticks(),
        tool_power: Scalar::HALF,
        tool_speed: Scalar::ONE,
    };
    AnyMove::new(common, ends.accelerations)
}

/// Parts that run once per tick.
pub struct Ticking {
    /// Foreground of the service.
    pub foreground: SceneForeground,
    /// Drives that take the service's output.
    pub drives: Drives,
    /// State of each switch of the machine: true if it is closed.
    #[cfg(homing)]
    pub closed: [bool; 3],
}

impl Ticking {
    /// With the drives of the scene.
    pub fn new(foreground: SceneForeground) -> Self {
        let angles = foreground.output().motors.map(|motor| motor.angle);
        Self {
            foreground,
            drives: drives::build(angles),
            #[cfg(homing)]
            closed: [false; 3],
        }
    }
}

/// One tick of the service and the drives: whatever there is to do in it.
#[inline(never)]
pub fn tick(ticking: &mut Ticking) {
    let Ticking {
        foreground, drives, ..
    } = ticking;
    #[cfg(drive = "odrive")]
    foreground.hear(drives.measure());
    if scene::Interlocks::EXISTS {
        foreground.sense(core::hint::black_box(Default::default()));
    }
    #[cfg(not(homing))]
    let output = foreground.tick();
    #[cfg(homing)]
    let output = {
        foreground.tick_with(ticking.closed);
        if let Some(by) = foreground.shift() {
            drives.shift(by);
        }
        foreground.output()
    };
    if let Err(failure) = drives.apply(output) {
        foreground.raise(failure.code(), failure.drive, failure.value, failure.limit);
    }
}
