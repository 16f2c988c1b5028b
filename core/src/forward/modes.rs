//! Assembly modes and the list of them.

use super::newton::Forward;
use super::polynomial::greater;
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
    /// Two modes meet here, to within rounding. The entry stands for both; rounding hides whether they
    /// are real. The platform is loose there.
    pub double: bool,
}

/// Completeness of a list of assembly modes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Completeness {
    /// Every real root is simple, and its pose is in the list. The rounding of the elbows is counted in.
    Complete,
    /// At least one entry is [`double`](Assembly::double); all others are in the list.
    Double,
    /// f is so close to zero on some arc that its roots there cannot be counted, or a root gave no
    /// pose. The entries are poses; there may be more.
    Undecided,
}

/// The assembly modes of one set of motor angles, sorted by platform angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Assemblies<N: Number> {
    pub(super) modes: [Assembly<N>; 6],
    pub(super) count: usize,
    /// Completeness of the list.
    pub completeness: Completeness,
    /// Number of arcs of the circle that the search examined.
    pub arcs: u32,
}

/// Reason why there is no list of modes.
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

impl Assemblies<f64> {
    /// The same list in the number type `N`.
    pub(super) fn rounded<N: Number>(&self) -> Result<Assemblies<N>, AssemblyError> {
        let modes = self.modes.map(|mode| {
            let [x, y] = [mode.pose.position.x, mode.pose.position.y];
            Assembly {
                pose: Pose::<N>::from_f64(x, y, mode.pose.angle),
                residual: N::from_f64(mode.residual),
                det_a: N::from_f64(mode.det_a),
                distance: N::from_f64(mode.distance),
                double: mode.double,
            }
        });
        let fits = |mode: &Assembly<N>| {
            let place = mode.pose.position;
            place.x.is_finite() && place.y.is_finite() && mode.det_a.is_finite()
        };
        if !modes[..self.count].iter().all(fits) {
            return Err(AssemblyError::OutOfRange);
        }
        Ok(Assemblies {
            modes,
            count: self.count,
            completeness: self.completeness,
            arcs: self.arcs,
        })
    }
}

impl<N: Number> Forward<N> {
    /// Displacement, from `a` to `b`, of the platform joint that moves most.
    pub(super) fn joint_distance(&self, a: &Pose<N>, b: &Pose<N>) -> N {
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
}
