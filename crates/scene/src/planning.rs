//! Moves for a job's path: planned in the least time, and judged as the scene's service judges them.

use crate::blocks::{PathBlock, blocks, is_one_block};
use crate::in_order::in_order;
use crate::job::Job;
use crate::job_move::JobMove;
use crate::job_path::{Dwell, JobPath, PlacedPath};
use crate::judge::{Judgement, Objection, judge_quickly, misfit};
use crate::levels::JobLevels;
use crate::offer::CAPACITY;
use crate::outputs::JobOutputs;
use crate::reach_map::StartReach;
use crate::read::Document;
use crate::tool::follows_speed;
use crate::unplanned::Unplanned;
use crate::{NumberType, Scene, ToolPort, in_number_type, units};
use nalgebra::Vector3;
use trirrr_core::limits::Limits;
use trirrr_core::machine::LegParameters;
use trirrr_core::model::{Model, ModelVisitor};
use trirrr_core::number::{Arithmetic, Fixed, Number};
use trirrr_core::setpoint::{Ends, Pose};
use trirrr_core::units::Units;
use trirrr_plan::alpha::{Sampler, choose_alpha};
use trirrr_plan::cell::{Limited, Planner};
use trirrr_plan::course::{Effort, PathPiece};
use trirrr_plan::moves::{Judged, PlannedMove, PlannedMoves, Sampling, plan_moves};

use trirrr_plan::piece::Piece;
use trirrr_protocol::message::{Bounded, Violation};
use trirrr_service::paces::longest_move;

/// Columns of a table of moves, `moves.csv`, SI units: number of the piece from 1, duration, state at the end, power and speed of the tool.
pub const MOVE_COLUMNS: [&str; 13] = [
    "piece", "duration", "x", "y", "alpha", "vx", "vy", "valpha", "ax", "ay", "aalpha", "power",
    "speed",
];

/// A job's path with its plan.
#[derive(Clone, Debug)]
pub struct PlannedJob {
    /// The path as it is played.
    pub path: JobPath,
    /// Plan and moves.
    pub moves: PlannedMoves,
    /// Duration with alpha as the file gives it, in ticks, if the planner may choose alpha and that path is feasible.
    pub given_ticks: Option<u64>,
}

impl PlannedJob {
    /// Returns the moves in order, dwells among them, each with the number of its table in the file.
    pub fn steps(&self) -> Vec<(usize, JobMove)> {
        let Self { path, moves, .. } = self;
        let sources = moves
            .moves
            .iter()
            .map(|each| path.pieces[each.piece].source);
        let mut steps: Vec<(usize, JobMove)> = Vec::new();
        let mut after = None;
        for (source, each) in sources.zip(job_moves(path, &moves.moves)) {
            let stands = path.dwells_between(after, Some(source));
            steps.extend(stands.map(|dwell| (dwell.source, stand(path, dwell, each.from))));
            after = Some(source);
            steps.push((source, each));
        }
        let end = steps.last().map(|(_, each)| each.to);
        let last = path
            .dwells_between(after, None)
            .zip(end.into_iter().cycle());
        steps.extend(last.map(|(dwell, at)| (dwell.source, stand(path, dwell, at))));
        steps
    }

    /// Returns the [steps](Self::steps) as they are played, and the levels of the moves among them.
    pub fn listed(&self) -> (Vec<(usize, JobMove)>, JobLevels) {
        let mut steps = self.steps();
        let levels = JobLevels::of(&self.path.rows, &mut steps);
        (steps, levels)
    }

    /// Returns the moves under [`MOVE_COLUMNS`]: the state at the end of each, after a row for the start.
    ///
    /// The numbers are those that the scene's number type holds, and so those that are played. The tool is off along moves that have
    /// [levels](Self::listed): a client that plays the rows does not know the levels.
    pub fn rows(&self, scene: &Scene) -> Vec<[f64; 13]> {
        in_number_type!(scene.number, N => self.rows_in::<N>(scene))
    }

