//! Steps and velocities by hand.

use super::lines::{listen, numbers, standard_input};
use super::session::{GoalSession, GoalSi, Goals};
use crate::failure::CliError;
use crate::stream::{key_complaint, user_command};
use crate::terminal::say;
use std::sync::mpsc::{Receiver, TryRecvError};
use std::time::Duration;
use trirrr_client::UserCommand;
use trirrr_service::ServiceNumber;

/// From one goal of a velocity to the next.
const EVERY: Duration = Duration::from_millis(50);

/// A goal of a velocity lies so many stops ahead: the machine must be able to come to rest before it.
const STOPS_AHEAD: f64 = 3.0;

/// Least time of a goal of a velocity, s.
const LEAST_AHEAD_S: f64 = 0.2;

/// Lines of a user.
pub(super) struct Jog {
    lines: Receiver<String>,
    renew: Duration,
    speed: Option<Speed>,
    is_over: bool,
}

/// Velocity under way.
struct Speed {
    velocity: [f64; 3],
    /// Pose from which it counts, and the time there.
    from: [f64; 3],
    at_s: f64,
    /// End of it, and time of the next goal.
    until: Duration,
    next: Duration,
}

/// A line of a user.
#[derive(Clone, Copy, Debug, PartialEq)]
enum JogLine {
    Step([f64; 3]),
    Speed([f64; 3]),
    User(UserCommand),
}

impl Jog {
    pub(super) fn new(renew_s: f64) -> Self {
        Self {
            lines: listen(standard_input),
            renew: Duration::from_secs_f64(renew_s),
            speed: None,
            is_over: false,
        }
    }

    fn obey<N: ServiceNumber>(
        &mut self,
        line: JogLine,
        session: &mut GoalSession<'_, N>,
        now: Duration,
    ) {
        match line {
            JogLine::User(command) => {
                if command == UserCommand::Stop {
                    self.speed = None;
                }
                session.command(command);
            }
            JogLine::Step(by) => {
                self.speed = None;
                if let Some(end) = session.end() {
                    let pose = [0, 1, 2].map(|axis| end[axis] + by[axis]);
                    session.aim(&GoalSi {
                        pose,
                        velocity: [0.0; 3],
                        least_s: 0.0,
                    });
                }
            }
            JogLine::Speed(velocity) => match &mut self.speed {
                Some(speed) if speed.velocity == velocity => speed.until = now + self.renew,
                _ => {
                    // From rest it falls behind by half of the time to the first goal.
                    let behind = ahead_s(session.ramp_s()) / 2.0;
                    self.speed = session.end().map(|from| Speed {
                        velocity,
                        from,
                        at_s: now.as_secs_f64() + behind,
                        until: now + self.renew,
                        next: now,
                    });
                }
            },
        }
    }

    /// The next goal of a velocity, or its end.
    fn go_on<N: ServiceNumber>(&mut self, session: &mut GoalSession<'_, N>, now: Duration) {
        let Some(speed) = &mut self.speed else {
            return;
        };
        if now >= speed.until {
            self.speed = None;
            session.command(UserCommand::Stop);
            return;
        }
        // The line is slower than the goals: the newest counts.
        if now < speed.next || session.is_wanting() {
            return;
        }
        speed.next = now + EVERY;
        let ahead = ahead_s(session.ramp_s());
        let time = now.as_secs_f64() + ahead - speed.at_s;
        session.aim(&GoalSi {
            pose: [0, 1, 2].map(|axis| speed.from[axis] + speed.velocity[axis] * time),
            velocity: speed.velocity,
            least_s: ahead,
        });
    }
}

/// Time from a goal of a velocity to its pose, s.
fn ahead_s(ramp_s: f64) -> f64 {
    (STOPS_AHEAD * ramp_s).max(LEAST_AHEAD_S)
}

impl Goals for Jog {
    fn want<N: ServiceNumber>(
        &mut self,
        session: &mut GoalSession<'_, N>,
        now: Duration,
    ) -> Result<(), CliError> {
        // Before the first status there is no pose to start from.
        if session.end().is_none() {
            return Ok(());
        }
        loop {
            match self.lines.try_recv() {
                Ok(line) => match read(&line) {
                    Some(line) => self.obey(line, session, now),
                    None if line.trim().is_empty() => {}
                    None => say(&complaint(&line)),
                },
                Err(TryRecvError::Empty) => break,
                Err(TryRecvError::Disconnected) => {
                    if !self.is_over && self.speed.is_none() {
                        self.is_over = true;
                        session.finish();
                    }
                    break;
                }
            }
        }
        self.go_on(session, now);
        Ok(())
    }
}

/// Says what is wrong with a line.
fn complaint(line: &str) -> String {
    let word = line.split_whitespace().next().unwrap_or_default();
    match word {
        "step" => "step takes two or three finite numbers, m, m and rad: step 0.001 0".into(),
        "speed" => "speed takes two or three finite numbers, m/s, m/s and rad/s: speed 0.01 0".into(),
        _ => key_complaint(line).unwrap_or_else(|| {
            "lines are step DX DY [DALPHA], speed VX VY [VALPHA], hold, resume, stop, disable and feed PERCENT".into()
        }),
    }
}

fn read(line: &str) -> Option<JogLine> {
    if let Some(command) = user_command(line) {
        return Some(JogLine::User(command));
    }
    let (word, rest) = line.trim().split_once(char::is_whitespace)?;
    let by = match numbers(rest)?[..] {
        [x, y] => [x, y, 0.0],
        [x, y, alpha] => [x, y, alpha],
        _ => return None,
    };
    match word {
        "step" => Some(JogLine::Step(by)),
        "speed" => Some(JogLine::Speed(by)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_read() {
        assert_eq!(
            read("step 0.01 -0.02"),
            Some(JogLine::Step([0.01, -0.02, 0.0]))
        );
        assert_eq!(
            read("speed 0.01,0,0.1"),
            Some(JogLine::Speed([0.01, 0.0, 0.1]))
        );
        assert_eq!(read(" stop\r"), Some(JogLine::User(UserCommand::Stop)));
        assert_eq!(
            read("feed 50"),
            Some(JogLine::User(UserCommand::FeedOverride(50)))
        );
        for line in ["step", "step 1", "step 1 2 3 4", "go 1 2", "step a b"] {
            assert_eq!(read(line), None, "{line}");
        }
    }
}
