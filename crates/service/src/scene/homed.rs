//! A scene with homing.

use super::{Scene, Setup, Slot};
use crate::homing::{Cycle, HomingCoefficients, Plan};
use crate::number::ServiceNumber;
use trirrr_core::number::Arithmetic;

/// Encoder offsets of a scene that can be changed.
type OffsetMemory<S> = <<S as Scene>::Slot as Slot<Setup<<S as Scene>::Model>>>::Memory<
    Option<[<<S as Scene>::N as Arithmetic>::Angle; 3]>,
>;

/// Scene `S` of a machine that is homed.
#[derive(Clone, Copy, Debug)]
pub struct WithHoming<'a, S: Scene> {
    /// Everything else of the scene.
    pub scene: S,
    /// Homing in the units of the machine. `None` for a machine that knows the angles of its motors.
    pub homing: Option<&'a HomingCoefficients<S::N>>,
}

impl<'a, N: ServiceNumber, S: Scene<N = N>> Scene for WithHoming<'a, S> {
    super::inner!(update, digital, levels, feedback, contact, interlocks);
    type Homing = Option<Cycle<'a, N, OffsetMemory<S>>>;

    fn homing(&self) -> Self::Homing {
        self.homing.map(Cycle::new)
    }

    fn plan(&self) -> Option<Plan<N>> {
        let homing = self.homing?;
        let axes = homing.axes.each_ref();
        Some(Plan {
            from: axes.map(|axis| axis.park),
            to: homing.start,
            ticks: homing.times.to_start,
            rates: axes.map(|axis| axis.search),
            accelerations: axes.map(|axis| axis.acceleration),
        })
    }
}
