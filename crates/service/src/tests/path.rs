//! Along the path: the segments' own bits, holds that stay on it, limits that hold.

use super::*;
use crate::number::ServiceNumber;
use nalgebra::Vector3;
use trirrr_core::setpoint::{Hermite, RestToRest, Segment, Setpoint};
use trirrr_core::units::Units;
use trirrr_protocol::message::{Acting, Bounded, FaultCode};

fn segment<N: ServiceNumber>(each: &Move<N>) -> Segment<N> {
    let period = N::factor_from_f64(PERIOD_S);
    let (start, end) = (each.start_velocity.into(), each.end_velocity.into());
    if each.is_rest_to_rest() {
        Segment::RestToRest(RestToRest::new(each.from, each.to, each.ticks, period))
    } else {
        Segment::Hermite(Hermite::new(
            each.from, start, each.to, end, each.ticks, period,
        ))
    }
}

/// A chain without a stop, one move of two ticks, one of a single tick, and a stop in the middle.
pub(super) fn chain<N: ServiceNumber>() -> Vec<Move<N>> {
    let v = |x: f64, y: f64, a: f64| [x, y, a].map(N::from_f64);
    let poses = [
        (0.21, 0.22, 0.157),
        (0.23, 0.23, 0.16),
        (0.232, 0.231, 0.161),
        (0.233, 0.2315, 0.1615),
        (0.25, 0.24, 0.17),
        (0.25, 0.26, 0.12),
        (0.23, 0.25, 0.1),
    ];
    let speeds = [
        v(0.0, 0.0, 0.0),
        v(0.1, 0.05, 0.05),
        v(0.1, 0.05, 0.05),
        v(0.1, 0.05, 0.05),
        v(0.0, 0.0, 0.0),
        v(-0.05, 0.0, 0.1),
        v(0.0, 0.0, 0.0),
    ];
    let ticks = [40, 2, 1, 35, 50, 60];
    (0..6)
        .map(|index| Move {
            start_velocity: speeds[index],
            end_velocity: speeds[index + 1],
            tool_power: N::from_f64(0.5),
            tool_speed: N::from_f64(0.2),
            ..rest(
                index as u32,
                pose(poses[index].0, poses[index].1, poses[index].2),
                pose(poses[index + 1].0, poses[index + 1].1, poses[index + 1].2),
                ticks[index],
            )
        })
        .collect()
}

fn ready<N: ServiceNumber>() -> Bench<Thesis<N>> {
    let mut bench = Bench::new();
    for each in chain() {
        bench.offer(each);
    }
    bench.done(Command::Start);
    bench
}

/// The setpoints of the job as they are without a service.
pub(super) fn expected<N: ServiceNumber>() -> Vec<Setpoint<N>> {
    let chain = chain::<N>();
    let mut all: Vec<Setpoint<N>> = Vec::new();
    for each in &chain {
        let segment = segment(each);
        all.extend((0..each.ticks).map(|tick| segment.at(tick)));
    }
    let last = &chain[chain.len() - 1];
    all.push(segment(last).at(last.ticks));
    all
}

fn plays_in_the_segments_own_bits<N: ServiceNumber>() {
    let mut bench = ready::<N>();
    bench.until(State::Idle);
    let samples: Vec<&Telemetry<N>> = bench
        .telemetry
        .iter()
        .filter(|sample| sample.state == State::Running)
        .collect();
    let expected = expected::<N>();
    assert_eq!(samples.len(), expected.len());
    for (index, (sample, setpoint)) in samples.iter().zip(&expected).enumerate() {
        assert_eq!(sample.setpoint, *setpoint, "{index}");
        assert_eq!(sample.part, 0);
    }
    // Not a tick is missing.
    let ticks: Vec<u32> = samples.iter().map(|sample| sample.tick).collect();
    assert!(ticks.windows(2).all(|pair| pair[1] == pair[0] + 1));
    let status = bench.status();
    assert_eq!(status.done, 6);
    assert_eq!(status.end.unwrap().pose, chain::<N>()[5].to);
}

#[test]
fn a_chain_is_played_in_the_segments_own_bits() {
    plays_in_the_segments_own_bits::<f64>();
    plays_in_the_segments_own_bits::<f32>();
}

