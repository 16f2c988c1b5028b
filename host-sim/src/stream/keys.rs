//! Commands of a user on standard input.

use crate::terminal::say;
use std::io::{self, BufRead};
use std::sync::mpsc::{Receiver, channel};
use trirrr_client::UserCommand;

/// Reads lines from standard input as long as there are any, on a thread of its own: a read cannot
/// be waited for in pieces. The thread ends with the program.
pub(super) fn listen() -> Receiver<UserCommand> {
    let (sender, receiver) = channel();
    std::thread::spawn(move || {
        for line in io::stdin().lock().lines() {
            let Ok(line) = line else { return };
            match user_command(&line) {
                Some(ask) if sender.send(ask).is_err() => return,
                Some(_) => {}
                None if line.trim().is_empty() => {}
                None => {
                    say("keys are hold, resume, stop, disable and feed PERCENT (h, r, s, d, f)");
                }
            }
        }
    });
    receiver
}

/// The command of a line, if it is one.
pub(crate) fn user_command(line: &str) -> Option<UserCommand> {
    match line.trim() {
        "hold" | "h" => Some(UserCommand::Hold),
        "resume" | "r" => Some(UserCommand::Resume),
        "stop" | "s" => Some(UserCommand::Stop),
        "disable" | "d" => Some(UserCommand::Disable),
        line => {
            let (word, percent) = line.split_once(char::is_whitespace)?;
            let percent = percent.trim().parse().ok()?;
            let is_feed = matches!(word, "feed" | "f") && (1..=100).contains(&percent);
            is_feed.then_some(UserCommand::FeedOverride(percent))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_and_letters_mean_the_same() {
        for (line, ask) in [
            ("hold", Some(UserCommand::Hold)),
            (" h ", Some(UserCommand::Hold)),
            ("resume\r", Some(UserCommand::Resume)),
            ("r", Some(UserCommand::Resume)),
            ("d", Some(UserCommand::Disable)),
            ("stop", Some(UserCommand::Stop)),
            ("s", Some(UserCommand::Stop)),
            ("feed 50", Some(UserCommand::FeedOverride(50))),
            ("f  100", Some(UserCommand::FeedOverride(100))),
            ("feed 0", None),
            ("feed 101", None),
            ("feed", None),
            ("halt", None),
            ("", None),
        ] {
            assert_eq!(user_command(line), ask, "{line:?}");
        }
    }
}
