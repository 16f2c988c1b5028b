//! Forward kinematics by Newton-Raphson: from the motor angles and a guess to the pose.
//!
//! The unknown pose X has to put every platform joint at the distal link's length from its elbow:
//!
//! ```text
//! g_i(X) = (|r2_i|^2 - l2_i^2) / 2 = 0,   r2_i = D + c_i - B_i,   dg_i/dX = [r2x, r2y, c x r2]
//! ```
//!
//! The Jacobian is the matrix A of the torque balance, so the iteration fails where the platform
//! is loose. A machine has up to six assembly modes, and the guess decides which one is found.
//! [`Forward::assemblies`] finds all; [`super::tracking`] follows one without leaving it.

use crate::inverse::Rotation;
use crate::machine::{Geometry, Parameters};
use crate::number::{Arithmetic, Number, cross, dot};
use crate::setpoint::Pose;
use crate::to_source;
use core::fmt;
use nalgebra::{Vector2, Vector3};

/// Coefficients of the forward kinematics.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Forward<N> {
    pub(super) legs: [ForwardLeg<N>; 3],
    /// Length against which a step counts as small: the longest leg.
    pub(super) size: N,
    /// The greatest size that det A can have.
    pub(super) greatest_det_a: N,
    /// The legs before they are rounded to `N`, for the search for all modes.
    pub(super) exact: [ForwardLeg<f64>; 3],
}

/// One leg of a [`Forward`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForwardLeg<N> {
    /// Base joint A in the fixed frame,
    pub base: Vector2<N>,
    /// platform joint in the platform's frame,
    pub joint: Vector2<N>,
    /// length of the proximal link,
    pub l1: N,
    /// and of the distal one.
    pub l2: N,
}

to_source!([N: Number] Forward [N] in trirrr_core::forward {
    legs: [ForwardLeg<N>; 3],
    size: N,
    greatest_det_a: N,
    exact: [ForwardLeg<f64>; 3],
});

to_source!(pub [N: Number] ForwardLeg [N] in trirrr_core::forward {
    base,
    joint,
    l1,
    l2,
});

/// A pose that the iteration converged to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found<N: Number> {
    /// The pose; its angle is the guess's plus the steps, so it is not wrapped.
    pub pose: Pose<N>,
    /// Newton steps taken.
    pub iterations: u32,
    /// Largest length error of a distal link at the pose, relative to its length.
    pub residual: N,
}

/// Failure to find a pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ForwardError<N> {
    /// det A = 0 on the way: the platform is loose there.
    ParallelSingular {
        /// Newton steps taken before.
        iterations: u32,
    },
    /// The steps did not become small: the guess is too far, or the angles fit no pose.
    NotConverged {
        /// Newton steps taken.
        iterations: u32,
        /// Largest length error of a distal link relative to its length.
        residual: N,
    },
}

impl<N: Number> fmt::Display for ForwardError<N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::ParallelSingular { iterations } => {
                write!(f, "parallel singular after {iterations} iterations")
            }
            Self::NotConverged {
                iterations,
                residual,
            } => write!(
                f,
                "not converged after {iterations} iterations, relative length error {:e}",
                residual.to_f64()
            ),
        }
    }
}

impl<N: Number> core::error::Error for ForwardError<N> {}

impl<N: Number> Forward<N> {
    /// Builds the coefficients. `geometry` has to be built from the same parameters.
    pub fn build(parameters: &Parameters, geometry: &Geometry<N>) -> Self {
        let leg = |index: usize| ForwardLeg {
            base: geometry.legs[index].base,
            joint: geometry.legs[index].joint,
            l1: N::from_f64(parameters.legs[index].proximal_m),
            l2: N::from_f64(parameters.legs[index].distal_m),
        };
        let exact = parameters.legs.each_ref().map(|leg| {
            let (sin, cos) = <f64 as Arithmetic>::sin_cos(leg.joint_angle_rad);
            ForwardLeg {
                base: leg.base_m,
                joint: Vector2::new(cos, sin) * leg.joint_radius_m,
                l1: leg.proximal_m,
                l2: leg.distal_m,
            }
        });
        let longest = |longest: f64, leg: &crate::machine::LegParameters| {
            longest.max(leg.proximal_m + leg.distal_m)
        };
        Self {
            legs: [leg(0), leg(1), leg(2)],
            size: N::from_f64(parameters.legs.iter().fold(0.0, longest)),
            greatest_det_a: N::from_f64(parameters.greatest_det_a()),
            exact,
        }
    }

