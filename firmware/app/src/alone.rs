//! Service of a scene without a host: the tick, with the job in flash, and what is left to do below it.

pub(crate) use self::LoneForeground as SceneForeground;
pub use self::{NoChannels as Channels, WatchdogKeeper as Background};
use crate::heartbeat::Monitor;
use crate::inputs::{Angle, Closed};
use crate::scene::{self, Curves, Model, Scalar};
use core::marker::PhantomData;
use trirrr_protocol::message::{Board, FaultCode, Firmware};
use trirrr_service::board::Compiled;
use trirrr_service::features::{OwnJob, OwnJobParts};

trirrr_service::scene! {
    /// Scene of this image.
    pub ImageScene: Compiled<'static, Model, Curves>,
    homing = scene::Homing,
    interlocks = scene::Interlocks
}

/// The tick, with the job of the scene.
pub(crate) type LoneForeground = trirrr_service::board::Foreground<
    'static,
    ImageScene,
    OwnJob<'static, ImageScene, { scene::PACED }>,
>;

/// Plays a tick.
// A call: here it is compiled for size. The flash of a small board is worth more than the time, which is proven by the watch over the tick.
#[inline(never)]
pub(crate) fn tick(foreground: &mut SceneForeground, closed: Closed) {
    foreground.tick_with(closed);
}

/// Latches a fault from outside. A call, as those that follow: for size, too.
#[inline(never)]
pub(crate) fn raise(
    foreground: &mut SceneForeground,
    code: FaultCode,
    index: Option<u8>,
    [value, limit]: [Scalar; 2],
) {
    foreground.raise(code, index, value, limit);
}

/// Takes angles that drives have counted.
#[inline(never)]
pub(crate) fn set_position(foreground: &mut SceneForeground, angles: [Angle; 3]) {
    foreground.set_position(angles);
}

/// Reports the latency of a tick. Returns true if it was in time.
#[inline(never)]
pub(crate) fn report_timing(foreground: &mut SceneForeground, duration: u32, period: u32) -> bool {
    foreground.report_timing(duration, period)
}

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
