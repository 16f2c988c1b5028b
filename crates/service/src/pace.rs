//! Rates at which the pace along a path may change, and the room that they leave to stop in.
//!
//! The pace is the speed along the path in parts of normal speed, u. It changes by whole levels, of which
//! `FULL` make up the most that it changes by within a tick. The admission proves for each part of a move the
//! greatest rates that keep the limits, those of slowing down and of speeding up, at rest and at normal speed.
//!
//! With x = u^2, a way s along the path at the rate j lowers x by 2 j s. So whoever slows down at each part's own rate
//! comes to rest within what is queued if x is at most the sum of 2 j s: the room. The room is counted in levels times
//! ticks of path.

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};
use trirrr_core::to_source;

/// Levels by which the pace changes at most from one tick to the next.
pub(crate) const FULL: u8 = Pace::LEVELS;

/// Most parts of a move with rates of their own.
const PARTS: u32 = 8;

/// Ticks of the shortest move with more than one part: so none is shorter than two ticks.
const PARTED: u32 = 16;

/// Greatest rates at which the pace may change, in levels a tick: at rest, and at normal speed, where they are not
/// greater. What lies between may be had between.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Pace {
    /// Of slowing down.
    pub slower: [u8; 2],
    /// Of speeding up.
    pub faster: [u8; 2],
}

to_source!([] Pace [] in trirrr_service::paces {
    slower: [u8; 2],
    faster: [u8; 2],
});

impl Pace {
    /// Levels of the ramp's own rate.
    pub const LEVELS: u8 = 128;

    /// Whatever the ramp allows.
    pub const FULL: Self = Self {
        slower: [FULL; 2],
        faster: [FULL; 2],
    };

    /// Rates asked of every move: to speed up from rest, however slowly, and to slow down at `slower` levels a tick.
    const fn least(slower: u8) -> Self {
        Self {
            slower: [slower; 2],
            faster: [1, 0],
        }
    }

    /// The lesser of each rate.
    pub(crate) fn and(self, other: Self) -> Self {
        let least = |a: [u8; 2], b: [u8; 2]| [a[0].min(b[0]), a[1].min(b[1])];
        Self {
            slower: least(self.slower, other.slower),
            faster: least(self.faster, other.faster),
        }
    }

    /// Rates of slowing down from any pace, and from half of normal speed: there a quarter of the way from rest to normal
    /// speed, in u^2, is behind.
    pub(crate) fn braking(&self) -> [u32; 2] {
        let [rest, normal] = self.slower.map(u32::from);
        [normal, (3 * rest + normal) / 4]
    }
}

/// Ramp of a hold, a stop or a resume.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Ramp {
    /// Ticks from normal speed to rest where the limits leave room; positive.
    pub ticks: u16,
    /// Rates that every move has to leave room for.
    pub least: Pace,
}

to_source!([] Ramp [] in trirrr_service::paces {
    ticks: u16,
    least: Pace,
});

impl Ramp {
    /// A ramp that takes `ticks` wherever it is, or a move is refused.
    pub const fn fixed(ticks: u16) -> Self {
        Self {
            ticks,
            least: Pace::FULL,
        }
    }

    /// A ramp that takes `ticks` where the limits leave room, and more where they do not: up to `most_ticks` from any pace to
    /// rest, or as long as the path makes it.
    pub const fn within(ticks: u16, most_ticks: Option<u32>) -> Self {
        let slower = match most_ticks {
            None => 0,
            // So many levels a tick that it is not longer.
            Some(most) if most > ticks as u32 => {
                (ticks as u64 * FULL as u64).div_ceil(most as u64) as u8
            }
            Some(_) => FULL,
        };
        Self {
            ticks,
            least: Pace::least(slower),
        }
    }

    /// Rate of slowing down that every move has to leave room for, in paces a second: whole levels a tick of `period_s`. A plan that
    /// leaves room for less is refused move by move.
    pub fn least_rate(&self, period_s: f64) -> f64 {
        let [slower, _] = self.least.slower;
        f64::from(slower) / (f64::from(FULL) * f64::from(self.ticks) * period_s)
    }
}

/// The paces of a move, part by part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MovePaces {
    parts: [Pace; PARTS as usize],
}

to_source!([] MovePaces [] in trirrr_service::paces { parts: [Pace; PARTS as usize] });

impl MovePaces {
    /// Whatever the ramp allows.
    pub(crate) const FULL: Self = Self {
        parts: [Pace::FULL; PARTS as usize],
    };

    /// Number of parts of a move of `ticks`, as a power of two.
    pub(crate) const fn parts_log2(ticks: u32) -> u32 {
        match ticks < PARTED {
            true => 0,
            false => PARTS.ilog2(),
        }
    }

