//! Commands of a user on their way to a machine.

use std::collections::VecDeque;
use trirrr_protocol::message::{Command, Transmit};

/// Command of the user while the machine moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UserCommand {
    /// Come to rest on the path.
    Hold,
    /// Go on.
    Resume,
    /// Come to rest on the path and drop the rest.
    Stop,
    /// Come to rest as by a stop, then switch the drives off.
    Disable,
    /// Play at so many percent of normal speed, 1 to 100, from now on.
    FeedOverride(u8),
}

impl<N: Transmit> From<UserCommand> for Command<N> {
    fn from(command: UserCommand) -> Self {
        match command {
            UserCommand::Hold => Self::Hold,
            UserCommand::Resume => Self::Resume,
            UserCommand::Stop => Self::Stop,
            UserCommand::Disable => Self::Disable,
            UserCommand::FeedOverride(percent) => Self::FeedOverride { percent },
        }
    }
}

/// Commands that the machine has not answered, the oldest first: a line that is lost, or a machine that is busy, takes none away.
#[derive(Clone, Debug, Default)]
pub(crate) struct UserCommands {
    waiting: VecDeque<UserCommand>,
    /// The oldest is on its way.
    is_asked: bool,
}

impl UserCommands {
    /// Adds a command of the user. A stop waits for none that was not asked, but for one that switches the drives off; of feed overrides the
    /// last counts.
    pub(crate) fn push(&mut self, command: UserCommand) {
        let outlasts = |waits: &UserCommand| match command {
            UserCommand::Disable => false,
            UserCommand::Stop => *waits == UserCommand::Disable,
            UserCommand::FeedOverride(_) => !matches!(waits, UserCommand::FeedOverride(_)),
            UserCommand::Hold | UserCommand::Resume => true,
        };
        let mut is_asked = self.is_asked;
        self.waiting
            .retain(|waits| std::mem::take(&mut is_asked) || outlasts(waits));
        self.waiting.push_back(command);
    }

    /// Returns true if the machine has answered all of them.
    pub(crate) fn is_empty(&self) -> bool {
        self.waiting.is_empty()
    }

    /// Returns the next command to ask, which is on its way from now on.
    pub(crate) fn ask(&mut self) -> Option<UserCommand> {
        let next = self.waiting.front().filter(|_| !self.is_asked).copied();
        self.is_asked |= next.is_some();
        next
    }

    /// The machine has answered `command`: it is over if it was the user's.
    pub(crate) fn settle<N: Transmit>(&mut self, command: &Command<N>) {
        let is_asked = |asked: &UserCommand| Command::from(*asked) == *command;
        if self.is_asked && self.waiting.front().is_some_and(is_asked) {
            self.waiting.pop_front();
            self.is_asked = false;
        }
    }

    /// Commands on their way may not have come, or were not taken: they are asked again.
    pub(crate) fn recall(&mut self) {
        self.is_asked = false;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn waiting(commands: &[UserCommand], asked: bool) -> Vec<UserCommand> {
        let mut waits = UserCommands::default();
        for (index, command) in commands.iter().enumerate() {
            waits.push(*command);
            if asked && index == 0 {
                assert_eq!(waits.ask(), Some(*command));
            }
        }
        waits.waiting.into()
    }

    #[test]
    fn a_stop_waits_for_what_was_asked_alone() {
        use UserCommand::*;
        let feeds = [FeedOverride(50), FeedOverride(40), FeedOverride(30)];
        assert_eq!(waiting(&feeds, false), [FeedOverride(30)]);
        assert_eq!(waiting(&feeds, true), [FeedOverride(50), FeedOverride(30)]);
        let stop = [Hold, Resume, FeedOverride(40), Stop];
        assert_eq!(waiting(&stop, false), [Stop]);
        assert_eq!(waiting(&stop, true), [Hold, Stop]);
        assert_eq!(waiting(&[Hold, Disable, Stop], false), [Disable, Stop]);
        assert_eq!(waiting(&[Stop, Hold, Disable], false), [Disable]);
        assert_eq!(waiting(&[Hold, Resume, Hold], false), [Hold, Resume, Hold]);
    }
}
