//! Checks that a job can be driven: every pose within reach and away from singularity, and every
//! move admitted by the service's own judgement.

use crate::job::{Job, PlacedJob};
use crate::job_move::JobMove;
use crate::judge::{Objection, Unjudged, judge};
use crate::peak::RefusedMove;
use crate::pipeline;
use crate::read::{Document, Place};
use crate::words::{self, short};
use crate::{NumberType, Scene};
use nalgebra::Vector2;
use trirrr_core::inverse::Position;
use trirrr_core::limits::LimitParameters;
use trirrr_core::machine::{BuildError, Geometry, Parameters};
use trirrr_core::number::Arithmetic;
use trirrr_core::setpoint::Pose;
use trirrr_core::singularity::Distances;
use trirrr_core::status::Status;
use trirrr_core::units::Units;

/// Means to measure a pose with.
struct Workspace<'p> {
    parameters: &'p Parameters,
    limits: &'p LimitParameters,
    geometry: Geometry<f64>,
    distances: Distances<f64>,
    period_s: f64,
    number: NumberType,
}

/// Refuses every pose and every move of `placed` that the machine and the limits of `scene` do not
/// allow. A pose is reported once, where the file gives it; a move only for what happens between its
/// poses.
///
/// # Errors
/// Why nothing could be looked at.
pub(crate) fn check_job(
    document: &Document,
    scene: &Scene,
    placed: &PlacedJob,
    number: &Place,
    geometry: Geometry<f64>,
) -> Result<(), BuildError> {
    let workspace = Workspace::of(scene, geometry);
    let is_allowed = |pose: &Pose<f64>, place: &Place| {
        let checked = workspace.check(pose);
        if let Err(reason) = &checked {
            document.refuse(place, reason);
        }
        checked.is_ok()
    };
    let moves = || placed.job.moves.iter().zip(&placed.moves);
    let mut allowed = vec![is_allowed(&placed.job.start, &placed.start)];
    allowed.extend(moves().map(|(each, place)| is_allowed(&each.to, &place.to)));
    // The moves of a path were judged when they were planned.
    if scene.job.path.is_some() {
        return Ok(());
    }
    let judgements = match judge(scene) {
        Ok(judgements) => judgements,
        Err(Unjudged::Machine(error)) => return Err(error),
        // The job has to be good before its units can be chosen.
        Err(Unjudged::Range(_)) if allowed.contains(&false) => return Ok(()),
        Err(Unjudged::Range(error)) => {
            document.refuse(number, error.to_string());
            return Ok(());
        }
    };
    let ends = allowed.windows(2);
    for (((each, place), judgement), ends) in moves().zip(judgements).zip(ends) {
        if let (Err(objection), &[true, true]) = (judgement, ends) {
            let reason = workspace.whole_objection(scene, each, &objection)?;
            document.refuse(&place.whole, reason);
        }
    }
    Ok(())
}

/// Verdict of the service of a scene on a move.
#[derive(Clone, Debug, PartialEq)]
pub struct MoveVerdict {
    /// Reason why the service does not play the move; none of a move that is admitted.
    pub reason: Option<String>,
    /// Duration in ticks that is proven to be long enough, if one was found.
    pub enough_ticks: Option<u32>,
}

/// Judges `each`, a move of the machine of `scene`, as the service of the scene does, in its number type. The job of the scene does not
/// matter.
///
/// # Errors
/// Reason why no move can be judged: machine or move fit no units of the number type.
pub fn judge_move(scene: &Scene, each: &JobMove) -> Result<MoveVerdict, String> {
    let refused = |reason: String| MoveVerdict {
        reason: Some(reason),
        enough_ticks: None,
    };
    let in_words = |error: BuildError| error.to_string();
    let geometry = Geometry::<f64>::build(&scene.parameters).map_err(in_words)?;
    let workspace = Workspace::of(scene, geometry);
    for (pose, name) in [(&each.from, "start"), (&each.to, "end")] {
        if let Err(reason) = workspace.check(pose) {
            return Ok(refused(format!("the {name}: {reason}")));
        }
    }
    let trial = Scene {
        job: Job::of(each.from, vec![*each]),
        ..scene.clone()
    };
    let judgements = judge(&trial).map_err(|error| error.to_string())?;
    let Some(Err(objection)) = judgements.first() else {
        return Ok(MoveVerdict {
            reason: None,
            enough_ticks: None,
        });
    };
    let reason = workspace
        .whole_objection(&trial, each, objection)
        .map_err(in_words)?;
    let shortest = match objection {
        Objection::Limit(violation) => violation.shortest,
        _ => None,
    };
    Ok(MoveVerdict {
        enough_ticks: shortest.map(|shortest| shortest.enough),
        ..refused(reason)
    })
}

