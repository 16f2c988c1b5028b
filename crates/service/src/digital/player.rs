//! The tick's end of spare inputs and outputs.

use super::{CHANGES, DigitalParameters, OutputChange, changed, falls};
use crate::interlock::DebouncedInput;
use crate::queue::Receiver;
use trirrr_protocol::message::{DIGITAL, DigitalStates, State};

/// Levels of the inputs and outputs, and the changes that come with moves.
pub(crate) struct DigitalPlayer<'q> {
    changes: Receiver<'q, OutputChange>,
    inputs: [DebouncedInput; DIGITAL],
    /// Outputs that were switched on.
    switched: u8,
    in_jobs: u8,
    /// States after the last tick.
    told: DigitalStates,
}

impl<'q> DigitalPlayer<'q> {
    pub(super) fn new(changes: Receiver<'q, OutputChange>, parameters: &DigitalParameters) -> Self {
        Self {
            changes,
            inputs: parameters.debounce_ticks.map(DebouncedInput::new),
            switched: 0,
            in_jobs: parameters.in_jobs,
            told: DigitalStates::default(),
        }
    }

    /// Takes the levels of the inputs. Those that the scene does not name are clear.
    pub(crate) fn sense(&mut self, readings: u8) {
        for (bit, input) in self.inputs.iter_mut().enumerate() {
            input.read(readings >> bit & 1 != 0);
        }
    }

    /// Switches outputs, in a state that keeps them.
    #[inline(never)]
    pub(crate) fn switch(&mut self, on: u8, off: u8, state: State) {
        if !falls(state) {
            self.switched = changed(self.switched, on, off);
        }
    }

    /// Switches the outputs that change with move `number`, which begins. Changes of moves that are over or dropped go.
    #[inline(never)]
    pub(crate) fn begin(&mut self, number: u32, generation: u8) {
        for _ in 0..=CHANGES {
            let Some(front) = self.changes.peek() else {
                return;
            };
            let ahead = front.number.wrapping_sub(number) as i32;
            let is_of_queue = front.generation == generation;
            if is_of_queue && ahead > 0 {
                return;
            }
            if is_of_queue && ahead == 0 {
                self.switched = changed(self.switched, front.on, front.off);
            }
            self.changes.discard();
        }
    }

    /// Drops a change of another generation, if it is the next.
    #[inline]
    pub(crate) fn drop_stale(&mut self, generation: u8) {
        let is_stale = |front: &OutputChange| front.generation != generation;
        if self.changes.peek().is_some_and(is_stale) {
            self.changes.discard();
        }
    }

    /// The machine comes to `state`: outputs of a job go off with its end, and all without power.
    #[inline(never)]
    pub(crate) fn enter(&mut self, state: State) {
        match state {
            State::Running | State::Slowing | State::Holding => {}
            _ if falls(state) => self.switched = 0,
            _ => self.switched &= !self.in_jobs,
        }
    }

    /// Outputs that are on; `runs`: the tool may be on.
    #[inline]
    pub(crate) fn outputs(&self, runs: bool) -> u8 {
        match runs {
            true => self.switched,
            false => self.switched & !self.in_jobs,
        }
    }

    /// Keeps the states at the end of tick `tick`. Returns true if one changed in it.
    #[inline(never)]
    pub(crate) fn settle(&mut self, runs: bool, tick: u32) -> bool {
        let outputs = self.outputs(runs);
        let inputs = (0..).zip(&self.inputs).fold(0, |bits, (bit, input)| {
            bits | u8::from(input.is_active()) << bit
        });
        let is_news = (self.told.inputs, self.told.outputs) != (inputs, outputs);
        if is_news {
            self.told = DigitalStates {
                inputs,
                outputs,
                tick,
            };
        }
        is_news
    }

    /// Returns the states after the last tick.
    pub(crate) fn states(&self) -> DigitalStates {
        self.told
    }
}
