//! Progress of long jobs on standard error: a bar on a terminal, plain lines elsewhere.

use crate::terminal::{bar, say};
use indicatif::ProgressBar;
use std::io::{self, IsTerminal};
use std::time::{Duration, Instant};

/// Shorter jobs are over before there is something to tell.
const LONG: Duration = Duration::from_secs(2);
/// Plain lines come at most this often.
const LINES: Duration = Duration::from_secs(5);

/// Tells how far a run is.
pub(super) struct ProgressDisplay {
    start: Instant,
    /// When to say something next, before there is a bar.
    next: Instant,
    ticks: u64,
    on_terminal: bool,
    bar: Option<ProgressBar>,
}

impl ProgressDisplay {
    /// For a job of `ticks` records that will take `expected`, if that is known.
    pub(super) fn new(ticks: u64, expected: Option<Duration>) -> Self {
        let start = Instant::now();
        let on_terminal = io::stderr().is_terminal();
        // A job known to be long has its bar from the start; another one if it turns out so.
        let next = match expected {
            Some(expected) if expected > LONG && on_terminal => start,
            _ if on_terminal => start + LONG,
            _ => start + LINES,
        };
        Self {
            start,
            next,
            ticks,
            on_terminal,
            bar: None,
        }
    }

    /// `done` records are there, the last one of time `t`.
    pub(super) fn update(&mut self, done: u64, t: f64) {
        if let Some(bar) = &self.bar {
            bar.set_position(done);
            return;
        }
        let now = Instant::now();
        if now < self.next || done >= self.ticks {
            return;
        }
        if self.on_terminal {
            let template = "{elapsed_precise} {wide_bar} {percent:>3} %, {eta} left";
            let bar = bar(self.ticks, template);
            self.bar = Some(bar.with_elapsed(now - self.start));
        } else {
            self.next = now + LINES;
            let percent = 100 * done / self.ticks;
            say(&format!("{percent} %, t = {t:.3} s"));
        }
    }

    /// Leaves no bar behind.
    pub(super) fn finish(self) {
        if let Some(bar) = self.bar {
            bar.finish_and_clear();
        }
    }
}