    fn rows_in<N: Number>(&self, scene: &Scene) -> Vec<[f64; 13]> {
        // A scene without units of its own is refused when it is read.
        let units = units::<N>(scene).unwrap_or(Units::SI);
        let row = |source: usize, duration_s: f64, at: [[f64; 3]; 3], tool: [f64; 2]| {
            let mut row = [0.0; 13];
            row[0] = (source + 1) as f64;
            row[1] = duration_s;
            row[2..11].copy_from_slice(at.as_flattened());
            row[11..].copy_from_slice(&tool);
            row
        };
        let pose = |pose: &Pose<f64>| [pose.position.x, pose.position.y, pose.angle];
        let (steps, levels) = self.listed();
        let first = steps
            .first()
            .map(|(_, each)| each.rounded::<N>(&units).from);
        let start = pose(&first.unwrap_or(scene.job.start));
        let start = [start, [0.0; 3], [0.0; 3]];
        let steps = (0..).zip(steps).map(|(index, (source, each))| {
            let each = each.rounded::<N>(&units);
            let tool = each
                .tool
                .filter(|_| levels.get(index).is_none())
                .map_or([0.0; 2], |tool| [tool.power, tool.speed_m_s]);
            let acceleration = each.accelerations.map_or([0.0; 3], |[_, end]| end.into());
            let end = [pose(&each.to), each.end_velocity.into(), acceleration];
            let duration_s = f64::from(each.duration_ticks) * scene.period_s();
            row(source, duration_s, end, tool)
        });
        std::iter::once(row(0, 0.0, start, [0.0; 2]))
            .chain(steps)
            .collect()
    }

    /// Returns the seconds for which the machine stands in the dwells.
    pub fn stands_s(&self, scene: &Scene) -> f64 {
        scene.period_s() * self.path.stand_ticks(None, None) as f64
    }

    /// Duration of the moves and dwells in ticks.
    pub fn ticks(&self) -> u64 {
        self.moves.ticks() + self.path.stand_ticks(None, None)
    }
}

/// The stand of `dwell` at a pose.
fn stand(path: &JobPath, dwell: &Dwell, at: Pose<f64>) -> JobMove {
    let zero = Vector3::zeros();
    JobMove {
        from: at,
        to: at,
        start_velocity: zero,
        end_velocity: zero,
        accelerations: Some([zero; 2]),
        duration_ticks: dwell.ticks,
        tool: path.tools[dwell.source],
    }
}

/// Plans `path`, the path of the job of `scene`. `scene` is otherwise checked. A path whose alpha is free is planned
/// as it is given, too: the faster plan counts.
///
/// # Errors
/// [`Unplanned`].
pub fn plan_job(scene: &Scene, path: &JobPath, effort: Effort) -> Result<PlannedJob, Unplanned> {
    plan_part(scene, path, Some(false), effort)
}

/// Plans as [`plan_job`]; the tool is `on` before the path, or nobody knows.
fn plan_part(
    scene: &Scene,
    path: &JobPath,
    on: Option<bool>,
    effort: Effort,
) -> Result<PlannedJob, Unplanned> {
    let planned = match scene.tool.filter(ToolPort::switches) {
        Some(port) => {
            if let Some(number) = path.tools.iter().position(|tool| follows_speed(*tool)) {
                return Err(Unplanned::Tool { number });
            }
            plan_alpha(scene, &path.waiting(port.travel_ticks, on), effort)?
        }
        None => plan_alpha(scene, path, effort)?,
    };
    check_dwells(scene, &planned)?;
    check_ticks(planned.ticks())?;
    Ok(planned)
}

/// Checks that a service counts so many ticks of a job.
pub(crate) fn check_ticks(ticks: u64) -> Result<(), Unplanned> {
    match ticks > u64::from(u32::MAX) {
        true => Err(Unplanned::Ticks(ticks)),
        false => Ok(()),
    }
}

/// Moves of a block, dwells among them, each with the number of its table in the file, and the outputs that change with them.
pub(crate) fn plan_block(
    scene: &Scene,
    block: &PathBlock,
) -> Result<(Vec<(usize, JobMove)>, JobOutputs), Unplanned> {
    let on = (block.before == 0).then_some(false);
    let planned = plan_part(scene, &block.path, on, Effort::default())
        .map_err(|error| error.in_block(block.first, block.before))?;
    let steps = planned.steps();
    let outputs = JobOutputs::of(&block.path.outputs, &steps);
    let steps = steps.into_iter();
    let steps = steps.map(|(source, each)| (block.first + source, each));
    Ok((steps.collect(), outputs))
}

