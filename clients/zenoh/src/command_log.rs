//! Commands of each client, by their numbers: each is executed once, and a repeated one gets the same answer.

use crate::answer::CommandOutcome;
use std::collections::{BTreeMap, VecDeque};

/// Answers that are kept for each client.
const KEPT: usize = 64;

/// Clients that are remembered.
const CLIENTS: usize = 256;

/// Meaning of a number that has come.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum NumberEntry {
    /// It is the next one: execute it, then [`CommandLog::answered`].
    New,
    /// It was executed, with this outcome.
    Repeated(CommandOutcome),
    /// It is being executed: its answer goes to this query, too.
    Open,
    /// It is refused, and does not count.
    Wrong(String),
}

/// A command of a client.
#[derive(Clone, Debug)]
struct Logged {
    number: u64,
    /// Verb and payload.
    text: String,
    outcome: Option<CommandOutcome>,
}

/// Commands of one client.
#[derive(Clone, Debug, Default)]
struct ClientLog {
    /// Number of the next command.
    next: u64,
    kept: VecDeque<Logged>,
    /// Order of its last command among those of all clients.
    used: u64,
}

/// Commands of all clients since the program was started.
#[derive(Clone, Debug, Default)]
pub(crate) struct CommandLog {
    clients: BTreeMap<String, ClientLog>,
    used: u64,
}

impl CommandLog {
    /// Greets `client`. Returns the number of its next command.
    pub(crate) fn greet(&mut self, client: &str) -> u64 {
        self.used += 1;
        if !self.clients.contains_key(client) && self.clients.len() >= CLIENTS {
            // A client that was forgotten is told to say hello.
            let oldest = self.clients.iter().min_by_key(|(_, log)| log.used);
            if let Some(name) = oldest.map(|(name, _)| name.clone()) {
                self.clients.remove(&name);
            }
        }
        let log = self.clients.entry(client.into()).or_insert(ClientLog {
            next: 1,
            ..ClientLog::default()
        });
        log.used = self.used;
        log.next
    }

    /// Takes note of the command `number` of `client`; `text` is its verb and payload.
    pub(crate) fn enter(&mut self, client: &str, number: u64, text: &str) -> NumberEntry {
        self.used += 1;
        let Some(log) = self.clients.get_mut(client) else {
            return NumberEntry::Wrong(format!("{client} is not known: say hello first"));
        };
        log.used = self.used;
        if let Some(logged) = log.kept.iter().find(|logged| logged.number == number) {
            return match &logged.outcome {
                _ if logged.text != text => NumberEntry::Wrong(format!(
                    "number {number} was used for another command: are there two clients {client}?"
                )),
                Some(outcome) => NumberEntry::Repeated(outcome.clone()),
                None => NumberEntry::Open,
            };
        }
        if number != log.next {
            return NumberEntry::Wrong(format!(
                "number {number} is not the next, {} is: are there two clients {client}?",
                log.next
            ));
        }
        log.next += 1;
        if log.kept.len() >= KEPT {
            log.kept.pop_front();
        }
        log.kept.push_back(Logged {
            number,
            text: text.into(),
            outcome: None,
        });
        NumberEntry::New
    }

    /// Takes note of the outcome of the command `number` of `client`.
    pub(crate) fn answered(&mut self, client: &str, number: u64, outcome: &CommandOutcome) {
        let log = self.clients.get_mut(client);
        let kept = log.and_then(|log| log.kept.iter_mut().find(|kept| kept.number == number));
        if let Some(kept) = kept {
            kept.outcome = Some(outcome.clone());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_is_executed_once_and_answered_as_often_as_asked() {
        let mut log = CommandLog::default();
        assert_eq!(log.greet("a"), 1);
        assert_eq!(log.enter("a", 1, "jog {}"), NumberEntry::New);
        assert_eq!(log.enter("a", 1, "jog {}"), NumberEntry::Open);
        let refused = CommandOutcome::refused("no");
        log.answered("a", 1, &refused);
        for _ in 0..3 {
            assert_eq!(
                log.enter("a", 1, "jog {}"),
                NumberEntry::Repeated(refused.clone())
            );
        }
        assert!(matches!(
            log.enter("a", 1, "home {}"),
            NumberEntry::Wrong(_)
        ));
        assert!(matches!(log.enter("a", 3, "jog {}"), NumberEntry::Wrong(_)));
        // A hello changes nothing: the client goes on where it is.
        assert_eq!(log.greet("a"), 2);
        assert_eq!(log.enter("a", 2, "jog {}"), NumberEntry::New);
        assert!(matches!(log.enter("b", 1, "jog {}"), NumberEntry::Wrong(_)));
    }

    #[test]
    fn numbers_older_than_what_is_kept_are_refused_and_never_executed() {
        let mut log = CommandLog::default();
        log.greet("a");
        for number in 1..=2 * KEPT as u64 {
            assert_eq!(log.enter("a", number, "stop"), NumberEntry::New);
            log.answered("a", number, &CommandOutcome::Accepted);
        }
        for number in 1..=KEPT as u64 {
            let entry = log.enter("a", number, "stop");
            assert!(
                matches!(entry, NumberEntry::Wrong(_)),
                "{number}: {entry:?}"
            );
        }
        let last = log.enter("a", KEPT as u64 + 1, "stop");
        assert_eq!(last, NumberEntry::Repeated(CommandOutcome::Accepted));
    }

    #[test]
    fn the_client_that_was_silent_longest_is_forgotten() {
        let mut log = CommandLog::default();
        for client in 0..=CLIENTS {
            log.greet(&client.to_string());
            log.enter("1", 1, "stop");
        }
        assert!(matches!(log.enter("0", 1, "stop"), NumberEntry::Wrong(_)));
        assert_eq!(log.enter("1", 1, "stop"), NumberEntry::Open);
        assert_eq!(log.clients.len(), CLIENTS);
    }
}
