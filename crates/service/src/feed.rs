//! Time along the path: how a hold, a stop, a resume and a feed override change the pace.
//!
//! The path's own time s runs at the pace u = k / T of a tick per tick, where the level k is a
//! whole number, T at normal speed and 0 at rest. Between two ticks u is linear in time, so s advances by
//! (k + k') / (2 T) ticks exactly: in parts of 1 / (2 T) of a tick s is a whole number. Nothing is rounded and nothing
//! drifts, and whoever runs at normal speed stands at whole ticks of the path.
//!
//! T is [`FULL`] times R, the ticks of the ramp: from normal speed to rest it takes R ticks, and R / 2 ticks of the path,
//! where the limits leave room for [`FULL`] levels a tick; elsewhere it takes longer.
//!
//! With D = T - k, every tick falls behind normal speed by D + D' parts. A way up to normal speed has to fall behind by
//! what lacks to a whole tick. It waits for that just below normal speed, where D is a tick's change or less. What lacks,
//! the position's part, and D have the same parity: so the last bit comes out.

use super::pace::{FULL, Pace, RoomMeasure};

/// Position on the path, in the path's own time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct PathPosition {
    /// Whole ticks since the start of the move.
    pub(super) tick: u32,
    /// Parts of 1 / (2 T) of a tick, less than 2 T.
    pub(super) part: u32,
}

impl PathPosition {
    /// The start of a move.
    pub(super) const START: Self = Self { tick: 0, part: 0 };
}

/// The pace.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct FeedScale {
    /// T, positive.
    top: u32,
    /// k.
    level: u32,
    /// The level that the host asks for, at most T.
    goal: u32,
    measure: RoomMeasure,
}

/// One tick of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Step {
    /// k' after it.
    pub(super) level: u32,
    /// k' - k.
    pub(super) slope: i32,
    /// Parts of a tick that the path advances.
    pub(super) parts: u32,
}

impl FeedScale {
    /// At rest, on a ramp of `ramp` ticks.
    pub(super) fn new(ramp: u16) -> Self {
        let top = u32::from(ramp.max(1)) * u32::from(FULL);
        Self {
            top,
            level: 0,
            goal: top,
            measure: RoomMeasure::new(top),
        }
    }

    /// T.
    pub(super) fn top(&self) -> u32 {
        self.top
    }

    /// Asks for `percent` of normal speed, 1 to 100.
    pub(super) fn aim_at(&mut self, percent: u8) {
        // Even, as T is: what lacks to a whole tick is even at the start of a path.
        let goal = self.top * u32::from(percent) / 100;
        self.goal = goal.min(self.top).max(2) & !1;
    }

    /// At the pace that the host asks for from one tick to the next: for the start of a path that starts at rest.
    pub(super) fn start(&mut self) {
        self.level = self.goal;
    }

    /// At rest from one tick to the next: where a path ends.
    pub(super) fn end(&mut self) {
        self.level = 0;
    }

    /// At the end of a path, which may be nearer than the tick would have gone: a whole tick. The level becomes even with it.
    pub(super) fn land(&mut self) {
        self.level &= !1;
    }

    /// At any level.
    #[cfg(test)]
    pub(super) fn be_at(&mut self, level: u32) {
        self.level = level;
    }

    /// Returns true if the path stands.
    pub(super) fn is_at_rest(&self) -> bool {
        self.level == 0
    }

    /// Returns true if the pace is what the host asks for.
    pub(super) fn is_at_goal(&self) -> bool {
        self.level == self.goal
    }

    /// One tick towards rest, at the lesser rates of both `paces`.
    #[inline(never)]
    pub(super) fn slower(&self, [pace, next]: &[Pace; 2]) -> Step {
        // Not those of the lesser pace: with the rate at rest of one and that at normal speed of the other they are less.
        let [[any, half], others] = [pace.braking(), next.braking()];
        let [any, half] = [any.min(others[0]), half.min(others[1])];
        let most = match 2 * self.level <= self.top {
            true => half,
            false => any,
        };
        self.step_to(self.level.saturating_sub(most))
    }

