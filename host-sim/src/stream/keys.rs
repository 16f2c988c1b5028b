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
                None => say(&key_complaint(&line).unwrap_or_else(|| {
                    "keys are hold, resume, stop, disable and feed PERCENT (h, r, s, d, f)".into()
                })),
            }
        }
    });
    receiver
}

/// Says what is wrong with a line of a key that is known.
fn key_complaint(line: &str) -> Option<String> {
    let word = line.split_whitespace().next()?;
    let is_feed = matches!(word, "feed" | "f") && user_command(line).is_none();
    is_feed
        .then(|| format!("{word} takes a whole number of percent from 1 to 100, such as {word} 50"))
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
        for line in ["f", "f 0", "feed 101", "feed x"] {
            assert!(key_complaint(line).unwrap().contains("from 1 to 100"));
        }
        assert_eq!(key_complaint("f 50").or(key_complaint("halt")), None);
    }
}
