//! Dialogues over a port to a board, and their words for the user.

use crate::failure::CliError;
use crate::terminal::say;
use std::fmt::Display;
use std::sync::atomic::AtomicBool;
use std::time::Duration;
use trirrr_client::{Dialogue, Turn, describe, drive};
use trirrr_line::{LostLine, Port};
use trirrr_protocol::message::{Acting, Event, Message, State, Transmit};

/// Carries `dialogue` over `port` to its end. `stop` ends it early.
///
/// # Errors
/// Failed: the port, or no answer.
pub(crate) fn carry<N: Transmit, D: Dialogue<N>>(
    dialogue: &mut D,
    port: &mut Port,
    stop: &AtomicBool,
) -> Result<D::End, CliError> {
    drive(dialogue, port, stop).map_err(|why| CliError::Failed(why.to_string()))
}

/// Returns the words for the user while a line is opened anew that is lost for the reason `why`.
pub(crate) fn reopening(why: impl Display) -> String {
    format!("{why}; opening the port anew")
}

/// Dialogue that reports to the user: states of the machine, a line that is lost, the stop.
pub(crate) struct Reported<D> {
    dialogue: D,
    state: Option<(State, Acting)>,
}

impl<D> Reported<D> {
    pub(crate) fn new(dialogue: D) -> Self {
        Self {
            dialogue,
            state: None,
        }
    }
}

impl<N: Transmit, D: Dialogue<N>> Dialogue<N> for Reported<D> {
    type End = D::End;
    const LOOK: Duration = D::LOOK;

    fn poll(&mut self, now: Duration) -> Turn<N, Self::End> {
        self.dialogue.poll(now)
    }

    fn receive(&mut self, message: &Message<N>, now: Duration) {
        if let Message::Event(Event::State { state, acting, .. }) = message
            && self.state.replace((*state, *acting)) != Some((*state, *acting))
        {
            say(&describe::state(*state, *acting));
        }
        self.dialogue.receive(message, now);
    }

    fn stop(&mut self) {
        say("Ctrl-C: the machine stops on its path");
        self.dialogue.stop();
    }

    fn reconnected(&mut self) {
        self.dialogue.reconnected();
    }

    fn lost(&mut self, why: &LostLine, is_news: bool) {
        if is_news {
            say(&reopening(why));
        }
    }

    fn attend(&mut self, now: Duration) -> Option<Self::End> {
        self.dialogue.attend(now)
    }
}
