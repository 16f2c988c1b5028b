//! The fall line through a place and a level, and the ticks that a stop takes at the least rates of a stretch.

use crate::pace::FULL;

/// Bits behind the point of times.
pub(super) const FRACTION: u32 = 8;

/// Greatest rate.
pub(super) const MOST: u64 = FULL as u64;

/// Fall lines at the rates of one part: above T / 2, and below.
#[derive(Clone, Copy)]
pub(super) struct Fall {
    pub(super) rates: [u64; 2],
    /// x at T / 2.
    pub(super) quarter: u64,
}

impl Fall {
    /// Parts of a tick from x to T / 2, rounded up by `up` or down; `None` if it stays above.
    pub(super) fn to_half(self, x: u64, up: bool) -> Option<u64> {
        let [any, _] = self.rates;
        let above = x.saturating_sub(self.quarter);
        match (above, any) {
            (0, _) => Some(0),
            (_, 0) => None,
            _ if up => Some(above.div_ceil(any)),
            _ => Some(above / any),
        }
    }

    /// x behind `length`, below 0 where it would be at rest before.
    pub(super) fn behind(self, x: u64, length: u64, up: bool) -> i64 {
        let [any, half] = self.rates;
        match self.to_half(x, up) {
            Some(above) if above < length => {
                x.min(self.quarter) as i64 - (half * (length - above)) as i64
            }
            _ => (x - any * length) as i64,
        }
    }

    /// The least x that is not at rest before `length`.
    pub(super) fn needed(self, length: u64) -> u64 {
        let [any, half] = self.rates;
        match half * length <= self.quarter {
            true => half * length,
            false => self.quarter + any * (length - self.quarter / half),
        }
    }

    /// Most time over `length` of those that are not at rest before.
    pub(super) fn slowest(self, length: u64) -> u64 {
        let least = self.rest(self.needed(length));
        match self.rates {
            // Above T / 2 nothing brakes.
            [0, half] if half * length > self.quarter => {
                least.max(stretch(self.quarter, length, 0))
            }
            _ => least,
        }
    }

    /// Time over `length`, at the end of which x is not below 0.
    pub(super) fn time(self, x: u64, length: u64) -> u64 {
        let [any, half] = self.rates;
        let above = self.to_half(x, false).unwrap_or(length).min(length);
        let below = x.min(self.quarter);
        let rest = (length - above).min(below.checked_div(half).unwrap_or(u64::MAX));
        stretch(x, above, any) + stretch(below, rest, half)
    }

    /// Time to rest.
    pub(super) fn rest(self, x: u64) -> u64 {
        let [any, half] = self.rates;
        let levels = x.min(self.quarter).isqrt() + 1;
        let above = (x.isqrt() + 1).saturating_sub(self.quarter.isqrt());
        let time = |levels: u64, rate: u64| (levels << FRACTION) / rate.max(1);
        time(above, any) + time(levels, half)
    }
}

/// Time from x over `length` at `rate`.
fn stretch(x: u64, length: u64, rate: u64) -> u64 {
    let level = |x: u64| (x << (2 * FRACTION)).isqrt();
    match rate {
        _ if length == 0 => 0,
        0 => (length << FRACTION) / (2 * x.isqrt()).max(1) + 1,
        _ => (level(x) + 1 - level(x - rate * length)) / rate + 1,
    }
}

/// Ticks that brake at some rates or more, from a place on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Braked {
    /// Time of that place, and level there.
    pub(super) since: u64,
    pub(super) level: u64,
    /// Least rates since then.
    pub(super) least: [u64; 2],
}

impl Braked {
    pub(super) fn new(since: u64, level: u64) -> Self {
        Self {
            since,
            level,
            least: [MOST; 2],
        }
    }

    pub(super) fn add(&mut self, rates: [u64; 2]) {
        self.least = [0, 1].map(|x| self.least[x].min(rates[x]));
    }

    /// Most that it takes to lower `all`, of which `low` is below T / 2, at the least rates; `lost` is what going below costs.
    pub(super) fn most(&self, all: u64, low: u64, lost: u64) -> u64 {
        let over = |way: u64, rate: u64| match (way, rate) {
            (0, _) => 0,
            (_, 0) => u64::MAX,
            _ => way.div_ceil(rate),
        };
        let [any, half] = self.least;
        let above = all.saturating_sub(low);
        let lost = if above == 0 { 0 } else { lost };
        let split = over(above, any)
            .saturating_add(over(all.min(low), half))
            .saturating_add(lost);
        over(all, any).min(split)
    }
}
