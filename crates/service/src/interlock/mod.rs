//! Interlocks: inputs by which a person or a contact stops the machine.
//!
//! | input | active | the tick |
//! |---|---|---|
//! | emergency stop | pressed, or the wire is broken | latches a fault with the stop category of the scene. `ClearFault` is taken once the stop is released |
//! | door | open | tool off at once, feed hold; other motion is given up. Nothing starts or goes on before the door is closed and the host commands it |
//! | limit switch of a motor | the motor has reached it, or the wire is broken | latches a fault with the motor's number, once; not in homing. `Recover` and `Home` lead off it, no job starts on it |
//! | probe | touches | in a run with the probe: keeps tick and pose, tool off, comes to rest on the path and drops the job |

mod debounce;
mod limits;
mod probe;

use crate::feature::Feature;
use crate::settings::StopCategory;
use core::marker::PhantomData;
use trirrr_core::to_source;
use trirrr_protocol::message::{InputState, InputStates};

pub(crate) use debounce::{DebouncedInput, StopContact};
use limits::LimitSwitches;
pub(crate) use probe::{LatchedContact, LatchedRun, ProbeLatch};

/// Settings of the interlocks. `None`: the scene names no such input.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct InterlockParameters {
    /// Emergency stop.
    pub emergency_stop: Option<EmergencyStop>,
    /// Door.
    pub door: Option<Door>,
    /// Probe.
    pub probe: Option<ProbeInput>,
    /// Limit switches of the motors.
    pub limits: Option<LimitInputs>,
}

/// Settings of an emergency stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EmergencyStop {
    /// Ticks of a change without bounces, that in which it counts included; at least 1.
    pub debounce_ticks: u16,
    /// [`StopCategory::Off`] or [`StopCategory::StopThenOff`].
    pub category: StopCategory,
}

/// Settings of a door.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Door {
    /// Ticks of a change without bounces, that in which it counts included; at least 1.
    pub debounce_ticks: u16,
}

/// Settings of a probe.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ProbeInput {
    /// Ticks of a change without bounces until it is told; at least 1. A run ends in the first of them.
    pub debounce_ticks: u16,
}

/// Settings of the limit switches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LimitInputs {
    /// Ticks of a change without bounces, that in which it counts included; at least 1.
    pub debounce_ticks: u16,
}

/// Settings of the button of a machine without a host.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ButtonInput {
    /// Ticks of a change without bounces, that in which it counts included; at least 1.
    pub debounce_ticks: u16,
}

to_source!(pub [] ButtonInput [] in trirrr_service::features { debounce_ticks });

to_source!(pub [] EmergencyStop [] in trirrr_service::features {
    debounce_ticks,
    category,
});

to_source!(pub [] Door [] in trirrr_service::features { debounce_ticks });

to_source!(pub [] ProbeInput [] in trirrr_service::features { debounce_ticks });

to_source!(pub [] LimitInputs [] in trirrr_service::features { debounce_ticks });

to_source!(pub [] InterlockParameters [] in trirrr_service::features {
    emergency_stop,
    door,
    probe,
    limits,
});

/// Readings of the contacts in a tick, bounces and all: true where the input is active.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct InterlockReadings {
    /// The emergency stop is pressed.
    pub emergency_stop: bool,
    /// The door is open.
    pub door: bool,
    /// The probe touches.
    pub probe: bool,
    /// The motor has reached its limit switch.
    pub limits: [bool; 3],
    /// The button of a machine without a host is pressed.
    pub button: bool,
}

/// Bits of the inputs for which the interlocks of a scene have code. That for the others is left out.
pub mod input_bits {
    /// Emergency stop.
    pub const STOP: u8 = 1;
    /// Door.
    pub const DOOR: u8 = 2;
    /// Limit switches.
    pub const LIMITS: u8 = 4;
    /// All of them.
    pub const ALL: u8 = STOP | DOOR | LIMITS;
}

/// Interlocks of a scene with the [inputs](input_bits) that the feature `F` has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Interlocks<F> {
    stop: StopContact,
    category: StopCategory,
    /// A fault was latched since the stop was acknowledged.
    is_latched: bool,
    has_stop: bool,
    door: StopContact,
    has_door: bool,
    limits: LimitSwitches,
    has_limits: bool,
    inputs: PhantomData<F>,
}

