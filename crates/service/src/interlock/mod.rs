//! Interlocks: inputs by which a person or a contact stops the machine.
//!
//! | input | active | the tick |
//! |---|---|---|
//! | emergency stop | pressed, or the wire is broken | latches a fault with the stop category of the scene. `ClearFault` is taken once the stop is released |
//! | door | open | tool off at once, feed hold; other motion is given up. Nothing starts or goes on before the door is closed and the host commands it |
//! | limit switch of a motor | the motor has reached it, or the wire is broken | latches a fault with the motor's number, once; not in homing. `Recover` and `Home` lead off it, no job starts on it |
//! | probe | touches | in a run with the probe: keeps tick and pose, tool off, comes to rest on the path and drops the job |
//!
//! The choice is a type, as that of [homing](super::homing) is: without interlocks an image holds nothing of them.

mod debounce;
mod limits;
mod probe;

use crate::settings::StopCategory;
use crate::splice::{Optional, Present};
use core::fmt::Debug;
use core::marker::PhantomData;
use trirrr_core::number::Number;
use trirrr_core::to_source;
use trirrr_protocol::message::{InputState, InputStates};

pub(crate) use debounce::{DebouncedInput, StopContact};
use limits::LimitSwitches;
pub(crate) use probe::{LatchedContact, LatchedRun};
pub use probe::{ProbeLatch, ProbeMemory};

/// Interlocks of a scene; `()` without any.
pub trait InterlockKind<N: Number>: Send {
    /// True for a scene with any.
    const EXIST: bool;

    /// Readings of the contacts in a tick.
    type Readings: Copy + Default;
    /// Memory of a probe; `()` without any.
    type Probe: ProbeMemory<N>;
    /// Report of the tick about them.
    type Report: Optional<InterlockReport<Self::Probe>> + Copy + Debug + PartialEq;

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

    /// Returns the motor that has come onto its limit switch. Where switches are not `watched`, those that motors stand on count as known.
    fn take_limit(&mut self, watched: bool) -> Option<u8>;

    /// Returns true while a motor stands on its limit switch.
    fn is_at_limit(&self) -> bool;

    /// Returns the probe; `None` without any.
    fn probe(&mut self) -> Option<&mut ProbeLatch<N>>;

    /// Returns the stop category of the emergency stop.
    fn category(&self) -> StopCategory;

    /// Returns the report of the tick.
    fn report(&self) -> Self::Report;

    /// Returns the states of the inputs.
    fn states(&self) -> InputStates;
}

/// Report of the tick about the interlocks, with a probe of the kind `P`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InterlockReport<P> {
    pub(crate) states: InputStates,
    pub(crate) probe: P,
}

impl<N: Number> InterlockKind<N> for () {
    const EXIST: bool = false;
    type Readings = ();
    type Probe = ();
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
    fn take_limit(&mut self, _: bool) -> Option<u8> {
        None
    }

    #[inline(always)]
    fn is_at_limit(&self) -> bool {
        false
    }

    #[inline(always)]
    fn probe(&mut self) -> Option<&mut ProbeLatch<N>> {
        None
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

to_source!(pub [] EmergencyStop [] in trirrr_service {
    debounce_ticks,
    category,
});

to_source!(pub [] Door [] in trirrr_service { debounce_ticks });

to_source!(pub [] ProbeInput [] in trirrr_service { debounce_ticks });

to_source!(pub [] LimitInputs [] in trirrr_service { debounce_ticks });

to_source!(pub [] InterlockParameters [] in trirrr_service {
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
}

/// Bits of the inputs for which [`Interlocks`] have code. That for the others is left out.
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

/// Interlocks of a scene with the [inputs](input_bits) `INPUTS`, and with a probe `P`, a [`ProbeLatch`] or `()`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interlocks<N: Number, const INPUTS: u8, P> {
    stop: StopContact,
    category: StopCategory,
    /// A fault was latched since the stop was acknowledged.
    is_latched: bool,
    has_stop: bool,
    door: StopContact,
    has_door: bool,
    limits: LimitSwitches,
    has_limits: bool,
    probe: P,
    number: PhantomData<N>,
}

impl<N: Number, const INPUTS: u8, P: ProbeMemory<N>> Interlocks<N, INPUTS, P> {
    const STOP: bool = INPUTS & input_bits::STOP != 0;
    const DOOR: bool = INPUTS & input_bits::DOOR != 0;
    const LIMITS: bool = INPUTS & input_bits::LIMITS != 0;

    /// Interlocks that are clear, until the contacts tell something else.
    pub fn new(parameters: &InterlockParameters) -> Self {
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
            probe: P::new(parameters.probe.map(|probe| probe.debounce_ticks)),
            number: PhantomData,
        }
    }

    /// Returns true if a fault was latched for the emergency stop, and not acknowledged.
    #[cfg(test)]
    pub(crate) fn is_latched(&self) -> bool {
        self.is_latched
    }
}

impl<N: Number, const INPUTS: u8, P: ProbeMemory<N>> InterlockKind<N> for Interlocks<N, INPUTS, P> {
    const EXIST: bool = true;
    type Readings = InterlockReadings;
    type Probe = P;
    type Report = Present<InterlockReport<P>>;

    #[inline]
    fn sense(&mut self, readings: InterlockReadings) -> bool {
        // All are read in each tick: no shortcut.
        let stop = Self::STOP && self.has_stop && self.stop.read(readings.emergency_stop);
        let door = Self::DOOR && self.has_door && self.door.read(readings.door);
        let limits = Self::LIMITS && self.has_limits && self.limits.read(readings.limits);
        let probe = match self.probe.get_mut() {
            Some(probe) => probe.read(readings.probe),
            None => false,
        };
        stop | door | limits | probe
    }

    #[inline(always)]
    fn is_pressed(&self) -> bool {
        Self::STOP && self.stop.is_active()
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
        Self::DOOR && self.door.is_active()
    }

    #[inline(always)]
    fn take_limit(&mut self, watched: bool) -> Option<u8> {
        match Self::LIMITS {
            true => self.limits.take_new(watched),
            false => None,
        }
    }

    #[inline(always)]
    fn is_at_limit(&self) -> bool {
        Self::LIMITS && self.limits.states() != [false; 3]
    }

    #[inline(always)]
    fn probe(&mut self) -> Option<&mut ProbeLatch<N>> {
        self.probe.get_mut()
    }

    #[inline(always)]
    fn category(&self) -> StopCategory {
        self.category
    }

    #[inline]
    fn report(&self) -> Self::Report {
        Present(InterlockReport {
            states: self.states(),
            probe: self.probe,
        })
    }

    fn states(&self) -> InputStates {
        let state = |has: bool, is_active: bool| match has {
            true => InputState::of(is_active),
            false => InputState::Absent,
        };
        InputStates {
            emergency_stop: state(self.has_stop, self.stop.is_active()),
            door: state(self.has_door, self.door.is_active()),
            probe: match self.probe.get() {
                Some(probe) => state(probe.exists(), probe.is_active()),
                None => InputState::Absent,
            },
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

/// Content of what the contacts of scene `S` tell in a tick.
pub type InterlockReadingsOf<S> = <<S as crate::scene::Scene>::Interlocks as InterlockKind<
    <S as crate::scene::Scene>::N,
>>::Readings;

/// Report of the tick about the interlocks of scene `S`.
pub(crate) type InterlockReportOf<S> = <<S as crate::scene::Scene>::Interlocks as InterlockKind<
    <S as crate::scene::Scene>::N,
>>::Report;