    /// One tick at the rates of `pace`, or where it goes beyond the tick `end` at the lesser ones of `pace` and `next`: a `step`
    /// keeps the rates of two.
    pub(super) fn across(
        &self,
        from: PathPosition,
        end: u32,
        [pace, next]: [Pace; 2],
        step: impl Fn(&[Pace; 2]) -> Step,
    ) -> Step {
        let within = step(&[pace, pace]);
        let crosses = from.part + within.parts >= 2 * self.top;
        match crosses && from.tick.saturating_add(1) >= end {
            true => step(&[pace, next]),
            false => within,
        }
    }

    /// One tick at the same pace.
    pub(super) fn steady(&self) -> Step {
        self.step_to(self.level)
    }

    /// One tick towards the pace that the host asks for, or at it, at the lesser rates of both `paces`, from `part` of a tick.
    #[inline(never)]
    pub(super) fn faster(&self, paces: &[Pace; 2], part: u32) -> Step {
        if self.level >= self.goal {
            let Step { level, .. } = self.slower(paces);
            return self.step_to(level.max(self.goal));
        }
        let [pace, next] = paces;
        let pace = &pace.and(*next);
        let most = self.most_faster(pace);
        let behind = self.top - self.level;
        if self.goal < self.top {
            return self.step_to((self.level + most).min(self.goal));
        }
        if behind > most {
            return self.step_to(self.level + most.min(behind - most));
        }
        // Within a tick's change of normal speed: it waits until what lacks to a whole tick is right.
        let lacks = match part < behind {
            true => part + 2 * self.top,
            false => part,
        };
        match lacks - behind {
            0 => self.step_to(self.top),
            rest if rest < 2 * behind => self.step_to(self.top - rest / 2),
            // Too near to normal speed it would wait for long.
            _ => {
                let [any, _] = pace.braking();
                self.step_to(self.level - any.min(most - behind))
            }
        }
    }

    /// Levels by which a tick may speed up. The rate that is proven is linear in u^2 between rest and normal speed, and that
    /// which is linear in u is no greater. It has to hold at the pace to which it leads.
    fn most_faster(&self, pace: &Pace) -> u32 {
        let [rest, normal] = pace.faster.map(u32::from);
        if rest == normal {
            return rest;
        }
        let weighted = rest * (self.top - self.level) + normal * self.level;
        weighted.checked_div(self.top + rest - normal).unwrap_or(0)
    }

    fn step_to(&self, level: u32) -> Step {
        Step {
            level,
            slope: level as i32 - self.level as i32,
            parts: self.level + level,
        }
    }

    /// Takes the step: the position after it.
    pub(super) fn take(&mut self, step: Step, from: PathPosition) -> PathPosition {
        self.level = step.level;
        let whole = 2 * self.top;
        // At most two ramps, one tick.
        let part = from.part + step.parts;
        if part < whole {
            PathPosition { part, ..from }
        } else {
            PathPosition {
                tick: from.tick.wrapping_add(1),
                part: part - whole,
            }
        }
    }

    /// The measure of rooms.
    pub(super) fn room_measure(&self) -> RoomMeasure {
        self.measure
    }

    /// Returns true if the path can still come to rest after `step` on what is left. `room` is asked for the
    /// [room](super::pace::Room) ahead of the whole tick of the position: at any pace (0), or at half of normal speed (1). The position
    /// is `part` beyond the whole tick.
    pub(super) fn can_stop(&self, step: Step, part: u32, room: impl Fn(usize) -> i32) -> bool {
        self.is_room(step, part, room(0))
            || (2 * step.level <= self.top && self.is_room(step, part, room(1)))
    }

    #[inline]
    fn is_room(&self, step: Step, part: u32, room: i32) -> bool {
        let room = room.saturating_mul(1 << self.measure.log2);
        // More than the square of the level and the tick's own way ask for, and below the products fit.
        room > (self.top / 2) as i32 + 4 * i32::from(FULL) || self.is_just_room(step, part, room)
    }

