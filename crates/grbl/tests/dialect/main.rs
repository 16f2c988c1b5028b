//! The dialect with machines that obey.

mod alarms;
mod damaged;
mod held;
mod machine;
mod replies;
mod sessions;
mod table;