/// Wherever a hold comes, across the ends of moves too: the setpoint is a point of the path, with
/// the path's own derivatives scaled, time along the path is what the ramp says, and afterwards the
/// job goes on in its own bits, exactly the ticks later that the hold cost.
#[test]
fn holds_stay_on_the_path_and_end_in_its_bits() {
    let ramp = u32::from(RAMP);
    let moves = chain::<f64>();
    let expected = expected::<f64>();
    for at in 1..185 {
        let mut bench = ready::<f64>();
        bench.ticks(at);
        bench.done(Command::Hold);
        bench.ticks(ramp + 7);
        let held = bench.service.foreground.state() == State::Holding;
        if held {
            bench.done(Command::Resume);
        }
        bench.until(State::Idle);

        let samples: Vec<Telemetry<f64>> = bench
            .telemetry
            .iter()
            .filter(|sample| sample.state != State::Idle)
            .copied()
            .collect();
        let top = i64::from(128 * ramp);
        let (mut level, mut place) = (top, -2 * top);
        for sample in &samples {
            // The level that the state tells, from one tick to the next.
            let next = match sample.state {
                State::Slowing | State::Holding => (level - 128).max(0),
                _ => (level + 128).min(top),
            };
            let slope = (next - level) as f64;
            place += level + next;
            level = next;
            let (u, change) = (level as f64 / top as f64, slope / (top as f64 * PERIOD_S));

            // The job's own time, in parts.
            let before: u32 = moves[..sample.number as usize]
                .iter()
                .map(|each| each.ticks)
                .sum();
            let total = 2 * top * i64::from(before + sample.at) + i64::from(sample.part);
            let end = 2 * top * 188;
            assert_eq!(total, place.min(end), "hold at {at}, tick {}", sample.tick);

            let each = &moves[sample.number as usize];
            let passed = f64::from(sample.at) + f64::from(sample.part) / (2 * top) as f64;
            let on_path = segment(each).at_fraction(passed / f64::from(each.ticks));
            let setpoint = &sample.setpoint;
            // Both round a few times at sizes below 1: 16 u. The accelerations are up to 40 in
            // size (h / T^2 of the move of one tick): another 40 times.
            let apart = |a: Vector3<f64>, b: Vector3<f64>| (a - b).abs().max();
            let position = setpoint.pose.position - on_path.pose.position;
            assert!(position.abs().max() < 16.0 * f64::EPSILON);
            assert!((setpoint.pose.angle - on_path.pose.angle).abs() < 16.0 * f64::EPSILON);
            let velocity = on_path.velocity * u;
            assert!(apart(setpoint.velocity, velocity) < 64.0 * f64::EPSILON);
            let acceleration = on_path.acceleration * (u * u) + on_path.velocity * change;
            assert!(apart(setpoint.acceleration, acceleration) < 640.0 * f64::EPSILON);
        }

        // Before and after, in the bits.
        assert_eq!(samples[0].setpoint, expected[0]);
        for (sample, setpoint) in samples.iter().zip(&expected).take(at as usize) {
            assert_eq!(sample.setpoint, *setpoint);
        }
        let last = samples.last().unwrap();
        // A hold so late that the job ends before normal speed is reached again is another matter.
        if held && at + ramp < 188 {
            assert_eq!(last.setpoint, *expected.last().unwrap(), "hold at {at}");
            // 7 ticks held, and 2 R ticks of ramps for R ticks of path.
            assert_eq!(samples.len() - expected.len(), (7 + ramp) as usize);
            let tail = expected.len() - (at + ramp) as usize;
            let (samples, expected) = (samples.iter().rev(), expected.iter().rev());
            for (sample, setpoint) in samples.zip(expected).take(tail) {
                assert_eq!(sample.setpoint, *setpoint, "hold at {at}");
            }
        }
        // The end is exact in any case.
        assert_eq!(bench.status().end.unwrap().pose, moves[5].to);
    }
}

