//! Power lists, against what their levels say at each place of D.

use super::*;
use std::vec;
use trirrr_protocol::message::{
    AnyMove, Goal, LEVEL_PARTS, LevelPiece, LevelRange, ListedMove, QuinticMove,
};

const ROOM: usize = LEVELS;

crate::scene! {
    /// The thesis machine, which plays power lists.
    pub(super) ListedScene [N: ServiceNumber] [N]: Thesis<N>, batches = On, update = NoImage, levels = On
}

type Listing<N> = Bench<ListedScene<N>>;

/// Direction of rows.
const ALONG: [f64; 2] = [0.8, 0.6];

const SPEED: f64 = 0.1;

const POWER: f64 = 0.5;

/// Length of a level, m. A tick has 0.1 mm more.
const PITCH: f64 = 0.9e-3;

fn with_room<N: ServiceNumber>(scene: Thesis<N>) -> SceneParts<'static, ListedScene<N>> {
    SceneParts {
        levels: ROOM as u16,
        ..scene.into()
    }
}

fn listing<N: ServiceNumber>() -> Listing<N> {
    let scene = Adjustable::new(example(), LimitParameters::default());
    Bench::of(with_room(scene), home())
}

/// Ends of the three moves of a row on the way, m, and their ticks: from rest, at the speed of the row, to rest.
const ROW: [(f64, u32); 3] = [(0.01, 20), (0.031, 21), (0.041, 20)];

/// The moves of a row from move `first` on, beginning at home, and the levels that they have of a row's.
fn row<N: ServiceNumber>(first: u32) -> [(AnyMove<N>, usize, LevelRange); 3] {
    let at = |way: f64| pose::<N>(0.21 + way * ALONG[0], 0.22 + way * ALONG[1], 0.157);
    let speed = |moves: bool| {
        let [x, y] = ALONG.map(|part| if moves { SPEED * part } else { 0.0 });
        [x, y, 0.0].map(N::from_f64)
    };
    core::array::from_fn(|index| {
        let begin = if index == 0 { 0.0 } else { ROW[index - 1].0 };
        let (end, ticks) = ROW[index];
        let each = Move {
            start_velocity: speed(index > 0),
            end_velocity: speed(index < 2),
            tool_power: N::from_f64(POWER),
            tool_speed: N::from_f64(SPEED),
            ..rest(first + index as u32, at(begin), at(end), ticks)
        };
        let [begin, end] = [begin, end].map(|way| way / PITCH);
        let (from, to) = (begin.floor(), end.ceil());
        let parts = f64::from(LEVEL_PARTS);
        let offset = ((begin - from) * parts).round();
        let range = LevelRange {
            first: 0,
            count: (to - from) as u16,
            offset: offset as u16,
            span: ((end - begin) * parts).floor() as u32,
        };
        (AnyMove::Cubic(each), from as usize, range)
    })
}

/// Different levels one after the other, with none and the full one among them.
fn tones() -> Vec<u8> {
    (0..60)
        .map(|index| [0, 255, 31, 100, 7, 200, 64][index % 7])
        .collect()
}

impl<N: ServiceNumber> Listing<N> {
    /// Number of the next level.
    fn next_level(&mut self) -> u32 {
        match self.ask(Command::Levels(LevelPiece::new(u32::MAX / 2, &[0]))) {
            Reply::Refused(Refusal::LevelNumber { expected }) => expected,
            other => panic!("{other:?}"),
        }
    }

    /// Offers a move with these of the levels.
    fn list(&mut self, each: &AnyMove<N>, from: usize, range: LevelRange, tones: &[u8]) {
        let first = self.next_level();
        let own = &tones[from..from + usize::from(range.count)];
        self.done(Command::Levels(LevelPiece::new(first, own)));
        let start = self.status().end.expect("it stands");
        let number = each.common().number;
        let range = LevelRange { first, ..range };
        self.done(Command::Listed(ListedMove::new(
            number, &start, each, range,
        )));
        self.judge();
    }

    /// Offers a row.
    fn list_row(&mut self, tones: &[u8]) {
        let next = self.status().next;
        for (each, from, range) in row::<N>(next) {
            self.list(&each, from, range, tones);
        }
    }
}

