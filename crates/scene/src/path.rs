//! Checks that a job can be driven: every pose within reach and away from singularity, and every
//! move admitted as the service would admit it, in `f64`.

use crate::Scene;
use crate::job::{JobMove, PlacedJob};
use crate::player::segment;
use crate::read::Document;
use nalgebra::Vector2;
use trirrr_core::inverse::Position;
use trirrr_core::limits::{self, LimitParameters};
use trirrr_core::machine::{BuildError, Geometry, Parameters};
use trirrr_core::model::Dynamic;
use trirrr_core::number::Arithmetic;
use trirrr_core::setpoint::Pose;
use trirrr_core::singularity::Distances;
use trirrr_core::status::Status;
use trirrr_core::torque::links::{InPlane, Massive};
use trirrr_core::torque::payload::Offset;
use trirrr_protocol::message::{self, Bounded, Violation};
use trirrr_service::admission::{Admission, Verdict};

/// Admission with room for whatever a scene may hold.
type AnyAdmission = Admission<Dynamic<f64, Offset<f64>, Massive<f64, InPlane<f64>>>>;

/// Means to measure a pose with.
struct Workspace<'p> {
    parameters: &'p Parameters,
    limits: &'p LimitParameters,
    geometry: Geometry<f64>,
    distances: Distances<f64>,
    admission: AnyAdmission,
    period_s: f64,
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
    geometry: Geometry<f64>,
) -> Result<(), BuildError> {
    let (parameters, limits) = (&scene.parameters, &scene.limits);
    let period_s = scene.period_s();
    let mut workspace = Workspace {
        parameters,
        limits,
        geometry,
        distances: Distances::build(parameters),
        admission: AnyAdmission::build(
            parameters,
            limits::Limits::build(limits)?,
            scene.ramp_ticks(),
            period_s,
        )?,
        period_s,
    };
    let mut from = workspace.check(&placed.job.start);
    if let Err(reason) = &from {
        document.refuse(&placed.start, reason);
    }
    for (each, place) in placed.job.moves.iter().zip(&placed.moves) {
        let to = workspace.check(&each.to);
        if let Err(reason) = &to {
            document.refuse(&place.to, reason);
        }
        if let (Ok(()), Ok(())) = (&from, &to)
            && let Err(reason) = workspace.check_between(each)
        {
            document.refuse(&place.whole, reason);
        }
        from = to;
    }
    Ok(())
}

/// The move as a host would offer it.
fn offered(each: &JobMove) -> message::Move<f64> {
    message::Move {
        number: 0,
        from: each.from,
        to: each.to,
        start_velocity: each.start_velocity.into(),
        end_velocity: each.end_velocity.into(),
        ticks: each.duration_ticks,
        tool_power: 0.0,
        tool_speed: 0.0,
    }
}

impl Workspace<'_> {
    /// Judges a move whose ends are allowed, as the service would when it is offered.
    fn check_between(&mut self, each: &JobMove) -> Result<(), String> {
        self.admission.offer(&offered(each));
        let violation = loop {
            match self.admission.step() {
                Verdict::Undecided => {}
                Verdict::Refused(violation) => break violation,
                Verdict::Admitted | Verdict::Nothing => return Ok(()),
            }
        };
        let (period_s, ticks) = (self.period_s, each.duration_ticks);
        let time_s = violation.at * f64::from(ticks) * period_s;
        let pose = segment::<f64>(each, ticks, period_s)
            .at_fraction(violation.at)
            .pose;
        let mut reason = format!(
            "{}: {}",
            instant(time_s, &pose),
            self.broken(&violation, &pose)
        );
        if let Some(shortest) = violation.shortest {
            let shortest_s = short(f64::from(shortest) * period_s);
            reason += &format!("; {shortest} ticks ({shortest_s} s) would be long enough");
        }
        Err(reason)
    }

    /// Describes what a move breaks at `pose`.
    fn broken(&self, violation: &Violation<f64>, pose: &Pose<f64>) -> String {
        let index = usize::from(violation.index.unwrap_or(0));
        let (value, limit) = (short(violation.value), short(violation.limit));
        let (name, unit) = match violation.what {
            Bounded::Reach => {
                return format!(
                    "unreachable: leg {} would span {value} m, its bound is {limit} m",
                    index + 1
                );
            }
            Bounded::SerialDistance => return self.serial(index, violation.value, pose),
            Bounded::ParallelDistance if violation.limit == 0.0 => {
                return "crosses a parallel singularity, det A changes its sign".into();
            }
            Bounded::ParallelDistance => {
                return format!(
                    "parallel singularity: distance {value}, the least allowed is {limit}"
                );
            }
            Bounded::Range => return "a result beyond the range of the number type".into(),
            Bounded::Rate => ("rate", "rad/s"),
            Bounded::Acceleration => ("acceleration", "rad/s^2"),
            Bounded::Torque => ("torque", "N m"),
            Bounded::Power => ("power", "W"),
        };
        let during = match violation.ramp {
            true => " in a hold or a resume there",
            false => "",
        };
        format!(
            "{name} of motor {} would be {value} {unit}{during}, the most allowed is {limit} {unit}",
            index + 1
        )
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
