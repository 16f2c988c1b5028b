//! The service of the scene with its drives, and their tick as a caller sees it.

use crate::drives::{self, Drives};
use crate::scene::{COEFFICIENTS, MOVES, Model, PARTS, SETTINGS, START, Scalar};
use nalgebra::Vector3;
use trirrr_core::number::Arithmetic;
use trirrr_core::setpoint::Pose;
use trirrr_protocol::message::Move;
use trirrr_protocol::message::{Command, Reply};
use trirrr_service::{Background, Channels, Compiled, Foreground, Settings};

type CompiledScene = Compiled<'static, Model>;

/// The scene of an image that does not change it.
#[cfg(not(homing))]
pub type CountedScene = CompiledScene;

/// The same, of a machine that is homed.
#[cfg(homing)]
pub type CountedScene = trirrr_service::WithHoming<'static, CompiledScene>;

/// Sixteen moves and samples less one each.
pub type SceneChannels = Channels<CountedScene, 16, 16>;

/// The half that ticks.
pub type SceneForeground = Foreground<'static, CountedScene>;

/// The half that talks.
pub type SceneBackground = Background<'static, CountedScene>;

/// Command that the service receives.
pub type SceneCommand = Command<Scalar, <CountedScene as trirrr_service::Scene>::Replacement>;

/// Reply that the service gives.
pub type SceneReply = Reply<Scalar, <CountedScene as trirrr_service::Scene>::Part>;

/// The scene.
pub fn scene() -> CountedScene {
    let scene = Compiled {
        coefficients: &COEFFICIENTS,
        parts: PARTS,
    };
    #[cfg(homing)]
    let scene = trirrr_service::WithHoming {
        scene,
        homing: Some(&crate::scene::HOMING),
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
pub fn offered(index: usize, number: u32) -> Move<Scalar> {
    let pose = |[x, y, alpha]: [f64; 3]| Pose::from_f64(x, y, alpha);
    let velocity = |v: [f64; 3]| Vector3::from(v.map(Scalar::from_f64)).into();
    let rest = [Scalar::ZERO; 3];
    let each = MOVES.get(index).or(MOVES.last());
    let (from, to, start, end, ticks) = match each {
        Some(trirrr_image::Move::RestToRest { from, to, ticks }) => {
            (pose(*from), pose(*to), rest, rest, *ticks)
        }
        Some(trirrr_image::Move::Hermite {
            from,
            from_velocity,
            to,
            to_velocity,
            ticks,
        }) => {
            let ends = (velocity(*from_velocity), velocity(*to_velocity));
            (pose(*from), pose(*to), ends.0, ends.1, *ticks)
        }
        None => (pose([0.0; 3]), pose([0.0; 3]), rest, rest, 0),
    };
    Move {
        number,
        from,
        to,
        start_velocity: start,
        end_velocity: end,
        ticks,
        tool_power: Scalar::HALF,
        tool_speed: Scalar::ONE,
    }
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
    #[cfg(not(homing))]
    let output = foreground.tick();
    #[cfg(homing)]
    let Ticking {
        foreground,
        drives,
        closed,
    } = ticking;
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
