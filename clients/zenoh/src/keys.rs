//! Names of the keys of a machine.

/// First part of all keys, unless the user gives another.
pub const PREFIX: &str = "trirrr";

/// Last part of the key of the liveliness token of a machine: the program has the machine on its line.
pub const ALIVE: &str = "alive";
/// Identity, JSON.
pub const IDENTITY: &str = "identity";
/// State, JSON.
pub const STATE: &str = "state";
/// Batches of samples, [`records`](crate::records).
pub const TELEMETRY: &str = "telemetry";
/// Joints as ROS 2 has them, CDR.
pub const JOINT_STATES: &str = "joint_states";
/// Events, JSON.
pub const EVENTS: &str = "events";
/// Commands, JSON: the verb follows.
pub const COMMAND: &str = "command";
/// Liveliness tokens of clients: the client's name follows.
pub const CONTROL: &str = "control";

/// Keys of one machine.
#[derive(Clone, Debug)]
pub struct MachineKeys {
    base: String,
}

impl MachineKeys {
    /// Creates the keys of the machine `name` below `prefix`.
    pub fn new(prefix: &str, name: &str) -> Self {
        Self {
            base: format!("{prefix}/{name}"),
        }
    }

    /// Returns the key of `part`.
    pub fn of(&self, part: &str) -> String {
        format!("{}/{part}", self.base)
    }

    /// Returns the key of the command `verb`, `*` for all.
    pub fn command(&self, verb: &str) -> String {
        format!("{}/{COMMAND}/{verb}", self.base)
    }

    /// Returns the key of the liveliness token of `client`, `*` for all.
    pub fn control(&self, client: &str) -> String {
        format!("{}/{CONTROL}/{client}", self.base)
    }
}

/// Returns true if `name` can be one part of a key: letters, digits, `-`, `_` and `.`, 1 to 64 of them.
pub fn is_name(name: &str) -> bool {
    let is_allowed = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
    (1..=64).contains(&name.len()) && name.chars().all(is_allowed)
}
