//! From the machine to the tick: homing switches, or drives that report a stall; emergency stop, door, probe and limit switches.

use crate::scene::Scalar;
use crate::service::ImageScene;
#[cfg(any(homing, interlocks))]
use core::convert::Infallible;
#[cfg(interlocks)]
use core::marker::PhantomData;
#[cfg(any(homing, interlocks))]
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

/// Switch or stall output of motor 1, 2, 3, at inputs that are pulled up.
#[cfg(homing)]
pub struct HomingSwitches<A, B, C>(pub A, pub B, pub C);

#[cfg(homing)]
impl<A, B, C> Inputs for HomingSwitches<A, B, C>
where
    A: InputPin<Error = Infallible>,
    B: InputPin<Error = Infallible>,
    C: InputPin<Error = Infallible>,
{
    #[inline(always)]
    fn read(&mut self, _: &[Motor<Scalar>; 3]) -> Closed {
        let Self(first, second, third) = self;
        [first.is_high(), second.is_high(), third.is_high()]
            .map(|Ok(high)| high == crate::scene::HOMING_ACTIVE_HIGH)
    }
}

/// A contact to ground at an input that is pulled up.
#[cfg(interlocks)]
pub trait InterlockInput {
    /// Returns true if the input is active.
    fn is_active(&mut self) -> bool;
}

/// Pin `P` that the scene does not name: it is left alone.
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

/// Contact at the pin `P`. `HIGH`: the input is active while the pin is high, which it is where the wire breaks.
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

/// The probe at the pin `P`, if the scene names one.
#[cfg(probe)]
pub type ProbeLine<P> = InterlockPin<P, { crate::scene::PROBE_TOUCHES_HIGH }>;
/// The scene names no probe.
#[cfg(all(interlocks, not(probe)))]
pub type ProbeLine<P> = NoInterlockPin<P>;

/// A limit switch at the pin `P`, if the scene names those with pins of their own.
#[cfg(limits)]
pub type MotorLimitLine<P> = InterlockPin<P, { crate::scene::LIMITS_HIGH }>;
/// The scene names no limit switch with a pin of its own.
#[cfg(all(interlocks, not(limits)))]
pub type MotorLimitLine<P> = NoInterlockPin<P>;

/// Limit switch of motor 1, 2, 3 at a pin of its own, if the scene names those.
#[cfg(interlocks)]
pub struct LimitSwitches<A, B, C> {
    own: (MotorLimitLine<A>, MotorLimitLine<B>, MotorLimitLine<C>),
    /// Homing switches of the tick, where the limit switches are those.
    #[cfg(limits_at_homing)]
    closed: Closed,
}

#[cfg(interlocks)]
impl<A, B, C> LimitSwitches<A, B, C> {
    /// Switches at the pins that these make inputs, of which an image calls those that its scene names.
    pub fn at(
        first: impl FnOnce() -> A,
        second: impl FnOnce() -> B,
        third: impl FnOnce() -> C,
    ) -> Self {
        Self {
            own: (
                MotorLimitLine::at(first),
                MotorLimitLine::at(second),
                MotorLimitLine::at(third),
            ),
            #[cfg(limits_at_homing)]
            closed: Default::default(),
        }
    }
}

#[cfg(interlocks)]
impl<A, B, C> LimitSwitches<A, B, C>
where
    A: InputPin<Error = Infallible>,
    B: InputPin<Error = Infallible>,
    C: InputPin<Error = Infallible>,
{
    /// Returns true for each motor on its limit switch.
    #[inline(always)]
    fn are_active(&mut self) -> [bool; 3] {
        let (first, second, third) = &mut self.own;
        let active = [first.is_active(), second.is_active(), third.is_active()];
        #[cfg(limits_at_homing)]
        let active = [0, 1, 2].map(|i| active[i] || self.closed[i]);
        active
    }
}

/// Switches of homing `I` beside the contacts `C` of emergency stop, door and probe, and the limit switches `L`.
#[cfg(interlocks)]
pub struct GuardedInputs<I, C, L> {
    /// Switches of homing.
    pub homing: I,
    /// Contacts of emergency stop, door and probe.
    pub contacts: C,
    /// Limit switches.
    pub limits: L,
}

#[cfg(interlocks)]
impl<I, S, D, P, A, B, C> Inputs for GuardedInputs<I, (S, D, P), LimitSwitches<A, B, C>>
where
    I: Inputs,
    S: InterlockInput,
    D: InterlockInput,
    P: InterlockInput,
    A: InputPin<Error = Infallible>,
    B: InputPin<Error = Infallible>,
    C: InputPin<Error = Infallible>,
{
    // A unit without homing.
    #[allow(clippy::let_unit_value, clippy::unit_arg)]
    #[inline(always)]
    fn read(&mut self, motors: &[Motor<Scalar>; 3]) -> Closed {
        let closed = self.homing.read(motors);
        #[cfg(limits_at_homing)]
        {
            self.limits.closed = closed;
        }
        closed
    }

    #[inline(always)]
    fn interlocks(&mut self) -> Interlocked {
        let (stop, door, probe) = &mut self.contacts;
        Interlocked {
            emergency_stop: stop.is_active(),
            door: door.is_active(),
            probe: probe.is_active(),
            limits: self.limits.are_active(),
        }
    }

    #[inline(always)]
    fn shift(&mut self, by: [Angle; 3]) {
        self.homing.shift(by);
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
