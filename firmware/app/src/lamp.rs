//! Status lamp: off, steady or blinking, by the state of the machine.

use crate::outputs::OutputPart;
use crate::scene::TICK_RATE_HZ;
use embedded_hal::digital::OutputPin;
use trirrr_protocol::message::State;

/// Ticks of a half period: 1 Hz in motion, 4 Hz in a fault. A machine of few ticks blinks as fast as it can.
const SLOW: u32 = half_period(1.0);
const FAST: u32 = half_period(4.0);

const fn half_period(hz: f64) -> u32 {
    let ticks = (TICK_RATE_HZ / (2.0 * hz)) as u32;
    match ticks {
        0 => 1,
        ticks => ticks,
    }
}

/// Pin of a lamp, which is high while the lamp is on.
pub struct LampPin<P> {
    pin: P,
    is_on: bool,
    /// Ticks since the lamp has changed.
    ticks: u32,
}

impl<P: OutputPin> LampPin<P> {
    /// Switches the lamp off.
    pub fn new(mut pin: P) -> Self {
        // A pin of the chip itself does not fail.
        let _ = pin.set_low();
        Self {
            pin,
            is_on: false,
            ticks: 0,
        }
    }

    /// Returns true if the lamp is on in this tick.
    #[inline(always)]
    fn is_lit(&mut self, state: State) -> bool {
        let half = match state {
            State::Disabled => return false,
            State::Idle | State::Cleared | State::Unhomed | State::Enabling | State::Disabling => {
                return true;
            }
            State::Fault | State::Reacting => FAST,
            State::Running
            | State::Slowing
            | State::Holding
            | State::Stopping
            | State::Recovering
            | State::Homing => SLOW,
        };
        self.ticks += 1;
        match self.ticks < half {
            true => self.is_on,
            false => !self.is_on,
        }
    }
}

impl<P: OutputPin> OutputPart for LampPin<P> {
    #[inline]
    fn show(&mut self, state: State) {
        let is_lit = self.is_lit(state);
        if is_lit == self.is_on {
            return;
        }
        (self.is_on, self.ticks) = (is_lit, 0);
        let _ = self.pin.set_state(is_lit.into());
    }
}
