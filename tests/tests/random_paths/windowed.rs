//! The same paths through windows of a fixed size, which get them piece by piece: what can be planned as a whole can be planned so.

use crate::geometry::Polyline;
use nalgebra::Vector3;
use trirrr_core::limits::Limits;
use trirrr_core::model::{Model, ModelKind, ModelVisitor};
use trirrr_core::setpoint::{Pose, Quintics};
use trirrr_plan::window::{Outlook, Window, WindowMove, WindowPiece};
use trirrr_protocol::message::{AnyMove, Move, Violation};
use trirrr_scene::{JobPath, NumberType, Scene, settings, units};
use trirrr_service::ServiceNumber;
use trirrr_service::admission::{Admission, Enclose, Path, Verdict};
use trirrr_tests::instant::{QuinticEnds, State};

/// Chords of each piece that a motion is compared with.
const CHORDS: u32 = 512;
/// Steps of a window at most.
const STEPS: u32 = 1_000_000;
/// Instants of a move that are compared.
const INSTANTS: u32 = 16;

/// A path that went through a window.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Windowed {
    /// Ticks of all moves.
    pub(crate) ticks: u32,
    /// Largest distance from the path, in tolerances.
    pub(crate) deviation: f64,
}

/// Plans the path of `scene` through a window in the number type of the scene: 128 cells in binary64, 48 as on a board in
/// binary32. The error says what the window refuses.
pub(crate) fn through_window(scene: &Scene) -> Result<Windowed, String> {
    let mut scene = scene.clone();
    scene.service.plans_paths = true;
    let scene = &scene;
    match scene.number {
        NumberType::F64 => ModelKind::visit::<f64, _>(scene.model(), Through::<128> { scene }),
        NumberType::F32 => ModelKind::visit::<f32, _>(scene.model(), Through::<48> { scene }),
        NumberType::Fixed | NumberType::Micromath => panic!("not drawn"),
    }
}

struct Through<'a, const CELLS: usize> {
    scene: &'a Scene,
}

impl<N: ServiceNumber + Enclose<Bound = N>, const CELLS: usize> ModelVisitor<N>
    for Through<'_, CELLS>
{
    type Output = Result<Windowed, String>;

    fn visit<M: Model<N = N>>(self) -> Self::Output {
        let scene = self.scene;
        let units = units::<N>(scene).expect("units");
        let limits = Limits::build(&scene.limits).expect("limits").map(N::bound);
        let coefficients = Path::<M>::build(
            scene.model().with(&scene.parameters),
            limits,
            scene.ramp(),
            scene.period_s(),
        );
        let coefficients = coefficients.expect("a machine");
        let mut admission = Admission::<M, Quintics>::over(coefficients);
        let path = scene.job.path.as_ref().expect("a path");
        let planning = settings::<N>(scene, &units).planning.expect("a planner");
        let mut window = Box::new(Window::<N, usize, 32, CELLS>::new(planning));
        window.stand(path.pieces[0].piece.over::<N>().at(N::ZERO).pose);
        let mut along = Polyline::planned(&path.pieces, CHORDS);
        let mut windowed = Windowed {
            ticks: 0,
            deviation: 0.0,
        };
        let mut next = 0;
        let mut steps = 0;
        while !window.is_done() || next < path.pieces.len() {
            while let Some(each) = path.pieces.get(next).filter(|_| window.room() > 0) {
                let piece = WindowPiece {
                    piece: each.piece.over(),
                    feed: each.feed_m_s.map(N::from_f64),
                    tag: 0,
                    number: next as u32,
                };
                if !window.push(piece) {
                    return Err(format!("{:?}", window.refusal()));
                }
                next += 1;
            }
            if next == path.pieces.len() {
                window.close();
            }
            steps += 1;
            if steps > STEPS {
                return Err(format!("no end: {windowed:?}"));
            }
            match window.step(&coefficients) {
                Outlook::Working => {}
                Outlook::Waiting if window.refusal().is_some() => break,
                Outlook::Waiting => assert!(window.is_done() || next < path.pieces.len()),
                Outlook::Move(each) => match judged(&mut admission, &each) {
                    None => {
                        windowed.ticks += each.ticks;
                        let off = off_path(&each, &mut along, path, scene.period_s());
                        windowed.deviation = windowed.deviation.max(off);
                        if windowed.deviation > 1.0 {
                            return Err(format!("off the path: {windowed:?}"));
                        }
                        window.keep();
                    }
                    Some(violation) => {
                        let excess = match violation.limit > N::ZERO {
                            true => violation.value.abs().div(violation.limit) - N::ONE,
                            false => N::ZERO,
                        };
                        window.cut(&coefficients, excess);
                    }
                },
            }
        }
        match window.refusal() {
            Some(refusal) => Err(format!("{refusal:?} after {} ticks", windowed.ticks)),
            None => Ok(windowed),
        }
    }
}

/// The violation for which the service refuses a move, if it does.
fn judged<M: Model<N: ServiceNumber>>(
    admission: &mut Admission<M, Quintics>,
    each: &WindowMove<M::N, usize>,
) -> Option<Violation<M::N>> {
    let common = Move {
        start_velocity: each.ends.velocities[0].into(),
        end_velocity: each.ends.velocities[1].into(),
        ..Move::rest_to_rest(0, each.ends.from, each.ends.to, each.ticks)
    };
    assert!(admission.offer_any(&AnyMove::new(common, each.ends.accelerations)));
    loop {
        if let Some(violation) = admission.violation() {
            return Some(violation);
        }
        if admission.step() == Verdict::Admitted {
            return None;
        }
    }
}

/// Largest distance of a move from the path, in parts of the tolerances.
fn off_path<N: ServiceNumber>(
    each: &WindowMove<N, usize>,
    along: &mut Polyline,
    path: &JobPath,
    period_s: f64,
) -> f64 {
    let numbers = |values: [N; 3]| values.map(N::to_f64);
    let [starts, stops] = each.ends.accelerations.expect("a quintic");
    let state = |pose: &Pose<N>, velocity: Vector3<N>, acceleration| State {
        pose: [
            pose.position.x.to_f64(),
            pose.position.y.to_f64(),
            N::angle_to_f64(pose.angle),
        ],
        velocity: numbers(velocity.into()),
        acceleration: numbers(acceleration),
    };
    let ends = QuinticEnds {
        states: [
            state(&each.ends.from, each.ends.velocities[0], starts),
            state(&each.ends.to, each.ends.velocities[1], stops),
        ],
        duration_s: f64::from(each.ticks) * period_s,
    };
    let tolerances = [path.tolerance_m, path.tolerance_rad];
    let mut most: f64 = 0.0;
    for instant in 0..=INSTANTS {
        let state = ends.at(f64::from(instant) / f64::from(INSTANTS));
        most = most.max(along.deviation(state.pose, tolerances));
        if most > 1.0 {
            break;
        }
    }
    most
}
