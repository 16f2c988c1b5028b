//! Checks that a job can be driven: every pose within reach and away from singularity, from the
//! start to the end of every move.

use crate::job::{Move, PlacedJob};
use crate::player::segment;
use crate::read::Document;
use nalgebra::Vector2;
use trirrr_core::inverse::Position;
use trirrr_core::limits::LimitParameters as Limits;
use trirrr_core::machine::{Geometry, Leg, Parameters};
use trirrr_core::number::Number;
use trirrr_core::setpoint::Pose;
use trirrr_core::singularity::{Distances, det_a};
use trirrr_core::status::Status;

/// Fewest intervals that a move is divided into, however short it is.
const FEWEST_INTERVALS: u32 = 200;

/// Most intervals. The path depends on the fraction of the move that has passed and not on the
/// number of ticks; beyond this, a slow move would only cost time.
const MOST_INTERVALS: u32 = 1 << 20;

/// What a pose is measured with.
struct Workspace<'p> {
    parameters: &'p Parameters,
    limits: &'p Limits,
    geometry: Geometry<f64>,
    distances: Distances<f64>,
}

/// Refuses every pose and every move of `placed` that `parameters` and `limits` do not allow.
/// A pose is reported once, where the file gives it; a move only for what happens between its
/// poses.
pub(crate) fn check_job(
    document: &Document,
    parameters: &Parameters,
    limits: &Limits,
    placed: &PlacedJob,
    period_s: f64,
    geometry: Geometry<f64>,
) {
    let workspace = Workspace {
        parameters,
        limits,
        geometry,
        distances: Distances::build(parameters),
    };
    let mut from = workspace.det_a(&placed.job.start);
    if let Err(reason) = &from {
        document.refuse(&placed.start, reason);
    }
    for (each, place) in placed.job.moves.iter().zip(&placed.moves) {
        let to = workspace.det_a(&each.to);
        if let Err(reason) = &to {
            document.refuse(&place.to, reason);
        }
        if let (Ok(_), Ok(_)) = (&from, &to)
            && let Err(reason) = workspace.check_between(each, period_s)
        {
            document.refuse(&place.whole, reason);
        }
        from = to;
    }
}

impl Workspace<'_> {
    /// Follows a move whose ends are allowed. Intervals are whole fractions of a tick, so every
    /// tick is among the instants looked at unless there are more than [`MOST_INTERVALS`].
    fn check_between(&self, each: &Move, period_s: f64) -> Result<(), String> {
        let ticks = each.duration_ticks;
        let duration_s = f64::from(ticks) * period_s;
        let intervals = match ticks {
            0..FEWEST_INTERVALS => ticks * FEWEST_INTERVALS.div_ceil(ticks),
            _ => ticks.min(MOST_INTERVALS),
        };
        let interval_s = duration_s / f64::from(intervals);
        let segment = segment::<f64>(each, intervals, interval_s);
        let mut before: Option<f64> = None;
        for interval in 0..=intervals {
            let pose = segment.at(interval).pose;
            let time_s = f64::from(interval) * interval_s;
            let now = self
                .det_a(&pose)
                .map_err(|reason| format!("{}: {reason}", instant(time_s, &pose)))?;
            if before.is_some_and(|before| before.is_sign_positive() != now.is_sign_positive()) {
                return Err(format!(
                    "{}: crosses a parallel singularity, det A changes its sign",
                    instant(time_s - interval_s, &pose)
                ));
            }
            before = Some(now);
        }
        Ok(())
    }

    /// det A at an allowed pose.
    ///
    /// # Errors
    /// Why the pose is not allowed.
    fn det_a(&self, pose: &Pose<f64>) -> Result<f64, String> {
        let position = self
            .geometry
            .position(pose)
            .map_err(|status| match status {
                Status::Unreachable { leg } => self.unreachable(leg, pose),
                other => other.to_string(),
            })?;
        self.check_serial(&position)?;
        let (distance, least) = (
            self.distances.parallel(&position),
            self.limits.parallel_distance_min,
        );
        let det_a = det_a(&position);
        let allowed = distance >= least && det_a.abs() > 0.0;
        if !allowed {
            return Err(format!(
                "parallel singularity: distance {}, the least allowed is {}",
                short(distance),
                short(least)
            ));
        }
        Ok(det_a)
    }

    fn check_serial(&self, position: &Position<f64>) -> Result<(), String> {
        let least = self.limits.serial_distance_min;
        let distances = self.distances.serial(position);
        for (leg, (distance, solved)) in distances.into_iter().zip(&position.legs).enumerate() {
            // Written so that a value that is not a number is refused.
            let allowed = distance >= least;
            if !allowed {
                let shape = match solved.links.r1.dot(&solved.links.r2) >= 0.0 {
                    true => "stretched",
                    false => "folded",
                };
                return Err(format!(
                    "serial singularity: leg {} is {shape}, distance {}, the least allowed is {}",
                    leg + 1,
                    short(distance),
                    short(least)
                ));
            }
        }
        Ok(())
    }

    /// Which leg is out of reach, and by how much.
    fn unreachable(&self, leg: usize, pose: &Pose<f64>) -> String {
        let parameters = &self.parameters.legs[leg];
        let Leg { base, joint, .. } = self.geometry.legs[leg];
        let (sin, cos) = f64::sin_cos(pose.angle);
        let c = Vector2::new(joint.x * cos - joint.y * sin, joint.x * sin + joint.y * cos);
        let span = pose.position - base + c;
        let distance = Number::sqrt(span.x * span.x + span.y * span.y);
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

/// "at t = 0.12 s, x = 0.2 m, y = 0.3 m, alpha = 0.1 rad".
fn instant(time_s: f64, pose: &Pose<f64>) -> String {
    format!(
        "at t = {} s of the move, x = {} m, y = {} m, alpha = {} rad",
        short(time_s),
        short(pose.position.x),
        short(pose.position.y),
        short(pose.angle)
    )
}

/// A number to four significant digits, without trailing zeros.
fn short(value: f64) -> String {
    let rounded: f64 = format!("{value:.3e}").parse().unwrap_or(value);
    let text = format!("{rounded:?}");
    text.strip_suffix(".0").map(Into::into).unwrap_or(text)
}
