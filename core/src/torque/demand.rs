//! The wrench that the platform demands of the legs.

use nalgebra::Vector2;

/// The force and the moment about D that the three legs together have to supply.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Demand<N> {
    /// F, in the fixed frame.
    pub force: Vector2<N>,
    /// M, about the reference point D.
    pub moment: N,
}
