//! One goal.

use super::args::GotoArgs;
use super::session::{GoalSession, GoalSi, Goals};
use crate::failure::CliError;
use std::time::Duration;
use trirrr_service::ServiceNumber;

/// One pose.
pub(super) struct OneGoal {
    x_m: f64,
    y_m: f64,
    alpha_rad: Option<f64>,
    is_asked: bool,
}

impl OneGoal {
    pub(super) fn new(args: &GotoArgs) -> Self {
        Self {
            x_m: args.x,
            y_m: args.y,
            alpha_rad: args.alpha,
            is_asked: false,
        }
    }
}

impl Goals for OneGoal {
    fn want<N: ServiceNumber>(
        &mut self,
        session: &mut GoalSession<'_, N>,
        _: Duration,
    ) -> Result<(), CliError> {
        let Some([_, _, stands]) = session.end().filter(|_| !self.is_asked) else {
            return Ok(());
        };
        self.is_asked = true;
        session.aim(&GoalSi {
            pose: [self.x_m, self.y_m, self.alpha_rad.unwrap_or(stands)],
            velocity: [0.0; 3],
            least_s: 0.0,
        });
        session.finish();
        Ok(())
    }
}