    /// Tick of a move of `ticks` at which its part `index` ends.
    pub(crate) const fn end_of(ticks: u32, index: u32) -> u32 {
        let log2 = Self::parts_log2(ticks);
        // Without a product that might leave the type.
        let part = index + 1;
        part * (ticks >> log2) + ((part * (ticks & ((1 << log2) - 1))) >> log2)
    }

    /// Halvings of a move of `ticks` down to which the rates of an interval are worth another.
    pub(crate) const fn finest(ticks: u32) -> u32 {
        let log2 = Self::parts_log2(ticks);
        if log2 == 0 { 1 } else { log2 }
    }

    /// Paces at `tick` of a move of `ticks`, and until the next tick.
    pub fn at(&self, ticks: u32, tick: u32) -> Pace {
        let count = 1 << Self::parts_log2(ticks);
        let part = |tick: u32| (0..count).find(|&index| tick < Self::end_of(ticks, index));
        let [now, next] = [tick, tick + 1].map(|tick| part(tick).unwrap_or(count - 1));
        self.of(now).and(self.of(next))
    }

    /// Paces of part `index`.
    pub(crate) fn of(&self, index: u32) -> Pace {
        self.parts
            .get(index as usize)
            .copied()
            .unwrap_or(Pace::FULL)
    }

    /// Parts that the interval [`index`, `index` + 1] / 2^`level` of a move of `ticks` touches: first and last.
    fn touched(ticks: u32, level: u32, index: u32) -> (u32, u32) {
        let log2 = Self::parts_log2(ticks);
        let [first, mut last] = match level >= log2 {
            true => [index >> (level - log2); 2],
            false => [index << (log2 - level), ((index + 1) << (log2 - level)) - 1],
        };
        // A part ends at a whole tick, up to one before the eighth does.
        let end = (u64::from(index) + 1) * u64::from(ticks);
        let whole = u64::from(Self::end_of(ticks, last)) << level;
        if end > whole && last + 1 < 1 << log2 {
            last += 1;
        }
        (first, last)
    }

    /// Least paces that hold over the interval so far.
    pub(crate) fn over(&self, ticks: u32, level: u32, index: u32) -> Pace {
        let (first, last) = Self::touched(ticks, level, index);
        (first..=last).fold(Pace::FULL, |pace, part| pace.and(self.of(part)))
    }

    /// Lowers the paces over the interval to `pace`.
    pub(crate) fn lower(&mut self, ticks: u32, level: u32, index: u32, pace: Pace) {
        let (first, last) = Self::touched(ticks, level, index);
        for part in self
            .parts
            .iter_mut()
            .take(last as usize + 1)
            .skip(first as usize)
        {
            *part = part.and(pace);
        }
    }
}

/// Room to stop in, by a [`RoomMeasure`], modulo 2^31: at any pace, and at up to half of normal speed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Room(pub(crate) [u32; 2]);

/// Rooms are counted modulo this.
const MODULUS: u32 = 1 << 31;

impl Room {
    pub(crate) const NONE: Self = Self([0; 2]);

    /// With more of it.
    pub(crate) fn and(self, more: Self) -> Self {
        let sum = |x: usize| self.0[x].wrapping_add(more.0[x]) % MODULUS;
        Self([sum(0), sum(1)])
    }

    /// Room of kind `x` from here on to the end of `total`; less than nothing where a pace is lost between parts.
    pub(crate) fn left(&self, total: &Self, x: usize) -> i32 {
        (total.0[x].wrapping_sub(self.0[x]) << 1) as i32 >> 1
    }
}

/// Measure of rooms on a ramp, the same wherever they are counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct RoomMeasure {
    /// More than anybody needs, in levels times ticks.
    pub(crate) most: u32,
    /// Rooms are counted in so many levels times ticks, as a power of two: all parts of a queue leave half of the
    /// modulus.
    pub(crate) log2: u32,
}

impl RoomMeasure {
    /// Measure for a pace whose normal speed has the level `top`.
    pub(crate) fn new(top: u32) -> Self {
        Self {
            // More than it takes to stop from normal speed.
            most: top / 2 + 8 * u32::from(FULL),
            // Then no part is more than 2^17 and a little: half of the modulus is left to 8,000 parts, those of 1,000 moves.
            log2: u32::BITS - (top.saturating_sub(1) >> 18).leading_zeros(),
        }
    }

    /// Room of `ticks` at `rate`, rounded down.
    pub(crate) fn of(&self, rate: u32, ticks: u32) -> u32 {
        rate.saturating_mul(ticks).min(self.most) >> self.log2
    }
}

/// Counts the room of one part after the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct RoomCount {
    pub(crate) room: Room,
    /// Rates of the last part.
    last: [u32; 2],
}

