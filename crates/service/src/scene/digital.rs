//! A scene of a machine with spare inputs and outputs.

use super::Scene;
use crate::digital::{DigitalParameters, DigitalPorts};
use crate::number::ServiceNumber;

/// Scene `S` of a machine with spare inputs and outputs.
#[derive(Clone, Copy, Debug)]
pub struct WithDigital<S> {
    /// Everything else of the scene.
    pub scene: S,
    /// Inputs and outputs that the scene names; none of a machine without any.
    pub parameters: DigitalParameters,
}

impl<N: ServiceNumber, S: Scene<N = N>> Scene for WithDigital<S> {
    super::inner!(update, levels, homing, feedback, contact, interlocks);
    type Digital = DigitalPorts;

    #[inline(always)]
    fn digital(&self) -> DigitalParameters {
        self.parameters
    }
}
