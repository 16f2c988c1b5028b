//! The dialect with machines that obey.

mod alarms;
mod damaged;
mod held;
mod machine;
mod sessions;
