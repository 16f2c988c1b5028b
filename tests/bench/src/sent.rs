//! What was sent in one direction of a line.

use std::collections::HashSet;

/// Every frame that was sent in one direction.
#[derive(Clone, Debug, Default)]
pub struct Sent(HashSet<Vec<u8>>);

impl Sent {
    /// A frame is sent.
    pub fn record(&mut self, frame: &[u8]) {
        self.0.insert(frame.to_vec());
    }

    /// Whether what the other end took for a message is a frame that was sent.
    ///
    /// # Errors
    /// It is none.
    pub fn check(&self, frame: &[u8]) -> Result<(), String> {
        match self.0.contains(frame) {
            true => Ok(()),
            false => Err(format!("heard and never sent: {frame:02X?}")),
        }
    }
}
