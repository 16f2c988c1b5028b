//! Problems with solutions in closed form or published to many digits.

use trirrr_integrate::{Action, Direction, Matrix, System};

/// What the equations here refuse: nothing, unless a test says so.
pub(crate) type Never = String;

/// y' = lambda y, decoupled.
pub(crate) struct Decay<const N: usize>(pub(crate) [f64; N]);

impl<const N: usize> System<N> for Decay<N> {
    type Refusal = Never;
    fn derivative(&self, _: f64, y: &[f64; N], dy: &mut [f64; N]) -> Result<(), Never> {
        for i in 0..N {
            dy[i] = self.0[i] * y[i];
        }
        Ok(())
    }
    fn scales(&self) -> [f64; N] {
        [1.0; N]
    }
}

/// Position and velocity with a force of time and of both: x'' = -x, plus y' = -y cos t beside
/// it, so that the time within a step matters too. x = cos t, v = -sin t, y = exp(-sin t).
pub(crate) struct Oscillator;

impl System<3> for Oscillator {
    type Refusal = Never;
    fn derivative(&self, t: f64, y: &[f64; 3], dy: &mut [f64; 3]) -> Result<(), Never> {
        *dy = [y[1], -y[0], -y[2] * t.cos()];
        Ok(())
    }
    fn scales(&self) -> [f64; 3] {
        [1.0; 3]
    }
    fn positions(&self) -> &[(usize, usize)] {
        &[(0, 1)]
    }
}

impl Oscillator {
    pub(crate) const START: [f64; 3] = [1.0, 0.0, 1.0];

    pub(crate) fn solution(t: f64) -> [f64; 3] {
        [t.cos(), -t.sin(), (-t.sin()).exp()]
    }
}

/// The Van der Pol oscillator in the scaled form of the test set for initial value problem
/// solvers, eps = 1e-6.
pub(crate) struct VanDerPol;

impl VanDerPol {
    pub(crate) const START: [f64; 2] = [2.0, 0.0];
    /// At t = 2: Mazzia and Magherini, *Test Set for Initial Value Problem Solvers*, release 2.4.
    pub(crate) const END: [f64; 2] = [1.706_167_732_170_483, -0.892_809_701_024_795_8];
}

impl System<2> for VanDerPol {
    type Refusal = Never;
    fn derivative(&self, _: f64, y: &[f64; 2], dy: &mut [f64; 2]) -> Result<(), Never> {
        *dy = [y[1], ((1.0 - y[0] * y[0]) * y[1] - y[0]) / 1e-6];
        Ok(())
    }
    fn jacobian(&self, _: f64, y: &[f64; 2], jacobian: &mut Matrix<2>) -> Result<(), Never> {
        *jacobian = [
            [0.0, 1.0],
            [
                (-2.0 * y[0] * y[1] - 1.0) / 1e-6,
                (1.0 - y[0] * y[0]) / 1e-6,
            ],
        ];
        Ok(())
    }
    fn scales(&self) -> [f64; 2] {
        [1.0, 1.0]
    }
}

/// Robertson's chemical reactions.
pub(crate) struct Robertson;

impl Robertson {
    pub(crate) const START: [f64; 3] = [1.0, 0.0, 0.0];
    /// At t = 1e11: Mazzia and Magherini, as above.
    pub(crate) const END: [f64; 3] = [
        0.208_334_014_970_123_e-7,
        0.833_336_077_033_471_2e-13,
        0.999_999_979_166_505_1,
    ];
}

impl System<3> for Robertson {
    type Refusal = Never;
    fn derivative(&self, _: f64, y: &[f64; 3], dy: &mut [f64; 3]) -> Result<(), Never> {
        let slow = 0.04 * y[0];
        let back = 1e4 * y[1] * y[2];
        let fast = 3e7 * y[1] * y[1];
        *dy = [back - slow, slow - back - fast, fast];
        Ok(())
    }
    fn jacobian(&self, _: f64, y: &[f64; 3], jacobian: &mut Matrix<3>) -> Result<(), Never> {
        let (back, forth, fast) = (1e4 * y[2], 1e4 * y[1], 6e7 * y[1]);
        *jacobian = [
            [-0.04, back, forth],
            [0.04, -back - fast, -forth],
            [0.0, fast, 0.0],
        ];
        Ok(())
    }
    fn scales(&self) -> [f64; 3] {
        // The tolerance is relative down to these.
        [1e-8, 1e-14, 1.0]
    }
}

/// A ball that falls on the floor and leaves it with 0.8 of its speed: height and speed.
#[derive(Default)]
pub(crate) struct Ball {
    pub(crate) bounces: Vec<f64>,
    /// Bounces after which the run stops.
    pub(crate) most: usize,
}

impl Ball {
    pub(crate) const GRAVITY: f64 = 9.81;
    pub(crate) const BACK: f64 = 0.8;

    /// Time of the bounce of this number, from 0, after a drop from 1 m.
    pub(crate) fn bounce(number: usize) -> f64 {
        let fall = (2.0 / Self::GRAVITY).sqrt();
        let mut t = fall;
        for bounce in 1..=number {
            t += 2.0 * fall * Self::BACK.powi(bounce as i32);
        }
        t
    }
}

impl System<2> for Ball {
    type Refusal = Never;
    fn derivative(&self, _: f64, y: &[f64; 2], dy: &mut [f64; 2]) -> Result<(), Never> {
        *dy = [y[1], -Self::GRAVITY];
        Ok(())
    }
    fn scales(&self) -> [f64; 2] {
        [1.0; 2]
    }
    fn positions(&self) -> &[(usize, usize)] {
        &[(0, 1)]
    }
    fn events(&self) -> usize {
        1
    }
    fn event_name(&self, _: usize) -> String {
        "floor".into()
    }
    fn direction(&self, _: usize) -> Option<Direction> {
        Some(Direction::Falling)
    }
    fn event_values(&self, _: f64, y: &[f64; 2], values: &mut [f64]) {
        values[0] = y[0];
    }
    fn at_event(&mut self, _: usize, t: f64, y: &mut [f64; 2]) -> Result<Action, Never> {
        self.bounces.push(t);
        y[1] *= -Self::BACK;
        let enough = self.bounces.len() >= self.most;
        Ok(if enough { Action::Stop } else { Action::Switch })
    }
}