/// Compares each sample of a row with the level at its place in the middle of the tick. Returns the indices of the levels played.
fn check<N: ServiceNumber>(telemetry: &[Telemetry<N>], tones: &[u8], error: f64) -> Vec<usize> {
    let mut played = Vec::new();
    for sample in telemetry {
        if !sample.state.is_running() {
            assert_eq!(sample.tool, N::ZERO);
            continue;
        }
        let setpoint = &sample.setpoint;
        let [x, y] = [setpoint.pose.position.x, setpoint.pose.position.y].map(N::to_f64);
        let [vx, vy] = [setpoint.velocity.x, setpoint.velocity.y].map(N::to_f64);
        let speed = vx.hypot(vy);
        let way = (x - 0.21) * ALONG[0] + (y - 0.22) * ALONG[1] + speed * PERIOD_S / 2.0;
        let level = |way: f64| (way / PITCH).clamp(0.0, tones.len() as f64 - 1.0) as usize;
        let power = POWER * speed / SPEED;
        // Where the middle of the tick is just at a border, either of both levels is right.
        let may = [way - error, way + error].map(level);
        let is_played = |index: &&usize| {
            let expected = power * f64::from(tones[**index]) / 255.0;
            (sample.tool.to_f64() - expected).abs() <= 1e-5
        };
        match may.iter().find(is_played) {
            Some(index) => played.push(*index),
            None => panic!("{sample:?}: {way} {may:?}"),
        }
    }
    played
}

/// Plays a row at `percent` of normal speed, with holds behind so many ticks.
fn play<N: ServiceNumber>(percent: u8, holds: &[u32], error: f64) -> Vec<usize> {
    let mut bench = listing::<N>();
    let tones = tones();
    bench.done(Command::FeedOverride { percent });
    bench.list_row(&tones);
    bench.tick();
    bench.telemetry.clear();
    bench.done(Command::Start);
    for ticks in holds {
        bench.ticks(*ticks);
        if bench.state() == State::Running {
            bench.done(Command::Hold);
            bench.until(State::Holding);
            bench.ticks(3);
            bench.done(Command::Resume);
        }
    }
    bench.until(State::Idle);
    check(&bench.telemetry, &tones, error)
}

#[test]
fn each_place_of_a_row_has_its_power_at_any_pace_and_across_holds() {
    fn of<N: ServiceNumber>(error: f64) {
        for percent in [100, 37, 1] {
            for holds in [&[][..], &[25], &[3, 20, 7, 1, 1, 40]] {
                let played = play::<N>(percent, holds, error);
                assert!(played.is_sorted(), "never back");
                if percent < 90 || !holds.is_empty() {
                    // Below the speed of a level a tick none is left out, but at the ends, where nothing moves.
                    let gaps = played.windows(2).any(|pair| pair[1] > pair[0] + 1);
                    assert!(percent == 100 || !gaps, "{percent} {played:?}");
                }
                assert_eq!(played.last(), Some(&45));
            }
        }
    }
    of::<f64>(1e-8);
    of::<f32>(1e-7);
}

/// At the speed of one level a tick, each level is played in one tick, wherever in the level ticks begin.
#[test]
fn a_level_a_tick_is_played_exactly_once() {
    for shift in [0.0, 0.1, 0.3, 0.45, 0.7, 0.95] {
        let tones: Vec<u8> = (0..=21).map(|index| 11 * index + 3).collect();
        let mut bench = listing::<f32>();
        for (each, _, range) in row::<f32>(0) {
            let number = each.common().number;
            match number {
                1 => {
                    let range = LevelRange {
                        count: 22,
                        offset: (shift * f64::from(LEVEL_PARTS)) as u16,
                        span: 21 * LEVEL_PARTS,
                        ..range
                    };
                    bench.list(&each, 0, range, &tones);
                }
                _ => bench.done(each.command()),
            }
        }
        bench.judge();
        bench.telemetry.clear();
        bench.done(Command::Start);
        bench.until(State::Idle);
        let own = bench.telemetry.iter().filter(|sample| sample.number == 1);
        let played: Vec<f64> = own
            .map(|sample| f64::from(sample.tool) / POWER * 255.0)
            .collect();
        let skipped = usize::from(shift >= 0.5);
        assert_eq!(played.len(), 21);
        for (index, level) in played.iter().enumerate() {
            let expected = f64::from(tones[index + skipped]);
            assert!(
                (level - expected).abs() < 1e-2,
                "{shift} {index}: {level} {expected}"
            );
        }
    }
}

