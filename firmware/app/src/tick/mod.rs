//! The tick: inputs, service, drives, and the time that all of it took.

#[cfg(feature = "fault-injection")]
mod fault_injection;
pub(crate) mod heartbeat;
#[cfg(feature = "ruled-switches")]
mod ruled_switches;
mod tick_clock;
mod wired;

pub use heartbeat::WATCHDOG_MS;
pub use tick_clock::{TickClock, period};

use crate::inputs::{Angle, Closed, Inputs};
use crate::outputs::Outputs;
use crate::scene::Scalar;
use crate::service::SceneForeground;
use trirrr_core::number::Arithmetic;
use trirrr_drives::Failure;
use trirrr_protocol::message::{Board, FaultCode};
use wired::Wired;

/// Half of the service that ticks, between the inputs `I` and the outputs `O` of a board.
pub struct Tick<I, O> {
    foreground: SceneForeground,
    inputs: I,
    wired: Wired,
    outputs: O,
    clock: TickClock,
}

impl<I: Inputs, O: Outputs> Tick<I, O> {
    /// Joins the parts. A `board` that has started after a failure has the fault `Board` latched from here
    /// on, and its drives stay off until the host clears the fault.
    pub fn new(
        mut foreground: SceneForeground,
        board: &Board,
        inputs: I,
        outputs: O,
        clock: TickClock,
    ) -> Self {
        if board.start.is_failure() {
            raise(
                &mut foreground,
                FaultCode::Board,
                None,
                [Scalar::ONE, Scalar::ZERO],
            );
        }
        Self {
            foreground,
            inputs,
            wired: Wired::new(board),
            outputs,
            clock,
        }
    }

    /// Runs one tick. The outputs stand and the tick is timed when this returns.
    #[inline]
    pub fn run(&mut self) {
        self.step();
        self.report_timing();
    }

    #[inline]
    fn step(&mut self) {
        let motors = &self.foreground.output().motors;
        let closed = self.wired.read(&mut self.inputs, motors);
        self.foreground.hear(self.outputs.measure());
        let contacts = self.inputs.interlocks();
        self.foreground.sense(self.wired.interlocks(contacts));
        self.foreground.sense_digital(self.inputs.digital());
        tick(&mut self.foreground, closed);
        if let Some(by) = self.foreground.shift() {
            self.outputs.shift(by);
            self.inputs.shift(by);
            self.wired.shift(by);
        }
        if let Err(failure) = self.outputs.apply(self.foreground.output()) {
            self.fail(&failure);
        }
        self.work();
        self.outputs.show(self.foreground.state());
    }

    /// Hands the tool its power, and switches the spare outputs. After a fault that is none.
    #[inline(always)]
    fn work(&mut self) {
        let runs = self.foreground.tool_runs();
        self.outputs.work(self.foreground.output().tool, runs);
        self.outputs.switch(self.foreground.digital_outputs());
    }

    /// Latches the failure of a drive as a fault and switches all drives off.
    #[cold]
    fn fail(&mut self, failure: &Failure<Scalar>) {
        let Failure {
            drive,
            value,
            limit,
            ..
        } = *failure;
        raise(&mut self.foreground, failure.code(), drive, [value, limit]);
        if let Some(angles) = self.outputs.angles() {
            set_position(&mut self.foreground, angles);
        }
        self.switch_off();
    }

    /// Carries out the output after a fault, if it has the drives off.
    fn switch_off(&mut self) {
        if !self.foreground.output().is_on() {
            // Off does not fail: every tick from now on repeats it.
            let _ = self.outputs.apply(self.foreground.output());
        }
    }

    /// Reports the time since the tick was due. A tick in time is a heartbeat, any other a fault.
    #[inline]
    fn report_timing(&mut self) {
        let (duration, period) = (self.clock.elapsed(), self.clock.period());
        if report_timing(&mut self.foreground, duration, period) {
            heartbeat::beat();
        } else {
            heartbeat::miss();
            self.switch_off();
            self.work();
        }
    }
}

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
    fn tick(foreground: &mut SceneForeground, closed: Closed) {
        foreground.tick_with(closed);
    }

    /// Latches a fault from outside.
    fn raise(
        foreground: &mut SceneForeground,
        code: FaultCode,
        index: Option<u8>,
        [value, limit]: [Scalar; 2],
    ) {
        foreground.raise(code, index, value, limit);
    }

    /// Takes angles that drives have counted.
    fn set_position(foreground: &mut SceneForeground, angles: [Angle; 3]) {
        foreground.set_position(angles);
    }

    /// Reports the latency of a tick. Returns true if it was in time.
    fn report_timing(
        foreground: &mut SceneForeground,
        duration: u32,
        period: u32,
    ) -> bool {
        foreground.report_timing(duration, period)
    }
}
