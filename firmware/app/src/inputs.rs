//! From the machine to the tick: homing switches, or drives that report a stall; emergency stop, door, probe and limit switches.

use crate::scene::Scalar;
use crate::service::ImageScene;
#[cfg(interlocks)]
use core::convert::Infallible;
#[cfg(interlocks)]
use core::marker::PhantomData;
#[cfg(interlocks)]
use embedded_hal::digital::InputPin;
use trirrr_core::number::Arithmetic;
use trirrr_core::tick::Motor;
use trirrr_service::{Homing, Scene};

/// Joint angle in the scene's number type.
pub type Angle = <Scalar as Arithmetic>::Angle;

/// One flag for each motor, set while the switch is closed or the drive stalls; `()` without homing.
pub type Closed = <<ImageScene as Scene>::Homing as Homing<Scalar>>::Inputs;

/// Readings of the contacts of the interlocks; `()` without any.
pub type Interlocked = trirrr_service::InterlockReadingsOf<ImageScene>;

/// Source of a tick's inputs.
pub trait Inputs {
    /// Reads all inputs. `motors` were commanded in the tick before: pins ignore them, simulated switches
    /// close by them.
    fn read(&mut self, motors: &[Motor<Scalar>; 3]) -> Closed;

    /// Reads the contacts of the interlocks; `()` in a scene without any.
    #[inline(always)]
    fn interlocks(&mut self) -> Interlocked {
        Default::default()
    }

    /// Reads the spare inputs: a bit for each, set while it is active.
    #[cfg(digital)]
    #[inline(always)]
    fn digital(&mut self) -> u8 {
        0
    }

    /// Follows a new zero of the joint angles: all are greater `by` so much from now on, without a motion.
    /// Only simulated switches have to know.
    #[inline(always)]
    fn shift(&mut self, by: [Angle; 3]) {
        let _ = by;
    }
}

/// Inputs of a scene without homing.
#[cfg(not(homing))]
pub struct NoInputs;

#[cfg(not(homing))]
impl Inputs for NoInputs {
    #[inline(always)]
    fn read(&mut self, _: &[Motor<Scalar>; 3]) -> Closed {}
}

/// A contact to ground at an input that is pulled up.
#[cfg(interlocks)]
pub trait InterlockInput {
    /// Returns true if the input is active.
    fn is_active(&mut self) -> bool;
}

/// Pin that the scene does not name: it is left alone.
#[cfg(interlocks)]
pub struct NoInterlockPin<P>(PhantomData<P>);

#[cfg(interlocks)]
impl<P> NoInterlockPin<P> {
    /// Leaves the pin as it is: nothing pulls it up.
    pub fn at(_: impl FnOnce() -> P) -> Self {
        Self(PhantomData)
    }
}

#[cfg(interlocks)]
impl<P> InterlockInput for NoInterlockPin<P> {
    #[inline(always)]
    fn is_active(&mut self) -> bool {
        false
    }
}

/// Contact at a pin. `HIGH`: the input is active while the pin is high, which it is where the wire breaks.
#[cfg(interlocks)]
pub struct InterlockPin<P, const HIGH: bool>(P);

#[cfg(interlocks)]
impl<P, const HIGH: bool> InterlockPin<P, HIGH> {
    /// Contact at the pin that `pull_up` makes an input.
    pub fn at(pull_up: impl FnOnce() -> P) -> Self {
        Self(pull_up())
    }
}

#[cfg(interlocks)]
impl<P: InputPin<Error = Infallible>, const HIGH: bool> InterlockInput for InterlockPin<P, HIGH> {
    #[inline(always)]
    fn is_active(&mut self) -> bool {
        let Ok(is_high) = self.0.is_high();
        is_high == HIGH
    }
}

/// The emergency stop at the pin `P`, if the scene names one.
#[cfg(estop)]
pub type StopLine<P> = InterlockPin<P, true>;
/// The scene names no emergency stop.
#[cfg(all(interlocks, not(estop)))]
pub type StopLine<P> = NoInterlockPin<P>;

/// The door at the pin `P`, if the scene names one.
#[cfg(door)]
pub type DoorLine<P> = InterlockPin<P, { crate::scene::DOOR_OPEN_HIGH }>;
/// The scene names no door.
#[cfg(all(interlocks, not(door)))]
pub type DoorLine<P> = NoInterlockPin<P>;

/// Inputs beside the contacts of emergency stop and door.
#[cfg(interlocks)]
pub struct WithInterlockPins<I, S, D> {
    /// Everything else.
    pub inputs: I,
    /// Contact of the emergency stop.
    pub stop: S,
    /// Contact of the door.
    pub door: D,
}

#[cfg(interlocks)]
impl<I: Inputs, S: InterlockInput, D: InterlockInput> Inputs for WithInterlockPins<I, S, D> {
    #[inline(always)]
    fn read(&mut self, motors: &[Motor<Scalar>; 3]) -> Closed {
        self.inputs.read(motors)
    }

    #[inline(always)]
    fn interlocks(&mut self) -> Interlocked {
        trirrr_service::InterlockReadings {
            emergency_stop: self.stop.is_active(),
            door: self.door.is_active(),
            ..Default::default()
        }
    }

