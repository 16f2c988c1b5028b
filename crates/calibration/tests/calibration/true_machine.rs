//! A machine that is there, computed by angles and arccosines: nothing is shared with the code under test.

use trirrr_core::machine::Parameters;

/// Random numbers of a seed.
pub(crate) struct Draw(pub(crate) u64);

impl Draw {
    /// From -1 to 1.
    pub(crate) fn even(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    /// Normal, of deviation 1.
    pub(crate) fn normal(&mut self) -> f64 {
        let (one, other) = (0.5 * (self.even() + 1.0), self.even());
        (-2.0 * one.max(1e-300).ln()).sqrt() * (std::f64::consts::PI * other).cos()
    }
}

#[derive(Clone, Copy)]
pub(crate) struct TrueLeg {
    pub(crate) base: [f64; 2],
    pub(crate) lengths: [f64; 2],
    pub(crate) joint: [f64; 2],
    pub(crate) elbow: f64,
    pub(crate) offset: f64,
}

#[derive(Clone, Copy)]
pub(crate) struct TrueMachine(pub(crate) [TrueLeg; 3]);

impl TrueMachine {
    /// The machine of `parameters`, each length and coordinate off by up to `error_m`, each encoder by up to `error_rad`.
    pub(crate) fn near(
        parameters: &Parameters,
        draw: &mut Draw,
        error_m: f64,
        error_rad: f64,
    ) -> Self {
        let legs = parameters.legs.map(|leg| {
            let mut off = |value: f64| value + error_m * draw.even();
            let angle = leg.joint_angle_rad;
            let mut own = TrueLeg {
                base: [off(leg.base_m.x), off(leg.base_m.y)],
                lengths: [off(leg.proximal_m), off(leg.distal_m)],
                joint: [
                    off(leg.joint_radius_m * angle.cos()),
                    off(leg.joint_radius_m * angle.sin()),
                ],
                elbow: leg.elbow.sign(),
                offset: 0.0,
            };
            own.offset = error_rad * draw.even();
            own
        });
        Self(legs)
    }

    /// Angles that the encoders tell at a pose, by the law of cosines.
    pub(crate) fn told(&self, [x, y, alpha]: [f64; 3]) -> [f64; 3] {
        self.0.map(|leg| {
            let (cos, sin) = (alpha.cos(), alpha.sin());
            let dx = x + cos * leg.joint[0] - sin * leg.joint[1] - leg.base[0];
            let dy = y + sin * leg.joint[0] + cos * leg.joint[1] - leg.base[1];
            let way = (dx * dx + dy * dy).sqrt();
            let [l1, l2] = leg.lengths;
            let corner = ((way * way + l1 * l1 - l2 * l2) / (2.0 * l1 * way)).acos();
            let angle = dy.atan2(dx) + leg.elbow * corner - leg.offset;
            angle - std::f64::consts::TAU * (angle / std::f64::consts::TAU).round()
        })
    }

    /// Pose at which the encoders tell these angles: secants of [`told`](Self::told), from a pose nearby. None where these find none.
    pub(crate) fn pose(&self, told: [f64; 3], near: [f64; 3]) -> Option<[f64; 3]> {
        let turn = std::f64::consts::TAU;
        let off = |pose: [f64; 3]| {
            let own = self.told(pose);
            [0, 1, 2].map(|motor| {
                let off = told[motor] - own[motor];
                off - turn * (off / turn).round()
            })
        };
        let mut pose = near;
        for _ in 0..60 {
            let here = off(pose);
            let column = |axis: usize| {
                let mut moved = pose;
                moved[axis] += 1e-7;
                let there = off(moved);
                [0, 1, 2].map(|motor| (here[motor] - there[motor]) / 1e-7)
            };
            let [a, b, c] = [column(0), column(1), column(2)];
            let det = |a: [f64; 3], b: [f64; 3], c: [f64; 3]| {
                a[0] * (b[1] * c[2] - b[2] * c[1]) - b[0] * (a[1] * c[2] - a[2] * c[1])
                    + c[0] * (a[1] * b[2] - a[2] * b[1])
            };
            let whole = det(a, b, c);
            let step = [det(here, b, c), det(a, here, c), det(a, b, here)];
            let length = step[0].hypot(step[1]) / whole.abs();
            let short = (2e-3 / length).min(1.0);
            for axis in 0..3 {
                pose[axis] += short * step[axis] / whole;
            }
        }
        let left = off(pose);
        left.iter().all(|part| part.abs() < 1e-12).then_some(pose)
    }
}
