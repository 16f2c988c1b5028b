//! Commands of clients: a verb, and a JSON object as payload.

use serde::Deserialize;
use serde_json::Value;
use std::time::Duration;

/// Lease of a client that names none.
const LEASE_S: f64 = 2.0;

/// Shortest and longest lease, s.
const LEASES_S: [f64; 2] = [0.2, 60.0];

/// Payload of a command. Each verb uses its own part.
#[derive(Clone, Debug, Default, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub(crate) struct CommandText {
    /// Name of the client.
    pub(crate) client: Option<String>,
    /// Session that the client was greeted in, 16 hexadecimal digits.
    pub(crate) session: Option<String>,
    /// Number of the command.
    pub(crate) seq: Option<u64>,
    lease_s: Option<f64>,
    x_m: Option<f64>,
    y_m: Option<f64>,
    alpha_rad: Option<f64>,
    dx_m: Option<f64>,
    dy_m: Option<f64>,
    dalpha_rad: Option<f64>,
    percent: Option<u8>,
}

/// A verb with its arguments, checked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Act {
    /// Takes control for this long after each command.
    Take(Duration),
    /// Gives control back.
    Release,
    Enable,
    Disable,
    Clear,
    Home,
    Hold,
    Resume,
    Stop,
    Feed(u8),
    /// Goes to x, y (m); alpha (rad) stays where it is left out.
    GoTo([f64; 2], Option<f64>),
    /// Goes on by dx, dy (m), dalpha (rad).
    Jog([f64; 3]),
    /// Plays the job of the scene.
    Run,
}

/// Verbs that are commands with a number.
pub(crate) const VERBS: [&str; 13] = [
    "take", "release", "enable", "disable", "clear", "home", "hold", "resume", "stop", "feed",
    "goto", "jog", "run",
];

impl CommandText {
    /// Reads a payload. `None` stands for a query without one.
    ///
    /// # Errors
    /// The payload is no JSON object, or has an entry that no command has.
    pub(crate) fn read(payload: Option<&[u8]>) -> Result<Self, String> {
        let bytes = payload.unwrap_or_default();
        if bytes.is_empty() {
            return Ok(Self::default());
        }
        serde_json::from_slice(bytes)
            .map_err(|error| format!("the payload is no JSON object of a command: {error}"))
    }

    /// Returns the act of `verb`.
    ///
    /// # Errors
    /// An argument is missing, not finite, or out of range; or the verb is none.
    pub(crate) fn act(&self, verb: &str) -> Result<Act, String> {
        let need = |name: &str, value: Option<f64>| {
            let value = value.ok_or_else(|| format!("{verb} needs {name}"))?;
            finite(name, value)
        };
        let or_zero = |name: &str, value: Option<f64>| finite(name, value.unwrap_or(0.0));
        Ok(match verb {
            "take" => {
                let seconds = self.lease_s.unwrap_or(LEASE_S);
                let [least, most] = LEASES_S;
                if !(least..=most).contains(&seconds) {
                    return Err(format!(
                        "lease_s is {seconds}; {least} to {most} are allowed"
                    ));
                }
                Act::Take(Duration::from_secs_f64(seconds))
            }
            "release" => Act::Release,
            "enable" => Act::Enable,
            "disable" => Act::Disable,
            "clear" => Act::Clear,
            "home" => Act::Home,
            "hold" => Act::Hold,
            "resume" => Act::Resume,
            "stop" => Act::Stop,
            "feed" => match self.percent {
                Some(percent @ 1..=100) => Act::Feed(percent),
                _ => return Err("feed needs percent, 1 to 100".into()),
            },
            "goto" => {
                let place = [need("x_m", self.x_m)?, need("y_m", self.y_m)?];
                let alpha = self.alpha_rad.map(|alpha| finite("alpha_rad", alpha));
                Act::GoTo(place, alpha.transpose()?)
            }
            "jog" => {
                let step = [
                    or_zero("dx_m", self.dx_m)?,
                    or_zero("dy_m", self.dy_m)?,
                    or_zero("dalpha_rad", self.dalpha_rad)?,
                ];
                if step == [0.0; 3] {
                    return Err("jog needs dx_m, dy_m or dalpha_rad that is not 0".into());
                }
                Act::Jog(step)
            }
            "run" => Act::Run,
            _ => {
                let verbs = VERBS.join(", ");
                return Err(format!(
                    "{verb} is no command; there are hello, status, renew, {verbs}"
                ));
            }
        })
    }
}

