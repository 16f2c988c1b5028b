//! Moves for a job's path: planned in the least time, and judged as the scene's service judges them.

use crate::job::{Job, JobMove};
use crate::job_path::{JobPath, PlacedPath};
use crate::judge::{Judgement, Objection, judge_quickly};
use crate::read::Document;
use crate::{NumberType, Scene, offer, words};
use thiserror::Error;
use trirrr_core::limits::Limits;
use trirrr_core::machine::{BuildError, LegParameters};
use trirrr_core::model::{Model, ModelVisitor};
use trirrr_core::number::{Arithmetic, Fixed};
use trirrr_core::setpoint::Ends;
use trirrr_plan::cell::{Limited, Obstacle, Planner};
use trirrr_plan::course::{Effort, PathRefusal};
use trirrr_plan::moves::{Judged, PlannedMove, PlannedMoves, Sampling, plan_moves};
use trirrr_protocol::message::Bounded;

/// Reason why a path has no plan.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum Unplanned {
    /// The machine or a limit is refused.
    #[error(transparent)]
    Machine(#[from] BuildError),
    /// Each run can be played, but not in units that hold all of them.
    #[error(
        "the number type of the scene has no units for all pieces together; take another number type or two jobs"
    )]
    Units,
    /// An obstacle on the path.
    #[error("{}", obstacle(.0))]
    Path(PathRefusal),
}

/// Plans `path`, the path of the job of `scene`. `scene` is otherwise checked.
///
/// # Errors
/// [`Unplanned`].
pub fn plan_job(scene: &Scene, path: &JobPath, effort: Effort) -> Result<PlannedMoves, Unplanned> {
    let mut others = Vec::new();
    loop {
        let planned = scene.model().visit(PlanJob {
            scene,
            path,
            effort,
            others: &others,
        })?;
        // Runs are judged one by one. Units of a number type of little range are those of the whole job: they may be
        // larger, and then the runs are judged again in those.
        if planned.plan.runs.len() == 1 || scene.number != NumberType::Fixed {
            return Ok(planned);
        }
        let moves = job_moves(path, &planned.moves);
        let is_kept = |judged: &Judged| *judged == Judged::Kept;
        if judged(scene, &moves, &[]).iter().all(is_kept) {
            return Ok(planned);
        }
        if !others.is_empty() {
            return Err(Unplanned::Units);
        }
        others = moves;
    }
}

struct PlanJob<'a> {
    scene: &'a Scene,
    path: &'a JobPath,
    effort: Effort,
    /// Moves that ask for room in the units beside those that are judged.
    others: &'a [JobMove],
}

impl ModelVisitor<f64> for PlanJob<'_> {
    type Output = Result<PlannedMoves, Unplanned>;

    fn visit<M: Model<N = f64>>(self) -> Self::Output {
        let Self {
            scene,
            path,
            effort,
            others,
        } = self;
        let limits = Limits::build(&scene.limits)?;
        let ramp = scene.service.stop_time_max_s.map_or(0.0, f64::recip);
        let planner = Planner::<M>::build(&scene.parameters, limits, ramp)?;
        let sampling = Sampling {
            period_s: scene.period_s(),
            tolerance_m: path.tolerance_m,
            tolerance_rad: path.tolerance_rad,
            resolution_m: resolution_m(scene),
            ticks_min: ticks_min(scene),
        };
        let judge = |moves: &[PlannedMove]| judged(scene, &job_moves(path, moves), others);
        plan_moves(&planner, &path.pieces, effort, sampling, judge).map_err(Unplanned::Path)
    }
}

/// Ticks of a move so long that the moves in a board's queue last for a hold: it takes half its ramp of the path.
fn ticks_min(scene: &Scene) -> u32 {
    // One move is being played, and one is on its way.
    let waiting = offer::CAPACITY as u32 - 2;
    (u32::from(scene.ramp().ticks) / 2 + 1).div_ceil(waiting)
}

/// Distance between neighbouring positions in the number type of `scene`, at the size of the machine.
fn resolution_m(scene: &Scene) -> f64 {
    let reach = |leg: &LegParameters| leg.base_m.amax() + leg.proximal_m + leg.distal_m;
    let size = scene.parameters.legs.iter().map(reach).fold(0.0, f64::max);
    size * match scene.number {
        NumberType::F64 => f64::UNIT_ROUNDOFF,
        NumberType::F32 | NumberType::Micromath => f32::UNIT_ROUNDOFF.to_f64(),
        NumberType::Fixed => Fixed::UNIT_ROUNDOFF.to_f64(),
    }
}

