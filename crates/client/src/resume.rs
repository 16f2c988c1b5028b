//! The rest of a job that was left on its way: back to the place, and on from there.
//!
//! The way back is a part of the job itself. It begins at the last rest before the place and follows the path with the tool off, at the
//! speeds of the job. So whatever was proven of the job is proven of the way back, and the machine passes the place in the very
//! motion in which it would have passed it. There the tool goes on.

use crate::job_client::JobWork;
use crate::job_mark::JobPlace;
use core::convert::Infallible;
use trirrr_core::number::Number;
use trirrr_core::setpoint::{Ends, Quintics, Segment};
use trirrr_protocol::message::{AnyMove, LEVEL_PARTS, LevelRange, Move, Transmit};
use trirrr_scene::{JobLevels, JobOutputs};

/// Shortest part of a move, s, in a number type whose roundings show in its acceleration, and the rounding below which they do not.
const SHORTEST_PART_S: f64 = 0.005;
const SHORTEST_PART_TICKS: u32 = 5;
const EXACT: f64 = 1e-12;

/// Moves that play a job from a place on.
#[derive(Clone, Debug, PartialEq)]
pub struct JobRest<N: Number> {
    moves: Vec<AnyMove<N>>,
    from: JobPlace,
    /// Moves of the way back to the place.
    lead: u32,
    /// Index in the whole job of the move behind these.
    next: u32,
    /// Levels of the moves.
    levels: JobLevels,
}

impl<N: Number> JobRest<N> {
    /// The rest of the job of `moves` from the place `from` on, and the way to there, on a machine with the tick period `period`, in
    /// its own units. Behind the end of the job nothing is left.
    pub fn new(moves: &[AnyMove<N>], from: JobPlace, period: N::Factor) -> Self {
        let get = |index: u32| Ok::<_, Infallible>(moves.get(index as usize).copied());
        let mut rest = match Self::opening(get, from, period) {
            Ok(rest) => rest,
            Err(never) => match never {},
        };
        let behind = moves.get(rest.next as usize..).unwrap_or_default();
        rest.moves.extend_from_slice(behind);
        rest.next += behind.len() as u32;
        rest
    }

    /// The same without the moves behind that in which the place is: those of the whole job follow from [`next`](Self::next) on.
    /// `get` reads a move of the job; none: the job is over before it. It is asked for one move after the other, backwards.
    ///
    /// # Errors
    /// Those of `get`.
    pub fn opening<E>(
        mut get: impl FnMut(u32) -> Result<Option<AnyMove<N>>, E>,
        from: JobPlace,
        period: N::Factor,
    ) -> Result<Self, E> {
        let mut from = from;
        let mut found = get(from.index)?;
        if let Some(cut) = &found {
            from.at = parting(cut, from.at, period);
        }
        if found.is_some_and(|each| from.at >= each.common().ticks) {
            from = JobPlace {
                index: from.index + 1,
                at: 0,
            };
            found = get(from.index)?;
        }
        let Some(cut) = found else {
            return Ok(Self {
                moves: Vec::new(),
                from,
                lead: 0,
                next: from.index,
                levels: JobLevels::default(),
            });
        };
        let mut opening = match from.at {
            0 => vec![cut],
            at => {
                let [before, behind] = split(&cut, at, period);
                vec![behind, without_tool(&before)]
            }
        };
        // Backwards to the last rest; the job begins at rest.
        let mut first = cut;
        for index in (0..from.index).rev() {
            if starts_at_rest(&first) {
                break;
            }
            let Some(before) = get(index)? else { break };
            opening.push(without_tool(&before));
            first = before;
        }
        opening.reverse();
        Ok(Self {
            lead: opening.len() as u32 - 1,
            moves: opening,
            from,
            next: from.index + 1,
            levels: JobLevels::default(),
        })
    }

    /// Index in the whole job of the move that follows [these](Self::moves): the number of its moves where none does.
    pub fn next(&self) -> u32 {
        self.next
    }

    /// The same of a job whose moves have the levels `levels`. A move that is cut goes on in the middle of a level.
    #[must_use]
    pub fn listed(
        moves: &[AnyMove<N>],
        levels: &JobLevels,
        from: JobPlace,
        period: N::Factor,
    ) -> Self {
        let mut rest = Self::new(moves, from, period);
        let JobPlace { index, at } = rest.from;
        let mut ranges = Vec::new();
        for (of, range) in levels.ranges.iter().filter(|(of, _)| *of >= index) {
            let place = of - index + rest.lead;
            let left = match (*of == index && at > 0, moves.get(*of as usize)) {
                (true, Some(cut)) => remaining(range, share(cut, at, period)),
                _ => Some(*range),
            };
            match (left, rest.moves.get_mut(place as usize)) {
                (Some(left), _) => ranges.push((place, left)),
                // D has arrived. Without levels the tool would have its whole power.
                (None, Some(each)) => *each = without_tool(each),
                (None, None) => {}
            }
        }
        rest.levels = JobLevels {
            ranges,
            levels: levels.levels.clone(),
        };
        rest
    }