/// In fixed point too: the segment's own bits, a hold, and exactly the end.
#[test]
fn fixed_point_plays_and_holds() {
    use trirrr_core::number::{Arithmetic, Fixed, WideArithmetic};
    use trirrr_protocol::message::scene::{Section, SectionName};
    // A quarter of a metre, a quarter of a second, half a kilogram: with them all values of the
    // tick fit the format.
    let units = Units {
        length: -2,
        time: -2,
        mass: -1,
    };
    let place = |x: f64, y: f64, alpha: f64| pose::<Fixed>(4.0 * x, 4.0 * y, alpha);
    let scene = Adjustable::new(
        units.parameters(&example()),
        units.limits(&LimitParameters::default()),
    );
    let home = place(0.21, 0.22, 0.157);
    let mut bench = Bench::<Thesis<Fixed>>::in_units(scene, home, units);
    // On the line the scene is in SI.
    let Reply::Section(Section::Leg { leg, .. }) = bench.ask(Command::Read(SectionName::Leg(1)))
    else {
        panic!("a leg");
    };
    assert_eq!(
        trirrr_core::machine::LegParameters::from(&leg),
        example().legs[1]
    );
    bench.done(Command::Replace(Section::Leg { index: 1, leg }));
    bench.ticks(2);
    let from = bench.status().end.unwrap().pose;

    let offered = Move {
        tool_power: Fixed::from_f64(0.5),
        // Both units are a quarter: 0.01 m/s.
        tool_speed: Fixed::from_f64(0.01),
        ..rest(0, from, place(0.28, 0.28, 0.2), 100)
    };
    let period = Fixed::factor_from_f64(units.time(PERIOD_S));
    let segment = RestToRest::new(offered.from, offered.to, 100, period);
    bench.telemetry.clear();
    bench.offer(offered);
    assert_eq!(bench.status().refused, None);
    bench.done(Command::Start);
    bench.ticks(30);
    bench.done(Command::Hold);
    bench.until(State::Holding);
    bench.done(Command::Resume);
    bench.until(State::Idle);
    let status = bench.status();
    assert_eq!((status.done, status.fault), (1, None));
    assert_eq!(status.end.unwrap().pose, offered.to);
    let (mut normal, mut full) = (0, 0);
    for sample in &bench.telemetry {
        if sample.state == State::Running && sample.acting == Acting::Nothing {
            assert_eq!(sample.setpoint, segment.at(sample.at));
            assert_eq!(sample.part, 0);
            normal += 1;
        }
        full += usize::from(sample.tool == Fixed::ONE);
    }
    // All but the ten ticks of path that the two ramps cover between them.
    assert_eq!(normal, 101 - 10);
    // 0.5 at 0.01 m/s is all there is at 0.02 m/s and beyond.
    assert!(full > 50);
}

/// Limits that the job keeps with little to spare are kept in every tick of every hold.
#[test]
fn limits_are_kept_on_the_ramps() {
    let job = chain::<f64>();
    let limits = LimitParameters {
        rate_rad_s: Some([0.7; 3]),
        acceleration_rad_s2: Some([9.0; 3]),
        torque_nm: Some([0.1; 3]),
        power_w: Some([0.06; 3]),
        ..LimitParameters::default()
    };
    let mut peaks = [0.0f64; 4];
    for at in (1..185).step_by(3) {
        let mut bench = Bench::<Thesis<f64>>::with(example(), limits);
        for each in &job {
            bench.offer(*each);
        }
        assert_eq!(bench.status().admitted, 6, "{:?}", bench.status().refused);
        bench.done(Command::Start);
        bench.ticks(at);
        bench.done(Command::Hold);
        for _ in 0..400 {
            let output = bench.tick();
            for motor in &output.motors {
                let power = motor.torque * motor.rate;
                for (peak, (value, limit)) in peaks.iter_mut().zip([
                    (motor.rate, 0.7),
                    (motor.acceleration, 9.0),
                    (motor.torque, 0.1),
                    (power, 0.06),
                ]) {
                    assert!(value.abs() <= limit);
                    *peak = peak.max(value.abs() / limit);
                }
            }
            if bench.service.foreground.state() == State::Holding {
                bench.done(Command::Resume);
            }
        }
        assert_eq!(bench.state(), State::Idle);
        assert_eq!(bench.status().fault, None);
    }
    // It was not far from the limits, or this would show nothing.
    assert!(peaks.iter().all(|peak| *peak > 0.6), "{peaks:?}");
}

/// The greatest of what the motors do on a job at normal speed.
fn peaks(samples: &[Telemetry<f64>]) -> [f64; 4] {
    let mut peaks = [0.0f64; 4];
    for sample in samples {
        for motor in 0..3 {
            let (rate, torque) = (sample.rates[motor], sample.torques[motor]);
            let values = [rate, sample.accelerations[motor], torque, rate * torque];
            for (peak, value) in peaks.iter_mut().zip(values) {
                *peak = peak.max(value.abs());
            }
        }
    }
    peaks
}

