//! Calls of the tick into the service, which know neither inputs nor outputs.

use crate::inputs::{Angle, Closed};
use crate::scene::Scalar;
use crate::service::SceneForeground;
use trirrr_protocol::message::FaultCode;

/// Functions that the board's crate compiles, for speed. Without a host they are compiled here, for size: the flash of a small board is worth
/// more than the time, which is proven by the watch over the tick.
macro_rules! calls {
    ($($call:item)*) => {$(
        #[cfg_attr(autonomous, inline(never))]
        #[cfg_attr(not(autonomous), inline(always))]
        $call
    )*};
}

calls! {
    /// Plays a tick.
    pub(super) fn tick(foreground: &mut SceneForeground, closed: Closed) {
        foreground.tick_with(closed);
    }

    /// Latches a fault from outside.
    pub(super) fn raise(
        foreground: &mut SceneForeground,
        code: FaultCode,
        index: Option<u8>,
        [value, limit]: [Scalar; 2],
    ) {
        foreground.raise(code, index, value, limit);
    }

    /// Takes angles that drives have counted.
    pub(super) fn set_position(foreground: &mut SceneForeground, angles: [Angle; 3]) {
        foreground.set_position(angles);
    }

    /// Reports the latency of a tick. Returns true if it was in time.
    pub(super) fn report_timing(
        foreground: &mut SceneForeground,
        duration: u32,
        period: u32,
    ) -> bool {
        foreground.report_timing(duration, period)
    }
}