    /// The elbows B_i in the fixed frame when the motors stand at `angles`.
    pub(super) fn elbows(&self, angles: &[N::Angle; 3]) -> [Vector2<N>; 3] {
        let elbow = |index: usize| {
            let (sin, cos) = N::sin_cos(angles[index]);
            let leg = &self.legs[index];
            leg.base + Vector2::new(cos, sin) * leg.l1
        };
        [elbow(0), elbow(1), elbow(2)]
    }

    /// The pose at which the motors stand at `angles`, reached from `guess` in at most
    /// `max_iterations` Newton steps.
    ///
    /// The iteration has converged at a step below four roundings of the machine's size. A step that
    /// no longer shrinks suffices below the square root of the rounding: near a parallel singularity
    /// the rounding of the residual alone makes steps larger than the first limit.
    ///
    /// # Errors
    /// [`ForwardError`].
    pub fn solve(
        &self,
        angles: &[N::Angle; 3],
        guess: Pose<N>,
        max_iterations: u32,
    ) -> Result<Found<N>, ForwardError<N>> {
        self.solve_elbows(&self.elbows(angles), guess, max_iterations)
    }

    /// [`Forward::solve`] with the elbows known.
    pub(super) fn solve_elbows(
        &self,
        elbows: &[Vector2<N>; 3],
        guess: Pose<N>,
        max_iterations: u32,
    ) -> Result<Found<N>, ForwardError<N>> {
        let rounding = N::UNIT_ROUNDOFF;
        let (fine, coarse) = (
            self.size * (rounding + rounding + rounding + rounding),
            self.size * rounding.sqrt(),
        );

        let mut pose = guess;
        let mut last_step = None;
        for iterations in 0..max_iterations {
            let step = self
                .linearised(&pose, elbows)
                .newton_step()
                .ok_or(ForwardError::ParallelSingular { iterations })?;
            pose = pose.displaced(step);
            let size = self.length_of(&step);
            let stalled = last_step.is_some_and(|last| !(size < last));
            if size <= fine || (stalled && size <= coarse) {
                return Ok(Found {
                    pose,
                    iterations: iterations + 1,
                    residual: self.linearised(&pose, elbows).length_error,
                });
            }
            last_step = Some(size);
        }
        Err(ForwardError::NotConverged {
            iterations: max_iterations,
            residual: self.linearised(&pose, elbows).length_error,
        })
    }

    /// Length of the longest leg.
    pub fn size(&self) -> N {
        self.size
    }

    /// Rough upper bound of the way of the platform's joints from one pose to the other, less than half a turn apart.
    pub fn travel(&self, from: &Pose<N>, to: &Pose<N>) -> N {
        self.length_of(&from.displacement(to))
    }

    /// Returns true if det A is positive at `pose`, with the motors at `angles`.
    pub fn side(&self, angles: &[N::Angle; 3], pose: &Pose<N>) -> bool {
        self.linearised(pose, &self.elbows(angles)).det() > N::ZERO
    }

    /// A guess with the platform at `angle`: in the middle of the places to which each leg alone would fold it.
    pub fn balanced(&self, angles: &[N::Angle; 3], angle: N::Angle) -> Pose<N> {
        let rotation = Rotation::new(angle);
        let mut sum = Vector2::new(N::ZERO, N::ZERO);
        for (leg, elbow) in self.legs.iter().zip(self.elbows(angles)) {
            sum += elbow - rotation.apply(leg.joint);
        }
        let third = N::ratio(1, 3);
        Pose {
            position: sum * third,
            angle,
        }
    }

    /// The equations at `pose`.
    pub(super) fn linearised(&self, pose: &Pose<N>, elbows: &[Vector2<N>; 3]) -> Linearised<N> {
        let rotation = Rotation::new(pose.angle);
        let mut equations = Linearised {
            rows: [Vector3::new(N::ZERO, N::ZERO, N::ZERO); 3],
            gaps: [N::ZERO; 3],
            length_error: N::ZERO,
        };
        for (index, leg) in self.legs.iter().enumerate() {
            let c = rotation.apply(leg.joint);
            let r2 = (pose.position - elbows[index]) + c;
            let l2_sq = leg.l2 * leg.l2;
            let gap = N::HALF * (l2_sq - dot(r2, r2));
            let error = gap.div(l2_sq).abs();
            if error > equations.length_error {
                equations.length_error = error;
            }
            equations.gaps[index] = gap;
            equations.rows[index] = Vector3::new(r2.x, r2.y, cross(c, r2));
        }
        equations
    }

    /// det A at `pose`, and its size over the greatest it can have.
    pub(super) fn det_a(&self, pose: &Pose<N>, elbows: &[Vector2<N>; 3]) -> (N, N) {
        let det_a = self.linearised(pose, elbows).det();
        let distance = if self.greatest_det_a > N::ZERO {
            det_a.abs().div(self.greatest_det_a)
        } else {
            // A platform whose joints coincide is singular everywhere.
            N::ZERO
        };
        (det_a, distance)
    }

