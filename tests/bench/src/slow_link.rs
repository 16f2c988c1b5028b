//! A line that takes its time: so many bytes in a tick, each some ticks on its way.

use std::collections::VecDeque;

/// One direction of a line.
#[derive(Clone, Debug)]
pub struct SlowLink {
    delay: u64,
    bytes_per_tick: usize,
    /// Bytes that wait for their turn,
    waiting: VecDeque<u8>,
    /// and bytes on their way, with the tick at which they arrive.
    flying: VecDeque<(u64, Vec<u8>)>,
}

impl SlowLink {
    /// A line that takes `bytes_per_tick` and delivers each after `delay` ticks.
    pub fn new(delay: u64, bytes_per_tick: usize) -> Self {
        Self {
            delay,
            bytes_per_tick,
            waiting: VecDeque::new(),
            flying: VecDeque::new(),
        }
    }

    /// Returns true if nothing waits for its turn.
    pub fn is_free(&self) -> bool {
        self.waiting.is_empty()
    }

    /// Loses all that is on the line.
    pub fn clear(&mut self) {
        self.waiting.clear();
        self.flying.clear();
    }

    /// Takes a frame.
    pub fn send(&mut self, frame: &[u8]) {
        self.waiting.extend(frame);
    }

    /// Carries bytes in the tick `now`.
    pub fn tick(&mut self, now: u64) {
        let count = self.waiting.len().min(self.bytes_per_tick);
        if count > 0 {
            let bytes = self.waiting.drain(..count).collect();
            self.flying.push_back((now + self.delay, bytes));
        }
    }

    /// The next bytes that have arrived by the tick `now`.
    pub fn receive(&mut self, now: u64) -> Option<Vec<u8>> {
        let (due, _) = self.flying.front()?;
        let arrived = *due <= now;
        arrived
            .then(|| self.flying.pop_front())?
            .map(|(_, bytes)| bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_byte_arrives_in_order_and_at_its_time() {
        let mut link = SlowLink::new(5, 2);
        link.send(&[1, 2, 3]);
        let mut arrived = Vec::new();
        for now in 0..10 {
            link.tick(now);
            while let Some(bytes) = link.receive(now) {
                arrived.extend(bytes.into_iter().map(|byte| (now, byte)));
            }
        }
        assert_eq!(arrived, [(5, 1), (5, 2), (6, 3)]);
        assert!(link.is_free());
    }
}
