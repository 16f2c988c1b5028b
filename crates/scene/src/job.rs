//! The job: where the machine starts, and the moves that follow.

use crate::duration::{ticks_at_constant_acceleration, whole_ticks};
use crate::io::SparePins;
use crate::job_move::{JobMove, read_tool};
use crate::job_path::{JobPath, PlacedPath, read_path};
use crate::levels::JobLevels;
use crate::outputs::{JobOutputs, OutputBits, read_outputs};
use crate::read::{Bound, Document, Place, Section};
use crate::spool::MoveSpool;
use nalgebra::Vector3;
use std::sync::Arc;
use trirrr_core::setpoint::Pose;
use trirrr_core::units::Units;

/// A start pose and the moves from it, one after the other without a pause.
#[derive(Clone, Debug, PartialEq)]
pub struct Job {
    /// Pose in which the machine stands, at rest, before the first move.
    pub start: Pose<f64>,
    /// The moves, at least one. Each starts with the pose and velocity the one before ends with,
    /// the first from rest; the last ends at rest.
    pub moves: Vec<JobMove>,
    /// Path that the moves were planned for, if the job gives one instead of moves.
    pub path: Option<JobPath>,
    /// The moves of a long job, in place of `moves`: those are none then.
    pub spool: Option<Arc<MoveSpool>>,
    /// Levels of the tool along moves of the path.
    pub levels: JobLevels,
    /// Outputs that change with its moves.
    pub outputs: JobOutputs,
}

impl Job {
    /// The job of these moves alone.
    pub fn of(start: Pose<f64>, moves: Vec<JobMove>) -> Self {
        Self {
            start,
            moves,
            path: None,
            spool: None,
            levels: JobLevels::default(),
            outputs: JobOutputs::default(),
        }
    }

    /// The job in `units`, without its path. Moves in a spool stay in SI units.
    pub fn in_units(&self, units: &Units) -> Self {
        Self {
            start: units.pose(&self.start),
            moves: self.moves.iter().map(|each| each.in_units(units)).collect(),
            path: None,
            spool: self.spool.clone(),
            levels: self.levels.clone(),
            outputs: self.outputs.clone(),
        }
    }

    /// Duration of the whole job in ticks. It has one setpoint more than that, for both ends
    /// count.
    pub fn ticks(&self) -> u32 {
        // Cannot overflow: a longer job is refused when it is read.
        let ticks = self.moves.iter().map(|each| each.duration_ticks);
        self.spool
            .as_ref()
            .map_or_else(|| ticks.sum(), |spool| spool.ticks())
    }

    /// Number of moves.
    pub fn count(&self) -> usize {
        let spool = self.spool.as_ref();
        spool.map_or(self.moves.len(), |spool| spool.count() as usize)
    }

    /// Returns true if a move is a quintic.
    pub fn has_quintics(&self) -> bool {
        let is_quintic = |each: &JobMove| each.accelerations.is_some();
        let spool = self.spool.as_ref();
        spool.map_or_else(
            || self.moves.iter().any(is_quintic),
            |spool| spool.has_quintics(),
        )
    }

    /// Ticks of the shortest move; `None` without moves.
    pub fn shortest_ticks(&self) -> Option<u32> {
        let ticks = self.moves.iter().map(|each| each.duration_ticks);
        self.spool
            .as_ref()
            .map_or_else(|| ticks.min(), |spool| spool.shortest_ticks())
    }
}

/// A job and where its parts stand in the file, for what is checked later.
pub struct PlacedJob {
    /// The job.
    pub job: Job,
    /// Place of the start pose.
    pub start: Place,
    /// Places of the moves.
    pub moves: Vec<PlacedMove>,
    /// The path from which the moves are still to be planned.
    pub(crate) path: Option<PlacedPath>,
}

/// Place of a move in the file.
pub struct PlacedMove {
    /// The table of the move.
    pub whole: Place,
    /// The pose at its end.
    pub to: Place,
}

/// Reads `[job]` of a machine with these spare `pins`. Without a tick rate, durations are not checked; without pins, those that are
/// named are not looked for.
pub(crate) fn read_job(
    document: &Document,
    root: &Section,
    rate: Option<f64>,
    pins: Option<&SparePins>,
) -> Option<PlacedJob> {
    read_job_with(document, root, rate, |each| read_outputs(each, pins))
}

