//! Goals from lines of poses.

use super::args::FollowArgs;
use super::lines::{is_skipped, listen, numbers, standard_input};
use super::session::{GoalSession, GoalSi, Goals};
use crate::failure::CliError;
use std::io::{BufRead, BufReader};
use std::sync::mpsc::{Receiver, TryRecvError};
use std::time::Duration;
use trirrr_scene::read::files;
use trirrr_service::ServiceNumber;

/// Longest time between poses that the motion takes into account, s.
const LONGEST_BETWEEN_S: f64 = 1.0;

/// Poses as they come, or one after the other in time.
pub(super) struct Poses {
    lines: Receiver<String>,
    every: Option<Duration>,
    next: Duration,
    /// Time of the last pose.
    last: Duration,
    read: u64,
    is_over: bool,
}

impl Poses {
    /// # Errors
    /// Refused: the file cannot be opened.
    pub(super) fn open(args: &FollowArgs) -> Result<Self, CliError> {
        let lines = match &args.poses {
            None => listen(standard_input),
            Some(path) => {
                let file = files::open(path)
                    .map_err(|error| CliError::Refused(format!("{}: {error}", path.display())))?;
                listen(move || -> Box<dyn BufRead> { Box::new(BufReader::new(file)) })
            }
        };
        Ok(Self {
            lines,
            every: args.every.map(Duration::from_secs_f64),
            next: Duration::ZERO,
            last: Duration::ZERO,
            read: 0,
            is_over: false,
        })
    }

    /// The goal of a line; `alpha_rad` where the line has none. One in motion is passed in `moving_s`.
    fn goal(&self, line: &str, alpha_rad: f64, moving_s: f64) -> Result<GoalSi, CliError> {
        let values = numbers(line).unwrap_or_default();
        let (pose, velocity) = match values[..] {
            [x, y] => ([x, y, alpha_rad], [0.0; 3]),
            [x, y, alpha] => ([x, y, alpha], [0.0; 3]),
            [x, y, alpha, vx, vy, valpha] => ([x, y, alpha], [vx, vy, valpha]),
            _ => {
                return Err(CliError::Refused(format!(
                    "pose {}: `{}` is not x, y, alpha and their velocity: give 2, 3 or 6 numbers",
                    self.read,
                    line.trim()
                )));
            }
        };
        Ok(GoalSi {
            pose,
            velocity,
            least_s: if velocity == [0.0; 3] { 0.0 } else { moving_s },
        })
    }

    /// Time to a pose in motion, s: in twice the time between poses the next one is there, and what is left is enough to stop in.
    fn moving_s(&self, now: Duration, ramp_s: f64) -> f64 {
        let between = self.every.unwrap_or(now.saturating_sub(self.last));
        (2.0 * between.as_secs_f64().min(LONGEST_BETWEEN_S)).max(2.0 * ramp_s)
    }
}

impl Goals for Poses {
    fn want<N: ServiceNumber>(
        &mut self,
        session: &mut GoalSession<'_, N>,
        now: Duration,
    ) -> Result<(), CliError> {
        let Some([_, _, alpha_rad]) = session.end() else {
            return Ok(());
        };
        while !self.is_over && now >= self.next {
            match self.lines.try_recv() {
                Ok(line) if is_skipped(&line) => {}
                Ok(line) => {
                    self.read += 1;
                    let moving_s = self.moving_s(now, session.ramp_s());
                    session.aim(&self.goal(&line, alpha_rad, moving_s)?);
                    self.last = now;
                    if let Some(every) = self.every {
                        self.next = now + every;
                    }
                }
                Err(TryRecvError::Empty) => return Ok(()),
                Err(TryRecvError::Disconnected) => {
                    self.is_over = true;
                    session.finish();
                }
            }
        }
        Ok(())
    }
}