impl<'p> Workspace<'p> {
    fn of(scene: &'p Scene, geometry: Geometry<f64>) -> Self {
        Self {
            parameters: &scene.parameters,
            limits: &scene.limits,
            geometry,
            distances: Distances::build(&scene.parameters),
            period_s: scene.period_s(),
            number: scene.number,
        }
    }

    /// Describes why the service does not play a move, and how far the move is beyond the limit at worst.
    fn whole_objection(
        &self,
        scene: &Scene,
        each: &JobMove,
        objection: &Objection,
    ) -> Result<String, BuildError> {
        let mut reason = self.objection(each, objection);
        if let Objection::Limit(violation) = objection {
            let machine = pipeline::of_scene::<f64>(scene, Units::SI)?;
            let refused = RefusedMove {
                each,
                period_s: self.period_s,
                machine: &*machine,
            };
            reason += &refused.worst(violation);
        }
        Ok(reason)
    }

    /// Describes why the service does not play a move.
    fn objection(&self, each: &JobMove, objection: &Objection) -> String {
        let number = self.number;
        let violation = match objection {
            Objection::Limit(violation) => violation,
            Objection::NotFinite => return format!("a value is beyond the range of {number}"),
            Objection::Duration(longest) => {
                return format!(
                    "{} ticks; a move lasts {longest} at most",
                    each.duration_ticks
                );
            }
            Objection::Tool => {
                return format!("power and speed of the tool cannot be told from zero in {number}");
            }
        };
        let (period_s, ticks) = (self.period_s, each.duration_ticks);
        let time_s = violation.at * f64::from(ticks) * period_s;
        let pose = each
            .segment::<f64>(ticks, period_s)
            .at_fraction(violation.at)
            .pose;
        let mut reason = format!(
            "{}: {}",
            words::instant(time_s, &pose),
            words::violation(violation)
        );
        if let Some(shortest) = &violation.shortest {
            reason += &format!("; {}", words::long_enough(shortest, period_s.recip()));
        }
        reason
    }

    /// Checks that a pose is allowed.
    ///
    /// # Errors
    /// Why it is not.
    fn check(&self, pose: &Pose<f64>) -> Result<(), String> {
        let position = self
            .geometry
            .position(pose)
            .map_err(|status| match status {
                Status::Unreachable { leg } => self.unreachable(leg, pose),
                other => other.to_string(),
            })?;
        self.check_serial(&position, pose)?;
        let (distance, least) = (
            self.distances.parallel(&position),
            self.limits.parallel_distance_min,
        );
        // Written so that a value that is not a number is refused.
        let allowed = distance >= least && distance > 0.0;
        if !allowed {
            return Err(format!(
                "parallel singularity: distance {}, the least allowed is {}",
                short(distance),
                short(least)
            ));
        }
        Ok(())
    }

    fn check_serial(&self, position: &Position<f64>, pose: &Pose<f64>) -> Result<(), String> {
        let least = self.limits.serial_distance_min;
        for (leg, distance) in self.distances.serial(position).into_iter().enumerate() {
            // Written so that a value that is not a number is refused.
            let allowed = distance >= least;
            if !allowed {
                return Err(self.serial(leg, distance, pose));
            }
        }
        Ok(())
    }

    /// That `leg` is too near to its singularity at `pose`.
    fn serial(&self, leg: usize, distance: f64, pose: &Pose<f64>) -> String {
        let links = self.geometry.position(pose).map(|at| at.legs[leg].links);
        let shape = match links {
            Ok(links) if links.r1.dot(&links.r2) < 0.0 => "folded",
            _ => "stretched",
        };
        format!(
            "serial singularity: leg {} is {shape}, distance {}, the least allowed is {}",
            leg + 1,
            short(distance),
            short(self.limits.serial_distance_min)
        )
    }

    /// Describes which leg is out of reach, and by how much.
    fn unreachable(&self, leg: usize, pose: &Pose<f64>) -> String {
        let parameters = &self.parameters.legs[leg];
        let geometry = &self.geometry.legs()[leg];
        let (base, joint) = (geometry.base(), geometry.joint());
        let (sin, cos) = f64::sin_cos(pose.angle);
        let c = Vector2::new(joint.x * cos - joint.y * sin, joint.x * sin + joint.y * cos);
        let span = pose.position - base + c;
        let distance = Arithmetic::sqrt(span.x * span.x + span.y * span.y);
        let longest = parameters.proximal_m + parameters.distal_m;
        let shortest = (parameters.proximal_m - parameters.distal_m).abs();
        let (excess, bound) = match distance > longest {
            true => (
                distance - longest,
                format!("beyond its reach of {} m", short(longest)),
            ),
            false => (
                shortest - distance,
                format!("short of the {} m it folds to", short(shortest)),
            ),
        };
        format!(
            "unreachable: leg {} would span {} m, {} m {bound}",
            leg + 1,
            short(distance),
            short(excess)
        )
    }
}
