//! Simulated stepper drivers: pins that count the pulses they get.

use embedded_hal::digital::{ErrorType, OutputPin};
use std::convert::Infallible;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicI32, Ordering};

/// Three drivers on one enable line.
#[derive(Debug, Default)]
pub(crate) struct Drivers {
    axes: [StepInputs; 3],
    /// Level of the enable line.
    enable: AtomicBool,
    /// Level at which the drivers are on.
    on_high: bool,
}

#[derive(Debug, Default)]
struct StepInputs {
    step: AtomicBool,
    direction: AtomicBool,
    microsteps: AtomicI32,
}

/// Input of a driver.
#[derive(Clone, Copy, Debug)]
pub(crate) enum DriverInput {
    /// Step input of an axis, which acts at its rising edge.
    Step(usize),
    /// Direction input of an axis: high counts up.
    Direction(usize),
    /// Enable line.
    Enable,
}

/// Pin wired to an input.
#[derive(Debug)]
pub(crate) struct Pin {
    drivers: Arc<Drivers>,
    input: DriverInput,
}

impl Drivers {
    /// Drivers that are on while their enable line is at `on_high`.
    pub(crate) fn new(on_high: bool) -> Arc<Self> {
        Arc::new(Self {
            enable: AtomicBool::new(!on_high),
            on_high,
            ..Self::default()
        })
    }

    /// Pin wired to `input`.
    pub(crate) fn pin(self: &Arc<Self>, input: DriverInput) -> Pin {
        Pin {
            drivers: Arc::clone(self),
            input,
        }
    }

    /// Microsteps that each axis has taken since the start, modulo 2^32.
    pub(crate) fn microsteps(&self) -> [i32; 3] {
        let count = |axis: &StepInputs| axis.microsteps.load(Ordering::Relaxed);
        self.axes.each_ref().map(count)
    }

    fn set(&self, input: DriverInput, high: bool) {
        match input {
            DriverInput::Enable => self.enable.store(high, Ordering::Relaxed),
            DriverInput::Direction(axis) => {
                self.axes[axis].direction.store(high, Ordering::Relaxed)
            }
            DriverInput::Step(axis) => {
                let axis = &self.axes[axis];
                let was_high = axis.step.swap(high, Ordering::Relaxed);
                let on = self.enable.load(Ordering::Relaxed) == self.on_high;
                if high && !was_high && on {
                    let up = axis.direction.load(Ordering::Relaxed);
                    let step = if up { 1 } else { -1 };
                    axis.microsteps.fetch_add(step, Ordering::Relaxed);
                }
            }
        }
    }
}

impl ErrorType for Pin {
    type Error = Infallible;
}

impl OutputPin for Pin {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.drivers.set(self.input, false);
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.drivers.set(self.input, true);
        Ok(())
    }
}
