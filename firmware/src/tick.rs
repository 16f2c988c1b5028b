//! The tick: the service, then the drives, then how long both took.

use crate::outputs::Outputs;
use crate::pulse;
use crate::station::Foreground;

/// What runs once per tick.
pub(crate) struct Tick<O> {
    foreground: Foreground,
    outputs: O,
}

impl<O: Outputs> Tick<O> {
    pub(crate) fn new(foreground: Foreground, outputs: O) -> Self {
        Self {
            foreground,
            outputs,
        }
    }

    /// One tick; its outputs stand when this returns.
    #[inline]
    pub(crate) fn run(&mut self) {
        #[cfg(feature = "provoke")]
        crate::provoke::at(pulse::ticks());
        self.outputs.apply(self.foreground.tick());
    }

    /// Says how long it took since it was due, of how long it may take, in counts of the timer.
    #[inline]
    pub(crate) fn took(&mut self, duration: u32, period: u32) {
        if self.foreground.took(duration, period) {
            pulse::beat();
        } else {
            self.outputs.apply(self.foreground.output());
        }
    }
}
