//! All assembly modes: every pose at which the motors can stand where they do.
//!
//! [`super`] derives the polynomial. Each of its roots is a platform angle; the position belonging
//! to it is an intersection of two of the three circles about B_i - R h_i, and Newton-Raphson on all
//! three conditions gives the pose its last digits.

use super::isolate::{isolate, refine};
use super::newton::Forward;
use super::polynomial::{Polynomial, greater};
use super::search::Search;
use crate::number::{Number, dot, perpendicular};
use crate::setpoint::Pose;
use core::fmt;
use nalgebra::Vector2;

/// One assembly mode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Assembly<N: Number> {
    /// The pose; its angle is in \[-pi, pi\] to rounding.
    pub pose: Pose<N>,
    /// Largest length error of a distal link at the pose, relative to its length.
    pub residual: N,
    /// det A at the pose, m^4. Its sign tells modes apart: two that meet have different ones.
    pub det_a: N,
    /// Scale-free distance to the parallel singularity: |det A| over the greatest it can be.
    pub distance: N,
    /// Two modes meet here, to within rounding: the entry stands for both, and whether they are
    /// real cannot be told. The platform is loose there.
    pub double: bool,
}

/// Whether the list is the whole truth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Completeness {
    /// Every real root is simple, and its pose is in the list.
    Complete,
    /// At least one entry is [`double`](Assembly::double); all others are in the list.
    Double,
    /// f is so close to zero on some arc that the number of its roots there could not be told, or
    /// a root gave no pose. The entries are poses; there may be more.
    Undecided,
}

/// The assembly modes of one set of motor angles, sorted by platform angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Assemblies<N: Number> {
    pub(super) modes: [Assembly<N>; 6],
    pub(super) count: usize,
    /// Whether all are there.
    pub completeness: Completeness,
    /// Arcs of the circle that were looked at: the work done.
    pub arcs: u32,
}

/// Why there is no list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AssemblyError {
    /// The platform can move while the motors stand: its joints coincide, two legs are the same, or
    /// the three distal links are and stay parallel. There are infinitely many poses.
    Loose,
    /// An angle is not finite, or a length is beyond the range of the number type.
    OutOfRange,
}

impl fmt::Display for AssemblyError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Loose => write!(f, "the platform is loose: infinitely many poses"),
            Self::OutOfRange => write!(f, "out of range of the number type"),
        }
    }
}

impl core::error::Error for AssemblyError {}

impl<N: Number> Assemblies<N> {
    /// The modes found: at most six, an even number of them unless one is double or undecided.
    pub fn modes(&self) -> &[Assembly<N>] {
        &self.modes[..self.count]
    }
}

impl<N: Number> Forward<N> {
    /// Every pose at which the motors stand at `angles`.
    ///
    /// Bounded work, no allocation; [`Assemblies::arcs`] tells how much it was. It is meant for
    /// starting up and for looking round, not for every tick: [`super::Tracker`] is.
    ///
    /// # Errors
    /// [`AssemblyError`]. Angles that fit no pose are no error: the list is empty.
    pub fn assemblies(&self, angles: &[N::Angle; 3]) -> Result<Assemblies<N>, AssemblyError> {
        let elbows = self.elbows(angles);
        let f = Polynomial::new(self, &elbows);
        if !f.value(N::ONE).is_finite() {
            return Err(AssemblyError::OutOfRange);
        }
        let isolated = isolate(&f);
        let mut search = Search::new(self, elbows);
        search.found.arcs = isolated.visited;
        // Simple roots first: a pose that noise leads to may be one of them.
        for arc in isolated.arcs().iter().filter(|arc| arc.simple) {
            search.simple(arc, refine(&f, arc));
        }
        for arc in isolated.arcs().iter().filter(|arc| !arc.simple) {
            search.noise(arc)?;
        }
        search.sort();
        if isolated.exhausted {
            search.found.completeness = Completeness::Undecided;
        }
        Ok(search.found)
    }

    /// How far the platform joint that moves most moves from `a` to `b`.
    pub(super) fn apart(&self, a: &Pose<N>, b: &Pose<N>) -> N {
        let joint = |pose: &Pose<N>, joint: Vector2<N>| {
            let (sin, cos) = N::sin_cos(pose.angle);
            joint * cos + perpendicular(joint) * sin
        };
        let moved = self.legs.iter().map(|leg| {
            let moved = (b.position - a.position) + (joint(b, leg.joint) - joint(a, leg.joint));
            dot(moved, moved)
        });
        moved.fold(N::ZERO, greater).sqrt()
    }

    /// The one of `assemblies` whose platform joints are nearest to where they are at `reference`,
    /// with its angle less than half a turn from the reference's; `None` if there is none.
    pub fn nearest(&self, assemblies: &Assemblies<N>, reference: &Pose<N>) -> Option<Assembly<N>> {
        let mut nearest: Option<(N, Assembly<N>)> = None;
        for mode in assemblies.modes() {
            let distance = self.apart(&mode.pose, reference);
            if nearest.is_none_or(|(least, _)| distance < least) {
                nearest = Some((distance, *mode));
            }
        }
        nearest.map(|(_, mode)| {
            let turned = half_turn::<N>(mode.pose.angle - reference.angle);
            Assembly {
                pose: Pose {
                    position: mode.pose.position,
                    angle: reference.angle + turned,
                },
                ..mode
            }
        })
    }
}

/// `angle` less whole turns, in (-pi, pi].
pub(super) fn half_turn<N: Number>(angle: N::Angle) -> N::Angle {
    let (sin, cos) = N::sin_cos(angle);
    N::atan2(sin, cos)
}

#[cfg(test)]
mod tests;
