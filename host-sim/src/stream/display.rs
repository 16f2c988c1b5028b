//! Display of a stream on standard error: changes as lines; on a terminal a bar with the latest
//! values, elsewhere a line now and then.

use crate::terminal::{bar, message, say};
use indicatif::ProgressBar;
use std::io::{self, IsTerminal};
use std::time::{Duration, Instant};
use trirrr_client::describe;
use trirrr_protocol::message::{Acting, State};
use trirrr_scene::record::Record;

/// Without a terminal, values come at most this often.
const LINES: Duration = Duration::from_secs(5);

/// Display of a stream under way.
pub(super) struct Display {
    ticks: u64,
    /// The scene computes torques.
    torque: bool,
    bar: Option<ProgressBar>,
    /// Time at which the next line with values is due.
    next: Instant,
    state: Option<(State, Acting)>,
    /// The user can give commands.
    has_keys: bool,
}

impl Display {
    /// Shows a job of `ticks` of a scene with or without `torque`.
    pub(super) fn new(ticks: u64, torque: bool) -> Self {
        let on_terminal = io::stderr().is_terminal();
        let bar = || bar(ticks, "{wide_bar} {percent:>3} %, {eta} left\n{msg}");
        Self {
            ticks,
            torque,
            bar: on_terminal.then(bar),
            next: Instant::now() + LINES,
            state: None,
            has_keys: false,
        }
    }

    /// Says which keys lead on, for a user who `has_keys`.
    pub(super) fn with_keys(self, has_keys: bool) -> Self {
        Self { has_keys, ..self }
    }

    /// Says something.
    pub(super) fn note(&self, text: &str) {
        match &self.bar {
            Some(bar) => bar.println(message(text)),
            None => say(text),
        }
    }

    /// The machine is in this state.
    pub(super) fn state(&mut self, state: State, acting: Acting) {
        if self.state.replace((state, acting)) != Some((state, acting)) {
            let text = describe::state(state, acting);
            match (state, acting) {
                (State::Holding, Acting::Hold) if self.has_keys => {
                    self.note(&format!("{text}: r goes on"));
                }
                (State::Holding, Acting::Door) if self.has_keys => {
                    self.note(&format!("{text}: close the door, then r goes on"));
                }
                _ => self.note(&text),
            }
        }
    }

    /// The latest values; `at` ticks of the job are over. `queued` are the moves that the machine holds, and the most that it
    /// holds.
    pub(super) fn values(&mut self, at: u64, record: &Record, queued: Option<[u16; 2]>) {
        if let Some(bar) = &self.bar {
            bar.set_position(at);
            bar.set_message(values(record, self.torque, queued));
            return;
        }
        let now = Instant::now();
        if now >= self.next {
            self.next = now + LINES;
            let percent = 100 * at / self.ticks.max(1);
            let values = values(record, self.torque, queued);
            self.note(&format!("{percent} %, {values}"));
        }
    }

    /// Leaves no bar behind.
    pub(super) fn finish(self) {
        if let Some(bar) = self.bar {
            bar.finish_and_clear();
        }
    }
}

/// One line of values.
fn values(record: &Record, torque: bool, queued: Option<[u16; 2]>) -> String {
    let [x, y, alpha] = record.pose;
    let [vx, vy, _] = record.velocity;
    let torques = match (torque, record.legs.map(|leg| leg.torque)) {
        (true, [t1, t2, t3]) => format!(" torques {t1:.4} {t2:.4} {t3:.4} N m,"),
        (false, _) => String::new(),
    };
    let queued = queued.map_or(String::new(), |[held, most]| {
        format!(", {held} of {most} moves queued")
    });
    format!(
        "t {:.3} s, x {x:.4} m, y {y:.4} m, alpha {alpha:.4} rad, {:.4} m/s,{torques} tool {:.0} %{queued}",
        record.t,
        vx.hypot(vy),
        100.0 * record.tool
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_stand_with_their_units() {
        let record = Record {
            t: 1.25,
            pose: [0.25, -0.5, 1.0],
            velocity: [0.03, -0.04, 1.0],
            tool: 0.6,
            ..Record::default()
        };
        assert_eq!(
            values(&record, true, None),
            "t 1.250 s, x 0.2500 m, y -0.5000 m, alpha 1.0000 rad, 0.0500 m/s, \
             torques 0.0000 0.0000 0.0000 N m, tool 60 %"
        );
        assert_eq!(
            values(&record, false, Some([200, 256])),
            "t 1.250 s, x 0.2500 m, y -0.5000 m, alpha 1.0000 rad, 0.0500 m/s, tool 60 %, \
             200 of 256 moves queued"
        );
    }
}
