//! One drive of the bus, as it was heard last.

use super::Say;
use super::heard::{Heard, Told};
use super::rotor::{JointPlace, Rotor, RotorCommand, RotorScale};
use crate::count::Countable;
use trirrr_core::tick::Motor;
use trirrr_protocol::message::{DriveReading, DriveState};

/// Ticks in which a drive is told to stop before its own word counts: what it said before it was told is read by then.
const STOPS_AT_LEAST: u8 = 3;

/// Ticks without a position in which a drive that answers each frame is still taken to be the one that was switched on.
const MISSED_ANSWERS: u16 = 3;

/// Drive with its rotor, and what it has said.
#[derive(Debug)]
pub(super) struct Listener<N: Countable> {
    node: u8,
    rotor: Rotor<N>,
    reading: DriveReading<N>,
    measured: Option<JointPlace<N>>,
    /// Ticks since the last frame with a state, and with a position.
    ages: [u16; 2],
    /// The drive may be on and is to be off: ticks in which it was told so.
    stopping: Option<u8>,
    /// Its errors are to be cleared once it is off.
    clears: bool,
}

impl<N: Countable> Listener<N> {
    /// Drive `node` of a joint near `angle`, not heard yet.
    pub(super) fn new(node: u8, scale: RotorScale, angle: N::Angle) -> Self {
        Self {
            node,
            rotor: Rotor::new(scale, angle),
            reading: DriveReading::unheard(angle),
            measured: None,
            ages: [u16::MAX; 2],
            stopping: None,
            clears: false,
        }
    }

    #[inline(always)]
    pub(super) fn node(&self) -> u8 {
        self.node
    }

    /// Returns true once a position was heard.
    #[inline(always)]
    pub(super) fn is_known(&self) -> bool {
        self.rotor.is_known()
    }

    /// Returns true if a drive that answers each frame has answered lately.
    #[inline(always)]
    pub(super) fn answers(&self) -> bool {
        let [_, position_age] = self.ages;
        position_age <= MISSED_ANSWERS
    }

    /// Lets a tick go by.
    #[inline(always)]
    pub(super) fn begin_tick(&mut self) {
        for age in &mut self.ages {
            *age = age.saturating_add(1);
        }
    }

    /// Takes a frame. A drive without a state of its own is on if it `is_on`, as it was told.
    pub(super) fn hear(&mut self, heard: &Heard, is_on: bool) {
        let [state_age, position_age] = &mut self.ages;
        if let Some(told) = heard.state {
            *state_age = 0;
            self.reading.state = match told {
                Told::State(state) => state,
                Told::Obeys if is_on => DriveState::On,
                Told::Obeys => DriveState::Off,
            };
        }
        if let Some(position) = heard.position {
            let age = core::mem::take(position_age);
            let (measured, restarts) = self.rotor.measure(position, age);
            let restarts = self.reading.restarts.wrapping_add(restarts.into());
            self.reading.restarts = restarts;
            self.reading.angle = measured.angle;
            self.measured = Some(measured);
        }
        let [rate, torque] = self.rotor.motion(heard);
        let reading = &mut self.reading;
        reading.rate = rate.unwrap_or(reading.rate);
        reading.torque = torque.unwrap_or(reading.torque);
        reading.error = heard.error.unwrap_or(reading.error);
        // Casts cut, and saturate.
        if let Some(celsius) = heard.temperature {
            reading.temperature_c = celsius as i32;
        }
        if let Some(volts) = heard.supply {
            reading.supply_mv = (volts * 1000.0) as u32;
        }
    }

    /// Reading of this tick. A drive is silent until it has told both its state and its position.
    #[inline(always)]
    pub(super) fn reading(&self) -> DriveReading<N> {
        let [state_age, age] = self.ages;
        let state = match (age.max(state_age), self.reading.error, self.reading.state) {
            (u16::MAX, _, _) => DriveState::Silent,
            (_, 0, state) | (_, _, state @ DriveState::Uncalibrated) => state,
            _ => DriveState::Fault,
        };
        DriveReading {
            state,
            age,
            state_age,
            ..self.reading
        }
    }

    /// Returns true if `motor` is told to be where the joint is, but for a 256th of a turn: a drive goes on where it
    /// stands.
    pub(super) fn stands_at(&self, motor: &Motor<N>) -> bool {
        let off = N::turn(motor.angle).wrapping_sub(N::turn(self.reading.angle));
        (off as i32).unsigned_abs() <= 1 << 24
    }

    /// Command of the tick. Errors are not cleared any more.
    #[inline(always)]
    pub(super) fn command(&mut self, motor: &Motor<N>) -> RotorCommand {
        self.clears = false;
        self.rotor.command(motor)
    }

    /// From now on the drive is told to stop until it says that it has.
    pub(super) fn must_stop(&mut self) {
        self.stopping = Some(0);
    }

    /// Order of a tick in which the drive is to be off, and its errors cleared from now on if `clear` says so. The next
    /// command starts where the joint is.
    pub(super) fn order_off(&mut self, clear: bool, tick: u8) -> Say {
        if let Some(measured) = &self.measured {
            self.rotor.stand(measured);
        }
        self.clears |= clear;
        let is_on = self.reading.state == DriveState::On;
        let is_ready = is_on || self.reading.state == DriveState::Preparing;
        let [state_age, _] = self.ages;
        self.stopping = match self.stopping {
            Some(ticks) if ticks < STOPS_AT_LEAST => Some(ticks + 1),
            // It has said nothing new, or not that it is off.
            Some(ticks) if is_ready || state_age >= STOPS_AT_LEAST.into() => Some(ticks),
            _ => None,
        };
        match (is_on || self.stopping.is_some(), self.clears) {
            (true, _) => Say::Off,
            (false, true) => Say::Clear,
            (false, false) => Say::Ask(tick),
        }
    }

    /// Takes note that the order to clear errors has gone out.
    pub(super) fn cleared(&mut self) {
        self.clears = false;
    }

    /// Follows a new zero of the joint angle, greater `by` so much.
    pub(super) fn shift(&mut self, by: N::Angle) {
        self.rotor.shift(by);
        self.measured = None;
        let turn = N::turn(self.reading.angle).wrapping_add(N::turn(by));
        self.reading.angle = N::angle_of(turn);
    }
}
