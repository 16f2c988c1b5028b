//! Links to a board, and to a client: bytes in, bytes out, over a serial port or TCP.
//!
//! A [`Link`] carries bytes, and [`Frames`] finds the messages in them. Once a call has failed, the link
//! is lost, and the owner opens a new one. A [`SharedKey`] seals a TCP link: who does not have it gets in nowhere, and reads nothing.
//!
//! Frames and addresses are there without the feature `transport`, too. All else takes an operating system.

mod address;
mod frames;
#[cfg(feature = "transport")]
mod key;
#[cfg(feature = "transport")]
mod links;
mod raw;
#[cfg(feature = "transport")]
mod refusal;
#[cfg(feature = "transport")]
mod seal;
#[cfg(feature = "transport")]
mod sealed;
#[cfg(feature = "transport")]
mod serial;
#[cfg(feature = "transport")]
mod served;
#[cfg(feature = "transport")]
mod tcp;

pub use address::{Address, listening};
pub use frames::Frames;
#[cfg(feature = "transport")]
pub use key::{KeyError, SharedKey, entropy};
#[cfg(feature = "transport")]
pub use links::{Link, OpenError, open, open_keyed, open_link, open_watched};
#[cfg(feature = "transport")]
use links::{WRITE_TIMEOUT, closed};
pub use raw::RawMessage;
#[cfg(feature = "transport")]
pub use refusal::{KeyRefusal, OtherClient};
#[cfg(feature = "transport")]
pub use served::{Listener, ServedLink};