impl InterlockParameters {
    /// Ticks in which contacts that are active from the start on have become so.
    pub(crate) fn settling_ticks(&self) -> u16 {
        let each = [
            self.emergency_stop.map(|stop| stop.debounce_ticks),
            self.door.map(|door| door.debounce_ticks),
            self.limits.map(|limits| limits.debounce_ticks),
        ];
        each.into_iter().flatten().max().unwrap_or(0)
    }
}

impl<F: Feature> Interlocks<F> {
    const STOP: bool = F::BITS & input_bits::STOP != 0;
    const DOOR: bool = F::BITS & input_bits::DOOR != 0;
    const LIMITS: bool = F::BITS & input_bits::LIMITS != 0;

    /// Interlocks that are clear, until the contacts tell something else.
    pub(crate) fn new(parameters: &InterlockParameters) -> Self {
        let stop = parameters.emergency_stop;
        Self {
            stop: StopContact::new(stop.map_or(1, |stop| stop.debounce_ticks)),
            category: stop.map_or(StopCategory::Off, |stop| stop.category),
            is_latched: false,
            has_stop: Self::STOP && stop.is_some(),
            door: StopContact::new(parameters.door.map_or(1, |door| door.debounce_ticks)),
            has_door: Self::DOOR && parameters.door.is_some(),
            limits: LimitSwitches::new(parameters.limits.map_or(1, |each| each.debounce_ticks)),
            has_limits: Self::LIMITS && parameters.limits.is_some(),
            inputs: PhantomData,
        }
    }

    /// Returns true if a fault was latched for the emergency stop, and not acknowledged.
    #[cfg(test)]
    pub(crate) fn is_latched(&self) -> bool {
        self.is_latched
    }

    /// Takes what the contacts tell, before the tick. Returns true if an input changed.
    #[inline]
    pub(crate) fn sense(&mut self, readings: InterlockReadings) -> bool {
        // All are read in each tick: no shortcut.
        let stop = Self::STOP && self.has_stop && self.stop.read(readings.emergency_stop);
        let door = Self::DOOR && self.has_door && self.door.read(readings.door);
        let limits = Self::LIMITS && self.has_limits && self.limits.read(readings.limits);
        stop | door | limits
    }

    /// Returns true while the emergency stop is pressed.
    #[inline(always)]
    pub(crate) fn is_pressed(&self) -> bool {
        Self::STOP && self.stop.is_active()
    }

    /// Returns true if the emergency stop is pressed and no fault was latched for it since it was acknowledged. One is latched now.
    #[inline]
    pub(crate) fn take_stop(&mut self) -> bool {
        let is_new = self.is_pressed() && !self.is_latched;
        self.is_latched |= is_new;
        is_new
    }

    /// A person has acknowledged: the next time that the stop is pressed is a fault again.
    #[inline(always)]
    pub(crate) fn acknowledge(&mut self) {
        self.is_latched = false;
    }

    /// Returns true while the door is open.
    #[inline(always)]
    pub(crate) fn is_open(&self) -> bool {
        Self::DOOR && self.door.is_active()
    }

    /// Returns the motor that has come onto its limit switch. Where switches are not `watched`, those that motors stand on count as known.
    #[inline(always)]
    pub(crate) fn take_limit(&mut self, watched: bool) -> Option<u8> {
        match Self::LIMITS {
            true => self.limits.take_new(watched),
            false => None,
        }
    }

    /// Returns true while a motor stands on its limit switch.
    #[inline(always)]
    pub(crate) fn is_at_limit(&self) -> bool {
        Self::LIMITS && self.limits.states() != [false; 3]
    }

    /// Returns the stop category of the emergency stop.
    #[inline(always)]
    pub(crate) fn category(&self) -> StopCategory {
        self.category
    }

    /// Returns the states of the inputs, with that of the probe.
    pub(crate) fn states(&self, probe: InputState) -> InputStates {
        let state = |has: bool, is_active: bool| match has {
            true => InputState::of(is_active),
            false => InputState::Absent,
        };
        InputStates {
            emergency_stop: state(self.has_stop, self.stop.is_active()),
            door: state(self.has_door, self.door.is_active()),
            probe,
            limits: match Self::LIMITS {
                true => self
                    .limits
                    .states()
                    .map(|each| state(self.has_limits, each)),
                false => [InputState::Absent; 3],
            },
        }
    }
}
