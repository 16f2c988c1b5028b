//! A scene of a machine with an emergency stop, a door, limit switches or a probe.

use super::Scene;
use crate::interlock::{InterlockParameters, Interlocks, ProbeMemory};
use crate::number::ServiceNumber;
use core::marker::PhantomData;

/// Scene `S` of a machine with the inputs `INPUTS` of [`input_bits`](crate::input_bits), and with a probe `P`: a
/// [`ProbeLatch`](crate::ProbeLatch), or `()`.
#[derive(Clone, Copy, Debug)]
pub struct WithInterlocks<S, const INPUTS: u8, P> {
    /// Everything else of the scene.
    pub scene: S,
    /// Inputs that the scene names. Those without their parameter count for nothing.
    pub parameters: InterlockParameters,
    /// Kind of the probe.
    pub probe: PhantomData<P>,
}

impl<N: ServiceNumber, S: Scene<N = N>, const INPUTS: u8, P: ProbeMemory<N>> Scene
    for WithInterlocks<S, INPUTS, P>
{
    super::inner!(update, digital, levels, homing, feedback, contact);
    type Interlocks = Interlocks<N, INPUTS, P>;

    fn interlocks(&self) -> Interlocks<N, INPUTS, P> {
        Interlocks::new(&self.parameters)
    }
}
