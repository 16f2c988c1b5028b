//! [`ServiceNumber`]: the number types that a service runs in.

use crate::admission::Enclose;
use trirrr_protocol::message::Transmit;

/// A number type of a whole service: the admission bounds its rounding, the protocol transmits its
/// values.
pub trait ServiceNumber: Enclose + Transmit {}

impl<N: Enclose + Transmit> ServiceNumber for N {}