/// A job from rest to rest whose ends take all that the limits give, with a stop in the middle, and quick moves between.
fn tight_job() -> (Vec<Move<f64>>, LimitParameters) {
    let poses = [
        home(),
        pose(0.25, 0.24, 0.17),
        pose(0.25, 0.27, 0.1),
        pose(0.22, 0.23, 0.15),
    ];
    let job: Vec<_> = (0..3)
        .map(|index| rest(index, poses[index as usize], poses[index as usize + 1], 60))
        .collect();
    let mut bench = Bench::<Thesis<f64>>::new();
    for each in &job {
        bench.offer(*each);
    }
    bench.done(Command::Start);
    bench.until(State::Idle);
    let [rate, acceleration, torque, power] = peaks(&bench.telemetry).map(|peak| 1.01 * peak);
    let limits = LimitParameters {
        rate_rad_s: Some([rate; 3]),
        acceleration_rad_s2: Some([acceleration; 3]),
        torque_nm: Some([torque; 3]),
        power_w: Some([power; 3]),
        ..LimitParameters::default()
    };
    (job, limits)
}

/// A job that uses its limits to a hundredth is admitted. A hold anywhere takes what room there is: it comes to rest, no
/// limit is broken, and the job ends in its own bits.
#[test]
fn holds_take_the_room_that_there_is() {
    let (job, limits) = tight_job();
    let (mut longest, mut greatest) = (0, [0.0f64; 4]);
    for at in 1..178 {
        let mut bench = Bench::<Thesis<f64>>::with(example(), limits);
        for each in &job {
            bench.offer(*each);
        }
        assert_eq!(bench.status().admitted, 3, "{:?}", bench.status().refused);
        bench.done(Command::Start);
        bench.ticks(at);
        bench.done(Command::Hold);
        let mut ticks = 0;
        while !matches!(bench.state(), State::Holding | State::Idle) {
            bench.ticks(1);
            ticks += 1;
        }
        longest = longest.max(ticks);
        if bench.state() == State::Holding {
            bench.done(Command::Resume);
            bench.until(State::Idle);
        }
        let status = bench.status();
        assert_eq!((status.fault, status.done), (None, 3), "hold at {at}");
        assert_eq!(status.end.unwrap().pose, job[2].to);
        let all = [
            limits.rate_rad_s,
            limits.acceleration_rad_s2,
            limits.torque_nm,
            limits.power_w,
        ];
        for (index, peak) in peaks(&bench.telemetry).into_iter().enumerate() {
            let limit = all[index].unwrap()[0];
            assert!(peak <= limit, "hold at {at}: {index} {peak} {limit}");
            greatest[index] = greatest[index].max(peak / limit);
        }
    }
    // Longer than with room all along, for it waits where the motion brakes by itself; and not much longer than two moves.
    assert!((2 * u32::from(RAMP)..120).contains(&longest), "{longest}");
    assert!(greatest.iter().all(|part| *part > 0.98), "{greatest:?}");
}

/// With a longest stop, a move that leaves no room for it is refused: only a ramp breaks the limit.
#[test]
fn a_longest_stop_is_kept_or_the_move_refused() {
    let (job, limits) = tight_job();
    let judged = |most| {
        let ramp = Ramp::within(RAMP, most);
        let limits = trirrr_core::limits::Limits::build(&limits).unwrap();
        let mut admission =
            crate::admission::Admission::<Dynamic<f64>>::build(&example(), limits, ramp, PERIOD_S)
                .unwrap();
        admission.offer(&job[0]);
        loop {
            match admission.step() {
                crate::admission::Verdict::Undecided => {}
                verdict => break verdict,
            }
        }
    };
    use crate::admission::Verdict;
    assert_eq!(judged(None), Verdict::Admitted);
    let Verdict::Refused(violation) = judged(Some(2 * u32::from(RAMP))) else {
        panic!("there is no room at its end");
    };
    assert!(violation.ramp && violation.certain, "{violation:?}");
    // Half a second to stop hardly adds to the torque.
    assert_eq!(judged(Some(50 * u32::from(RAMP))), Verdict::Admitted);
}