    #[inline(never)]
    fn is_just_room(&self, step: Step, part: u32, room: i32) -> bool {
        let left = i64::from(room) * i64::from(2 * self.top)
            - i64::from(FULL) * i64::from(part + step.parts);
        let level = i64::from(step.level);
        left >= level * level + LAST
    }

    /// Returns true if a path that stands anywhere before `room` goes on: it comes to rest in there behind the greatest change of a tick.
    pub(super) fn can_start(&self, room: impl Fn(usize) -> i32) -> bool {
        let step = Step {
            level: u32::from(FULL),
            slope: i32::from(FULL),
            parts: u32::from(FULL),
        };
        self.can_stop(step, 2 * self.top, room)
    }

    /// Returns true if `room` is enough to come to rest from the pace that the host asks for, and from the present one.
    pub(super) fn is_enough(&self, part: u32, room: impl Fn(usize) -> i32) -> bool {
        let at_goal = Step {
            // A lower one may have been asked for a moment ago.
            level: self.goal.max(self.level),
            slope: 0,
            parts: 0,
        };
        self.can_stop(at_goal, part, room)
    }
}

/// The last tick before rest loses less than a whole tick's change r of j levels, and so r (j - r) of the room.
const LAST: i64 = (FULL as i64 * FULL as i64) / 4;

impl Step {
    /// Returns true if the step is one at normal speed all along.
    pub(super) fn is_normal(&self, feed: &FeedScale) -> bool {
        self.slope == 0 && self.level == feed.top
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pace::{MovePaces, RoomCount};
    use proptest::prelude::*;
    use std::vec::Vec;

    #[test]
    fn a_hold_and_a_resume_take_whole_ticks() {
        for ramp in [1, 2, 3, 7, 10, 100, u16::MAX] {
            let mut feed = FeedScale::new(ramp);
            feed.start();
            let mut position = PathPosition { tick: 5, part: 0 };
            let mut ticks = 0;
            while !feed.is_at_rest() {
                let step = feed.slower(&[Pace::FULL; 2]);
                position = feed.take(step, position);
                ticks += 1;
            }
            assert_eq!(ticks, u32::from(ramp));
            // R T parts of 1 / (2 T).
            assert_eq!(
                2 * (position.tick - 5) + position.part / feed.top(),
                u32::from(ramp)
            );
            while !feed.is_at_goal() {
                let step = feed.faster(&[Pace::FULL; 2], position.part);
                position = feed.take(step, position);
            }
            let expected = PathPosition {
                tick: 5 + u32::from(ramp),
                part: 0,
            };
            assert_eq!(position, expected);
            let step = feed.faster(&[Pace::FULL; 2], position.part);
            assert!(step.is_normal(&feed));
        }
    }

    /// A path of parts with rates of their own.
    struct Walk {
        parts: Vec<(u32, Pace)>,
        index: usize,
        begin: u32,
        total: RoomCount,
        passed: RoomCount,
        feed: FeedScale,
        position: PathPosition,
    }

    impl Walk {
        fn new(ramp: u16, parts: Vec<(u32, Pace)>) -> Self {
            let feed = FeedScale::new(ramp);
            let mut total = RoomCount::NOTHING;
            for (ticks, pace) in &parts {
                total.add(pace, *ticks, &feed.room_measure());
            }
            let mut passed = RoomCount::NOTHING;
            passed.add(&parts[0].1, parts[0].0, &feed.room_measure());
            Self {
                parts,
                index: 0,
                begin: 0,
                total,
                passed,
                feed,
                position: PathPosition::START,
            }
        }

        fn length(&self) -> u32 {
            self.parts.iter().map(|(ticks, _)| ticks).sum()
        }

        fn room(&self) -> impl Fn(usize) -> i32 + '_ {
            |x| {
                let (ticks, pace) = self.parts[self.index];
                let within = self.begin + ticks - self.position.tick;
                let rate = pace.braking()[x];
                self.passed.room.left(&self.total.room, x)
                    + self.feed.room_measure().of(rate, within) as i32
            }
        }

        fn across(&self, step: impl Fn(&[Pace; 2]) -> Step) -> (Step, [Pace; 2]) {
            let (ticks, pace) = self.parts[self.index];
            let next = self.parts.get(self.index + 1).map_or(pace, |next| next.1);
            let end = self.begin + ticks;
            let step = self.feed.across(self.position, end, [pace, next], step);
            let crosses = self.position.part + step.parts >= 2 * self.feed.top();
            match crosses && self.position.tick + 1 >= end {
                true => (step, [pace, next]),
                false => (step, [pace, pace]),
            }
        }

        /// One tick, and the rates that its parts allow are kept on it.
        fn tick(&mut self, (step, paces): (Step, [Pace; 2])) {
            let u = f64::from(step.level) / f64::from(self.feed.top());
            let allowed = |[rest, normal]: [u8; 2]| {
                f64::from(rest) + (f64::from(normal) - f64::from(rest)) * u * u
            };
            let slope = f64::from(step.slope);
            // The rates at half of normal speed are those of its upper end.
            let before = (f64::from(step.level) - slope) / f64::from(self.feed.top());
            for pace in paces {
                let [rest, normal] = pace.slower.map(f64::from);
                let slower = match before <= 0.5 {
                    true => rest * 0.75 + normal * 0.25,
                    false => normal,
                };
                assert!(
                    slope >= -slower && slope <= allowed(pace.faster),
                    "{step:?} {paces:?}"
                );
            }
            self.position = self.feed.take(step, self.position);
            let (ticks, _) = self.parts[self.index];
            if self.position.tick >= self.begin + ticks && self.index + 1 < self.parts.len() {
                self.begin += ticks;
                self.index += 1;
                let (ticks, pace) = self.parts[self.index];
                self.passed.add(&pace, ticks, &self.feed.room_measure());
            }
        }
    }

