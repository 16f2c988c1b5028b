//! Levels of one move.

use crate::number::ServiceNumber;
use crate::offered::Offered;
use trirrr_core::number::Number;
use trirrr_core::setpoint::{CurveKind, Setpoint};
use trirrr_protocol::message::{LEVEL_PARTS, LevelRange};

/// Most levels that the tool passes in a tick. [`MoveLevels::new`] refuses more.
pub(super) const STEPS: u32 = MEAN as u32 * GREATEST;

/// Most levels a tick in the mean of a move.
const MEAN: u64 = 2;

/// Greatest speed along the chord, in mean speeds.
const GREATEST: u32 = 6;

/// Mean speeds in which speeds along the chord are compared: more than [`GREATEST`], as not every number type has a 6.
const UNIT: u32 = 8;

/// Levels of a move, and the place of the tool among them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MoveLevels<N: Number> {
    pub(super) number: u32,
    /// As in a [`QueuedMove`](crate::handoff::QueuedMove).
    pub(super) generation: u8,
    pub(super) range: LevelRange,
    chord: Chord<N>,
    span: N::Count,
}

/// Way of D from one end of a move straight to the other.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Chord<N: Number> {
    from: [N; 2],
    /// The chord over the larger size of its two components, `m`: none of it is larger than 1.
    along: [N; 2],
    /// 1 over `m` and over the square of `along`: the fraction of the chord for what lies along it.
    per: N::Factor,
    /// The same for half the way of a tick at a velocity.
    lead: N::Factor,
}

impl<N: Number> Chord<N> {
    /// The chord between two places; none where they are the same.
    fn between(from: [N; 2], to: [N; 2], period: N::Factor) -> Option<Self> {
        let [x, y] = [to[0] - from[0], to[1] - from[1]];
        let (width, height) = (x.abs(), y.abs());
        let most = if width > height { width } else { height };
        if !(most > N::ZERO) {
            return None;
        }
        let most = most.reciprocal();
        let along = [x.scaled(most), y.scaled(most)];
        let square = N::ab_plus_cd(along[0], along[0], along[1], along[1]);
        let per = most * square.reciprocal();
        Some(Self {
            from,
            along,
            per,
            lead: per * N::quotient(1, 2) * period,
        })
    }

    /// What `vector` has along the chord, times `factor`.
    #[inline]
    fn of(&self, [x, y]: [N; 2], factor: N::Factor) -> N {
        let [a, b] = self.along;
        N::round_scaled(N::sum_ab_plus_cd(x, a, y, b), factor)
    }

    /// Fraction of the chord at which the tool is in the middle of the tick that begins at `setpoint`.
    #[inline]
    fn place(&self, setpoint: &Setpoint<N>) -> N {
        let (at, velocity) = (&setpoint.pose.position, &setpoint.velocity);
        let way = [at.x - self.from[0], at.y - self.from[1]];
        self.of(way, self.per) + self.of([velocity.x, velocity.y], self.lead)
    }
}

impl<N: ServiceNumber> MoveLevels<N> {
    /// The levels `range` of a move. None where D turns back along the chord or passes too many levels in a tick, as far as
    /// the Bernstein coefficients of the way's derivative bound it.
    pub(crate) fn new<K: CurveKind>(
        offered: &Offered<N, K>,
        range: LevelRange,
        period: N::Factor,
    ) -> Option<Self> {
        let common = &offered.common;
        let [from, to] = [common.from, common.to].map(|pose| pose.position.into());
        let chord = Chord::between(from, to, period)?;
        let ticks = u64::from(common.ticks);
        let is_fine = u64::from(range.span) > MEAN * u64::from(LEVEL_PARTS) * ticks;
        let duration = N::quotient(common.ticks, 1) * period;
        let speed = chord.per * duration * N::quotient(1, UNIT);
        let [start, end] =
            [common.start_velocity, common.end_velocity].map(|[x, y, _]| chord.of([x, y], speed));
        let bounds = match offered.quintic() {
            None => {
                let middle = N::ratio(3, UNIT) - start - end;
                [start, middle, middle, middle, end]
            }
            Some(accelerations) => {
                let change = speed * duration * N::quotient(1, 4);
                let [bend, unbend] = accelerations.map(|[x, y, _]| chord.of([x, y], change));
                let (next, last) = (start + bend, end - unbend);
                // Their mean is 1.
                let middle = N::ratio(5, UNIT) - start - next - last - end;
                [start, next, middle, last, end]
            }
        };
        // A little backwards is what the rounding of a rest has left.
        let least = -N::UNIT_ROUNDOFF.scaled(N::quotient(1 << 8, 1));
        let most = N::ratio(GREATEST, UNIT);
        let goes_on = bounds.iter().all(|&bound| bound >= least && bound <= most);
        (goes_on && !is_fine).then(|| Self {
            number: common.number,
            generation: 0,
            range,
            chord,
            span: N::count(range.span),
        })
    }

    /// The list of an admitted move, for the tick.
    pub(super) fn of_generation(self, generation: u8) -> Self {
        Self { generation, ..self }
    }

    /// Index of the level where the tool is from `setpoint` on, from the index of a tick before.
    #[inline]
    pub(super) fn index_from(&self, index: u16, setpoint: &Setpoint<N>) -> u16 {
        let place = self.chord.place(setpoint);
        let mut index = index;
        for _ in 0..=STEPS {
            let end = (u32::from(index) + 1).wrapping_mul(LEVEL_PARTS);
            let end = end.wrapping_sub(u32::from(self.range.offset));
            let is_last = index + 1 >= self.range.count || end >= self.range.span;
            if is_last || place < N::fraction(end, &self.span) {
                break;
            }
            index += 1;
        }
        index
    }
}
