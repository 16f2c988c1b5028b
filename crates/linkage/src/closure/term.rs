//! The vectors that loops are made of.

use super::ClosureError;
use crate::motion::unit;
use nalgebra::Vector2;
use trirrr_core::number::Number;

/// The length of a vector; negative lengths point backwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Length {
    /// Known for good, m.
    Constant(f64),
    /// The input of this number.
    Driven(usize),
    /// The unknown of this number.
    Unknown(usize),
}

/// Reference of the direction of a vector.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reference {
    /// The fixed x axis: the direction is constant.
    Fixed,
    /// The input of this number, an angle in rad.
    Driven(usize),
    /// The unknown of this number, an angle in rad.
    Unknown(usize),
}

/// One vector of a loop: +-length e^(i (reference + offset)).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Term<N> {
    pub(super) in_loop: usize,
    pub(super) length: Length,
    pub(super) reference: Reference,
    /// The constant length, or +1 or -1 where the length is driven or unknown.
    pub(super) factor: N,
    /// Cosine and sine of the offset.
    pub(super) offset: Vector2<N>,
}

impl<N: Number> Term<N> {
    /// A vector of loop number `in_loop` with a `length` in the direction of `reference` plus
    /// `offset_rad`.
    pub fn new(in_loop: usize, length: Length, reference: Reference, offset_rad: f64) -> Self {
        // Written out for no offset: no rounding of the number type's sine can disturb it.
        let offset = if offset_rad == 0.0 {
            Vector2::new(N::ONE, N::ZERO)
        } else {
            unit(offset_rad).map(N::from_f64)
        };
        let factor = match length {
            Length::Constant(length) => N::from_f64(length),
            Length::Driven(_) | Length::Unknown(_) => N::ONE,
        };
        Self {
            in_loop,
            length,
            reference,
            factor,
            offset,
        }
    }

    /// The same vector, run through backwards.
    #[must_use]
    pub fn reversed(self) -> Self {
        Self {
            factor: -self.factor,
            ..self
        }
    }

    /// Checks the term, number `term`, of a system with so many unknowns and inputs.
    pub(super) fn check(
        &self,
        term: usize,
        unknowns: usize,
        inputs: usize,
    ) -> Result<(), ClosureError> {
        if 2 * self.in_loop >= unknowns {
            let in_loop = self.in_loop;
            return Err(ClosureError::NoSuchLoop { term, in_loop });
        }
        if ![self.factor, self.offset.x, self.offset.y]
            .iter()
            .all(|value| value.is_finite())
        {
            return Err(ClosureError::NotFinite { term });
        }
        let length = match self.length {
            Length::Constant(_) => [None, None],
            Length::Driven(input) => [Some(input), None],
            Length::Unknown(unknown) => [None, Some(unknown)],
        };
        let angle = match self.reference {
            Reference::Fixed => [None, None],
            Reference::Driven(input) => [Some(input), None],
            Reference::Unknown(unknown) => [None, Some(unknown)],
        };
        for [input, unknown] in [length, angle] {
            if let Some(input) = input.filter(|&input| input >= inputs) {
                return Err(ClosureError::NoSuchInput { term, input });
            }
            if let Some(unknown) = unknown.filter(|&unknown| unknown >= unknowns) {
                return Err(ClosureError::NoSuchUnknown { term, unknown });
            }
        }
        Ok(())
    }

    /// The length with its sign.
    pub(super) fn signed_length(&self, inputs: &[ClosureInput<N>], unknowns: &[N]) -> N {
        match self.length {
            Length::Constant(_) => self.factor,
            Length::Driven(input) => inputs[input].value * self.factor,
            Length::Unknown(unknown) => unknowns[unknown] * self.factor,
        }
    }

    /// A derivative of the length and the same of the angle, from those of inputs and unknowns.
    pub(super) fn derivative(
        &self,
        of_input: impl Fn(usize) -> N,
        of_unknown: impl Fn(usize) -> N,
    ) -> (N, N) {
        let length = match self.length {
            Length::Constant(_) => N::ZERO,
            Length::Driven(input) => of_input(input) * self.factor,
            Length::Unknown(unknown) => of_unknown(unknown) * self.factor,
        };
        let angle = match self.reference {
            Reference::Fixed => N::ZERO,
            Reference::Driven(input) => of_input(input),
            Reference::Unknown(unknown) => of_unknown(unknown),
        };
        (length, angle)
    }
}

/// An input: a driven angle (rad) or length (m) with its derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClosureInput<N> {
    /// Its value.
    pub value: N,
    /// Its rate.
    pub rate: N,
    /// Its second derivative.
    pub acceleration: N,
}

impl<N: Number> ClosureInput<N> {
    /// An input that stands still.
    pub fn fixed(value: N) -> Self {
        Self {
            value,
            rate: N::ZERO,
            acceleration: N::ZERO,
        }
    }
}