    /// The moves as the work of a client.
    pub fn work(&self) -> JobWork<N>
    where
        N: Transmit,
    {
        JobWork::of(self.moves.clone(), &self.levels)
    }

    /// Returns the changes of outputs with these moves, of a job with `outputs`. All changes before the place come with it: on the way back the
    /// outputs are as the machine has them.
    pub fn outputs(&self, outputs: &JobOutputs) -> JobOutputs {
        outputs.rest(self.from.index, self.lead)
    }

    /// The moves, the way back first.
    pub fn moves(&self) -> &[AnyMove<N>] {
        &self.moves
    }

    /// Place from which the rest is played with the tool.
    pub fn from(&self) -> JobPlace {
        self.from
    }

    /// Place on the path of the whole job, of a place on these moves. On the way back nothing is gained.
    pub fn place(&self, place: JobPlace) -> JobPlace {
        match place.index.checked_sub(self.lead) {
            None => self.from,
            Some(0) => JobPlace {
                index: self.from.index,
                at: self.from.at + place.at,
            },
            Some(behind) => JobPlace {
                index: self.from.index + behind,
                at: place.at,
            },
        }
    }
}

fn starts_at_rest<N: Number>(each: &AnyMove<N>) -> bool {
    let accelerations = each.accelerations().unwrap_or([[N::ZERO; 3]; 2]);
    each.common().starts_at_rest() && accelerations[0] == [N::ZERO; 3]
}

fn without_tool<N: Number>(each: &AnyMove<N>) -> AnyMove<N> {
    let common = Move {
        tool_power: N::ZERO,
        tool_speed: N::ZERO,
        ..*each.common()
    };
    AnyMove::new(common, each.accelerations())
}

/// The curve of a move.
fn segment<N: Number>(each: &AnyMove<N>, period: N::Factor) -> Segment<N, Quintics> {
    let common = each.common();
    let ends = Ends {
        from: common.from,
        to: common.to,
        velocities: [common.start_velocity.into(), common.end_velocity.into()],
        accelerations: each.accelerations(),
    };
    Segment::new(&ends, common.ticks, period)
}

/// Tick at which the rest of a job parts a move, about `at`. With the tool off it begins with the move. Poses are rounded: the acceleration in
/// a part of few ticks would be off by more than the job leaves of its limits, so that no part is shorter than that: it begins earlier then.
fn parting<N: Number>(cut: &AnyMove<N>, at: u32, period: N::Factor) -> u32 {
    let common = cut.common();
    let ticks = common.ticks;
    if common.tool_power == N::ZERO && at < ticks {
        return 0;
    }
    if N::UNIT_ROUNDOFF.to_f64() < EXACT {
        return at;
    }
    let least = (SHORTEST_PART_S / N::factor_to_f64(period)).ceil() as u32;
    // In fixed point, which has no small numbers, the unit of time is that of the machine.
    let least = match N::from_f64(EXACT) == N::ZERO {
        true => least.max(SHORTEST_PART_TICKS),
        false => least,
    };
    // A few ticks are played twice rather than none.
    if at >= ticks {
        return at;
    }
    let latest = at.min(ticks.saturating_sub(least));
    if latest < least { 0 } else { latest }
}

/// The two parts of a move, before and behind its tick `at`: a part of a polynomial is one of the same degree.
fn split<N: Number>(whole: &AnyMove<N>, at: u32, period: N::Factor) -> [AnyMove<N>; 2] {
    let common = whole.common();
    let middle = segment(whole, period).at(at);
    let velocity: [N; 3] = middle.velocity.into();
    let acceleration: [N; 3] = middle.acceleration.into();
    let before = Move {
        to: middle.pose,
        end_velocity: velocity,
        ticks: at,
        ..*common
    };
    let behind = Move {
        from: middle.pose,
        start_velocity: velocity,
        ticks: common.ticks - at,
        ..*common
    };
    let accelerations = whole.accelerations();
    [
        AnyMove::new(
            before,
            accelerations.map(|[start, _]| [start, acceleration]),
        ),
        AnyMove::new(behind, accelerations.map(|[_, end]| [acceleration, end])),
    ]
}

