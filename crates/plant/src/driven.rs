//! Drives on the ticks of a job.

use crate::control::{Commands, Measured};
use crate::drives::SimulatedDrives;
use crate::refusal::Refusal;
use trirrr_core::number::Number;
use trirrr_service::Output;

/// Drives that take samples, whatever the number type of their ticks: a plant is compiled once, for all number types.
pub(crate) trait Sampled {
    /// Samples in each tick.
    fn per_tick(&self) -> u32;

    /// Begins a tick; `false` if the service has not given one.
    ///
    /// # Errors
    /// [`Refusal::Drive`].
    fn begin(&mut self) -> Result<bool, Refusal>;

    /// Takes sample `slot` of the tick, as [`SimulatedDrives::sample`].
    fn sample(&mut self, slot: u32, measured: &[Measured; 3]) -> Commands;
}

/// Drives, and the ticks that the service gave them.
pub(crate) struct Driven<'l, N: Number> {
    pub(crate) drives: Box<dyn SimulatedDrives<N> + 'l>,
    per_tick: u32,
    /// Ticks of the job.
    job: u32,
    /// Ticks that the service gave.
    given: u32,
    /// Output of the tick that has not begun.
    next: Option<Output<N>>,
}

impl<'l, N: Number> Driven<'l, N> {
    /// Joins `drives`, which take `per_tick` samples in a tick, to a job of `job` ticks.
    pub(crate) fn new(drives: Box<dyn SimulatedDrives<N> + 'l>, per_tick: u32, job: u32) -> Self {
        Self {
            drives,
            per_tick,
            job,
            given: 0,
            next: None,
        }
    }

    /// Takes the output of the next tick.
    pub(crate) fn give(&mut self, output: &Output<N>) {
        // The last setpoint still decelerates; the machine stands from there on.
        if self.given != self.job {
            self.next = Some(*output);
        }
        self.given = self.given.saturating_add(1);
    }
}

impl<N: Number> Sampled for Driven<'_, N> {
    fn per_tick(&self) -> u32 {
        self.per_tick
    }

    fn begin(&mut self) -> Result<bool, Refusal> {
        let Some(output) = &self.next else {
            return Ok(false);
        };
        self.drives.tick(output)?;
        // The last output holds for the time after the job.
        if self.given <= self.job {
            self.next = None;
        }
        Ok(true)
    }

    fn sample(&mut self, slot: u32, measured: &[Measured; 3]) -> Commands {
        self.drives.sample(slot, measured)
    }
}