    #[inline(always)]
    fn shift(&mut self, by: [Angle; 3]) {
        self.inputs.shift(by);
    }
}

/// The probe at the pin `P`, if the scene names one.
#[cfg(probe)]
pub type ProbeLine<P> = InterlockPin<P, { crate::scene::PROBE_TOUCHES_HIGH }>;
/// The scene names no probe.
#[cfg(all(interlocks, not(probe)))]
pub type ProbeLine<P> = NoInterlockPin<P>;

/// Source of the limit switches.
#[cfg(interlocks)]
pub trait LimitSource {
    /// Keeps the homing switches of the tick, where the limit switches are those.
    #[inline(always)]
    fn keep(&mut self, _: Closed) {}

    /// Returns true for each motor on its limit switch.
    fn limits(&mut self) -> [bool; 3];
}

/// Limit switches at pins of their own, or none where all are [`NoInterlockPin`].
#[cfg(interlocks)]
pub struct LimitPins<A, B, C>(pub A, pub B, pub C);

#[cfg(interlocks)]
impl<A: InterlockInput, B: InterlockInput, C: InterlockInput> LimitSource for LimitPins<A, B, C> {
    #[inline(always)]
    fn limits(&mut self) -> [bool; 3] {
        [self.0.is_active(), self.1.is_active(), self.2.is_active()]
    }
}

/// A limit switch at the pin `P`, if the scene names those with pins of their own.
#[cfg(limits)]
pub type MotorLimitLine<P> = InterlockPin<P, { crate::scene::LIMITS_HIGH }>;
/// The scene names no limit switch with a pin of its own.
#[cfg(all(interlocks, not(limits)))]
pub type MotorLimitLine<P> = NoInterlockPin<P>;

/// Limit switches of this image.
#[cfg(all(interlocks, not(limits_at_homing)))]
pub type LimitSwitchesOf<A, B, C> =
    LimitPins<MotorLimitLine<A>, MotorLimitLine<B>, MotorLimitLine<C>>;
/// Limit switches of this image: those of homing.
#[cfg(limits_at_homing)]
pub type LimitSwitchesOf<A, B, C> =
    HomingLimits<LimitPins<MotorLimitLine<A>, MotorLimitLine<B>, MotorLimitLine<C>>>;

/// Limit switches of this image at these pins, which are left alone where the limit switches are those of homing.
#[cfg(interlocks)]
#[inline(always)]
pub fn limit_switches<A, B, C>(
    first: MotorLimitLine<A>,
    second: MotorLimitLine<B>,
    third: MotorLimitLine<C>,
) -> LimitSwitchesOf<A, B, C> {
    let pins = LimitPins(first, second, third);
    #[cfg(limits_at_homing)]
    let pins = HomingLimits {
        closed: Default::default(),
        _pins: pins,
    };
    pins
}

/// Limit switches that are those of homing.
#[cfg(limits_at_homing)]
pub struct HomingLimits<P> {
    closed: Closed,
    _pins: P,
}

#[cfg(limits_at_homing)]
impl<P> LimitSource for HomingLimits<P> {
    #[inline(always)]
    fn keep(&mut self, closed: Closed) {
        self.closed = closed;
    }

    #[inline(always)]
    fn limits(&mut self) -> [bool; 3] {
        self.closed
    }
}

/// Inputs beside the contacts of probe and limit switches.
#[cfg(interlocks)]
pub struct WithTouchPins<I, P, L> {
    /// Everything else.
    pub inputs: I,
    /// Contact of the probe.
    pub probe: P,
    /// Limit switches.
    pub limits: L,
}

#[cfg(interlocks)]
impl<I: Inputs, P: InterlockInput, L: LimitSource> Inputs for WithTouchPins<I, P, L> {
    // A unit without homing.
    #[allow(clippy::let_unit_value, clippy::unit_arg)]
    #[inline(always)]
    fn read(&mut self, motors: &[Motor<Scalar>; 3]) -> Closed {
        let closed = self.inputs.read(motors);
        self.limits.keep(closed);
        closed
    }

    #[inline(always)]
    fn interlocks(&mut self) -> Interlocked {
        Interlocked {
            probe: self.probe.is_active(),
            limits: self.limits.limits(),
            ..self.inputs.interlocks()
        }
    }

    #[inline(always)]
    fn shift(&mut self, by: [Angle; 3]) {
        self.inputs.shift(by);
    }
}

// Inputs of this image: those of the board, and around them the wrapper of a test image.
#[cfg(all(feature = "fault-injection", not(feature = "ruled-switches")))]
pub(crate) use crate::fault_injection::{FaultInjection as Wired, wire};
#[cfg(feature = "ruled-switches")]
pub(crate) use crate::ruled_switches::{RuledInputs as Wired, wire};
#[cfg(not(any(feature = "fault-injection", feature = "ruled-switches")))]
pub(crate) use bare::{Wired, wire};

#[cfg(not(any(feature = "fault-injection", feature = "ruled-switches")))]
mod bare {
    use trirrr_protocol::message::Board;

    pub(crate) type Wired<I> = I;

    #[inline(always)]
    pub(crate) fn wire<I>(inputs: I, _: &Board) -> Wired<I> {
        inputs
    }
}