    fn paces() -> impl Strategy<Value = Pace> {
        let pair = || (0u8..=FULL, 0u8..=FULL).prop_map(|(a, b)| [a.max(b), a.min(b)]);
        let faster = pair().prop_map(|[rest, normal]| [rest.max(1), normal]);
        prop_oneof![
            Just(Pace::FULL),
            (pair(), faster).prop_map(|(slower, faster)| Pace { slower, faster }),
        ]
    }

    /// Parts of all kinds, or of two in turn.
    fn parts() -> impl Strategy<Value = Vec<(u32, Pace)>> {
        let part = || (1u32..30, paces());
        let in_turn = |(pair, times): (_, _)| core::iter::repeat_n(pair, times).flatten().collect();
        prop_oneof![
            proptest::collection::vec(part(), 1..40),
            ([(1u32..4, paces()), (1u32..4, paces())], 1usize..60).prop_map(in_turn),
        ]
    }

    proptest! {
        /// However the rates change from part to part and whatever is asked for: the rates are kept, the path stops before its
        /// end, and normal speed stands at whole ticks.
        #[test]
        fn rates_are_kept_and_the_end_is_never_passed(
            ramp in prop_oneof![1u16..40, 8190u16..8200],
            parts in parts(),
            wishes in proptest::collection::vec((any::<bool>(), 1u8..=100, 1u32..60), 1..20),
        ) {
            let mut walk = Walk::new(ramp, parts);
            let length = walk.length();
            let mut wish = None;
            for (go, percent, ticks) in wishes {
                walk.feed.aim_at(if percent > 60 { 100 } else { percent });
                for _ in 0..ticks {
                    let part = walk.position.part;
                    let faster = walk.across(|paces| walk.feed.faster(paces, part));
                    let steady = walk.across(|_| walk.feed.steady());
                    let can = |step: (Step, [Pace; 2])| walk.feed.can_stop(step.0, part, walk.room());
                    // Once it slows down it does so to rest.
                    let down = wish == Some(false) && !walk.feed.is_at_rest();
                    let step = match go && !down {
                        true if can(faster) => faster,
                        true if can(steady) => steady,
                        _ => {
                            wish = Some(false);
                            walk.across(|paces| walk.feed.slower(paces))
                        }
                    };
                    if walk.feed.is_at_rest() {
                        wish = None;
                    }
                    walk.tick(step);
                    prop_assert!(walk.position.part < 2 * walk.feed.top());
                    let at_end = walk.position == PathPosition { tick: length, part: 0 };
                    let stands = at_end && walk.feed.is_at_rest();
                    prop_assert!(walk.position.tick < length || stands, "{:?}", walk.position);
                    if step.0.is_normal(&walk.feed) {
                        prop_assert_eq!(walk.position.part, 0);
                    }
                }
            }
        }

        /// Wherever there is room to speed up, normal speed is reached within two ramps and stands at a whole tick.
        #[test]
        fn normal_speed_is_reached_at_a_whole_tick(
            ramp in 1u16..40,
            stops in proptest::collection::vec((1u32..50, 1u8..=FULL), 1..8),
        ) {
            let mut feed = FeedScale::new(ramp);
            feed.start();
            let mut position = PathPosition::START;
            for (ticks, rate) in stops {
                let pace = Pace { slower: [rate; 2], faster: [FULL; 2] };
                for _ in 0..ticks {
                    position = feed.take(feed.slower(&[pace; 2]), position);
                }
                let mut waited = 0;
                while !feed.is_at_goal() {
                    position = feed.take(feed.faster(&[Pace::FULL; 2], position.part), position);
                    waited += 1;
                    prop_assert!(waited <= 2 * u32::from(ramp) + 4);
                }
                prop_assert_eq!(position.part, 0);
            }
        }
    }

