//! Effect of an error of the motor angles at the tool: forward kinematics of the angles that a
//! number type computed, in 31 digits.

use trirrr_truth::double_double::DoubleDouble;
use trirrr_truth::inputs::Inputs;
use trirrr_truth::scalar::{cross, difference, dot, scaled, solve, sum, turned};

/// Newton steps after which there is no pose near. From an angle error of 0.1 rad six suffice.
const STEPS: usize = 30;

/// Computes how far the platform stands from the pose of `inputs`, m and rad, when its motors stand
/// at `angles`. None if the angles belong to no pose near.
pub(crate) fn miss(inputs: &Inputs<DoubleDouble>, angles: [f64; 3]) -> Option<[f64; 2]> {
    let number = DoubleDouble::new;
    let elbows: [_; 3] = std::array::from_fn(|leg| {
        let (sin, cos) = number(angles[leg]).sin_cos();
        let leg = &inputs.legs[leg];
        sum(leg.base, scaled([cos, sin], leg.l1))
    });
    let (mut position, mut angle) = (inputs.position, inputs.angle);
    let size = inputs.legs[0].l1.value() + inputs.legs[0].l2.value();
    for _ in 0..STEPS {
        // (|C - B|^2 - l2^2) / 2 = 0 for each leg; its derivative is the row [r2x, r2y, c x r2].
        let mut rows = Vec::with_capacity(3);
        let mut gaps = Vec::with_capacity(3);
        for (leg, &elbow) in inputs.legs.iter().zip(&elbows) {
            let c = turned([leg.h, number(0.0)], angle + leg.lambda);
            let r2 = difference(sum(position, c), elbow);
            rows.push(vec![r2[0], r2[1], cross(c, r2)]);
            gaps.push(number(0.5) * (leg.l2 * leg.l2 - dot(r2, r2)));
        }
        let step = solve(rows, gaps);
        position = sum(position, [step[0], step[1]]);
        angle = angle + step[2];
        let length = step[0].value().hypot(step[1].value());
        if !(length.is_finite() && step[2].value().is_finite()) {
            return None;
        }
        if length < 1e-24 * size && step[2].value().abs() < 1e-24 {
            let missed = difference(position, inputs.position);
            return Some([
                missed[0].value().hypot(missed[1].value()),
                (angle - inputs.angle).value().abs(),
            ]);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::instants;
    use crate::scenes::shipped;

    /// The thesis machine at the start of its move: angles off by 1e-6 rad move the tool by the
    /// transpose of the virtual work, tau . dtheta = F . dX; and angles of another pose lead there.
    #[test]
    fn the_tool_follows_the_motors() {
        let scene = &shipped().unwrap()[0];
        let instants = instants(scene);
        let angles = |tick: usize| instants[tick].motors.map(|motor| motor[0].value());
        let inputs = &instants[0].inputs;
        let rounded = miss(inputs, angles(0)).unwrap();
        assert!(rounded[0] < 1e-15 && rounded[1] < 1e-14, "{rounded:?}");

        let there = miss(inputs, angles(30)).unwrap();
        let other = &instants[30].inputs;
        let way = difference(other.position, inputs.position);
        let way = way[0].value().hypot(way[1].value());
        assert!((there[0] - way).abs() < 1e-15, "{there:?} {way}");
        let turn = (other.angle - inputs.angle).value();
        assert!((there[1] - turn.abs()).abs() < 1e-14, "{there:?} {turn}");
    }

    #[test]
    fn angles_that_no_pose_has_miss_none() {
        let scene = &shipped().unwrap()[0];
        let inputs = &instants(scene)[0].inputs;
        // All proximal links away from the middle.
        assert_eq!(miss(inputs, [2.5, 0.6, -1.6]), None);
    }
}
