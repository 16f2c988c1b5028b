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

/// Poses as they come, or one after the other in time.
pub(super) struct Poses {
    lines: Receiver<String>,
    every: Option<Duration>,
    next: Duration,
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
            read: 0,
            is_over: false,
        })
    }

    /// The goal of a line; `alpha_rad` where the line has none.
    fn goal(&self, line: &str, alpha_rad: f64) -> Result<GoalSi, CliError> {
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
            least_s: 0.0,
        })
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
                    session.aim(&self.goal(&line, alpha_rad)?);
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
