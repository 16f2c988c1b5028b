//! Line to a machine: requests out, messages in.

use std::io;
use std::time::Duration;
use trirrr_protocol::message::{Message, Reply, Request, Transmit};

/// Reason why a line is lost.
#[derive(Debug, thiserror::Error)]
pub enum LostLine {
    /// The machine answers no request.
    #[error("the board does not answer")]
    Silent,
    /// The port has failed.
    #[error(transparent)]
    Broken(#[from] io::Error),
    /// The port is not open, for this reason.
    #[error("{0}")]
    NotOpen(String),
}

/// State of a line that is opened anew.
#[derive(Debug)]
pub enum Reopening {
    /// The line is open.
    Open,
    /// An attempt is under way, or is not due yet.
    Pending,
    /// An attempt has failed for this reason. A later one may succeed.
    Failed(LostLine),
    /// No attempt follows, for this reason.
    GivenUp(LostLine),
}

/// Line to a machine, with the clock of its dialogue.
pub trait Line<N: Transmit> {
    /// Returns the time since any start.
    fn now(&self) -> Duration;

    /// Sends a request.
    ///
    /// # Errors
    /// The line is lost.
    fn send(&mut self, request: &Request<N>) -> Result<(), LostLine>;

    /// Waits up to `timeout` for something to come. Returns it.
    ///
    /// # Errors
    /// The line is lost.
    fn receive(&mut self, timeout: Duration) -> Result<Vec<Message<N>>, LostLine>;

    /// Opens the line anew, step by step: each call waits some milliseconds at most. `why`: the reason of the loss.
    /// `is_stopped`: the user does not want to wait any longer.
    fn reopen(&mut self, why: &LostLine, is_stopped: bool) -> Reopening;

    /// Returns true if the line was opened. A line that was not is opened by the owner.
    fn is_open(&self) -> bool {
        true
    }
}

/// Returns true for a sign of the machine: one that says hello and then nothing is as good as silent.
pub fn is_answer<N: Transmit>(message: &Message<N>) -> bool {
    match message {
        Message::Reply { reply, .. } => !matches!(reply, Reply::Hello(_)),
        _ => false,
    }
}