/// Lets the `first` move of a block begin where the move before it ends: pieces meet but for rounding, moves do exactly.
pub(crate) fn join(before: Option<&JobMove>, first: Option<&mut JobMove>) {
    if let (Some(before), Some(first)) = (before, first) {
        first.from = before.to;
    }
}

/// Checks that the service stands where the path dwells: a plan knows the machine's limits, not the number type.
fn check_dwells(scene: &Scene, planned: &PlannedJob) -> Result<(), Unplanned> {
    let steps = planned.steps();
    let is_dwell = |(source, stand): &&(usize, JobMove)| {
        let mut dwells = planned.path.dwells.iter();
        stand.from == stand.to && dwells.any(|each| each.source == *source)
    };
    let dwells: Vec<_> = steps.iter().filter(is_dwell).copied().collect();
    let longest = longest_move(CAPACITY);
    for (number, each) in &dwells {
        let (number, ticks) = (*number, each.duration_ticks);
        if ticks > longest {
            return Err(Unplanned::LongDwell {
                number,
                ticks,
                longest,
            });
        }
    }
    let moves: Vec<_> = dwells.iter().map(|(_, each)| *each).collect();
    let all: Vec<_> = steps.iter().map(|(_, each)| *each).collect();
    let verdicts = judged(scene, &moves, &all);
    match dwells
        .iter()
        .zip(verdicts)
        .find(|(_, judged)| *judged != Judged::Kept)
    {
        Some((&(number, _), _)) => Err(Unplanned::Dwell { number }),
        None => Ok(()),
    }
}

/// Plans as [`plan_job`], and looks at no dwell.
fn plan_alpha(scene: &Scene, path: &JobPath, effort: Effort) -> Result<PlannedJob, Unplanned> {
    let Some(free) = &path.free else {
        return plan_either(scene, path, false, effort);
    };
    let as_given = JobPath {
        pieces: free.given.clone(),
        ..path.clone()
    };
    let given = plan_either(scene, &as_given, false, effort);
    let chosen = plan_either(scene, path, true, effort);
    let given_ticks = given.as_ref().ok().map(PlannedJob::ticks);
    let chosen = chosen.map(|planned| PlannedJob {
        given_ticks,
        ..planned
    });
    match (chosen, given) {
        (Ok(chosen), Ok(given)) if given.ticks() <= chosen.ticks() => Ok(PlannedJob {
            given_ticks,
            ..given
        }),
        (Err(_), Ok(given)) => Ok(PlannedJob {
            given_ticks,
            ..given
        }),
        (chosen, _) => chosen,
    }
}

/// Plans the pieces of `path`, or those with the alpha that the planner chooses.
fn plan_either(
    scene: &Scene,
    path: &JobPath,
    choose: bool,
    effort: Effort,
) -> Result<PlannedJob, Unplanned> {
    let mut others = Vec::new();
    loop {
        let planned = scene.model().visit(PlanJob {
            scene,
            path,
            choose,
            effort,
            others: &others,
        })?;
        // Runs are judged one by one. Units of a number type of little range are those of the whole job: they may be
        // larger, and then the runs are judged again in those.
        if planned.moves.plan.runs.len() == 1 || scene.number != NumberType::Fixed {
            return Ok(planned);
        }
        let moves = job_moves(&planned.path, &planned.moves.moves);
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
    /// The planner chooses alpha.
    choose: bool,
    effort: Effort,
    /// Moves that ask for room in the units beside those that are judged.
    others: &'a [JobMove],
}

impl ModelVisitor<f64> for PlanJob<'_> {
    type Output = Result<PlannedJob, Unplanned>;

    fn visit<M: Model<N = f64>>(self) -> Self::Output {
        let Self {
            scene,
            path,
            choose,
            effort,
            others,
        } = self;
        let limits = Limits::build(&scene.limits)?;
        let ramp = scene.ramp().least_rate(scene.period_s());
        let machine = scene.model().with(&scene.parameters);
        let planner = Planner::<M>::build(machine, limits, ramp)?;
        let sampling = Sampling {
            period_s: scene.period_s(),
            tolerance_m: path.tolerance_m,
            tolerance_rad: path.tolerance_rad,
            resolution_m: resolution(scene, size_m(scene)),
            resolution_rad: resolution(scene, angle_rad(path)),
            ticks_min: ticks_min(scene),
            ticks_shortest: ticks_shortest(scene),
        };
        let mut path = path.clone();
        if let Some(free) = path.free.as_ref().filter(|_| choose) {
            let sampler = Sampler::<M>::build(machine, limits, ramp)?;
            path.pieces = choose_alpha(&planner, &sampler, &free.way, shortest_reach_m(scene))
                .map_err(|refusal| Unplanned::NoAlpha {
                    number: free.way.pieces[refusal.place.piece].source,
                    refusal,
                })?;
        }
        let judge = |moves: &[PlannedMove]| judged(scene, &job_moves(&path, moves), others);
        let planned = plan_moves(&planner, &path.pieces, effort, sampling, judge);
        match planned {
            Ok(moves) => Ok(PlannedJob {
                path,
                moves,
                given_ticks: None,
            }),
            Err(refusal) => Err(Unplanned::Path {
                number: path.pieces[refusal.place.piece].source,
                refusal,
            }),
        }
    }
}

