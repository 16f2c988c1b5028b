use super::*;
use crate::feed::PathPosition;
use crate::pace::{FULL, Pace};
use proptest::prelude::*;
use std::vec;
use std::vec::Vec;

/// Most ticks, and most way, of D at `speeds` per tick of each move.
fn longest(moves: &[PacedMove], ramp: u16, speeds: &[f64]) -> (u64, f64) {
    let job = StopJob::new(moves, ramp, true, true);
    let mut longest = (0, 0.0f64);
    job.each(moves.len(), |stops| {
        let to = stops.to.expect("the end of the job");
        let fastest = speeds.iter().copied().fold(0.0, f64::max);
        let way = way_to(&job, speeds, to) - way_to(&job, speeds, stops.from);
        let way = way.min(job.ticks(stops.parts) * fastest);
        let longer = [stops.ticks > longest.0, way > longest.1];
        let mut looks = longer.into_iter().zip(stops.is_narrow);
        if looks.any(|(longer, narrow)| longer && !narrow) {
            return true;
        }
        longest = (longest.0.max(stops.ticks), longest.1.max(way));
        false
    });
    longest
}

fn way_to(job: &StopJob, speeds: &[f64], place: PathPlace) -> f64 {
    let passed = job.moves.iter().zip(speeds).take(place.index);
    let passed: f64 = passed
        .map(|(each, speed)| f64::from(each.ticks) * speed)
        .sum();
    passed + job.ticks(place.parts) * speeds[place.index]
}

/// Plays a stop from a level, as the tick does: ticks until it stands, and its place.
fn play(job: &StopJob, ramp: u16, from: PathPlace, level: u64) -> (u64, PathPlace) {
    let moves = job.moves;
    let mut feed = FeedScale::new(ramp);
    feed.be_at(level as u32);
    let whole = job.whole();
    let mut index = from.index;
    let mut position = PathPosition {
        tick: (from.parts / whole) as u32,
        part: (from.parts % whole) as u32,
    };
    let mut ticks = 0;
    while !feed.is_at_rest() {
        let PacedMove {
            ticks: length,
            paces,
            ..
        } = moves[index];
        let is_ahead = |part: &u32| position.tick < MovePaces::end_of(length, *part);
        let part = (0..8).find(is_ahead).expect("a place before the end");
        let end = MovePaces::end_of(length, part);
        let next = match end < length {
            true => Some(paces.of(part + 1)),
            false => moves.get(index + 1).map(|next| next.paces.of(0)),
        };
        let pace = paces.of(part);
        let both = [pace, next.unwrap_or(pace)];
        let step = feed.across(position, end, both, |paces| feed.slower(paces));
        position = feed.take(step, position);
        ticks += 1;
        if position.tick >= length {
            if index + 1 == moves.len() {
                // A tick later the machine says so, unless it is at rest anyway.
                ticks += u64::from(!feed.is_at_rest());
                let parts = u64::from(length) * whole;
                return (ticks, PathPlace { index, parts });
            }
            position.tick -= length;
            index += 1;
        }
    }
    let parts = u64::from(position.tick) * whole + u64::from(position.part);
    (ticks, PathPlace { index, parts })
}

/// Place so many parts of a tick behind the start.
fn place(job: &StopJob, mut parts: u64) -> PathPlace {
    let mut index = 0;
    let length = |index: usize| u64::from(job.moves[index].ticks) * job.whole();
    while parts >= length(index) {
        parts -= length(index);
        index += 1;
    }
    PathPlace { index, parts }
}

fn paced(ticks: u32, slower: &[[u8; 2]], rests: bool) -> PacedMove {
    let mut paces = MovePaces::FULL;
    let log2 = MovePaces::parts_log2(ticks);
    for index in 0..1 << log2 {
        let faster = [FULL; 2];
        let slower = slower[index as usize % slower.len()];
        paces.lower(ticks, log2, index, Pace { slower, faster });
    }
    PacedMove {
        ticks,
        paces,
        rests,
    }
}

#[test]
fn with_room_all_along_a_stop_takes_its_ramp() {
    for ramp in [1, 2, 10, 99] {
        let moves = [40, 10, 3, 300, 1000].map(|ticks| paced(ticks, &[[FULL; 2]], true));
        let (ticks, way) = longest(&moves, ramp, &[1.0; 5]);
        assert_eq!(ticks, u64::from(ramp));
        let half = f64::from(ramp) / 2.0;
        assert!(way >= half && way <= 1.02 * half + 0.02, "{ramp}: {way}");
    }
}

/// A stop that begins just before parts without room at more than half of normal speed waits there, the longer the slower it comes.
#[test]
fn a_stop_waits_for_room_and_longer_at_a_lower_pace() {
    let full = paced(400, &[[FULL; 2]], false);
    let moves = [full, paced(200, &[[FULL, 0]], false), full];
    let job = StopJob::new(&moves, 100, true, true);
    let (ticks, _) = longest(&moves, 100, &[1.0; 3]);
    let stop = |parts, percent| play(&job, 100, place(&job, parts), percent * job.top / 100).0;
    let at_once = stop(400 * job.whole(), 100);
    let slow = stop(400 * job.whole(), 51);
    assert!(at_once < 310 && slow > 440, "{at_once} {slow}");
    let before = (350 * 64..400 * 64).map(|part| stop(part * job.whole() / 64, 100));
    let worst = before.max().expect("some");
    assert!(worst > slow + 40, "{worst} {slow}");
    assert!(ticks >= worst && ticks < worst + 15, "{ticks} {worst}");
}