/// Fraction of the chord of a move at which D is at the tick `at`.
fn share<N: Number>(each: &AnyMove<N>, at: u32, period: N::Factor) -> f64 {
    let segment = segment(each, period);
    let place = |at: u32| segment.at(at).pose.position.map(N::to_f64);
    let (start, end) = (place(0), place(each.common().ticks));
    let chord = end - start;
    ((place(at) - start).dot(&chord) / chord.dot(&chord)).clamp(0.0, 1.0)
}

/// Levels behind the fraction `share` of their move; none where nothing is left.
fn remaining(range: &LevelRange, share: f64) -> Option<LevelRange> {
    // The cast of what is not a number gives 0.
    let passed = (share * f64::from(range.span)).round() as u32;
    let begin = u64::from(range.offset) + u64::from(passed);
    let skipped = begin / u64::from(LEVEL_PARTS);
    let rest = LevelRange {
        first: range.first + skipped as u32,
        count: range.count.checked_sub(skipped as u16)?,
        offset: (begin % u64::from(LEVEL_PARTS)) as u16,
        span: range.span.checked_sub(passed)?,
    };
    rest.is_whole().then_some(rest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use trirrr_core::setpoint::{Pose, Setpoint};

    const PERIOD: f64 = 0.001;

    /// Two chains: a cubic and a quintic, then a quintic and two cubics; each from rest to rest.
    fn job() -> Vec<AnyMove<f64>> {
        let pose = |i: u32| {
            let x = 0.21 + 0.01 * f64::from(i);
            Pose::from_f64(
                x,
                0.22 + 0.003 * f64::from(i % 3),
                0.15 + 0.01 * f64::from(i),
            )
        };
        let velocity = [0.03, -0.02, 0.05];
        let acceleration = [0.1, 0.2, -0.1];
        let each = |i: u32, starts: bool, ends: bool, accelerations| {
            let common = Move {
                start_velocity: if starts { [0.0; 3] } else { velocity },
                end_velocity: if ends { [0.0; 3] } else { velocity },
                tool_power: 0.5,
                tool_speed: 0.1,
                ..Move::rest_to_rest(i, pose(i), pose(i + 1), 100 + i)
            };
            AnyMove::new(common, accelerations)
        };
        vec![
            each(0, true, false, None),
            each(1, false, true, Some([[0.0; 3]; 2])),
            each(2, true, false, Some([[0.0; 3], acceleration])),
            each(3, false, false, Some([acceleration, [0.0; 3]])),
            each(4, false, true, None),
        ]
    }

    /// Setpoints of all ticks, each with the tool's power: by the moves one after the other.
    fn played(moves: &[AnyMove<f64>]) -> Vec<(Setpoint<f64>, f64)> {
        let mut ticks = Vec::new();
        for each in moves {
            let common = each.common();
            let segment = segment(each, PERIOD);
            ticks.extend((0..common.ticks).map(|tick| (segment.at(tick), common.tool_power)));
        }
        ticks
    }

    fn length(parts: &[f64]) -> f64 {
        parts.iter().map(|part| part * part).sum::<f64>().sqrt()
    }

    fn is_near(one: &Setpoint<f64>, other: &Setpoint<f64>) -> bool {
        let (a, b) = (&one.pose, &other.pose);
        length((a.position - b.position).as_slice()) < 1e-12
            && (a.angle - b.angle).abs() < 1e-12
            && length((one.velocity - other.velocity).as_slice()) < 1e-10
            && length((one.acceleration - other.acceleration).as_slice()) < 1e-7
    }

    /// From any place: the motion is that of the job from the last rest on, with the tool on from the place.
    #[test]
    fn the_way_back_is_the_job_itself_with_the_tool_off() {
        let job = job();
        let whole = played(&job);
        let before = |index: u32| -> u32 {
            job[..index as usize]
                .iter()
                .map(|each| each.common().ticks)
                .sum()
        };
        for (index, at) in [
            (0, 0),
            (0, 60),
            (1, 1),
            (1, 100),
            (2, 0),
            (3, 50),
            (4, 0),
            (4, 103),
        ] {
            let rest = JobRest::new(&job, JobPlace { index, at }, PERIOD);
            let get = |index: u32| Ok::<_, ()>(job.get(index as usize).copied());
            let opening = JobRest::opening(get, JobPlace { index, at }, PERIOD).unwrap();
            let joined = [opening.moves(), &job[opening.next() as usize..]].concat();
            assert_eq!(joined, rest.moves(), "{index} {at}");
            assert_eq!(opening.from(), rest.from());
            assert_eq!(rest.next() as usize, job.len());
            let begin = if index < 2 { 0 } else { before(2) };
            let expected = &whole[begin as usize..];
            let found = played(rest.moves());
            assert_eq!(found.len(), expected.len(), "{index} {at}");
            let on = (before(index) + at - begin) as usize;
            for (tick, (found, expected)) in found.iter().zip(expected).enumerate() {
                assert!(is_near(&found.0, &expected.0), "{index} {at}: {tick}");
                let power = if tick < on { 0.0 } else { expected.1 };
                assert_eq!(found.1, power, "{index} {at}: {tick}");
            }
            // Each place of the rest is one of the job.
            let mut tick = begin;
            for (i, each) in (0..).zip(rest.moves()) {
                for at in [0, each.common().ticks - 1] {
                    let place = rest.place(JobPlace { index: i, at });
                    let there = before(place.index) + place.at;
                    assert_eq!(there, (tick + at).max(before(index) + rest.from().at));
                }
                tick += each.common().ticks;
            }
        }
    }

    #[test]
    fn a_place_at_the_end_of_a_move_is_the_start_of_the_next() {
        let job = job();
        let at = job[1].common().ticks;
        let rest = JobRest::new(&job, JobPlace { index: 1, at }, PERIOD);
        assert_eq!(rest.from(), JobPlace { index: 2, at: 0 });
        assert_eq!(rest.moves(), &job[2..]);
        let end = JobPlace {
            index: 4,
            at: job[4].common().ticks,
        };
        assert!(JobRest::new(&job, end, PERIOD).moves().is_empty());
        assert_eq!(JobRest::new(&job, JobPlace::default(), PERIOD).moves(), job);
    }

    /// Power of a place on a chord, from levels and their range.
    fn level(levels: &JobLevels, range: &LevelRange, share: f64) -> u8 {
        let parts = f64::from(range.offset) + share * f64::from(range.span);
        let index = (parts / f64::from(LEVEL_PARTS)) as usize;
        levels.levels[range.first as usize + index.min(usize::from(range.count) - 1)]
    }

    /// Cut at any tick: each place of what is left has the level that it had.
    #[test]
    fn what_is_left_of_a_move_keeps_its_levels() {
        let job = job();
        let levels = JobLevels {
            levels: (0..90).map(|index| (index * 37 % 256) as u8).collect(),
            ranges: vec![
                (
                    1,
                    LevelRange {
                        first: 0,
                        count: 41,
                        offset: 1234,
                        span: 40 * LEVEL_PARTS,
                    },
                ),
                (
                    2,
                    LevelRange {
                        first: 41,
                        count: 49,
                        offset: 0,
                        span: 49 * LEVEL_PARTS - 7,
                    },
                ),
            ],
        };
        for at in [0, 1, 13, 50, 99, 100] {
            let from = JobPlace { index: 1, at };
            let rest = JobRest::listed(&job, &levels, from, PERIOD);
            let begin = share(&job[1], at, PERIOD);
            let JobWork::Listed {
                moves,
                levels: left,
            } = rest.work()
            else {
                panic!("it has levels");
            };
            assert_eq!(moves, rest.moves());
            // Behind the way back: the rest of the move, and the next one.
            let [first, next] = &left.ranges[..] else {
                panic!("{:?}", left.ranges);
            };
            assert_eq!(
                (first.0, next),
                (rest.lead, &(rest.lead + 1, levels.ranges[1].1))
            );
            for step in 0..=1000 {
                let within = (f64::from(step) + 0.5) / 1001.0;
                let whole = begin + within * (1.0 - begin);
                let parts = 1234.0 + whole * f64::from(levels.ranges[0].1.span);
                let is_border = (parts / f64::from(LEVEL_PARTS))
                    .fract()
                    .min(1.0 - (parts / f64::from(LEVEL_PARTS)).fract())
                    < 1e-4;
                let found = level(&left, &first.1, within);
                let expected = level(&levels, &levels.ranges[0].1, whole);
                assert!(found == expected || is_border, "{at} {step}");
            }
        }
        // Where nothing of the levels is left, the tool is off.
        let short = LevelRange {
            first: 0,
            count: 1,
            offset: 0,
            span: 1,
        };
        let ended = JobLevels {
            levels: vec![255],
            ranges: vec![(1, short)],
        };
        let rest = JobRest::listed(&job, &ended, JobPlace { index: 1, at: 99 }, PERIOD);
        assert!(rest.levels.is_empty());
        assert_eq!(rest.moves()[rest.lead as usize].common().tool_power, 0.0);
        // At the end of the move nothing of its levels is left.
        let from = JobPlace { index: 2, at: 0 };
        let rest = JobRest::listed(&job, &levels, from, PERIOD);
        assert_eq!(rest.levels.ranges, [(0, levels.ranges[1].1)]);
    }
}
