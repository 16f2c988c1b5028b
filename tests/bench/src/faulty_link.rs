//! A line that damages what it carries, for tests of whoever talks over it. The same seed gives the
//! same damage.

use std::collections::VecDeque;

/// What a line did to a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// It never arrives.
    Dropped,
    /// It arrives twice.
    Duplicated,
    /// It arrives after frames that were sent later.
    Reordered,
    /// Its end is missing, mostly with the zero, so that it runs into the next frame.
    Truncated,
    /// Bytes of it are others.
    Corrupted,
    /// Bytes that nobody sent come before it, zeros among them or not.
    Garbage,
}

impl Fault {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::Dropped,
        Self::Duplicated,
        Self::Reordered,
        Self::Truncated,
        Self::Corrupted,
        Self::Garbage,
    ];
}

/// A frame overtaken by others stays behind for at most this many.
const LATEST: u64 = 8;

/// Most bytes of garbage at a time.
const GARBAGE: u64 = 16;

/// One direction of a line. Frames go in, pieces of bytes come out.
#[derive(Clone, Debug)]
pub struct FaultyLink {
    random: Random,
    /// Of 256 frames, how many are damaged.
    rate: u64,
    /// Ready to be received.
    ready: VecDeque<Vec<u8>>,
    /// Overtaken: after how many further frames, which bytes.
    late: Vec<(u64, Vec<u8>)>,
    frames: u64,
    faults: [u64; Fault::ALL.len()],
}

impl FaultyLink {
    /// A line that damages about `percent` of all frames.
    pub fn new(seed: u64, percent: u64) -> Self {
        Self {
            random: Random::new(seed),
            rate: percent * 256 / 100,
            ready: VecDeque::new(),
            late: Vec::new(),
            frames: 0,
            faults: [0; Fault::ALL.len()],
        }
    }

    /// Frames that were sent.
    pub fn frames(&self) -> u64 {
        self.frames
    }

    /// How often a fault was made.
    pub fn count(&self, fault: Fault) -> u64 {
        self.faults[fault as usize]
    }

    /// Frames that were damaged in whatever way.
    pub fn damaged(&self) -> u64 {
        self.faults.iter().sum()
    }

    /// Takes a frame.
    pub fn send(&mut self, frame: &[u8]) {
        self.frames += 1;
        let mut frame = frame.to_vec();
        let mut delay = 0;
        if self.random.below(256) < self.rate {
            let fault = Fault::ALL[self.random.below(Fault::ALL.len() as u64) as usize];
            self.faults[fault as usize] += 1;
            match fault {
                Fault::Dropped => frame.clear(),
                Fault::Duplicated => self.ready.push_back(frame.clone()),
                // The frame itself counts as the first that passes.
                Fault::Reordered => delay = 2 + self.random.below(LATEST - 1),
                Fault::Truncated => frame.truncate(self.random.below(frame.len() as u64) as usize),
                Fault::Corrupted => self.corrupt(&mut frame),
                Fault::Garbage => self.ready.push_back(self.random.bytes(GARBAGE)),
            }
        }
        match delay {
            0 => self.ready.push_back(frame),
            _ => self.late.push((delay, frame)),
        }
        self.overtake();
    }

    /// One to four bytes become others, zeros among them.
    fn corrupt(&mut self, frame: &mut [u8]) {
        for _ in 0..=self.random.below(4) {
            let at = self.random.below(frame.len() as u64) as usize;
            frame[at] ^= 1 + self.random.below(255) as u8;
        }
    }

    /// A frame has passed those that are late.
    fn overtake(&mut self) {
        let mut index = 0;
        while index < self.late.len() {
            self.late[index].0 -= 1;
            if self.late[index].0 == 0 {
                let (_, frame) = self.late.remove(index);
                self.ready.push_back(frame);
            } else {
                index += 1;
            }
        }
    }

    /// The next bytes that arrive: those of a frame, or what is left of it.
    pub fn receive(&mut self) -> Option<Vec<u8>> {
        self.ready.pop_front()
    }

    /// The line is torn and joined again: what was on it is lost.
    pub fn clear(&mut self) {
        self.ready.clear();
        self.late.clear();
    }
}

/// SplitMix64 (Steele, Lea and Flood 2014): every seed gives another sequence.
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// The sequence of `seed`.
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// The next 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// From 0 to `bound` - 1, close enough to evenly for small bounds.
    pub fn below(&mut self, bound: u64) -> u64 {
        self.bits() % bound.max(1)
    }

    /// One to `most` bytes.
    fn bytes(&mut self, most: u64) -> Vec<u8> {
        (0..=self.below(most)).map(|_| self.bits() as u8).collect()
    }

    /// From 0 to 1.
    pub fn fraction(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Twenty per cent of the frames, a fifth of it each kind: within six standard deviations of
    /// the binomial distribution.
    #[test]
    fn every_kind_of_damage_is_done_as_often_as_it_should() {
        let frames = 100_000u64;
        let mut link = FaultyLink::new(1, 20);
        for _ in 0..frames {
            link.send(&[1, 2, 3, 0]);
        }
        let rate = f64::from(20 * 256 / 100) / 256.0 / Fault::ALL.len() as f64;
        let mean = frames as f64 * rate;
        let deviation = (mean * (1.0 - rate)).sqrt();
        for fault in Fault::ALL {
            let count = link.count(fault) as f64;
            assert!((count - mean).abs() < 6.0 * deviation, "{fault:?}: {count}");
        }
        assert_eq!(link.frames(), frames);
    }

    #[test]
    fn what_is_not_damaged_arrives_once_and_in_order() {
        let mut link = FaultyLink::new(1, 0);
        for byte in 0..200 {
            link.send(&[byte]);
        }
        for byte in 0..200 {
            assert_eq!(link.receive(), Some(vec![byte]));
        }
        assert_eq!(link.receive(), None);
    }

    #[test]
    fn late_frames_arrive_in_the_end() {
        let mut link = FaultyLink::new(5, 20);
        let mut arrived = 0;
        for _ in 0..10_000 {
            link.send(&[7; 9]);
            while let Some(bytes) = link.receive() {
                arrived += u64::from(bytes == [7; 9]);
            }
        }
        let lost = link.count(Fault::Dropped) + link.count(Fault::Truncated);
        let changed = link.count(Fault::Corrupted);
        let twice = link.count(Fault::Duplicated);
        let expected = 10_000 - lost - changed + twice;
        // Up to LATEST are still under way; a byte can be changed and changed back.
        assert!(
            (expected - LATEST..=expected + 2).contains(&arrived),
            "{arrived} of {expected}"
        );
    }
}