#[test]
fn levels_that_do_not_fit_are_refused_and_change_nothing() {
    let mut plain = Bench::<Thesis<f64>>::new();
    let piece = LevelPiece::new(0, &[1, 2, 3]);
    let [(each, _, range), ..] = row::<f64>(0);
    let listed = |range| {
        ListedMove::new(
            0,
            &AnyMove::Cubic(rest(0, home(), home(), 1)).end(),
            &each,
            range,
        )
    };
    assert_eq!(plain.greet().levels, 0);
    plain.service.background.next_sequence_is(0);
    assert_eq!(plain.refused(Command::Levels(piece)), Refusal::NoLevels);
    assert_eq!(
        plain.refused(Command::Listed(listed(range))),
        Refusal::NoLevels
    );

    // The memory is there, and the scene plays no lists: on a host.
    let scene = Adjustable::new(example(), LimitParameters::default());
    let mut host: Listing<f64> = Bench::of(scene, home());
    assert_eq!(host.greet().levels, 0);
    host.service.background.next_sequence_is(0);
    assert_eq!(host.refused(Command::Levels(piece)), Refusal::NoLevels);
    assert_eq!(
        host.refused(Command::Listed(listed(range))),
        Refusal::NoLevels
    );

    let mut bench = listing::<f64>();
    assert_eq!(bench.greet().levels, ROOM as u16);
    bench.service.background.next_sequence_is(0);
    let number = |expected| Refusal::LevelNumber { expected };
    // A move that names levels which were not given is not taken.
    assert_eq!(bench.refused(Command::Listed(listed(range))), number(0));
    bench.done(Command::Levels(LevelPiece::new(0, &[9; 100])));
    assert_eq!(
        bench.refused(Command::Levels(LevelPiece::new(101, &[9]))),
        number(100)
    );
    assert_eq!(
        bench.refused(Command::Levels(LevelPiece::new(u32::MAX, &[9]))),
        number(100)
    );
    for count in [0, 129] {
        let wrong = LevelPiece {
            count,
            ..LevelPiece::new(100, &[9])
        };
        assert_eq!(bench.refused(Command::Levels(wrong)), Refusal::LevelRange);
    }
    // They may be sent anew from any of them on, as far as there is room.
    bench.done(Command::Levels(LevelPiece::new(0, &[9; 128])));
    bench.done(Command::Levels(LevelPiece::new(128, &[9; 128])));
    assert_eq!(
        bench.refused(Command::Levels(LevelPiece::new(256, &[9]))),
        Refusal::LevelsFull
    );
    let beyond = LevelRange {
        first: 250,
        ..range
    };
    assert_eq!(bench.refused(Command::Listed(listed(beyond))), number(256));
    // Levels all along the way, of a move that goes on, and not too many in a tick.
    let short = LevelRange {
        count: range.count - 2,
        ..range
    };
    let fine = LevelRange {
        count: 200,
        span: 41 * LEVEL_PARTS,
        ..range
    };
    for wrong in [short, fine, LevelRange { span: 0, ..range }] {
        assert_eq!(
            bench.refused(Command::Listed(listed(wrong))),
            Refusal::LevelRange
        );
    }
    let mut stands = listed(range);
    stands.step.to = home();
    assert_eq!(bench.refused(Command::Listed(stands)), Refusal::LevelRange);
    let mut turns = listed(range);
    turns.step.velocity = [-0.05, -0.05, 0.0];
    assert_eq!(bench.refused(Command::Listed(turns)), Refusal::LevelRange);
    let mut swings = listed(range);
    swings.step.velocity = [0.3, 0.3, 0.0];
    assert_eq!(bench.refused(Command::Listed(swings)), Refusal::LevelRange);
    let mut elsewhere = listed(range);
    elsewhere.check ^= 1;
    assert!(matches!(
        bench.refused(Command::Listed(elsewhere)),
        Refusal::Check { .. }
    ));
    assert_eq!(bench.status().next, 0);
    bench.done(Command::Listed(listed(range)));
    // Its levels are its own from now on.
    let own = u32::from(range.count);
    assert_eq!(
        bench.refused(Command::Levels(LevelPiece::new(own - 1, &[9]))),
        number(256)
    );
    bench.done(Command::Levels(LevelPiece::new(own, &[9])));
}

#[test]
fn a_row_after_another_is_played_as_room_comes_up() {
    let mut bench = listing::<f64>();
    let mut tones = tones();
    for pass in 0..12 {
        tones.rotate_left(pass);
        bench.list_row(&tones);
        bench.telemetry.clear();
        bench.done(Command::Start);
        bench.until(State::Idle);
        check(&bench.telemetry, &tones, 1e-8);
        let next = bench.status().next;
        let back = rest(next, bench.status().end.unwrap().pose, home(), 60);
        bench.offer(back);
        bench.done(Command::Start);
        bench.tick();
        bench.until(State::Idle);
    }
    assert!(bench.next_level() > 2 * ROOM as u32);
}

