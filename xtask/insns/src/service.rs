//! The service of the scene with its drives, and their tick as a caller sees it.

use crate::drives::{self, Drives};
use crate::scene::{
    BATCHES, COEFFICIENTS, Curves, MOVES, Model, PARTS, Planner, SETTINGS, START, Scalar,
};
use trirrr_core::number::Arithmetic;
use trirrr_core::setpoint::{Pose, Quintics};
use trirrr_protocol::message::{AnyMove, Move, Reply};
use trirrr_service::{Background, Channels, CommandOf, Compiled, Foreground, Settings};

type CompiledScene = Compiled<'static, Model, Curves, Planner, BATCHES>;

/// The scene of an image that does not change it, with its power lists, if it plays any.
#[cfg(not(levels))]
type CountedLevelScene = CompiledScene;
#[cfg(levels)]
type CountedLevelScene =
    trirrr_service::WithLevels<CompiledScene, { crate::scene::LEVELS as usize }>;

/// The same of a machine that is not homed,
#[cfg(not(homing))]
type CountedHomedScene = CountedLevelScene;

/// and of one that is.
#[cfg(homing)]
type CountedHomedScene = trirrr_service::WithHoming<'static, CountedLevelScene>;

/// The same, of drives that tell where they are.
#[cfg(not(drive = "odrive"))]
type HeardScene = CountedHomedScene;
#[cfg(drive = "odrive")]
type HeardScene = trirrr_service::WithFeedback<'static, CountedHomedScene>;

/// The same, of a machine that detects no contacts,
#[cfg(not(all(drive = "odrive", contact)))]
type CountedFeelingScene = HeardScene;
/// and of one that does.
#[cfg(all(drive = "odrive", contact))]
type CountedFeelingScene = trirrr_service::WithContact<'static, HeardScene>;

/// The scene that is counted.
#[cfg(not(interlocks))]
pub type CountedScene = CountedFeelingScene;
/// The same, with an emergency stop or a door.
#[cfg(interlocks)]
pub type CountedScene = trirrr_service::WithInterlocks<
    CountedFeelingScene,
    { crate::scene::INPUTS },
    crate::scene::Probe,
>;

/// Sixteen moves and samples less one each.
pub type SceneChannels = Channels<CountedScene, 16, 16>;

/// The half that ticks.
pub type SceneForeground = Foreground<'static, CountedScene>;

/// The half that talks.
pub type SceneBackground = Background<'static, CountedScene>;

/// Command that the service receives.
pub type SceneCommand = CommandOf<CountedScene>;

/// Reply that the service gives.
pub type SceneReply = Reply<Scalar, <CountedScene as trirrr_service::Scene>::Part>;

/// The scene.
pub fn scene() -> CountedScene {
    let scene = Compiled {
        coefficients: &COEFFICIENTS,
        parts: PARTS,
        types: core::marker::PhantomData,
    };
    #[cfg(levels)]
    let scene = trirrr_service::WithLevels {
        scene,
        room: crate::scene::LEVELS,
    };
    #[cfg(homing)]
    let scene = trirrr_service::WithHoming {
        scene,
        homing: Some(&crate::scene::HOMING),
    };
    #[cfg(drive = "odrive")]
    let scene = trirrr_service::WithFeedback {
        scene,
        feedback: Some(&crate::scene::FEEDBACK),
    };
    #[cfg(all(drive = "odrive", contact))]
    let scene = trirrr_service::WithContact {
        scene,
        contact: Some(&crate::scene::CONTACT),
        retreat: trirrr_service::NoRetreat,
    };
    #[cfg(interlocks)]
    let scene = trirrr_service::WithInterlocks {
        scene,
        parameters: crate::scene::INTERLOCKS,
        probe: core::marker::PhantomData,
    };
    scene
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
    #[cfg(not(homing))]
    let Ticking { foreground, drives } = ticking;
    // Of drives in the MIT mode no answers are imitated: their tick hears nothing.
    #[cfg(all(drive = "odrive", not(homing)))]
    foreground.hear(drives.measure());
    #[cfg(all(interlocks, not(homing)))]
    foreground.sense(core::hint::black_box(Default::default()));
    #[cfg(not(homing))]
    let output = foreground.tick();
    #[cfg(homing)]
    let Ticking {
        foreground,
        drives,
        closed,
    } = ticking;
    #[cfg(all(drive = "odrive", homing))]
    foreground.hear(drives.measure());
    #[cfg(all(interlocks, homing))]
    foreground.sense(core::hint::black_box(Default::default()));
    #[cfg(homing)]
    let output = {
        foreground.tick_with(*closed);
        if let Some(by) = foreground.shift() {
            drives.shift(by);
        }
        foreground.output()
    };
    if let Err(failure) = drives.apply(output) {
        foreground.raise(failure.code(), failure.drive, failure.value, failure.limit);
    }
}