/// Shortest time of a move, s: about what a board takes to prove one (`cargo xtask cycles`).
const MOVE_MIN_S: f64 = 0.004;

/// Fewest ticks of a move.
fn ticks_min(scene: &Scene) -> u32 {
    // The cast saturates.
    (MOVE_MIN_S * scene.tick_rate_hz).round().max(1.0) as u32
}

/// Time in which the acceleration goes from one value of the plan to the next, s.
const RAMP_S: f64 = 0.001;

/// Ticks of the shortest move where the acceleration changes. In fixed point the rounding of velocities is seen in what is shorter than
/// other moves.
fn ticks_shortest(scene: &Scene) -> u32 {
    match scene.number {
        NumberType::Fixed => ticks_min(scene),
        _ => (RAMP_S * scene.tick_rate_hz).round().max(1.0) as u32,
    }
}

/// Distance between neighbouring numbers of about `size` in the number type of `scene`.
fn resolution(scene: &Scene, size: f64) -> f64 {
    size * match scene.number {
        NumberType::F64 => f64::UNIT_ROUNDOFF,
        NumberType::F32 | NumberType::Micromath => f32::UNIT_ROUNDOFF.to_f64(),
        NumberType::Fixed => Fixed::UNIT_ROUNDOFF.to_f64(),
    }
}

/// Size of the machine.
fn size_m(scene: &Scene) -> f64 {
    let reach = |leg: &LegParameters| leg.base_m.amax() + leg.proximal_m + leg.distal_m;
    scene.parameters.legs.iter().map(reach).fold(0.0, f64::max)
}

/// Largest alpha along `path`, or a little more.
fn angle_rad(path: &JobPath) -> f64 {
    let largest = |piece: &Piece<f64>| {
        piece
            .turning
            .iter()
            .fold(piece.angle.abs(), |sum, turned| sum + turned.abs())
    };
    path.pieces
        .iter()
        .map(|each| largest(&each.piece))
        .fold(0.0, f64::max)
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
        Err(Objection::Limit(violation)) => match exceeded(&violation) {
            Some(what) => Judged::Exceeded(violation.value / violation.limit - 1.0, what),
            None => Judged::Refused,
        },
        Err(_) => Judged::Refused,
    };
    judgements.into_iter().map(judged).collect()
}