fn finite(name: &str, value: f64) -> Result<f64, String> {
    match value.is_finite() {
        true => Ok(value),
        false => Err(format!("{name} is infinite or not a number")),
    }
}

/// Clients that may give a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Right {
    /// Each that has said hello: it makes the machine stand.
    Everyone,
    /// The one that has control.
    Holder,
}

impl Act {
    pub(crate) fn right(&self) -> Right {
        match self {
            Self::Take(_) | Self::Release | Self::Hold | Self::Stop | Self::Disable => {
                Right::Everyone
            }
            _ => Right::Holder,
        }
    }
}

/// Parses a range `from` to `to` (exclusive) of the parameters of a query for history.
///
/// # Errors
/// A value is no whole number.
pub(crate) fn range(
    from: Option<&str>,
    to: Option<&str>,
) -> Result<(Option<u64>, Option<u64>), String> {
    let number = |name: &str, text: Option<&str>| {
        let parsed = text.map(str::parse::<u64>).transpose();
        parsed.map_err(|_| format!("{name} is no whole number"))
    };
    Ok((number("from", from)?, number("to", to)?))
}

/// Reads the session of a client, as [`session_text`] writes it.
pub(crate) fn read_session(text: &str) -> Option<u64> {
    (text.len() == 16).then(|| u64::from_str_radix(text, 16).ok())?
}

/// A session in JSON: numbers there are exact to 53 bits only.
pub(crate) fn session_text(session: u64) -> Value {
    format!("{session:016x}").into()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn act(verb: &str, payload: &str) -> Result<Act, String> {
        CommandText::read(Some(payload.as_bytes()))?.act(verb)
    }

    #[test]
    fn arguments_are_checked_by_name() {
        assert_eq!(
            act("jog", r#"{"dx_m": 0.01}"#),
            Ok(Act::Jog([0.01, 0.0, 0.0]))
        );
        assert_eq!(
            act("goto", r#"{"x_m": 1, "y_m": 2}"#),
            Ok(Act::GoTo([1.0, 2.0], None))
        );
        for (verb, payload, says) in [
            ("jog", "{}", "jog needs"),
            ("goto", r#"{"x_m": 1}"#, "goto needs y_m"),
            ("goto", r#"{"x_m": 1, "y": 2}"#, "unknown field `y`"),
            ("feed", r#"{"percent": 0}"#, "1 to 100"),
            ("take", r#"{"lease_s": 0.01}"#, "0.2 to 60"),
            ("dance", "{}", "dance is no command"),
            ("stop", "[1]", "no JSON object"),
            ("stop", "{", "no JSON object"),
        ] {
            let error = act(verb, payload).unwrap_err();
            assert!(error.contains(says), "{verb} {payload}: {error}");
        }
        for verb in VERBS {
            let all = r#"{"x_m": 1, "y_m": 2, "dx_m": 1, "percent": 50}"#;
            assert!(act(verb, all).is_ok(), "{verb}");
        }
    }

    #[test]
    fn only_commands_that_make_the_machine_stand_are_for_everyone() {
        for (verb, right) in [
            ("stop", Right::Everyone),
            ("hold", Right::Everyone),
            ("disable", Right::Everyone),
            ("enable", Right::Holder),
            ("resume", Right::Holder),
            ("run", Right::Holder),
        ] {
            assert_eq!(act(verb, "{}").unwrap().right(), right, "{verb}");
        }
    }

    #[test]
    fn a_session_is_read_back() {
        let text = session_text(0x12);
        assert_eq!(text, "0000000000000012");
        assert_eq!(read_session("0000000000000012"), Some(0x12));
        assert_eq!(read_session("12"), None);
        assert_eq!(read_session("zzzzzzzzzzzzzzzz"), None);
    }
}
