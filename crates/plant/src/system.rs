//! The plant as the integrators see it.

use crate::model::Plant;
use crate::motor::MotorModel;
use crate::refusal::Refusal;
use crate::watch::Watch;
use trirrr_integrate::{Action, Direction, Matrix, System};

impl<const N: usize> System<N> for Plant<N> {
    type Refusal = Refusal;

    #[inline]
    fn derivative(&self, t: f64, y: &[f64; N], dy: &mut [f64; N]) -> Result<(), Refusal> {
        self.slope(t, y, dy)
    }

    fn jacobian(&self, t: f64, y: &[f64; N], jacobian: &mut Matrix<N>) -> Result<(), Refusal> {
        self.slope_jacobian(t, y, jacobian)
    }

    fn scales(&self) -> [f64; N] {
        // Of the coordinates x, y and alpha. They are a little strict for angles of a leading leg,
        // in rad instead of parts of the machine's size.
        let mut scales = [1.0; N];
        let size = self.mechanics.size();
        for axis in [0, 1, 3, 4] {
            scales[axis] = size;
        }
        if Self::LAYOUT.currents {
            for (leg, motor) in self.motors.iter().enumerate() {
                if let MotorModel::Bldc(winding) = motor {
                    // What the supply could drive through the winding: currents jump towards it with
                    // every sample, and a motion integrates them twice.
                    scales[Self::LAYOUT.current() + leg] = winding.supply / winding.resistance;
                }
            }
        }
        // Recorded only.
        scales[N - 2] = f64::INFINITY;
        scales[N - 1] = f64::INFINITY;
        scales
    }

    fn positions(&self) -> &[(usize, usize)] {
        Self::LAYOUT.positions()
    }

    fn events(&self) -> usize {
        self.watches.len()
    }

    fn event_name(&self, event: usize) -> String {
        self.watches[event].to_string()
    }

    fn direction(&self, event: usize) -> Option<Direction> {
        let watch = self.watches[event];
        self.is_watched(watch).then_some(match watch {
            Watch::Serial(_) | Watch::Lead(_) => Direction::Falling,
            Watch::Release | Watch::MoveEnd | Watch::FollowingError(_) => Direction::Rising,
            _ => Direction::Either,
        })
    }

    fn event_values(&self, t: f64, y: &[f64; N], values: &mut [f64]) {
        self.watch_values(t, y, values);
    }

    fn at_event(&mut self, event: usize, t: f64, y: &mut [f64; N]) -> Result<Action, Refusal> {
        let ends = self.meet(self.watches[event], t, y)?;
        Ok(match self.watches[event] {
            _ if ends => Action::Stop,
            // The field is a sine: nothing changes in the equations.
            Watch::Slip(_) => Action::Continue,
            _ => Action::Switch,
        })
    }
}
