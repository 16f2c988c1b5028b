//! Links to a board, and to a client: bytes in, bytes out, over a serial port or TCP.
//!
//! A [`Link`] carries bytes, and [`Frames`] finds the messages in them. Once a call has failed, the link
//! is lost, and the owner opens a new one. A [`Port`] does so by itself: it is a [`Line`] of messages.
//! A [`SharedKey`] seals a TCP link: who does not have it gets in nowhere, and reads nothing.
//!
//! Frames, addresses and the trait of lines are there without the feature `system`, too: a page in a browser uses them. All else
//! takes an operating system, and a key takes the feature `keys`.
#![forbid(unsafe_code)]

mod address;
mod frames;
#[cfg(feature = "system")]
mod key;
mod line;
#[cfg(feature = "system")]
mod link;
#[cfg(feature = "system")]
mod links;
#[cfg(feature = "system")]
mod noise;
#[cfg(feature = "system")]
mod port;
mod raw;
#[cfg(feature = "system")]
mod refusal;
#[cfg(feature = "system")]
mod seal;
#[cfg(feature = "system")]
mod sealed;
#[cfg(feature = "system")]
mod serial;
#[cfg(feature = "system")]
mod served;
#[cfg(feature = "system")]
mod tcp;

pub use address::{Address, listening};
pub use frames::Frames;
#[cfg(feature = "system")]
pub use key::{KeyError, SharedKey, entropy};
pub use line::{Line, LostLine, Reopening, is_answer};
#[cfg(feature = "system")]
pub use link::Link;
#[cfg(feature = "system")]
use link::{WRITE_TIMEOUT, closed};
#[cfg(feature = "system")]
pub use links::{OpenError, open, open_keyed, open_link, open_watched};
#[cfg(feature = "system")]
pub use port::{Port, Retry};
pub use raw::RawMessage;
#[cfg(feature = "system")]
pub use refusal::{KeyRefusal, OtherClient};
#[cfg(feature = "system")]
pub use served::{Listener, ServedLink};
