//! Memory that code and constants are read from: flash with wait states, a line of prefetch, caches.

use std::collections::VecDeque;

/// A cache with lines that are replaced by age of use.
#[derive(Clone, Copy, Debug)]
pub(super) struct CacheSize {
    pub(super) sets: u32,
    pub(super) ways: usize,
}

/// No cache at all.
pub(super) const UNCACHED: CacheSize = CacheSize { sets: 1, ways: 0 };

/// A flash memory and its interface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Flash {
    /// Cycles of a read beyond the first.
    pub(super) wait_states: u64,
    /// Bytes of a read, and of a line of the caches.
    pub(super) line: u32,
    /// The line behind the one that is executed is read ahead.
    pub(super) prefetches: bool,
    /// Cache of instructions, filled by reads that the processor waits for.
    pub(super) instructions: CacheSize,
    /// Cache of constants; none: they share that of the instructions.
    pub(super) constants: Option<CacheSize>,
}

/// Lines of a cache: the one that was used last stands last in its set.
#[derive(Clone, Debug)]
struct Cache {
    ways: usize,
    sets: Vec<VecDeque<u32>>,
}

impl Cache {
    fn new(size: CacheSize) -> Self {
        Self {
            ways: size.ways,
            sets: vec![VecDeque::new(); size.sets as usize],
        }
    }

    fn set(&mut self, line: u32) -> &mut VecDeque<u32> {
        let count = self.sets.len() as u32;
        &mut self.sets[(line % count) as usize]
    }

    /// Returns true if `line` is there, and makes it the one that was used last.
    fn uses(&mut self, line: u32) -> bool {
        let set = self.set(line);
        let place = set.iter().position(|other| *other == line);
        let found = place.and_then(|place| set.remove(place));
        set.extend(found);
        found.is_some()
    }

    fn insert(&mut self, line: u32) {
        let ways = self.ways;
        let set = self.set(line);
        set.push_back(line);
        if set.len() > ways {
            set.pop_front();
        }
    }
}

/// State of a flash memory.
#[derive(Clone, Debug)]
pub(super) struct FlashState {
    flash: Flash,
    instructions: Cache,
    constants: Option<Cache>,
    /// The line that is executed.
    current: Option<u32>,
    /// The line that is read ahead, and the cycle from which it is there.
    ahead: Option<(u32, u64)>,
    /// Cycle from which the memory is free for another read.
    free: u64,
}

impl FlashState {
    pub(super) fn new(flash: Flash) -> Self {
        Self {
            flash,
            instructions: Cache::new(flash.instructions),
            constants: flash.constants.map(Cache::new),
            current: None,
            ahead: None,
            free: 0,
        }
    }

    /// Forgets every line.
    pub(super) fn empty(&mut self) {
        *self = Self::new(self.flash);
    }

    /// Reads a line from `now` on, and returns the cycle from which it is there.
    fn read(&mut self, now: u64) -> u64 {
        let done = now.max(self.free) + 1 + self.flash.wait_states;
        self.free = done;
        done
    }

    /// Cycles that an instruction waits for its lines.
    pub(super) fn fetch(&mut self, address: u32, bytes: u32, now: u64) -> u64 {
        let first = address / self.flash.line;
        let last = (address + bytes - 1) / self.flash.line;
        let mut wait = 0;
        for line in first..=last {
            wait += self.enter(line, now + wait);
        }
        wait
    }

    fn enter(&mut self, line: u32, now: u64) -> u64 {
        if self.current == Some(line) {
            return 0;
        }
        self.current = Some(line);
        let ahead = self.ahead.take().filter(|(next, _)| *next == line);
        let there = match ahead {
            // Lines that were read ahead are not kept.
            Some((_, there)) => there,
            None if self.instructions.uses(line) => now,
            None => {
                let there = self.read(now);
                self.instructions.insert(line);
                there
            }
        };
        // The first cycle of a read is that of the fetch itself.
        let wait = there.saturating_sub(now + 1);
        if self.flash.prefetches && !self.instructions.uses(line + 1) {
            let there = self.read(now + wait);
            self.ahead = Some((line + 1, there));
        }
        wait
    }

    /// Cycles that a load waits for its constant.
    pub(super) fn load(&mut self, address: u32, bytes: u32, now: u64) -> u64 {
        let first = address / self.flash.line;
        let last = (address + bytes.max(1) - 1) / self.flash.line;
        let mut wait = 0;
        for line in first..=last {
            let cache = self.constants.as_mut().unwrap_or(&mut self.instructions);
            if cache.uses(line) {
                continue;
            }
            cache.insert(line);
            let at = now + wait;
            wait += self.read(at) - (at + 1);
        }
        wait
    }
}
