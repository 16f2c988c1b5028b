//! Bounds of what a machine has in all poses of a square and a range of angles.

use super::Conditions;
use crate::interval::Interval;
use trirrr_core::machine::Parameters;

/// Rectangle of places of D, m.
pub(super) struct Box2([Interval; 2]);

impl Box2 {
    pub(super) fn around(centre: [f64; 2], half: f64) -> Self {
        // A rounding more, so that neighbours overlap.
        Self(centre.map(|at| Interval::new((at - half).next_down(), (at + half).next_up())))
    }
}

/// CellVerdict on a square.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum CellVerdict {
    Within,
    Beyond,
    Undecided,
}

struct LegBounds {
    base_m: [f64; 2],
    /// D to C in the fixed frame, m.
    joint: [Interval; 2],
    proximal_m: f64,
    distal_m: f64,
    elbow: f64,
}

/// A machine with bounds of the angle of its platform.
pub(super) struct MachineBounds {
    legs: [LegBounds; 3],
    conditions: Conditions,
    greatest_det_a: f64,
}

impl MachineBounds {
    pub(super) fn new(parameters: &Parameters, conditions: &Conditions, alpha: [f64; 2]) -> Self {
        let legs = parameters.legs.each_ref().map(|leg| {
            let [sin, cos] = Interval::sin_cos(
                alpha[0] + leg.joint_angle_rad,
                alpha[1] + leg.joint_angle_rad,
            );
            LegBounds {
                base_m: leg.base_m.into(),
                joint: [cos, sin].map(|each| each.times(leg.joint_radius_m)),
                proximal_m: leg.proximal_m,
                distal_m: leg.distal_m,
                elbow: leg.elbow.sign(),
            }
        });
        Self {
            legs,
            conditions: *conditions,
            greatest_det_a: parameters.greatest_det_a(),
        }
    }

    /// CellVerdict on all poses with D in `square`.
    pub(super) fn verdict(&self, square: &Box2) -> CellVerdict {
        let mut all_within = true;
        let mut rows = [[Interval::point(0.0); 3]; 3];
        for (leg, row) in self.legs.iter().zip(&mut rows) {
            let across: [Interval; 2] = [0, 1]
                .map(|axis| square.0[axis] + leg.joint[axis] - Interval::about(leg.base_m[axis]));
            let squared = across[0].squared() + across[1].squared();
            let (l1, l2) = (leg.proximal_m, leg.distal_m);
            // The sine of the angle between the links, by the law of cosines: it is 0 where the leg is stretched or folded.
            let sum = Interval::about(l1 * l1) + Interval::about(l2 * l2);
            let cosine = (squared - sum) * Interval::about(2.0 * l1 * l2).reciprocal();
            if cosine.low > 1.0 || cosine.high < -1.0 {
                return CellVerdict::Beyond;
            }
            let reaches = cosine.low >= -1.0 && cosine.high <= 1.0;
            let sine = (Interval::point(1.0) - cosine.squared()).sqrt();
            if sine.high < self.conditions.serial_min {
                return CellVerdict::Beyond;
            }
            if !reaches || sine.low < self.conditions.serial_min {
                all_within = false;
            }
            if squared.low <= 0.0 {
                // A leg with its platform joint over its motor has no direction.
                all_within = false;
                *row = [Interval::new(-1e3, 1e3); 3];
                continue;
            }
            let inverse = squared.reciprocal();
            let along = Interval::point(0.5)
                + (Interval::about(l2 * l2) - Interval::about(l1 * l1)).times(0.5) * inverse;
            let beside = (sine * inverse).times(l1 * l2 * leg.elbow);
            let distal = [
                along * across[0] + beside * across[1],
                along * across[1] - beside * across[0],
            ];
            let moment = leg.joint[0] * distal[1] - leg.joint[1] * distal[0];
            *row = [distal[0], distal[1], moment];
        }
        let asks = self.conditions.parallel_min > 0.0 || self.conditions.side.is_some();
        if asks {
            match self.parallel(&rows) {
                CellVerdict::Beyond => return CellVerdict::Beyond,
                CellVerdict::Undecided => all_within = false,
                CellVerdict::Within => {}
            }
        }
        match all_within {
            true => CellVerdict::Within,
            false => CellVerdict::Undecided,
        }
    }

    fn parallel(&self, rows: &[[Interval; 3]; 3]) -> CellVerdict {
        let [a, b, c] = rows;
        let minor = |i: usize, j: usize| b[i] * c[j] - b[j] * c[i];
        let det = a[0] * minor(1, 2) - a[1] * minor(0, 2) + a[2] * minor(0, 1);
        // A leg that does not reach everywhere has bounds that hold nothing for sure, and is undecided already.
        let part = det * Interval::about(self.greatest_det_a).reciprocal();
        let signed = match self.conditions.side {
            Some(true) => part,
            Some(false) => -part,
            None => part.abs(),
        };
        match () {
            () if signed.high < self.conditions.parallel_min || signed.high < 0.0 => {
                CellVerdict::Beyond
            }
            () if signed.low >= self.conditions.parallel_min && signed.low >= 0.0 => {
                CellVerdict::Within
            }
            () => CellVerdict::Undecided,
        }
    }
}
