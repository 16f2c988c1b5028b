//! Search for all assembly modes: every pose that fits given motor angles.
//!
//! [`super`] derives the polynomial. Each of its roots is a platform angle; the position belonging
//! to it is an intersection of two of the three circles about B_i - R h_i, and Newton-Raphson on all
//! three conditions gives the pose its last digits.

use super::isolate::{isolate, refine};
use super::modes::{Assemblies, Assembly, AssemblyError, Completeness};
use super::newton::Forward;
use super::polynomial::Polynomial;
use super::search::PoseSearch;
use crate::number::Number;
use crate::setpoint::Pose;

impl<N: Number> Forward<N> {
    /// Every pose at which the motors stand at `angles`.
    ///
    /// The search computes in binary64 whatever `N` is: next to a double root the rounding of a shorter type
    /// hides how many modes there are. The poses are rounded to `N`.
    ///
    /// The work is bounded, and nothing is allocated; [`Assemblies::arcs`] counts the work. It serves
    /// at the start of a job; [`super::Tracker`] serves in every tick.
    ///
    /// # Errors
    /// [`AssemblyError`]. Angles that fit no pose are no error: the list is empty.
    pub fn assemblies(&self, angles: &[N::Angle; 3]) -> Result<Assemblies<N>, AssemblyError> {
        let exact = Forward {
            legs: self.exact,
            size: self.size.to_f64(),
            greatest_det_a: self.greatest_det_a.to_f64(),
            exact: self.exact,
        };
        exact.search(&angles.map(N::angle_to_f64))?.rounded()
    }

    /// The mode of `assemblies` whose platform joints are nearest to those at `reference`,
    /// with its angle less than half a turn from the reference's; `None` if there is none.
    pub fn nearest(&self, assemblies: &Assemblies<N>, reference: &Pose<N>) -> Option<Assembly<N>> {
        let mut nearest: Option<(N, Assembly<N>)> = None;
        for mode in assemblies.modes() {
            let distance = self.joint_distance(&mode.pose, reference);
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

impl Forward<f64> {
    fn search(&self, angles: &[f64; 3]) -> Result<Assemblies<f64>, AssemblyError> {
        let elbows = self.elbows(angles);
        let f = Polynomial::new(self, &elbows);
        if !f.value(1.0).is_finite() {
            return Err(AssemblyError::OutOfRange);
        }
        let isolated = isolate(&f);
        let mut search = PoseSearch::new(self, elbows);
        search.found.arcs = isolated.visited;
        // Simple roots first: a pose found on an undecided arc may be one of them.
        for arc in isolated.arcs().iter().filter(|arc| arc.simple_root) {
            search.add_simple_root(arc, refine(&f, arc));
        }
        for arc in isolated.arcs().iter().filter(|arc| !arc.simple_root) {
            search.add_undecided(arc)?;
        }
        search.sort();
        if isolated.exhausted {
            search.found.completeness = Completeness::Undecided;
        }
        Ok(search.found)
    }
}

/// `angle` less whole turns, in (-pi, pi].
pub(super) fn half_turn<N: Number>(angle: N::Angle) -> N::Angle {
    let (sin, cos) = N::sin_cos(angle);
    N::atan2(sin, cos)
}

#[cfg(test)]
mod tests;
