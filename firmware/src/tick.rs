//! The tick: the service, then the drives, then how long both took.

use crate::inputs::Inputs;
use crate::outputs::Outputs;
use crate::pulse;
use trirrr_core::number::Number;
use trirrr_drives::Failure;
use trirrr_protocol::message::{FaultCode, Start};
use trirrr_station::Foreground;
use trirrr_station::scene::Scalar;

/// Where the board started because it had failed, that is a fault: the drives stay off until the
/// host has acknowledged it. Said here, where the tick's own code for faults is.
pub(crate) fn heed(start: &Start, foreground: &mut Foreground) {
    if start.is_failure() {
        foreground.raise(FaultCode::Board, None, Scalar::ONE, Scalar::ZERO);
    }
}

/// What runs once per tick.
pub(crate) struct Tick<I, O> {
    foreground: Foreground,
    inputs: I,
    outputs: O,
    #[cfg(feature = "switches")]
    switches: crate::inputs::Ruled,
}

impl<I: Inputs, O: Outputs> Tick<I, O> {
    pub(crate) fn new(foreground: Foreground, inputs: I, outputs: O) -> Self {
        Self {
            foreground,
            inputs,
            outputs,
            #[cfg(feature = "switches")]
            switches: crate::inputs::ruled(),
        }
    }

    /// One tick; its outputs stand when this returns.
    #[inline]
    pub(crate) fn run(&mut self) {
        #[cfg(feature = "provoke")]
        crate::provoke::at(pulse::ticks());
        // Without homing they are nothing.
        #[allow(clippy::let_unit_value)]
        let inputs = self.inputs.read();
        #[cfg(feature = "switches")]
        let inputs = {
            // The pins say nothing in an emulator, but they are read.
            core::hint::black_box(inputs);
            self.switches.closed(&self.foreground.output().motors)
        };
        self.foreground.tick_with(inputs);
        if let Some(by) = self.foreground.shift() {
            self.outputs.shift(by);
            #[cfg(feature = "switches")]
            self.switches.shift(by);
        }
        if let Err(failure) = self.outputs.apply(self.foreground.output()) {
            self.fail(&failure);
        }
    }

    /// A drive does not do what it was told: a fault, and all are off.
    #[cold]
    fn fail(&mut self, failure: &Failure<Scalar>) {
        let Failure {
            drive,
            value,
            limit,
            ..
        } = *failure;
        self.foreground.raise(failure.code(), drive, value, limit);
        if let Some(angles) = self.outputs.angles() {
            self.foreground.motors_are_at(angles);
        }
        self.off();
    }

    /// Carries out that the drives are off, which a latched fault has said.
    fn off(&mut self) {
        // Off does not fail: it is said again in every tick.
        let _ = self.outputs.apply(self.foreground.output());
    }

    /// Says how long it took since it was due, of how long it may take, in counts of the timer.
    #[inline]
    pub(crate) fn took(&mut self, duration: u32, period: u32) {
        if self.foreground.took(duration, period) {
            pulse::beat();
        } else {
            self.off();
        }
    }
}