    /// Rough upper bound of the displacement of the platform's joints in a step.
    fn length_of(&self, step: &Vector3<N>) -> N {
        let arm = self.legs.iter().fold(N::ZERO, |arm, leg| {
            let length = leg.joint.x.abs() + leg.joint.y.abs();
            if length > arm { length } else { arm }
        });
        step.x.abs() + step.y.abs() + arm * step.z.abs()
    }
}

/// The three equations linearised at a pose.
pub(super) struct Linearised<N> {
    /// Rows of the Jacobian.
    pub(super) rows: [Vector3<N>; 3],
    /// (l2^2 - |r2|^2) / 2 of each leg.
    pub(super) gaps: [N; 3],
    /// Largest gap relative to l2^2: to first order the relative length error.
    pub(super) length_error: N,
}

impl<N: Number> Linearised<N> {
    /// det A, the determinant of the Jacobian.
    pub(super) fn det(&self) -> N {
        let [a, b, c] = &self.rows;
        let bc = b.cross(c);
        a.x * bc.x + a.y * bc.y + a.z * bc.z
    }

    /// The displacement that closes the gaps to first order; `None` where the Jacobian is singular
    /// or the step leaves the number type's range.
    fn newton_step(&self) -> Option<Vector3<N>> {
        let [a, b, c] = &self.rows;
        let (bc, ca, ab) = (b.cross(c), c.cross(a), a.cross(b));
        let det = a.x * bc.x + a.y * bc.y + a.z * bc.z;
        let step = (bc * self.gaps[0] + ca * self.gaps[1] + ab * self.gaps[2]) * N::ONE.div(det);
        (step.x + step.y + step.z).is_finite().then_some(step)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machine::example;

    fn machine<N: Number>() -> (Geometry<N>, Forward<N>) {
        let parameters = example();
        let geometry = Geometry::build(&parameters).unwrap();
        let forward = Forward::build(&parameters, &geometry);
        (geometry, forward)
    }

    /// Angles of a pose, then back from a guess beside it.
    fn there_and_back<N: Number>() -> (Found<N>, [f64; 3]) {
        let (geometry, forward) = machine::<N>();
        let pose = [0.26, 0.24, 0.2];
        let position = geometry
            .position(&Pose::from_f64(pose[0], pose[1], pose[2]))
            .unwrap();
        let angles = geometry.motor_angles(&position);
        let guess = Pose::from_f64(0.25, 0.25, 0.1);
        let found = forward.solve(&angles, guess, 20).unwrap();
        let error = [
            found.pose.position.x.to_f64() - pose[0],
            found.pose.position.y.to_f64() - pose[1],
            N::angle_to_f64(found.pose.angle) - pose[2],
        ];
        (found, error)
    }

    #[test]
    fn finds_the_pose_again() {
        // Far from singularities, where the pose carries a few dozen roundings of the angles.
        let (found, error) = there_and_back::<f64>();
        assert!(error.iter().all(|e| e.abs() < 1e-14), "{error:?}");
        assert!((3..=6).contains(&found.iterations), "{found:?}");
        assert!(found.residual < 1e-15, "{found:?}");

        let (found, error) = there_and_back::<f32>();
        assert!(error.iter().all(|e| e.abs() < 1e-5), "{error:?}");
        assert!((2..=6).contains(&found.iterations), "{found:?}");
        assert!(found.residual < 1e-6, "{found:?}");
    }

    #[test]
    fn says_when_it_does_not_converge() {
        let (_, forward) = machine::<f64>();
        // All proximal links point away from the middle: no pose fits.
        let angles = [2.6, 0.5, -1.6];
        let error = forward
            .solve(&angles, Pose::from_f64(0.25, 0.25, 0.0), 20)
            .unwrap_err();
        assert!(
            matches!(error, ForwardError::NotConverged { iterations: 20, residual } if residual > 0.1),
            "{error}"
        );
    }

    #[test]
    fn says_when_the_platform_is_loose() {
        // All joints of the platform in one point: its rotation is free everywhere.
        let mut parameters = example();
        for leg in &mut parameters.legs {
            leg.joint_radius_m = 0.0;
        }
        let geometry = Geometry::<f64>::build(&parameters).unwrap();
        let forward = Forward::build(&parameters, &geometry);
        let guess = Pose::from_f64(0.25, 0.25, 0.0);
        let angles = geometry.motor_angles(&geometry.position(&guess).unwrap());
        assert_eq!(
            forward.solve(&angles, guess, 20).unwrap_err(),
            ForwardError::ParallelSingular { iterations: 0 }
        );
    }
}
