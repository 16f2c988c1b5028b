//! Pose of the platform at given motor angles, and its derivatives by every parameter.
//!
//! Each distal link has to keep its length between elbow and platform joint:
//!
//! ```text
//! g_i(X, p) = (|r2_i|^2 - l2_i^2) / 2 = 0,   r2_i = D + R(alpha) J_i - A_i - l1_i u(theta_i + offset_i)
//! ```
//!
//! Newton's method finds X = (D, alpha). By implicit differentiation dX/dp = -(dg/dX)^-1 dg/dp, where dg/dX has the rows
//! [r2x, r2y, c x r2]: exact, without differences.

use crate::parameter::{KinematicVector, PER_LEG};

/// Newton's steps; far fewer are taken where there is a pose.
const MOST_STEPS: u32 = 60;

/// Step, relative to the size of the machine, below which the pose is found.
const SMALL: f64 = 1e-13;

/// Length error of a distal link, relative, that a pose may have.
const CLOSED: f64 = 1e-11;

/// Longest step, relative to the size of the machine.
const LONGEST: f64 = 0.1;

/// Pose at which the three loops close.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LoopClosure {
    /// x, y of D in m, alpha in rad.
    pub(crate) pose: [f64; 3],
    /// Sign of det A: that of the assembly mode.
    pub(crate) side: bool,
}

/// Derivatives of the pose by the 21 parameters of the legs.
pub(crate) type PoseSlopes = [[f64; 3 * PER_LEG]; 3];

/// Vectors of a leg at a pose.
struct LegVectors {
    /// A -> B.
    r1: [f64; 2],
    /// B -> C.
    r2: [f64; 2],
    /// D -> C.
    c: [f64; 2],
}

pub(crate) fn turned([x, y]: [f64; 2], angle: f64) -> [f64; 2] {
    let (sin, cos) = angle.sin_cos();
    [cos * x - sin * y, sin * x + cos * y]
}

fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

