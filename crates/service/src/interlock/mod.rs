//! Interlocks: inputs by which a person stops the machine, an emergency stop and a door.
//!
//! | input | active | the tick |
//! |---|---|---|
//! | emergency stop | pressed, or the wire is broken | latches a fault with the stop category of the scene. `ClearFault` is taken once the stop is released |
//! | door | open | tool off at once, feed hold; other motion is given up. Nothing starts or goes on before the door is closed and the host commands it |
//!
//! The choice is a type, as that of [homing](super::homing) is: without interlocks an image holds nothing of them.

mod debounce;

use crate::settings::StopCategory;
use crate::splice::{Optional, Present};
use core::fmt::Debug;
use trirrr_core::to_source;
use trirrr_protocol::message::{InputState, InputStates};

use debounce::DebouncedInput;

/// Interlocks of a scene; `()` without any.
pub trait InterlockKind: Send {
    /// True for a scene with any.
    const EXIST: bool;

    /// Readings of the contacts in a tick.
    type Readings: Copy + Default;
    /// Report of the tick about them.
    type Report: Optional<InputStates> + Copy + Debug + PartialEq;

    /// Takes what the contacts tell, before the tick. Returns true if an input changed.
    fn sense(&mut self, readings: Self::Readings) -> bool;

    /// Returns true while the emergency stop is pressed.
    fn is_pressed(&self) -> bool;

    /// Returns true if the emergency stop is pressed and no fault was latched for it since it was acknowledged. One is latched now.
    fn take_stop(&mut self) -> bool;

    /// A person has acknowledged: the next time that the stop is pressed is a fault again.
    fn acknowledge(&mut self);

    /// Returns true while the door is open.
    fn is_open(&self) -> bool;

    /// Returns the stop category of the emergency stop.
    fn category(&self) -> StopCategory;

    /// Returns the report of the tick.
    fn report(&self) -> Self::Report;

    /// Returns the states of the inputs.
    fn states(&self) -> InputStates;
}

impl InterlockKind for () {
    const EXIST: bool = false;
    type Readings = ();
    type Report = ();

    #[inline(always)]
    fn sense(&mut self, (): ()) -> bool {
        false
    }

    #[inline(always)]
    fn is_pressed(&self) -> bool {
        false
    }

    #[inline(always)]
    fn take_stop(&mut self) -> bool {
        false
    }

    #[inline(always)]
    fn acknowledge(&mut self) {}

    #[inline(always)]
    fn is_open(&self) -> bool {
        false
    }

    #[inline(always)]
    fn category(&self) -> StopCategory {
        StopCategory::Off
    }

    #[inline(always)]
    fn report(&self) {}

    #[inline(always)]
    fn states(&self) -> InputStates {
        InputStates::ABSENT
    }
}

/// Settings of the interlocks. `None`: the scene names no such input.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct InterlockParameters {
    /// Emergency stop.
    pub emergency_stop: Option<EmergencyStop>,
    /// Door.
    pub door: Option<Door>,
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

to_source!(pub [] EmergencyStop [] in trirrr_service {
    debounce_ticks,
    category,
});

to_source!(pub [] Door [] in trirrr_service { debounce_ticks });

to_source!(pub [] InterlockParameters [] in trirrr_service {
    emergency_stop,
    door,
});

/// Readings of the contacts in a tick, bounces and all: true where the machine must not move.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct InterlockReadings {
    /// The emergency stop is pressed.
    pub emergency_stop: bool,
    /// The door is open.
    pub door: bool,
}

/// Interlocks of a scene with an emergency stop (`STOP`), a door (`DOOR`), or both. Code for the other is left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Interlocks<const STOP: bool, const DOOR: bool> {
    stop: DebouncedInput,
    category: StopCategory,
    /// A fault was latched since the stop was acknowledged.
    is_latched: bool,
    has_stop: bool,
    door: DebouncedInput,
    has_door: bool,
}

impl<const STOP: bool, const DOOR: bool> Interlocks<STOP, DOOR> {
    /// Interlocks that are clear, until the contacts tell something else.
    pub fn new(parameters: &InterlockParameters) -> Self {
        let stop = parameters.emergency_stop;
        Self {
            stop: DebouncedInput::new(stop.map_or(1, |stop| stop.debounce_ticks)),
            category: stop.map_or(StopCategory::Off, |stop| stop.category),
            is_latched: false,
            has_stop: STOP && stop.is_some(),
            door: DebouncedInput::new(parameters.door.map_or(1, |door| door.debounce_ticks)),
            has_door: DOOR && parameters.door.is_some(),
        }
    }

    /// Returns true if a fault was latched for the emergency stop, and not acknowledged.
    #[cfg(test)]
    pub(crate) fn is_latched(&self) -> bool {
        self.is_latched
    }
}

impl<const STOP: bool, const DOOR: bool> InterlockKind for Interlocks<STOP, DOOR> {
    const EXIST: bool = true;
    type Readings = InterlockReadings;
    type Report = Present<InputStates>;

    #[inline]
    fn sense(&mut self, readings: InterlockReadings) -> bool {
        // Both are read in each tick: no shortcut.
        let stop = STOP && self.has_stop && self.stop.read(readings.emergency_stop);
        let door = DOOR && self.has_door && self.door.read(readings.door);
        stop | door
    }

    #[inline(always)]
    fn is_pressed(&self) -> bool {
        STOP && self.stop.is_active()
    }

    #[inline]
    fn take_stop(&mut self) -> bool {
        let is_new = self.is_pressed() && !self.is_latched;
        self.is_latched |= is_new;
        is_new
    }

    #[inline(always)]
    fn acknowledge(&mut self) {
        self.is_latched = false;
    }

    #[inline(always)]
    fn is_open(&self) -> bool {
        DOOR && self.door.is_active()
    }

    #[inline(always)]
    fn category(&self) -> StopCategory {
        self.category
    }

    #[inline]
    fn report(&self) -> Present<InputStates> {
        Present(self.states())
    }

    fn states(&self) -> InputStates {
        let state = |has: bool, input: &DebouncedInput| match has {
            true => InputState::of(input.is_active()),
            false => InputState::Absent,
        };
        InputStates {
            emergency_stop: state(self.has_stop, &self.stop),
            door: state(self.has_door, &self.door),
        }
    }
}

/// Content of what the contacts of scene `S` tell in a tick.
pub type InterlockReadingsOf<S> =
    <<S as crate::scene::Scene>::Interlocks as InterlockKind>::Readings;

/// Report of the tick about the interlocks of scene `S`.
pub(crate) type InterlockReportOf<S> =
    <<S as crate::scene::Scene>::Interlocks as InterlockKind>::Report;
