//! Inputs of the tick: switches of homing, emergency stop, door, probe and limit switches, and spare inputs, all pulled up. An image leaves the pins
//! alone whose inputs its scene does not name.

use trirrr_app::inputs::Inputs;

/// Pins of the inputs: homing switches; emergency stop, door, probe and three limit switches and the button; spare ones.
pub struct InputPins<H, C, S> {
    /// Homing switches of the three motors.
    pub homing: H,
    /// Contacts of the interlocks.
    pub contacts: C,
    /// Spare inputs.
    pub spare: S,
}

/// Inputs that pins become.
pub trait BuiltInputs {
    /// All of them.
    type Inputs: Inputs;

    /// Pulls the pins up.
    fn build(self) -> Self::Inputs;
}

impl<H, C, S> BuiltInputs for InputPins<H, C, S>
where
    H: SwitchPins,
    C: InputGroup<H::Switches>,
    S: InputGroup<C::Joined>,
{
    type Inputs = S::Joined;

    fn build(self) -> Self::Inputs {
        self.spare.beside(self.contacts.beside(self.homing.build()))
    }
}

/// Pins of homing switches.
pub trait SwitchPins {
    /// Switches, or none.
    type Switches: Inputs;

    /// Pulls the pins up.
    fn build(self) -> Self::Switches;
}

#[cfg(not(homing))]
impl SwitchPins for () {
    type Switches = trirrr_app::inputs::NoInputs;

    fn build(self) -> Self::Switches {
        trirrr_app::inputs::NoInputs
    }
}

#[cfg(homing)]
mod switches {
    use super::SwitchPins;
    use crate::BoardPin;
    use trirrr_app::inputs::HomingSwitches;

    impl<A: BoardPin, B: BoardPin, C: BoardPin> SwitchPins for (A, B, C) {
        type Switches = HomingSwitches<A::Input, B::Input, C::Input>;

        fn build(self) -> Self::Switches {
            let (first, second, third) = self;
            HomingSwitches(first.pulled_up(), second.pulled_up(), third.pulled_up())
        }
    }
}

/// Pins of inputs that join others, `I`.
pub trait InputGroup<I> {
    /// Both.
    type Joined: Inputs;

    /// Pulls the pins up.
    fn beside(self, others: I) -> Self::Joined;
}

impl<I: Inputs> InputGroup<I> for () {
    type Joined = I;

    fn beside(self, others: I) -> I {
        others
    }
}

#[cfg(interlocks)]
mod contacts {
    use super::{InputGroup, Inputs};
    use crate::BoardPin;
    use trirrr_app::inputs::{
        ButtonLine, DoorLine, GuardedInputs, LimitSwitches, ProbeLine, StopLine,
    };

    impl<I, S, D, P, A, B, C, T> InputGroup<I> for (S, D, P, A, B, C, T)
    where
        I: Inputs,
        S: BoardPin,
        D: BoardPin,
        P: BoardPin,
        A: BoardPin,
        B: BoardPin,
        C: BoardPin,
        T: BoardPin,
    {
        type Joined = GuardedInputs<
            I,
            (
                StopLine<S::Input>,
                DoorLine<D::Input>,
                ProbeLine<P::Input>,
                ButtonLine<T::Input>,
            ),
            LimitSwitches<A::Input, B::Input, C::Input>,
        >;

        fn beside(self, homing: I) -> Self::Joined {
            let (stop, door, probe, first, second, third, button) = self;
            GuardedInputs {
                homing,
                contacts: (
                    StopLine::at(|| stop.pulled_up()),
                    DoorLine::at(|| door.pulled_up()),
                    ProbeLine::at(|| probe.pulled_up()),
                    ButtonLine::at(|| button.pulled_up()),
                ),
                limits: LimitSwitches::at(
                    || first.pulled_up(),
                    || second.pulled_up(),
                    || third.pulled_up(),
                ),
            }
        }
    }
}

#[cfg(digital)]
mod spare {
    use super::{InputGroup, Inputs};
    use crate::BoardPin;
    use trirrr_app::digital::WithSpareInputs;

    macro_rules! for_pins {
        ($($pin:ident),*) => {
            impl<I: Inputs, $($pin: BoardPin),*> InputGroup<I> for ($($pin,)*) {
                type Joined = WithSpareInputs<I, ($($pin::Input,)*)>;

                #[allow(non_snake_case)]
                fn beside(self, others: I) -> Self::Joined {
                    let ($($pin,)*) = self;
                    WithSpareInputs::new(others, ($($pin.pulled_up(),)*))
                }
            }
        };
    }

    for_pins!(A, B, C, D, E, F, G, H);
}
