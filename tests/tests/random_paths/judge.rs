//! Judgement of a planned job: the service's own admission of each move, and what the independent model says of the
//! motion at many instants.

use crate::drawn::{DrawnJob, GivenEnds};
use crate::geometry::Polyline;
use trirrr_core::limits::Limits;
use trirrr_core::model::{Model, ModelVisitor};
use trirrr_core::setpoint::{Pose, Quintics};
use trirrr_plan::cell::Planner;
use trirrr_plan::course::{Effort, plan};
use trirrr_protocol::message::{AnyMove, Move};
use trirrr_scene::{NumberType, Scene, offer};
use trirrr_service::ServiceNumber;
use trirrr_service::admission::{Admission, Verdict};
use trirrr_service::paces::{check_offer, longest_move};
use trirrr_tests::instant::{Instant, QuinticEnds, State, jerks};

/// Chords of each piece that a motion is compared with.
const CHORDS: u32 = 2048;

/// Largest parts of limits and tolerances that a motion takes, at most 1; and its duration over the bound.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Findings {
    pub(crate) limit: f64,
    pub(crate) jerk: f64,
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
    let ticks: u32 = moves.iter().map(|each| each.common().ticks).sum();
    let mut findings = Findings {
        limit: 0.0,
        jerk: 0.0,
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
        let own = u64::from(samples) * u64::from(each.common().ticks) / u64::from(ticks) + 1;
        let ends = ends(each, period_s);
        for sample in 0..=own {
            let state = ends.at(sample as f64 / own as f64);
            let instant = Instant::of(&job.parameters, &state);
            findings.limit = findings.limit.max(instant.part_of(&scene.limits, side));
            if let Some(limits) = scene.limits.jerk_rad_s3 {
                let jerk = ends.jerk_at(sample as f64 / own as f64);
                for (jerk, limit) in jerks(&job.parameters, &state, jerk).iter().zip(limits) {
                    findings.jerk = findings.jerk.max(jerk.abs() / limit);
                }
            }
            if let Some(fastest) = fastest {
                let speed = state.velocity[0].hypot(state.velocity[1]);
                findings.feed = findings.feed.max(speed / fastest);
            }
            let off = planned.deviation(state.pose, [path.tolerance_m, path.tolerance_rad]);
            let corner_m = job.corner_m.unwrap_or(0.0);
            // A rounded corner turns the platform on its own way, and so does the planner where it may.
            let turn = if corner_m > 0.0 || job.free_alpha.is_some() {
                f64::INFINITY
            } else {
                path.tolerance_rad
            };
            let off_given = given.deviation(state.pose, [path.tolerance_m + corner_m, turn]);
            findings.deviation = findings.deviation.max(off).max(off_given);
        }
        before += each.common().ticks;
    }
    assert_eq!(before, ticks);
    findings
}

/// The moves as a service in `N` gets them, admitted one by one, as the numbers that they are.
fn played<N: ServiceNumber>(scene: &Scene) -> Vec<AnyMove<f64>> {
    let units = trirrr_scene::units::<N>(scene).expect("units");
    let moves = offer::moves::<N>(scene, &units);
    for each in &moves {
        check_offer(each, longest_move(offer::CAPACITY)).expect("an offer");
    }
    scene.model().visit(Admit {
        scene,
        moves: &moves,
    });
    let pose = |pose: &Pose<N>| {
        let [x, y] = [pose.position.x, pose.position.y].map(N::to_f64);
        Pose::from_f64(x, y, N::angle_to_f64(pose.angle))
    };
    let numbers = |values: [N; 3]| values.map(N::to_f64);
    let in_f64 = |each: &AnyMove<N>| {
        let common = each.common();
        let same = Move {
            start_velocity: numbers(common.start_velocity),
            end_velocity: numbers(common.end_velocity),
            ..Move::rest_to_rest(
                common.number,
                pose(&common.from),
                pose(&common.to),
                common.ticks,
            )
        };
        AnyMove::new(same, each.accelerations().map(|both| both.map(numbers)))
    };
    moves.iter().map(in_f64).collect()
}

struct Admit<'a, N: ServiceNumber> {
    scene: &'a Scene,
    moves: &'a [AnyMove<N>],
}

impl<N: ServiceNumber> ModelVisitor<N> for Admit<'_, N> {
    type Output = ();

    fn visit<M: Model<N = N>>(self) {
        let Self { scene, moves } = self;
        let limits = Limits::build(&scene.limits).expect("limits");
        let mut admission = Admission::<M, Quintics>::build(
            scene.model().with(&scene.parameters),
            limits,
            scene.ramp(),
            scene.period_s(),
        )
        .expect("a machine");
        for each in moves {
            assert!(admission.offer_any(each));
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
        let planner = Planner::<M>::build(scene.model().with(&scene.parameters), limits, 0.0)
            .expect("a machine");
        let path = scene.job.path.as_ref().expect("a path");
        let plan = plan(&planner, &path.pieces, Effort::default()).expect("a plan");
        [plan.least_s(), plan.duration_s()]
    }
}

fn check_chain(job: &DrawnJob, moves: &[AnyMove<f64>]) {
    let close = |a: f64, b: f64| (a - b).abs() <= 1e-6 * (a.abs() + b.abs() + 1e-3);
    let (first, last) = (moves.first().expect("a move"), &moves[moves.len() - 1]);
    let mut from = job.start;
    for piece in &job.pieces {
        from = piece.end(from);
    }
    let zero = [0.0; 3];
    for (pose, at) in [(&first.common().from, job.start), (&last.common().to, from)] {
        let is_free = job.free_alpha == Some(GivenEnds::None) && pose == &last.common().to;
        let angle = if is_free { at[2] } else { pose.angle };
        let all = [pose.position.x, pose.position.y, angle];
        assert!(
            all.into_iter().zip(at).all(|(a, b)| close(a, b)),
            "{pose:?} {at:?}"
        );
    }
    assert_eq!(
        [first.common().start_velocity, last.common().end_velocity],
        [zero; 2]
    );
    let accelerations = |each: &AnyMove<f64>| each.accelerations().expect("a quintic");
    assert_eq!([accelerations(first)[0], accelerations(last)[1]], [zero; 2]);
    for pair in moves.windows(2) {
        let [before, after] = [&pair[0], &pair[1]].map(AnyMove::common);
        assert_eq!(before.to, after.from);
        assert_eq!(before.end_velocity, after.start_velocity);
        assert_eq!(accelerations(&pair[0])[1], accelerations(&pair[1])[0]);
    }
}

/// Ends of a move as numbers.
fn ends(each: &AnyMove<f64>, period_s: f64) -> QuinticEnds {
    let common = each.common();
    let [start, end] = each.accelerations().expect("a quintic");
    let state = |pose: &Pose<f64>, velocity, acceleration| State {
        pose: [pose.position.x, pose.position.y, pose.angle],
        velocity,
        acceleration,
    };
    QuinticEnds {
        states: [
            state(&common.from, common.start_velocity, start),
            state(&common.to, common.end_velocity, end),
        ],
        duration_s: f64::from(common.ticks) * period_s,
    }
}