fn cross3(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

fn vectors(values: &KinematicVector, angles: &[f64; 3], pose: [f64; 3]) -> [LegVectors; 3] {
    [0, 1, 2].map(|leg| {
        let own = &values.0[leg * PER_LEG..];
        let r1 = turned([own[2], 0.0], angles[leg] + own[6]);
        let c = turned([own[4], own[5]], pose[2]);
        let r2 = [0, 1].map(|axis| pose[axis] + c[axis] - own[axis] - r1[axis]);
        LegVectors { r1, r2, c }
    })
}

/// Columns of the inverse of A, and det A.
fn inverse(legs: &[LegVectors; 3]) -> ([[f64; 3]; 3], f64) {
    let [a, b, c] = legs
        .each_ref()
        .map(|leg| [leg.r2[0], leg.r2[1], cross(leg.c, leg.r2)]);
    let columns = [cross3(b, c), cross3(c, a), cross3(a, b)];
    let det = (0..3).map(|part| a[part] * columns[0][part]).sum::<f64>();
    (columns.map(|column| column.map(|part| part / det)), det)
}

/// Length against which steps count as small: the longest leg.
fn size(values: &KinematicVector) -> f64 {
    let legs = values.0.chunks(PER_LEG).take(3);
    legs.map(|own| own[2] + own[3]).fold(0.0, f64::max)
}

/// Pose at the motor angles `angles` that Newton's method finds from `guess`; none where it finds none.
pub(crate) fn close(
    values: &KinematicVector,
    angles: &[f64; 3],
    guess: [f64; 3],
) -> Option<LoopClosure> {
    let size = size(values);
    let mut pose = guess;
    for _ in 0..MOST_STEPS {
        let legs = vectors(values, angles, pose);
        let (columns, det) = inverse(&legs);
        let mut step = [0.0; 3];
        let mut error: f64 = 0.0;
        for (leg, (own, column)) in legs.iter().zip(columns).enumerate() {
            let l2 = values.0[leg * PER_LEG + 3];
            let gap = 0.5 * (l2 * l2 - own.r2[0] * own.r2[0] - own.r2[1] * own.r2[1]);
            error = error.max(gap.abs() / (l2 * l2));
            for (part, slope) in step.iter_mut().zip(column) {
                *part += gap * slope;
            }
        }
        let length = step[0].hypot(step[1]).max(size * step[2].abs());
        if !length.is_finite() {
            return None;
        }
        let short = (LONGEST * size / length).min(1.0);
        for (part, step) in pose.iter_mut().zip(step) {
            *part += short * step;
        }
        if length < SMALL * size {
            let side = det > 0.0;
            return (error < CLOSED).then_some(LoopClosure { pose, side });
        }
    }
    None
}

/// Signs of r1 x r2 of the legs at a pose: opposite to the elbow signs.
pub(crate) fn crosses(values: &KinematicVector, angles: &[f64; 3], pose: [f64; 3]) -> [f64; 3] {
    vectors(values, angles, pose).map(|leg| cross(leg.r1, leg.r2))
}

/// Derivatives of the pose by the parameters of the legs, at a pose where the loops close.
pub(crate) fn slopes(values: &KinematicVector, angles: &[f64; 3], pose: [f64; 3]) -> PoseSlopes {
    let legs = vectors(values, angles, pose);
    let (columns, _) = inverse(&legs);
    let mut slopes = [[0.0; 3 * PER_LEG]; 3];
    for (leg, (own, column)) in legs.iter().zip(columns).enumerate() {
        let [l1, l2] = [2, 3].map(|part| values.0[leg * PER_LEG + part]);
        let across = turned(own.r2, -pose[2]);
        // Slopes of g by base x and y, l1, l2, joint x and y, offset.
        let of_gap = [
            -own.r2[0],
            -own.r2[1],
            -(own.r2[0] * own.r1[0] + own.r2[1] * own.r1[1]) / l1,
            -l2,
            across[0],
            across[1],
            -cross(own.r1, own.r2),
        ];
        for (row, part) in slopes.iter_mut().zip(column) {
            for (place, slope) in row[leg * PER_LEG..].iter_mut().zip(of_gap) {
                *place = -part * slope;
            }
        }
    }
    slopes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parameter::parameter_name;
    use trirrr_core::machine::{Geometry, example};
    use trirrr_core::setpoint::Pose;

    fn nominal() -> (KinematicVector, [f64; 3], [f64; 3]) {
        let machine = example();
        let geometry = Geometry::<f64>::build(&machine).expect("a machine");
        let pose = [0.24, 0.27, 0.2];
        let position = geometry
            .position(&Pose::from_f64(pose[0], pose[1], pose[2]))
            .expect("a pose");
        let values = KinematicVector::of(&machine, [0.0; 3], [0.0; 3]);
        (values, geometry.motor_angles(&position), pose)
    }

    #[test]
    fn the_pose_of_the_core_s_angles_is_found() {
        let (values, angles, pose) = nominal();
        let found = close(&values, &angles, [0.25, 0.25, 0.0]).expect("a pose");
        for (found, own) in found.pose.iter().zip(pose) {
            assert!((found - own).abs() < 1e-14, "{found} {own}");
        }
        // Proximal links that point away from the middle leave the platform no place.
        assert_eq!(close(&values, &[2.6, 0.5, -1.6], pose), None);
        assert_eq!(close(&values, &[f64::NAN; 3], pose), None);
    }

    #[test]
    fn slopes_are_those_of_finite_differences() {
        let (values, angles, pose) = nominal();
        let exact = slopes(&values, &angles, pose);
        let step = 1e-6;
        let [of_x, of_y, of_alpha] = exact;
        let columns = of_x.into_iter().zip(of_y).zip(of_alpha);
        for (index, ((x, y), alpha)) in columns.enumerate() {
            let at = |by: f64| {
                let mut moved = values;
                moved.0[index] += by;
                close(&moved, &angles, pose).expect("a pose").pose
            };
            let (low, high) = (at(-step), at(step));
            for (row, exact) in [x, y, alpha].into_iter().enumerate() {
                let difference = (high[row] - low[row]) / (2.0 * step);
                let off = (difference - exact).abs();
                assert!(off < 1e-7, "{}: {off}", parameter_name(index));
            }
        }
    }
}