    /// A tick that goes over from part to part brakes at the lesser rate of both, at up to half of normal speed, too: of parts
    /// of which one has more room at rest and the other at normal speed, none is lost beyond the difference.
    #[test]
    fn parts_in_turn_keep_their_room() {
        let pace = |slower| Pace {
            slower,
            faster: [FULL; 2],
        };
        for (one, other) in [([128, 0], [100, 100]), ([127, 9], [60, 40])] {
            for (length, percent) in [(1, 50), (2, 50), (2, 47), (3, 49)] {
                let parts = (0..200).map(|i| (length, pace(if i % 2 == 0 { one } else { other })));
                let mut walk = Walk::new(100, parts.collect());
                walk.feed.aim_at(percent);
                walk.feed.start();
                let mut slows = false;
                while !walk.feed.is_at_rest() {
                    let steady = walk.across(|_| walk.feed.steady());
                    let part = walk.position.part;
                    slows |= !walk.feed.can_stop(steady.0, part, walk.room());
                    walk.tick(match slows {
                        true => walk.across(|paces| walk.feed.slower(paces)),
                        false => steady,
                    });
                    assert!(
                        walk.position.tick < walk.length(),
                        "{one:?} {length} {percent}"
                    );
                }
                // And most of the room is used.
                let left = walk.length() - walk.position.tick;
                assert!(4 * left < walk.length(), "{one:?} {length}: {left}");
            }
        }
    }

    #[test]
    fn the_room_of_a_move_is_that_of_its_parts() {
        let mut paces = MovePaces::FULL;
        let low = Pace {
            slower: [60, 20],
            faster: [FULL; 2],
        };
        paces.lower(40, 3, 2, low);
        let mut count = RoomCount::NOTHING;
        count.add_move(&paces, 40, &FeedScale::new(100).room_measure());
        // Seven eighths at 128 and one at 20, or at 50 below half of normal speed; both changes lose a tick.
        let expected = |rate: u32| 35 * 128 + 5 * rate - 2 * (128 - rate);
        assert_eq!(count.room.0, [expected(20), expected(50)]);
    }
}
