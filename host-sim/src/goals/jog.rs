//! Steps and velocities by hand.

use super::lines::{listen, numbers, standard_input};
use super::session::{GoalSession, GoalSi, Goals};
use crate::failure::CliError;
use crate::stream::user_command;
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
    read: u64,
    /// Lines that are none, and the last of them with the reason.
    left_out: u64,
    reason: String,
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
    /// The machine has no motion there: it waits for another velocity.
    is_blocked: bool,
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
            read: 0,
            left_out: 0,
            reason: String::new(),
        }
    }

    fn obey<N: ServiceNumber>(
        &mut self,
        line: JogLine,
        session: &mut GoalSession<'_, N>,
        now: Duration,
    ) {
        match line {
            JogLine::User(UserCommand::Stop) => {
                self.speed = None;
                session.rest();
            }
            JogLine::User(command) => session.command(command),
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
                        is_blocked: false,
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
            if !speed.is_blocked {
                session.rest();
            }
            self.speed = None;
            return;
        }
        // The line is slower than the goals: the newest counts.
        if now < speed.next || session.is_wanting() || speed.is_blocked {
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
        // The next line starts where this one leads to: behind a stop that is where the machine stands.
        while session.end().is_some() {
            match self.lines.try_recv() {
                Ok(line) => {
                    self.read += 1;
                    match read(line.trim()) {
                        Ok(Some(line)) => self.obey(line, session, now),
                        Ok(None) => {}
                        Err(reason) => {
                            self.left_out += 1;
                            self.reason = format!("line {}: {reason}", self.read);
                            say(&self.reason);
                        }
                    }
                }
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

    /// At the edge of the workspace: the machine stops on its path, and the velocity waits for another one.
    fn refused<N: ServiceNumber>(&mut self, session: &mut GoalSession<'_, N>) {
        if let Some(speed) = &mut self.speed
            && !std::mem::replace(&mut speed.is_blocked, true)
        {
            session.rest();
        }
    }

    fn verdict(&self) -> Result<(), CliError> {
        match self.left_out {
            0 => Ok(()),
            count => Err(CliError::Refused(format!(
                "{count} of {} lines left out, last {}",
                self.read, self.reason
            ))),
        }
    }
}

/// The line, none where it is empty, or the reason why it is none.
fn read(line: &str) -> Result<Option<JogLine>, String> {
    if let Some(command) = user_command(line) {
        return Ok(Some(JogLine::User(command)));
    }
    let (word, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
    let values = numbers(rest).unwrap_or_default();
    match (word, &values[..]) {
        ("", _) => Ok(None),
        ("step" | "speed", &[x, y] | &[x, y, _]) => {
            let by = [x, y, values.get(2).copied().unwrap_or(0.0)];
            Ok(Some(match word {
                "step" => JogLine::Step(by),
                _ => JogLine::Speed(by),
            }))
        }
        ("step", _) => Err(format!(
            "`{line}`: give step DX DY [DALPHA], 2 or 3 numbers in m and rad"
        )),
        ("speed", _) => Err(format!(
            "`{line}`: give speed VX VY [VALPHA], 2 or 3 numbers in m/s and rad/s"
        )),
        ("feed" | "f", _) => Err(format!(
            "`{line}`: give feed PERCENT, a whole number from 1 to 100"
        )),
        _ => Err(format!(
            "`{line}` is no line of a jog: they are step DX DY [DALPHA], speed VX VY [VALPHA], hold, resume, stop, disable and feed PERCENT"
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_read() {
        let some = |line| Ok(Some(line));
        assert_eq!(
            read("step 0.01 -0.02"),
            some(JogLine::Step([0.01, -0.02, 0.0]))
        );
        assert_eq!(
            read("speed 0.01,0,0.1"),
            some(JogLine::Speed([0.01, 0.0, 0.1]))
        );
        assert_eq!(read("stop"), some(JogLine::User(UserCommand::Stop)));
        assert_eq!(
            read("feed 50"),
            some(JogLine::User(UserCommand::FeedOverride(50)))
        );
        assert_eq!(read(""), Ok(None));
    }

    #[test]
    fn a_line_that_is_none_is_told_what_it_lacks() {
        for (line, what) in [
            ("step", "step DX DY"),
            ("step 1", "step DX DY"),
            ("step 1 2 3 4", "step DX DY"),
            ("step nan 0", "step DX DY"),
            ("speed a b", "speed VX VY"),
            ("feed 101", "from 1 to 100"),
            ("feed", "from 1 to 100"),
            ("go 1 2", "hold, resume, stop, disable"),
            ("spede", "hold, resume, stop, disable"),
        ] {
            let reason = read(line).expect_err(line);
            assert!(reason.contains(line) && reason.contains(what), "{reason}");
        }
    }
}
