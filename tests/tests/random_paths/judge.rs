//! Judgement of a planned job: the service's own admission of each move, and what the independent model says of the
//! motion at many instants.

use crate::drawn::DrawnJob;
use crate::geometry::{Coordinates, Polyline};
use crate::truth::{Instant, State};
use trirrr_core::limits::Limits;
use trirrr_core::model::{Model, ModelVisitor};
use trirrr_plan::cell::Planner;
use trirrr_plan::course::{Effort, plan};
use trirrr_protocol::message::Move;
use trirrr_scene::{NumberType, Scene, offer};
use trirrr_service::admission::{Admission, Verdict};
use trirrr_service::{ServiceNumber, check_offer, longest_move};

/// Chords of each piece that a motion is compared with.
const CHORDS: u32 = 2048;
/// Rounding of the independent model, as a part of a value.
const ROUNDING: f64 = 1e-11;

/// Largest parts of limits and tolerances that a motion takes, at most 1; and its duration over the bound.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Findings {
    pub(crate) limit: f64,
    pub(crate) feed: f64,
    pub(crate) deviation: f64,
    pub(crate) played_over_bound: f64,
    pub(crate) plan_over_bound: f64,
    pub(crate) ticks: u32,
}

/// Judges `scene`, which was read from the text of `job`.
///
/// # Panics
/// When a move is not admitted or the moves are no chain.
pub(crate) fn judge(job: &DrawnJob, scene: &Scene, samples: u32) -> Findings {
    let moves = match scene.number {
        NumberType::F64 => played::<f64>(scene),
        NumberType::F32 => played::<f32>(scene),
        NumberType::Fixed | NumberType::Micromath => panic!("not drawn"),
    };
    check_chain(job, &moves);
    let [least_s, plan_s] = scene.model().visit(Bound { scene });
    let period_s = scene.period_s();
    let ticks: u32 = moves.iter().map(|each| each.ticks).sum();
    let mut findings = Findings {
        limit: 0.0,
        feed: 0.0,
        deviation: 0.0,
        played_over_bound: f64::from(ticks) * period_s / least_s,
        plan_over_bound: plan_s / least_s,
        ticks,
    };
    let path = scene.job.path.as_ref().expect("a path");
    let mut planned = Polyline::planned(&path.pieces, CHORDS);
    let mut given = Polyline::of(job.start, &job.pieces, CHORDS);
    let fastest = job.feeds.iter().copied().collect::<Option<Vec<_>>>();
    let fastest = fastest.map(|feeds| feeds.into_iter().fold(0.0, f64::max));
    let side = Instant::kinematics(
        &job.parameters,
        &State {
            pose: job.start,
            ..State::default()
        },
    )
    .side;
    let mut before = 0;
    for each in &moves {
        // Evenly in time over all moves, and both ends of each.
        let own = u64::from(samples) * u64::from(each.ticks) / u64::from(ticks) + 1;
        for sample in 0..=own {
            let state = state_at(each, sample as f64 / own as f64, period_s);
            let instant = Instant::of(&job.parameters, &state);
            findings.limit = findings.limit.max(part_of_limits(scene, &instant, side));
            if let Some(fastest) = fastest {
                let speed = state.velocity[0].hypot(state.velocity[1]);
                findings.feed = findings.feed.max(speed / fastest);
            }
            let off = planned.deviation(state.pose, [path.tolerance_m, path.tolerance_rad]);
            let corner_m = job.corner_m.unwrap_or(0.0);
            // A rounded corner turns the platform on its own way.
            let turn = if corner_m > 0.0 {
                f64::INFINITY
            } else {
                path.tolerance_rad
            };
            let off_given = given.deviation(state.pose, [path.tolerance_m + corner_m, turn]);
            findings.deviation = findings.deviation.max(off).max(off_given);
        }
        before += each.ticks;
    }
    assert_eq!(before, ticks);
    findings
}

/// The largest part of a limit, at most 1 where all are kept; infinite where a value is none.
fn part_of_limits(scene: &Scene, instant: &Instant, side: bool) -> f64 {
    let limits = &scene.limits;
    let power: [f64; 3] = core::array::from_fn(|motor| instant.torque[motor] * instant.rate[motor]);
    let mut most: f64 = match instant.side == side {
        true => 0.0,
        false => f64::INFINITY,
    };
    let mut note = |part: f64| {
        most = if part.is_nan() {
            f64::INFINITY
        } else {
            most.max(part)
        }
    };
    for (limit, values) in [
        (limits.rate_rad_s, instant.rate),
        (limits.acceleration_rad_s2, instant.acceleration),
        (limits.torque_nm, instant.torque),
        (limits.power_w, power),
    ] {
        for (limit, value) in limit.iter().flatten().zip(values) {
            note(value.abs() * (1.0 - ROUNDING) / limit);
        }
    }
    for serial in instant.serial {
        note(limits.serial_distance_min * (1.0 - ROUNDING) / serial);
    }
    note(limits.parallel_distance_min * (1.0 - ROUNDING) / instant.parallel);
    most
}