impl RoomCount {
    pub(crate) const NOTHING: Self = Self {
        room: Room::NONE,
        last: [FULL as u32; 2],
    };

    /// Behind a part of any rates: going over from it may lose a tick of the ramp's own.
    pub(crate) fn behind_any(measure: &RoomMeasure) -> Self {
        let lost = (u32::from(FULL) >> measure.log2) + 1;
        Self {
            room: Room([MODULUS - lost; 2]),
            ..Self::NOTHING
        }
    }

    /// Counts a part of `ticks` with the paces `pace`. A tick that goes over from one part into the next changes the pace by
    /// the lesser of both rates: it may lose a tick of the difference.
    #[inline(never)]
    pub(crate) fn add(&mut self, pace: &Pace, ticks: u32, measure: &RoomMeasure) {
        let rates = pace.braking();
        let room = |x: usize| {
            let lost = rates[x].abs_diff(self.last[x]) + ((1 << measure.log2) - 1);
            measure
                .of(rates[x], ticks)
                .wrapping_sub(lost >> measure.log2)
        };
        self.room = self.room.and(Room([room(0), room(1)]));
        self.last = rates;
    }

    /// Counts all parts of a move of `ticks`.
    pub(crate) fn add_move(&mut self, paces: &MovePaces, ticks: u32, measure: &RoomMeasure) {
        let mut begin = 0;
        for index in 0..1 << MovePaces::parts_log2(ticks) {
            let end = MovePaces::end_of(ticks, index);
            self.add(&paces.of(index), end - begin, measure);
            begin = end;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_move_leaves_room_for_whole_levels() {
        assert_eq!(Ramp::within(100, None).least_rate(1e-3), 0.0);
        assert_eq!(Ramp::within(100, Some(100)).least_rate(1e-3), 10.0);
        // 33 of 128 levels of 10/s, which is more than 1 / 0.397 s.
        let rate = Ramp::within(100, Some(397)).least_rate(1e-3);
        assert!((rate - 2.578_125).abs() < 1e-12, "{rate}");
    }

    #[test]
    fn parts_cover_a_move_without_gap_and_each_is_a_tick_at_least() {
        for ticks in (1..200).chain([65_535, 126_322_566]) {
            let count = 1 << MovePaces::parts_log2(ticks);
            let mut begin = 0;
            for index in 0..count {
                let end = MovePaces::end_of(ticks, index);
                assert!(end > begin, "{ticks}");
                assert_eq!(
                    u64::from(end),
                    (u64::from(index) + 1) * u64::from(ticks) / count as u64
                );
                begin = end;
            }
            assert_eq!(begin, ticks);
        }
    }

    /// A chain goes on from a part of any rates: a tick of the ramp's own may be lost there.
    #[test]
    fn behind_a_part_of_any_rates_a_tick_is_lost() {
        for (top, lost) in [(1 << 7, 129), (1 << 18, 129), (1 << 19, 65), (1 << 23, 5)] {
            let RoomCount { room, last } = RoomCount::behind_any(&RoomMeasure::new(top));
            assert_eq!(
                [0, 1].map(|x| Room::NONE.left(&room, x)),
                [-lost; 2],
                "{top}"
            );
            assert_eq!(last, [u32::from(FULL); 2]);
        }
    }

    /// An interval lowers every part that it touches, by the definition: in whole ticks of path.
    #[test]
    fn an_interval_lowers_all_parts_that_it_touches() {
        let low = Pace::least(0);
        for ticks in [1, 15, 16, 17, 23, 24, 100] {
            for level in 0..7 {
                for index in 0..1 << level {
                    let mut paces = MovePaces::FULL;
                    paces.lower(ticks, level, index, low);
                    let [begin, end] =
                        [index, index + 1].map(|i| f64::from(i * ticks) / f64::from(1 << level));
                    let mut from = 0;
                    for part in 0..1 << MovePaces::parts_log2(ticks) {
                        let to = MovePaces::end_of(ticks, part);
                        let touches = begin < f64::from(to) && end > f64::from(from);
                        if touches {
                            assert_eq!(paces.of(part), low, "{ticks} {level} {index} {part}");
                        }
                        from = to;
                    }
                    assert_eq!(paces.over(ticks, level, index), low);
                }
            }
        }
    }

    #[test]
    fn a_ramp_within_a_time_is_not_longer() {
        for (ticks, most) in [(100, 100), (100, 101), (100, 250), (7, 5000), (100, 50)] {
            let Ramp { least, .. } = Ramp::within(ticks, Some(most));
            let [rate, _] = least.slower.map(u32::from);
            assert!(rate > 0 && rate * most.max(100) >= u32::from(ticks) * u32::from(FULL));
        }
        assert_eq!(Ramp::within(100, None).least.slower, [0, 0]);
    }
}
