//! Service of a scene without a host: the tick, with the job in flash, and what is left to do below it.

pub mod cause;
mod no_log;

pub(crate) use self::LoneForeground as SceneForeground;
pub use self::{NoChannels as Channels, WatchdogKeeper as Background};
use crate::outputs::Steps;
use crate::scene;
use crate::tick::heartbeat::Monitor;
use core::marker::PhantomData;
use trirrr_protocol::message::{Board, Firmware};
use trirrr_service::features::{OwnJob, OwnJobParts};

/// Scene of this image.
type ImageScene = scene::ImageScene<()>;

/// The tick, with the job of the scene.
pub(crate) type LoneForeground = trirrr_service::board::Foreground<
    'static,
    ImageScene,
    OwnJob<'static, ImageScene, { scene::PACED }>,
>;

/// Memory between both halves: there is one.
pub struct NoChannels;

impl NoChannels {
    /// None.
    #[expect(
        clippy::new_without_default,
        reason = "beside the channels of other images"
    )]
    pub const fn new() -> Self {
        Self
    }
}

/// Builds the tick. The machine stands at the start of its job.
// A call: inlined, the board's crate would compile it for speed.
#[inline(never)]
pub fn build(_: &mut NoChannels, _: Board, _: &'static Firmware) -> (SceneForeground, ()) {
    let parts = OwnJobParts {
        tick: &scene::TICK,
        limits: &scene::RESULT_LIMITS,
        moves: &scene::OWN_MOVES,
        passes: scene::PASSES,
        start: scene::START,
        angles: scene::START_ANGLES,
        begins: scene::BEGINS,
        button: scene::BUTTON,
        homing: scene::OWN_HOMING,
        interlocks: scene::INTERLOCKS,
    };
    (SceneForeground::alone(parts, &scene::SETTINGS), ())
}

/// Work below the tick: the watchdog's condition. There is no line, with no transmitter `W` and no receiver `R`, and no log `L`.
pub struct WatchdogKeeper<W, L, R = ()> {
    heartbeat: Monitor,
    ends: PhantomData<(W, L, R)>,
}

impl<W, L, R> WatchdogKeeper<W, L, R> {
    /// Takes what does nothing.
    pub fn new((): (), _: R, _: W, _: L) -> Self {
        Self {
            heartbeat: Monitor::default(),
            ends: PhantomData,
        }
    }

    /// Works below every interrupt and never returns. Calls `after_tick` after each tick that was in time, with `true` if the watchdog is to
    /// be fed.
    pub fn run(&mut self, mut after_tick: impl FnMut(bool)) -> ! {
        loop {
            if self.heartbeat.has_beaten() {
                after_tick(self.heartbeat.feeds());
            }
        }
    }
}

/// Steps of the scene that is played: those of the image.
pub fn played_steps() -> Option<Steps> {
    None
}