/// The moves as a service in `N` gets them, admitted one by one, as the numbers that they are.
fn played<N: ServiceNumber>(scene: &Scene) -> Vec<Move<f64>> {
    let units = trirrr_scene::units::<N>(scene).expect("units");
    let moves = offer::moves::<N>(scene, &units);
    for each in &moves {
        check_offer(each, longest_move(offer::CAPACITY)).expect("an offer");
    }
    scene.model().visit(Admit {
        scene,
        moves: &moves,
    });
    let number = |value: N| value.to_f64();
    let pose = |pose: &trirrr_core::setpoint::Pose<N>| {
        trirrr_core::setpoint::Pose::from_f64(
            pose.position.x.to_f64(),
            pose.position.y.to_f64(),
            N::angle_to_f64(pose.angle),
        )
    };
    let in_f64 = |each: &Move<N>| Move {
        number: each.number,
        from: pose(&each.from),
        to: pose(&each.to),
        start_velocity: each.start_velocity.map(number),
        end_velocity: each.end_velocity.map(number),
        ticks: each.ticks,
        tool_power: 0.0,
        tool_speed: 0.0,
    };
    moves.iter().map(in_f64).collect()
}

struct Admit<'a, N: ServiceNumber> {
    scene: &'a Scene,
    moves: &'a [Move<N>],
}

impl<N: ServiceNumber> ModelVisitor<N> for Admit<'_, N> {
    type Output = ();

    fn visit<M: Model<N = N>>(self) {
        let Self { scene, moves } = self;
        let limits = Limits::build(&scene.limits).expect("limits");
        let mut admission = Admission::<M>::build(
            &scene.parameters,
            limits,
            scene.ramp_ticks(),
            scene.period_s(),
        )
        .expect("a machine");
        for each in moves {
            admission.offer(each);
            let verdict = loop {
                match admission.step() {
                    Verdict::Undecided => {}
                    verdict => break verdict,
                }
            };
            assert_eq!(verdict, Verdict::Admitted, "{each:?}");
        }
    }
}

/// Bound and plan, s.
struct Bound<'a> {
    scene: &'a Scene,
}

impl ModelVisitor<f64> for Bound<'_> {
    type Output = [f64; 2];

    fn visit<M: Model<N = f64>>(self) -> [f64; 2] {
        let scene = self.scene;
        let limits = Limits::build(&scene.limits).expect("limits");
        // Without room for holds, plan and bound are comparable.
        let planner = Planner::<M>::build(&scene.parameters, limits, 0.0).expect("a machine");
        let path = scene.job.path.as_ref().expect("a path");
        let plan = plan(&planner, &path.pieces, Effort::default()).expect("a plan");
        [plan.least_s(), plan.duration_s()]
    }
}

fn check_chain(job: &DrawnJob, moves: &[Move<f64>]) {
    let close = |a: f64, b: f64| (a - b).abs() <= 1e-6 * (a.abs() + b.abs() + 1e-3);
    let [first, .., last] = moves else {
        panic!("a move from rest to rest is no plan")
    };
    let mut from = job.start;
    for piece in &job.pieces {
        from = piece.end(from);
    }
    for (pose, at) in [(&first.from, job.start), (&last.to, from)] {
        let all = [pose.position.x, pose.position.y, pose.angle];
        assert!(
            all.into_iter().zip(at).all(|(a, b)| close(a, b)),
            "{pose:?} {at:?}"
        );
    }
    assert_eq!(
        (first.start_velocity, last.end_velocity),
        ([0.0; 3], [0.0; 3])
    );
    for pair in moves.windows(2) {
        assert_eq!(pair[0].to, pair[1].from);
        assert_eq!(pair[0].end_velocity, pair[1].start_velocity);
    }
}

/// The move's cubic in the basis of Bernstein, which shares no formula with the setpoints of the core.
fn state_at(each: &Move<f64>, part: f64, period_s: f64) -> State {
    let duration = f64::from(each.ticks) * period_s;
    let pose = |pose: &trirrr_core::setpoint::Pose<f64>| -> Coordinates {
        [pose.position.x, pose.position.y, pose.angle]
    };
    let (from, to) = (pose(&each.from), pose(&each.to));
    let rest = 1.0 - part;
    let mut state = State::default();
    for axis in 0..3 {
        let third = duration / 3.0;
        let b = [
            from[axis],
            from[axis] + each.start_velocity[axis] * third,
            to[axis] - each.end_velocity[axis] * third,
            to[axis],
        ];
        let d = [b[1] - b[0], b[2] - b[1], b[3] - b[2]].map(|step| 3.0 * step / duration);
        let dd = [d[1] - d[0], d[2] - d[1]].map(|step| 2.0 * step / duration);
        state.pose[axis] = b[0] * rest.powi(3)
            + 3.0 * part * rest * (b[1] * rest + b[2] * part)
            + b[3] * part.powi(3);
        state.velocity[axis] = d[0] * rest * rest + 2.0 * d[1] * rest * part + d[2] * part * part;
        state.acceleration[axis] = dd[0] * rest + dd[1] * part;
    }
    state
}
