//! The directions of all vectors of a system of loops at one place.

use super::{ClosureInput, Reference, Term};
use crate::motion::turned;
use nalgebra::Vector2;
use trirrr_core::number::Number;

/// Unit vectors of all angles, of inputs and of unknowns; those of lengths are of no use.
pub(super) struct Directions<N, const UNKNOWNS: usize, const INPUTS: usize> {
    inputs: [Vector2<N>; INPUTS],
    unknowns: [Vector2<N>; UNKNOWNS],
}

impl<N: Number, const UNKNOWNS: usize, const INPUTS: usize> Directions<N, UNKNOWNS, INPUTS> {
    pub(super) fn new(inputs: &[ClosureInput<N>; INPUTS], unknowns: &[N; UNKNOWNS]) -> Self {
        let unit = |radians: N| {
            let (sin, cos) = N::sin_cos(N::angle(radians));
            Vector2::new(cos, sin)
        };
        Self {
            inputs: inputs.map(|input| unit(input.value)),
            unknowns: unknowns.map(unit),
        }
    }

    /// The unit vector that `term` is a multiple of.
    pub(super) fn of(&self, term: &Term<N>) -> Vector2<N> {
        match term.reference {
            Reference::Fixed => term.offset,
            Reference::Driven(input) => turned(term.offset, self.inputs[input]),
            Reference::Unknown(unknown) => turned(term.offset, self.unknowns[unknown]),
        }
    }

    /// Adds `value`, given along and across `term`, to the sum of its loop.
    pub(super) fn add(&self, sum: &mut [N; UNKNOWNS], term: &Term<N>, value: Vector2<N>) {
        let vector = turned(value, self.of(term));
        sum[2 * term.in_loop] += vector.x;
        sum[2 * term.in_loop + 1] += vector.y;
    }
}