/// What is left of a row after a stop, in any tick, has no part in what is played afterwards.
#[test]
fn a_stop_drops_the_levels_of_all_moves() {
    let other = vec![77; 60];
    for ticks in [1, 2, 19, 20, 21, 22, 30, 41, 50] {
        let mut bench = listing::<f64>();
        bench.list_row(&tones());
        bench.done(Command::Start);
        bench.ticks(ticks);
        bench.done(Command::Stop);
        bench.until(State::Idle);
        let at = bench.status();
        assert_eq!(at.next, at.done);
        // The same numbers again: a move without levels has its whole power.
        let mut back = rest(at.next, at.end.unwrap().pose, home(), 60);
        (back.tool_power, back.tool_speed) = (0.25, 0.0);
        bench.offer(back);
        bench.telemetry.clear();
        bench.done(Command::Start);
        bench.until(State::Running);
        bench.until(State::Idle);
        let running = bench
            .telemetry
            .iter()
            .filter(|each| each.state.is_running());
        assert!(running.clone().count() >= 60);
        assert!(running.clone().all(|each| each.tool == 0.25), "{ticks}");
        bench.list_row(&other);
        bench.telemetry.clear();
        bench.done(Command::Start);
        bench.until(State::Running);
        bench.until(State::Idle);
        check(&bench.telemetry, &other, 1e-8);
        // All is free again.
        let next = bench.next_level();
        for piece in [0, 128] {
            bench.done(Command::Levels(LevelPiece::new(next + piece, &[1; 128])));
        }
    }
}

#[test]
fn a_refused_move_takes_its_levels_with_it() {
    let limits = LimitParameters {
        rate_rad_s: Some([0.9; 3]),
        ..LimitParameters::default()
    };
    let scene = Adjustable::new(example(), limits);
    let mut bench: Listing<f64> = Bench::of(with_room(scene), home());
    let tones = tones();
    let [first, second, _] = row::<f64>(0);
    bench.list(&first.0, first.1, first.2, &tones);
    let before = bench.next_level();
    let AnyMove::Cubic(mut fast) = second.0 else {
        panic!("a cubic");
    };
    fast.ticks = 12;
    bench.list(&AnyMove::Cubic(fast), second.1, second.2, &tones);
    assert!(bench.status().refused.is_some());
    assert_eq!((bench.status().next, bench.next_level()), (1, before));
    for (each, from, range) in row::<f64>(0).into_iter().skip(1) {
        bench.list(&each, from, range, &tones);
    }
    bench.telemetry.clear();
    bench.done(Command::Start);
    bench.until(State::Idle);
    check(&bench.telemetry, &tones, 1e-8);
}

/// A retarget cuts a listed move. What comes behind it has its own levels.
#[test]
fn a_retarget_drops_the_levels_behind_the_cut() {
    let mut bench = listing::<f64>();
    let tones = tones();
    bench.list_row(&tones);
    bench.telemetry.clear();
    bench.done(Command::Start);
    bench.ticks(5);
    bench.done(Command::Retarget(Goal {
        to: home(),
        velocity: [0.0; 3],
        cut: true,
        least_ticks: 0,
    }));
    bench.judge();
    while bench.status().cut.is_none() {
        bench.tick();
        bench.judge();
        assert!(bench.telemetry.len() < 100, "{:?}", bench.status());
    }
    let cut = bench.status().cut.unwrap();
    bench.until(State::Idle);
    let is_before = |sample: &Telemetry<f64>| sample.number.wrapping_sub(cut.next) as i32 <= -1;
    let (row, chain): (Vec<_>, Vec<_>) = bench.telemetry.iter().copied().partition(is_before);
    check(&row, &tones, 1e-8);
    assert!(chain.iter().all(|sample| sample.tool == 0.0));
    bench.list_row(&[50; 60]);
    bench.telemetry.clear();
    bench.done(Command::Start);
    bench.until(State::Idle);
    check(&bench.telemetry, &[50; 60], 1e-8);
}

/// Quintics have levels as cubics have: also from rest to rest, where D is fastest in the middle.
#[test]
fn a_quintic_has_levels_where_it_does_not_turn_back() {
    let mut bench = listing::<f64>();
    let at = |way: f64| pose::<f64>(0.21 + way * ALONG[0], 0.22 + way * ALONG[1], 0.157);
    let common = Move {
        tool_power: POWER,
        tool_speed: SPEED,
        ..rest(0, home(), at(0.036), 100)
    };
    let quintic = AnyMove::Quintic(QuinticMove {
        common,
        start_acceleration: [0.0; 3],
        end_acceleration: [0.0; 3],
    });
    let range = LevelRange {
        first: 0,
        count: 40,
        offset: 0,
        span: 40 * LEVEL_PARTS,
    };
    let start = bench.status().end.unwrap();
    bench.done(Command::Levels(LevelPiece::new(0, &tones()[..40])));
    let mut back = ListedMove::new(0, &start, &quintic, range);
    back.step.acceleration = Some([8.0, 6.0, 0.0]);
    assert_eq!(bench.refused(Command::Listed(back)), Refusal::LevelRange);
    bench.list(&quintic, 0, range, &tones());
    bench.telemetry.clear();
    bench.done(Command::Start);
    bench.until(State::Idle);
    let played = check(&bench.telemetry, &tones()[..40], 1e-8);
    assert!(played.is_sorted() && played.last() == Some(&39));
}
