//! Outputs of the tick beside the drives: brake, tool, lamp and spare outputs, where the scene has them.

use trirrr_app::outputs::OutputPart;

/// Pins of the outputs beside drives and tool.
pub struct OutputPins<B, L, S> {
    /// Release of the brake.
    pub brake: B,
    /// Status lamp.
    pub lamp: L,
    /// Spare outputs.
    pub spare: S,
}

/// Kinds of outputs: the brake,
pub struct Brake;
/// the lamp,
pub struct Lamp;
/// and spare outputs.
pub struct Spare;

/// Outputs beside the drives.
pub trait OutputsBeside {
    /// All of them, with the tool `T`.
    type Parts<T: OutputPart>: OutputPart;

    /// Makes the pins outputs that are off.
    fn build<T: OutputPart>(self, tool: T) -> Self::Parts<T>;
}

impl<B, L, S> OutputsBeside for OutputPins<B, L, S>
where
    B: OutputGroup<Brake>,
    L: OutputGroup<Lamp>,
    S: OutputGroup<Spare>,
{
    type Parts<T: OutputPart> = (B::Part, T, L::Part, S::Part);

    fn build<T: OutputPart>(self, tool: T) -> Self::Parts<T> {
        (self.brake.off(), tool, self.lamp.off(), self.spare.off())
    }
}

/// Pins of outputs of a kind `K`.
pub trait OutputGroup<K> {
    /// Outputs that the tick switches.
    type Part: OutputPart;

    /// Makes the pins outputs that are off.
    fn off(self) -> Self::Part;
}

impl<K> OutputGroup<K> for () {
    type Part = ();

    fn off(self) {}
}

#[cfg(brake)]
impl<P: crate::BoardPin> OutputGroup<Brake> for (P,) {
    type Part = trirrr_app::outputs::BrakePin<P::Output>;

    fn off(self) -> Self::Part {
        trirrr_app::outputs::BrakePin::new(self.0.output(false))
    }
}

#[cfg(lamp)]
impl<P: crate::BoardPin> OutputGroup<Lamp> for (P,) {
    type Part = trirrr_app::LampPin<P::Output>;

    fn off(self) -> Self::Part {
        trirrr_app::LampPin::new(self.0.output(false))
    }
}

#[cfg(digital)]
mod spare {
    use super::{OutputGroup, Spare};
    use crate::BoardPin;
    use trirrr_app::digital::SpareOutputs;

    macro_rules! for_pins {
        ($($pin:ident),*) => {
            impl<$($pin: BoardPin),*> OutputGroup<Spare> for ($($pin,)*) {
                type Part = SpareOutputs<($($pin::Output,)*)>;

                #[allow(non_snake_case)]
                fn off(self) -> Self::Part {
                    let ($($pin,)*) = self;
                    SpareOutputs::new(($($pin.output(false),)*))
                }
            }
        };
    }

    for_pins!(A, B, C, D, E, F, G, H);
}