/// Judges `moves` of `scene`, which do not stand in its job yet, in units that have room for `others`, too.
fn judged(scene: &Scene, moves: &[JobMove], others: &[JobMove]) -> Vec<Judged> {
    let job = Job {
        moves: [moves, others].concat(),
        ..scene.job.clone()
    };
    let trial = Scene {
        job,
        ..scene.clone()
    };
    let Ok(judgements) = judge_quickly(&trial, moves.len()) else {
        return vec![Judged::Refused; moves.len()];
    };
    let judged = |judgement: Judgement| match judgement {
        Ok(_) => Judged::Kept,
        Err(Objection::Limit(violation)) => match violation.what {
            Bounded::Rate | Bounded::Acceleration | Bounded::Torque | Bounded::Power => {
                Judged::Exceeded(violation.value / violation.limit - 1.0)
            }
            _ => Judged::Refused,
        },
        Err(_) => Judged::Refused,
    };
    judgements.into_iter().map(judged).collect()
}

/// Converts planned moves of `path` to moves of a job.
fn job_moves(path: &JobPath, moves: &[PlannedMove]) -> Vec<JobMove> {
    let job_move = |each: &PlannedMove| {
        let Ends {
            from,
            to,
            velocities: [start_velocity, end_velocity],
            accelerations,
        } = each.ends;
        JobMove {
            from,
            to,
            start_velocity,
            end_velocity,
            accelerations: accelerations.map(|both| both.map(Into::into)),
            duration_ticks: each.ticks,
            tool: path.tools[path.pieces[each.piece].source],
        }
    };
    moves.iter().map(job_move).collect()
}

/// Gives the job of `scene` the planned moves of its path, or refuses the piece with the first obstacle.
pub(crate) fn plan_path(document: &Document, scene: &mut Scene, placed: &PlacedPath) -> Option<()> {
    match plan_job(scene, &placed.path, Effort::default()) {
        Ok(planned) => {
            scene.job.moves = job_moves(&placed.path, &planned.moves);
            return Some(());
        }
        Err(error @ Unplanned::Units) => document.refuse(&placed.places[0], error.to_string()),
        Err(Unplanned::Path(refusal)) => {
            let source = placed.path.pieces[refusal.place.piece].source;
            document.refuse(&placed.places[source], obstacle(&refusal));
        }
        // The machine is checked, and refused, by itself.
        Err(Unplanned::Machine(_)) => {}
    }
    None
}

/// Describes an obstacle and its place.
fn obstacle(refusal: &PathRefusal) -> String {
    let PathRefusal {
        place,
        pose,
        obstacle,
    } = refusal;
    let reason = match obstacle {
        Obstacle::Reach(leg) => format!("leg {} does not reach the platform", leg + 1),
        Obstacle::SerialDistance(leg) => format!(
            "leg {} comes nearer to its serial singularity than [limits] serial_distance_min",
            leg + 1
        ),
        Obstacle::ParallelDistance => {
            "the machine comes nearer to a parallel singularity than [limits] \
             parallel_distance_min, or crosses one"
                .into()
        }
        Obstacle::Standing(what) => format!(
            "the machine cannot stand there: {} is beyond its limit at rest; no duration helps",
            limited(*what)
        ),
        Obstacle::Range => "a value leaves the range of the number type".into(),
        Obstacle::Refused => {
            "the moves of the plan are refused, however slow: the limits leave no room for the \
             number type or the tick rate of the scene"
                .into()
        }
    };
    format!(
        "at p = {} of the piece, x = {} m, y = {} m, alpha = {} rad: {reason}",
        words::short(place.p),
        words::short(pose.position.x),
        words::short(pose.position.y),
        words::short(pose.angle)
    )
}

/// Names a limited quantity.
pub fn limited(what: Limited) -> String {
    let of_motor = |quantity: &str, motor: usize| format!("the {quantity} of motor {}", motor + 1);
    match what {
        Limited::Rate(motor) => of_motor("rate", motor),
        Limited::Acceleration(motor) => of_motor("acceleration", motor),
        Limited::Torque(motor) => of_motor("torque", motor),
        Limited::Power(motor) => of_motor("power", motor),
        Limited::Feed => "the feed".into(),
    }
}