/// All places and all levels of small jobs.
#[test]
fn no_stop_of_a_small_job_takes_more() {
    let jobs: [&[(u32, [u8; 2], bool)]; 4] = [
        &[
            (3, [128, 128], false),
            (2, [128, 0], false),
            (1, [70, 9], true),
            (4, [128, 128], true),
        ],
        &[
            (1, [128, 0], false),
            (1, [100, 100], false),
            (1, [128, 0], false),
            (3, [77, 3], true),
        ],
        &[(2, [5, 1], false), (1, [1, 0], false), (2, [128, 60], true)],
        &[(1, [0, 0], false), (3, [128, 128], true)],
    ];
    for moves in jobs {
        let moves: Vec<_> = moves
            .iter()
            .map(|(t, s, rests)| paced(*t, &[*s], *rests))
            .collect();
        let speeds: Vec<_> = (0..moves.len()).map(|i| 1.0 + i as f64).collect();
        for ramp in [1, 2] {
            let job = StopJob::new(&moves, ramp, true, true);
            let (most, most_way) = longest(&moves, ramp, &speeds);
            let parts = moves.iter().map(|each| u64::from(each.ticks)).sum::<u64>() * job.whole();
            for from in (0..parts).map(|parts| place(&job, parts)) {
                for level in 1..=job.top {
                    let (ticks, to) = play(&job, ramp, from, level);
                    let way = way_to(&job, &speeds, to) - way_to(&job, &speeds, from);
                    assert!(
                        ticks <= most && way <= most_way + 1e-9,
                        "{from:?} {level} {ticks}"
                    );
                }
            }
        }
    }
}

fn rates() -> impl Strategy<Value = [u8; 2]> {
    let any = || prop_oneof![Just(0u8), Just(FULL), 0u8..6, 90u8..=FULL, 0..=FULL];
    prop_oneof![
        1 => Just([FULL; 2]),
        2 => any().prop_map(|normal| [FULL, normal]),
        2 => (any(), any()).prop_map(|(a, b)| [a.max(b), a.min(b)]),
    ]
}

fn moves(most: u32) -> impl Strategy<Value = Vec<(PacedMove, f64)>> {
    let each = (
        1..=most,
        proptest::collection::vec(rates(), 1..9),
        any::<bool>(),
        0.1..9.0,
    );
    let each = each.prop_map(|(ticks, slower, rests, speed)| (paced(ticks, &slower, rests), speed));
    proptest::collection::vec(each, 1..9)
}

/// `count` stops of a job, from anywhere at any pace: none takes more.
fn compare(
    ramp: u16,
    moves: Vec<(PacedMove, f64)>,
    starts: &[(u64, u64)],
) -> Result<(), TestCaseError> {
    let (moves, speeds): (Vec<_>, Vec<_>) = moves.into_iter().unzip();
    let job = StopJob::new(&moves, ramp, true, true);
    let (most, most_way) = longest(&moves, ramp, &speeds);
    let parts = moves.iter().map(|each| u64::from(each.ticks)).sum::<u64>() * job.whole();
    for (at, level) in starts {
        // At normal speed from whole ticks, from anywhere, and at any level.
        let (at, level) = match level % 4 {
            0 => (at % parts / job.whole() * job.whole(), job.top),
            1 => (at % parts, job.top),
            _ => (at % parts, 1 + level % job.top),
        };
        let from = place(&job, at);
        let (ticks, to) = play(&job, ramp, from, level);
        let way = way_to(&job, &speeds, to) - way_to(&job, &speeds, from);
        prop_assert!(ticks <= most, "{ticks} {most}, {from:?} at {level}");
        prop_assert!(
            way <= most_way * (1.0 + 1e-12),
            "{way} {most_way}, {from:?} at {level}"
        );
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 100, ..ProptestConfig::default() })]

    #[test]
    fn no_stop_takes_more(
        (ramp, moves) in (1u16..60).prop_flat_map(|ramp| (Just(ramp), moves(40))),
        starts in proptest::collection::vec(any::<(u64, u64)>(), 100),
    ) {
        compare(ramp, moves, &starts)?;
    }

    /// Rates of a longest stop keep it at any pace: each tick lowers the level by the least rate or more.
    #[test]
    fn a_longest_stop_is_kept_at_any_pace(
        (ramp, factor) in (1u16..60, 1.0..40.0),
        moves in moves(40),
        at: u64,
        level: u64,
    ) {
        let most = (f64::from(ramp) * factor) as u32;
        let [rate, _] = crate::paces::Ramp::within(ramp, Some(most)).least.slower;
        let moves: Vec<_> = moves.into_iter().map(|(each, _)| {
            let slower: Vec<_> = (0..8).map(|part| each.paces.of(part).slower.map(|own| own.max(rate))).collect();
            paced(each.ticks, &slower, each.rests)
        }).collect();
        let job = StopJob::new(&moves, ramp, true, true);
        let parts = moves.iter().map(|each| u64::from(each.ticks)).sum::<u64>() * job.whole();
        let (ticks, _) = play(&job, ramp, place(&job, at % parts), 1 + level % job.top);
        let most = u64::from(most.max(ramp.into()));
        prop_assert!(ticks <= most);
        let (bound, _) = longest(&moves, ramp, &vec![1.0; moves.len()]);
        prop_assert!(bound <= most, "{bound} {most}");
    }
}
