//! Half above the tick: from positions to pulses.

use super::line::Line;
use super::schedule::{FRACTION_BITS, MICROSTEP, Schedule, Walk};
use crate::Enable;
use embedded_hal::digital::{ErrorType, OutputPin};

/// Pins of one driver.
#[derive(Debug)]
pub struct Axis<S, D> {
    step: S,
    direction: D,
    reversed: bool,
    /// The direction pin has the level for fewer microsteps.
    backward: bool,
    /// The step pin is high.
    high: bool,
    /// Microsteps given so far.
    position: i32,
    /// Position of the last tick, in units of [`MICROSTEP`]: the next line begins here.
    reached: i32,
    walk: Walk,
}

/// Farthest that the motor may be off the begin of a line whose pulses come where they belong: half a microstep, and one pulse
/// that the last tick had no slot for.
const MOST_BEHIND: u32 = (MICROSTEP + MICROSTEP / 2) as u32;

impl<S: OutputPin, D: OutputPin<Error = S::Error>> Axis<S, D> {
    /// Takes the pins: step low, direction forward, which is high unless `reversed`.
    ///
    /// # Errors
    /// A pin's.
    pub fn new(step: S, direction: D, reversed: bool) -> Result<Self, S::Error> {
        let mut axis = Self {
            step,
            direction,
            reversed,
            backward: true,
            high: true,
            position: 0,
            reached: 0,
            walk: Walk::REST,
        };
        axis.fall()?;
        axis.turn(false)?;
        Ok(axis)
    }

    /// Ends a pulse. Returns `true` if there was one.
    #[inline(always)]
    fn fall(&mut self) -> Result<bool, S::Error> {
        let high = self.high;
        if high {
            self.step.set_low()?;
            self.high = false;
        }
        Ok(high)
    }

    /// Sets the direction. Returns `true` if that was a change.
    #[inline(always)]
    fn turn(&mut self, backward: bool) -> Result<bool, S::Error> {
        if backward == self.backward {
            return Ok(false);
        }
        match backward == self.reversed {
            true => self.direction.set_high()?,
            false => self.direction.set_low()?,
        }
        self.backward = backward;
        Ok(true)
    }

    /// Sets out for `to`, in units of [`MICROSTEP`], within `slots` slots. Returns `true` if the direction changes.
    #[inline(always)]
    fn set_out(&mut self, to: i32, slots: u32) -> Result<bool, S::Error> {
        let given = self.position << FRACTION_BITS;
        let steps = to.wrapping_sub(given).wrapping_add(MICROSTEP / 2) >> FRACTION_BITS;
        let mut from = self.reached;
        self.reached = to;
        if steps == 0 {
            self.walk = Walk::REST;
            return Ok(false);
        }
        // Pulses are missing, or the last one came late and the line turns back: the way is spread anew from the motor's place.
        if from.wrapping_sub(given).unsigned_abs() > MOST_BEHIND
            || (to.wrapping_sub(from) < 0) != (steps < 0)
        {
            from = given;
        }
        self.walk = Walk::new(steps, given, Schedule::new(from, to, slots));
        self.turn(steps < 0)
    }

    /// Begins a pulse if one is due and `may` begin.
    #[inline(always)]
    fn rise(&mut self, may: bool) -> Result<(), S::Error> {
        if self.walk.step(may) {
            self.step.set_high()?;
            self.high = true;
            let step = if self.backward { -1 } else { 1 };
            self.position = self.position.wrapping_add(step);
        }
        Ok(())
    }
}

/// Three drivers and their enable line, as the slots see them.
#[derive(Debug)]
pub struct Slots<'l, S, D, E> {
    line: &'l Line,
    axes: [Axis<S, D>; 3],
    enable: Enable<E>,
    per_tick: u32,
    seen: u32,
}

impl<'l, S, D, E> Slots<'l, S, D, E>
where
    S: OutputPin,
    D: OutputPin<Error = S::Error>,
    E: OutputPin<Error = S::Error>,
{
    /// Drivers with `per_tick` slots in each tick, [`slots_per_tick`](super::slots_per_tick).
    pub fn new(line: &'l Line, axes: [Axis<S, D>; 3], enable: Enable<E>, per_tick: u32) -> Self {
        Self {
            line,
            axes,
            enable,
            per_tick,
            seen: line.round(),
        }
    }

    /// Microsteps that each motor was given since the start, modulo 2^32.
    pub fn positions(&self) -> [i32; 3] {
        self.axes.each_ref().map(|axis| axis.position)
    }

    /// Runs one slot.
    ///
    /// # Errors
    /// Those of a pin. Pins that are registers have none.
    #[inline]
    pub fn slot(&mut self) -> Result<(), <S as ErrorType>::Error> {
        let on = self.line.is_on();
        let mut may = [!self.enable.switch(on)?; 3];
        for (axis, may) in self.axes.iter_mut().zip(&mut may) {
            *may &= !axis.fall()?;
        }
        if !on {
            return Ok(());
        }
        let round = self.line.round();
        if round != self.seen {
            self.seen = round;
            let positions = self.line.positions();
            for ((axis, position), may) in self.axes.iter_mut().zip(positions).zip(&mut may) {
                *may &= !axis.set_out(position, self.per_tick)?;
            }
        }
        for (axis, may) in self.axes.iter_mut().zip(may) {
            axis.rise(may)?;
        }
        Ok(())
    }
}