/// The pace follows an override with a ramp, stays there, and comes back to the bits of the moves.
#[test]
fn an_override_changes_the_pace_and_nothing_else() {
    let moves = chain::<f64>();
    let expected = expected::<f64>();
    for percent in [1, 37, 50, 99] {
        let mut bench = ready::<f64>();
        bench.ticks(10);
        bench.done(Command::FeedOverride { percent });
        bench.ticks(60);
        assert_eq!(bench.status().feed_percent, percent);
        let sample = *bench.telemetry.last().unwrap();
        let each = &moves[sample.number as usize];
        let top = 128 * u32::from(RAMP);
        let passed = f64::from(sample.at) + f64::from(sample.part) / f64::from(2 * top);
        let on_path = segment(each).at_fraction(passed / f64::from(each.ticks));
        let u = f64::from((top * u32::from(percent) / 100) & !1) / f64::from(top);
        let apart = sample.setpoint.velocity - on_path.velocity * u;
        assert!(apart.abs().max() < 1e-12, "{percent}: {apart}");
        assert_eq!(
            (sample.state, sample.acting),
            (State::Running, Acting::Nothing)
        );
        bench.done(Command::FeedOverride { percent: 100 });
        bench.until(State::Idle);
        assert_eq!(bench.status().done, 6);
        let samples = bench.telemetry.iter().rev();
        let last = samples.filter(|sample| sample.state == State::Running);
        for (sample, setpoint) in last.zip(expected.iter().rev()).take(50) {
            assert_eq!(sample.setpoint, *setpoint, "{percent}");
        }
    }
    let mut bench = ready::<f64>();
    for percent in [0, 101, 255] {
        let refusal = bench.refused(Command::FeedOverride { percent });
        assert_eq!(refusal, Refusal::FeedOverride);
    }
    assert_eq!(bench.status().feed_percent, 100);
}

/// What is queued ends moving and nothing follows: it comes to rest before the end, waits, and goes
/// on by itself when there is more.
#[test]
fn a_queue_that_runs_dry_comes_to_rest_on_the_path() {
    let moves = chain::<f64>();
    let expected = expected::<f64>();
    let mut bench = Bench::<Thesis<f64>>::new();
    for each in &moves[..2] {
        bench.offer(*each);
    }
    bench.done(Command::Start);
    bench.until(State::Holding);
    let status = bench.status();
    assert_eq!(status.acting, Acting::QueueDry);
    let sample = *bench.telemetry.last().unwrap();
    // A tick before the end: what it takes to stop there is not known to the last bit.
    assert_eq!((sample.number, sample.at, sample.part), (1, 1, 0));
    bench.ticks(50);
    assert_eq!(bench.state(), State::Holding);
    // A resume does not help: there is nothing to resume with.
    bench.done(Command::Resume);
    bench.ticks(5);
    assert_eq!(bench.status().acting, Acting::QueueDry);
    // The next, of one tick, ends moving too: it is not enough.
    bench.offer(moves[2]);
    bench.ticks(5);
    assert_eq!(bench.state(), State::Holding);
    for each in &moves[3..] {
        bench.offer(*each);
    }
    bench.until(State::Running);
    bench.until(State::Idle);
    assert_eq!(bench.status().done, 6);
    let samples = bench.telemetry.iter().rev();
    let last = samples.filter(|sample| sample.state == State::Running);
    for (sample, setpoint) in last.zip(expected.iter().rev()).take(100) {
        assert_eq!(sample.setpoint, *setpoint);
    }
}

/// However late each move comes, there is never a jump: the velocity changes by no more per tick
/// than on the job itself and its ramps.
#[test]
fn no_move_comes_too_late_for_the_velocity() {
    let moves = chain::<f64>();
    for late in 0..60 {
        let mut bench = Bench::<Thesis<f64>>::new();
        bench.offer(moves[0]);
        bench.done(Command::Start);
        bench.ticks(late);
        for each in &moves[1..] {
            bench.offer(*each);
            bench.ticks(late / 4);
        }
        bench.until(State::Idle);
        assert_eq!(bench.status().done, 6, "{late}");
        let velocities: Vec<Vector3<f64>> = bench
            .telemetry
            .iter()
            .map(|sample| sample.setpoint.velocity)
            .collect();
        for pair in velocities.windows(2) {
            // 2.2 m/s^2 on the ramps, 0.11 m/s at the ramp's 10 / s and less on the path, where
            // the single tick's move changes most: 0.05 m/s within a tick.
            assert!((pair[1] - pair[0]).xy().abs().max() < 0.05, "{late}");
        }
    }
}

