//! Answers to commands.

use serde_json::{Value, json};

/// CommandOutcome of a command.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum CommandOutcome {
    /// The machine has taken it.
    Accepted,
    /// Nothing was done, for this reason.
    Refused(String),
    /// The machine may have executed it or not: the state tells.
    Unknown(String),
}

impl CommandOutcome {
    pub(crate) fn refused(why: impl Into<String>) -> Self {
        Self::Refused(why.into())
    }

    /// Payload of the answer to the command `number` of `client`.
    pub(crate) fn answer(&self, client: &str, number: u64) -> String {
        let (outcome, text) = self.parts();
        json!({ "client": client, "seq": number, "outcome": outcome, "text": text }).to_string()
    }

    /// Payload of the answer to a query that is no command of a client.
    pub(crate) fn plain(&self) -> String {
        let (outcome, text) = self.parts();
        json!({ "outcome": outcome, "text": text }).to_string()
    }

    fn parts(&self) -> (&'static str, Value) {
        match self {
            Self::Accepted => ("accepted", Value::Null),
            Self::Refused(text) => ("refused", text.as_str().into()),
            Self::Unknown(text) => ("unknown", text.as_str().into()),
        }
    }
}