/// The quantity of a motor that a move takes too much of, if it is one; what is not certain is not proven in the number type.
fn exceeded(violation: &Violation<f64>) -> Option<Limited> {
    let motor = violation.index.map_or(0, usize::from);
    let what = match violation.what {
        Bounded::Rate => Limited::Rate(motor),
        Bounded::Acceleration | Bounded::AccelerationJump => Limited::Acceleration(motor),
        Bounded::Torque => Limited::Torque(motor),
        Bounded::Power => Limited::Power(motor),
        Bounded::Jerk => Limited::Jerk(motor),
        _ => return None,
    };
    Some(match violation.certain {
        true => what,
        false => Limited::Number,
    })
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

/// Length of the shortest leg, stretched.
fn shortest_reach_m(scene: &Scene) -> f64 {
    let legs = scene.parameters.legs.iter();
    let reaches = legs.map(|leg| leg.proximal_m + leg.distal_m);
    reaches.fold(f64::INFINITY, f64::min)
}

/// Refusal of a piece that ends where the machine is not: known without a plan of those before it.
fn refused_at_once(scene: &Scene, path: &JobPath) -> Option<Unplanned> {
    let reach = StartReach::new(scene, &scene.job.start).ok()?;
    let is_beyond = |each: &&PathPiece| reach.margin(&each.piece.at(1.0).pose).is_none();
    let piece = path.pieces.iter().find(is_beyond)?;
    let alone = JobPath {
        pieces: vec![*piece],
        free: None,
        dwells: Vec::new(),
        rows: Vec::new(),
        outputs: Vec::new(),
        ..path.clone()
    };
    plan_part(scene, &alone, None, Effort::default()).err()
}

impl Scene {
    /// Gives the machine another job: `path`, which begins where the job of the scene does. The planned moves take the
    /// place of the job's; nothing else changes. A path of many thousand pieces is planned in blocks: the machine stands between two
    /// of them, where it does so anyway, or where the tool is off, or where its power follows the speed.
    ///
    /// # Errors
    /// [`Unplanned`]; the scene is as it was.
    pub fn take_path(&mut self, path: &JobPath) -> Result<(), Unplanned> {
        if is_one_block(self, path) {
            let planned = plan_job(self, path, Effort::default())?;
            return self.take_steps(planned.steps(), planned.path);
        }
        if let Some(refusal) = refused_at_once(self, path) {
            return Err(refusal);
        }
        let mut steps: Vec<(usize, JobMove)> = Vec::new();
        let scene = &*self;
        // The whole path has them, too.
        let plan = |block: PathBlock| plan_block(scene, &block).map(|(steps, _)| steps);
        in_order(blocks(path).map(Ok), plan, |mut block| {
            let first = block.first_mut().map(|(_, first)| first);
            join(steps.last().map(|(_, last)| last), first);
            steps.append(&mut block);
            Ok(())
        })?;
        let ticks = steps.iter().map(|(_, each)| u64::from(each.duration_ticks));
        check_ticks(ticks.sum())?;
        self.take_steps(steps, path.clone())
    }

    /// Gives the machine the moves `steps` of `path`, with the levels of its rows.
    fn take_steps(
        &mut self,
        mut steps: Vec<(usize, JobMove)>,
        path: JobPath,
    ) -> Result<(), Unplanned> {
        let levels = JobLevels::of(&path.rows, &mut steps);
        let outputs = JobOutputs::of(&path.outputs, &steps);
        let sources: Vec<usize> = steps.iter().map(|(source, _)| *source).collect();
        let moves: Vec<JobMove> = steps.into_iter().map(|(_, each)| each).collect();
        if !levels.is_empty() {
            let trial = Self {
                job: Job::of(self.job.start, moves.clone()),
                ..self.clone()
            };
            if let Some(index) = misfit(&trial, &moves, &levels) {
                let number = sources[index];
                return Err(Unplanned::Levels { number });
            }
        }
        self.job = Job {
            moves,
            path: Some(path),
            spool: None,
            levels,
            outputs,
            ..self.job
        };
        Ok(())
    }
}

/// Gives the job of `scene` the planned moves of its path, or refuses the piece with the first obstacle.
pub(crate) fn plan_path(document: &Document, scene: &mut Scene, placed: &PlacedPath) -> Option<()> {
    match scene.take_path(&placed.path) {
        Ok(()) => return Some(()),
        Err(error @ (Unplanned::Units | Unplanned::Ticks(_))) => {
            document.refuse(&placed.places[0], error.to_string());
        }
        Err(
            ref error @ (Unplanned::Path { number, .. }
            | Unplanned::NoAlpha { number, .. }
            | Unplanned::Dwell { number }
            | Unplanned::LongDwell { number, .. }
            | Unplanned::Levels { number }
            | Unplanned::Tool { number }),
        ) => document.refuse(&placed.places[number], error.to_string()),
        // The machine is checked, and refused, by itself.
        Err(Unplanned::Machine(_)) => {}
    }
    None
}