/// The tool follows the true speed, on the ramps too, and is off wherever the job does not run.
#[test]
fn the_tool_follows_the_speed_along_the_path() {
    let mut bench = ready::<f64>();
    bench.ticks(60);
    bench.done(Command::Hold);
    bench.until(State::Holding);
    bench.ticks(5);
    bench.done(Command::Resume);
    bench.until(State::Idle);
    let mut on_ramps = 0;
    for sample in &bench.telemetry {
        let (x, y) = (sample.setpoint.velocity.x, sample.setpoint.velocity.y);
        // 0.5 at 0.2 m/s.
        let power = if sample.state.is_running() {
            2.5 * f64::sqrt(x * x + y * y)
        } else {
            0.0
        };
        assert!((sample.tool - power).abs() < 4.0 * f64::EPSILON);
        on_ramps += usize::from(sample.state == State::Slowing && sample.tool > 0.0);
    }
    assert!(on_ramps > 5);

    // Faster than its speed for full power it stays at full power.
    let mut bench = Bench::<Thesis<f64>>::new();
    let full = Move {
        tool_power: 1.0,
        tool_speed: 0.01,
        ..rest(0, home(), pose(0.28, 0.28, 0.2), 100)
    };
    bench.offer(full);
    bench.done(Command::Start);
    bench.ticks(50);
    assert_eq!(bench.tick().tool, 1.0);
    // A stop, a silence and a fault switch it off at once, while the machine still moves.
    bench.done(Command::Stop);
    let output = bench.tick();
    assert!(output.tool == 0.0 && output.motors[0].rate != 0.0);
}

/// A power without a speed is the same on the ramps and at rest, and off wherever the job does not run.
#[test]
fn a_tool_without_a_speed_has_a_constant_power() {
    fn check<N: ServiceNumber>() {
        let mut bench = Bench::<Thesis<N>>::new();
        let power = N::from_f64(0.75);
        let there = pose(0.23, 0.23, 0.16);
        let on = |offered| Move {
            tool_power: power,
            ..offered
        };
        bench.offer(on(rest(0, home(), there, 100)));
        // A dwell: the machine stands.
        bench.offer(on(rest(1, there, there, 50)));
        bench.done(Command::Start);
        bench.ticks(40);
        bench.done(Command::Hold);
        bench.until(State::Holding);
        bench.ticks(5);
        bench.done(Command::Resume);
        bench.until(State::Idle);
        let (mut standing, mut held) = (0, 0);
        for sample in &bench.telemetry {
            let expected = match sample.state.is_running() {
                true => power,
                false => N::ZERO,
            };
            let error = (sample.tool - expected).abs();
            assert!(error <= N::UNIT_ROUNDOFF + N::UNIT_ROUNDOFF, "{sample:?}");
            let [x, y] = [sample.setpoint.velocity.x, sample.setpoint.velocity.y];
            standing += usize::from(sample.state == State::Running && x == N::ZERO && y == N::ZERO);
            held += usize::from(sample.state == State::Holding);
        }
        assert!(standing >= 50 && held >= 5, "{standing} {held}");
    }
    check::<f64>();
    check::<f32>();
}

/// The tick's own guard: what a setup without its admission lets through does not go out.
#[test]
fn what_is_beyond_a_limit_is_a_fault_and_does_not_go_out() {
    type Change = fn(&mut LimitParameters);
    let cases: [(Bounded, Change); 4] = [
        (Bounded::Rate, |limits| limits.rate_rad_s = Some([0.1; 3])),
        (Bounded::Acceleration, |limits| {
            limits.acceleration_rad_s2 = Some([0.2; 3])
        }),
        (Bounded::Torque, |limits| {
            limits.torque_nm = Some([0.001; 3])
        }),
        (Bounded::Power, |limits| limits.power_w = Some([0.0005; 3])),
    ];
    for (what, change) in cases {
        let mut limits = LimitParameters::default();
        change(&mut limits);
        let mut bench = Bench::<Thesis<f64>>::new();
        bench.offer(rest(0, home(), pose(0.28, 0.28, 0.2), 100));
        let limits = trirrr_core::limits::Limits::build(&limits).unwrap();
        bench.service.foreground.guard = crate::guard::Guard::holding(limits);
        bench.done(Command::Start);
        let mut before = bench.tick();
        let mut latched = false;
        for _ in 0..110 {
            let output = bench.tick();
            if output.is_on() {
                assert!(!latched);
                before = output;
                continue;
            }
            latched = true;
            for (motor, last) in output.motors.iter().zip(&before.motors) {
                assert_eq!(
                    (motor.angle, motor.rate, motor.torque),
                    (last.angle, 0.0, 0.0)
                );
            }
        }
        let fault = bench.status().fault.unwrap();
        assert_eq!(fault.code, FaultCode::Limit(what));
        assert!(fault.value.abs() > fault.limit && fault.index.is_some());
        assert_eq!(bench.status().acting, Acting::Limit(what));
    }
}
