//! From the machine to the tick: homing switches, or drives that report a stall; emergency stop, door, probe and limit switches.

use crate::scene::{self, LimitsAtHoming, Scalar};
use core::convert::Infallible;
use embedded_hal::digital::InputPin;
use trirrr_core::number::Arithmetic;
use trirrr_core::tick::Motor;
use trirrr_service::board::InterlockReadings;
use trirrr_service::features::{Feature, Optional};

/// Joint angle in the scene's number type.
pub type Angle = <Scalar as Arithmetic>::Angle;

/// One flag for each motor, set while the switch is closed or the drive stalls.
pub type Closed = [bool; 3];

/// Readings of the contacts of the interlocks.
pub type Interlocked = InterlockReadings;

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
pub struct NoInputs;

impl Inputs for NoInputs {
    #[inline(always)]
    fn read(&mut self, _: &[Motor<Scalar>; 3]) -> Closed {
        [false; 3]
    }
}

/// Switch or stall output of motor 1, 2, 3, at inputs that are pulled up.
pub struct HomingSwitches<A, B, C>(pub A, pub B, pub C);

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
            .map(|Ok(high)| high == scene::HOMING_ACTIVE_HIGH)
    }
}

/// A contact to ground at an input that is pulled up.
pub trait InterlockInput {
    /// Returns true if the input is active.
    fn is_active(&mut self) -> bool;
}

/// Contact at the pin `P`, if the scene has the feature `F`; else the pin is left alone. `HIGH`: the input is active while the pin
/// is high, which it is where the wire breaks.
pub struct InterlockPin<P, F: Feature, const HIGH: bool>(F::Of<P>);

impl<P, F: Feature, const HIGH: bool> InterlockPin<P, F, HIGH> {
    /// Contact at the pin that `pull_up` makes an input.
    pub fn at(pull_up: impl FnOnce() -> P) -> Self {
        Self(F::of(pull_up))
    }
}

impl<P, F: Feature, const HIGH: bool> InterlockInput for InterlockPin<P, F, HIGH>
where
    P: InputPin<Error = Infallible>,
{
    #[inline(always)]
    fn is_active(&mut self) -> bool {
        self.0.get_mut().is_some_and(|pin| {
            let Ok(is_high) = pin.is_high();
            is_high == HIGH
        })
    }
}

/// The emergency stop at the pin `P`.
pub type StopLine<P> = InterlockPin<P, scene::StopPin, true>;

/// The door at the pin `P`.
pub type DoorLine<P> = InterlockPin<P, scene::DoorPin, { scene::DOOR_OPEN_HIGH }>;

/// The probe at the pin `P`.
pub type ProbeLine<P> = InterlockPin<P, scene::Probe, { scene::PROBE_TOUCHES_HIGH }>;

/// The button at the pin `P`.
pub type ButtonLine<P> = InterlockPin<P, scene::ButtonPin, false>;

/// A limit switch at the pin `P`, if the scene names those with pins of their own.
pub type MotorLimitLine<P> = InterlockPin<P, scene::LimitPins, { scene::LIMITS_HIGH }>;

/// Limit switch of motor 1, 2, 3 at a pin of its own, if the scene names those.
pub struct LimitSwitches<A, B, C> {
    own: (MotorLimitLine<A>, MotorLimitLine<B>, MotorLimitLine<C>),
    /// Homing switches of the tick, where the limit switches are those.
    closed: <LimitsAtHoming as Feature>::Of<Closed>,
}

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
            closed: LimitsAtHoming::of(Closed::default),
        }
    }
}

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
        let closed: Option<&Closed> = self.closed.get();
        match closed {
            Some(closed) => [0, 1, 2].map(|i| active[i] || closed[i]),
            None => active,
        }
    }
}

/// Switches of homing `I` beside the contacts `C` of emergency stop, door and probe, and the limit switches `L`.
pub struct GuardedInputs<I, C, L> {
    /// Switches of homing.
    pub homing: I,
    /// Contacts of emergency stop, door, probe and button.
    pub contacts: C,
    /// Limit switches.
    pub limits: L,
}

impl<I, S, D, P, T, A, B, C> Inputs for GuardedInputs<I, (S, D, P, T), LimitSwitches<A, B, C>>
where
    I: Inputs,
    S: InterlockInput,
    D: InterlockInput,
    P: InterlockInput,
    T: InterlockInput,
    A: InputPin<Error = Infallible>,
    B: InputPin<Error = Infallible>,
    C: InputPin<Error = Infallible>,
{
    #[inline(always)]
    fn read(&mut self, motors: &[Motor<Scalar>; 3]) -> Closed {
        let closed = self.homing.read(motors);
        let at_limits: Option<&mut Closed> = self.limits.closed.get_mut();
        if let Some(at_limits) = at_limits {
            *at_limits = closed;
        }
        closed
    }

    #[inline(always)]
    fn interlocks(&mut self) -> Interlocked {
        let (stop, door, probe, button) = &mut self.contacts;
        Interlocked {
            emergency_stop: stop.is_active(),
            door: door.is_active(),
            probe: probe.is_active(),
            limits: self.limits.are_active(),
            button: button.is_active(),
        }
    }

    #[inline(always)]
    fn shift(&mut self, by: [Angle; 3]) {
        self.homing.shift(by);
    }
}