/// Reads `[job]`; `of_move` reads what a table has besides, of each `[[job.move]]` or `[[job.path]]` in turn, and returns the spare
/// outputs that change there. Without a tick rate, durations are not checked.
pub fn read_job_with(
    document: &Document,
    root: &Section,
    rate: Option<f64>,
    mut of_move: impl FnMut(&Section) -> OutputBits,
) -> Option<PlacedJob> {
    let section = root.section("job")?;
    let start = read_pose(&section, "start");
    let sections = section.sections("move")?;
    let pieces = section.sections("path")?;
    let shortest = match section.has("timing") {
        true => section.choice("timing", &[("given", false), ("shortest", true)])?,
        false => false,
    };
    if let Some((key, reason)) = misplaced(shortest, &sections, &pieces) {
        section.refuse_list(key, reason);
        section.ignore_rest();
        return None;
    }
    if shortest {
        let placed = read_path(&section, &pieces, start, rate, of_move)?;
        return Some(PlacedJob {
            start: section.place_of("start"),
            moves: Vec::new(),
            job: Job {
                path: Some(placed.path.clone()),
                ..Job::of(start?, Vec::new())
            },
            path: Some(placed),
        });
    }
    let mut from = start;
    let mut start_velocity = Some(Vector3::zeros());
    let mut start_acceleration = Vector3::zeros();
    let mut moves = Vec::with_capacity(sections.len());
    let mut outputs = JobOutputs::default();
    let mut complete = true;
    for (index, each) in (0..).zip(&sections) {
        let to = read_pose(each, "to");
        let end_velocity = read_velocity(each);
        let end_acceleration = read_end_acceleration(each);
        let is_quintic = end_acceleration.is_some_and(|end| end.is_some());
        let ticks = match is_quintic && !each.has("duration_s") {
            true => {
                each.refuse("duration_s", "a quintic needs its duration");
                None
            }
            false => read_ticks(each, rate, [from, to], [start_velocity, end_velocity]),
        };
        let tool = read_tool(each);
        let switched = of_move(each);
        if switched != OutputBits::default() {
            outputs.add(index, switched);
        }
        let whole = || {
            Some(JobMove {
                from: from?,
                to: to?,
                start_velocity: start_velocity?,
                end_velocity: end_velocity?,
                accelerations: end_acceleration?.map(|end| [start_acceleration, end]),
                duration_ticks: ticks?,
                tool: tool?,
            })
        };
        match whole() {
            Some(whole) => moves.push(whole),
            None => complete = false,
        }
        (from, start_velocity) = (to, end_velocity);
        start_acceleration = end_acceleration.flatten().unwrap_or(Vector3::zeros());
    }
    let last = sections.last()?;
    if start_velocity.is_some_and(|velocity| velocity != Vector3::zeros()) {
        last.refuse("end_velocity", "the last move must end at rest");
    }
    if start_acceleration != Vector3::zeros() {
        let reason = "the last move must end without an acceleration";
        last.refuse("end_acceleration", reason);
    }
    let total: u64 = moves
        .iter()
        .map(|each| u64::from(each.duration_ticks))
        .sum();
    if total > u64::from(u32::MAX) {
        let reason = format!(
            "the moves take {total} ticks together, at most {} are allowed",
            u32::MAX
        );
        document.refuse(&section.place(), reason);
    }
    if !complete {
        return None;
    }
    let placed = |each: &Section| PlacedMove {
        whole: each.place(),
        to: each.place_of("to"),
    };
    Some(PlacedJob {
        start: section.place_of("start"),
        moves: sections.iter().map(placed).collect(),
        job: Job {
            outputs,
            ..Job::of(start?, moves)
        },
        path: None,
    })
}

/// Returns the key that does not go with the timing, and the reason.
fn misplaced(
    shortest: bool,
    moves: &[Section],
    pieces: &[Section],
) -> Option<(&'static str, &'static str)> {
    match (shortest, moves, pieces) {
        (false, _, [_, ..]) => Some((
            "path",
            "a path gives no durations: it goes with timing = \"shortest\"",
        )),
        (true, [_, ..], _) => Some((
            "move",
            "a move gives its duration: with timing = \"shortest\" the job is a [[job.path]]",
        )),
        (false, [], _) => Some(("move", "a job needs at least one [[job.move]]")),
        (true, _, []) => Some((
            "path",
            "timing = \"shortest\" needs at least one [[job.path]]",
        )),
        _ => None,
    }
}

fn read_pose(section: &Section, key: &'static str) -> Option<Pose<f64>> {
    let pose = section.section(key)?;
    let x = pose.number("x_m", Bound::Finite);
    let y = pose.number("y_m", Bound::Finite);
    let alpha = pose.number("alpha_rad", Bound::Finite);
    Some(Pose::from_f64(x?, y?, alpha?))
}

fn read_velocity(each: &Section) -> Option<Vector3<f64>> {
    if !each.has("end_velocity") {
        return Some(Vector3::zeros());
    }
    read_rates(
        &each.section("end_velocity")?,
        ["vx_m_s", "vy_m_s", "valpha_rad_s"],
    )
}

/// The acceleration at the end of a quintic: `Some(None)` for a cubic.
fn read_end_acceleration(each: &Section) -> Option<Option<Vector3<f64>>> {
    let is_quintic = match each.has("curve") {
        true => each.choice("curve", &[("cubic", false), ("quintic", true)])?,
        false => false,
    };
    if !each.has("end_acceleration") {
        return Some(is_quintic.then(Vector3::zeros));
    }
    if !is_quintic {
        let reason = "goes with curve = \"quintic\"";
        each.refuse("end_acceleration", reason);
        return None;
    }
    read_rates(
        &each.section("end_acceleration")?,
        ["ax_m_s2", "ay_m_s2", "aalpha_rad_s2"],
    )
    .map(Some)
}

/// Three numbers, each 0 where it is left out.
fn read_rates(section: &Section, keys: [&'static str; 3]) -> Option<Vector3<f64>> {
    let [x, y, alpha] = keys.map(|key| section.number_or(key, Bound::Finite, 0.0));
    Some(Vector3::new(x?, y?, alpha?))
}

fn read_ticks(
    each: &Section,
    rate: Option<f64>,
    [from, to]: [Option<Pose<f64>>; 2],
    [start, end]: [Option<Vector3<f64>>; 2],
) -> Option<u32> {
    let ticks = if each.has("duration_s") {
        whole_ticks(each.number("duration_s", Bound::Positive)?, rate?)
    } else {
        ticks_at_constant_acceleration(&from?, &to?, start?, end?, rate?)
    };
    ticks
        .map_err(|reason| each.refuse("duration_s", reason))
        .ok()
}
