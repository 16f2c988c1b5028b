//! The host's side of the conversation, without ports and clocks: what to send next, what an answer
//! means, when to ask again. Whoever owns a port feeds it: `host-sim stream`, the tests.
//!
//! ```text
//!            poll(now) ──> Send, Wait, Lost, Finished
//! port ────> receive(message, now)
//! ```
//! [`exchange`] keeps requests and answers in step; [`stream`] plays a job through it.

pub mod exchange;
mod failure;
pub mod stream;

pub use exchange::Patience;
pub use failure::Failure;
pub use stream::{Action, Ask, Stream};
