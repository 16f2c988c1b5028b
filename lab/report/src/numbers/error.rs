//! Distance of the results of a number type from the exact ones.

use super::tool::miss;
use crate::error::ReportError;
use crate::exact::Instant;
use trirrr_core::number::Number;
use trirrr_scene::Scene;
use trirrr_scene::pipeline;
use trirrr_truth::results::angle_error;

/// Stage of a tick's computation, in the order of the stages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stage {
    Position,
    Rates,
    Accelerations,
    TorqueMassless,
    TorqueWithLinks,
}

impl Stage {
    pub(crate) const ALL: [Self; 5] = [
        Self::Position,
        Self::Rates,
        Self::Accelerations,
        Self::TorqueMassless,
        Self::TorqueWithLinks,
    ];

    /// The stages that a scene goes through, in the order of a motor's results.
    pub(crate) fn of(scene: &Scene) -> [Self; 4] {
        let torque = match scene.parameters.links_are_massless() {
            true => Self::TorqueMassless,
            false => Self::TorqueWithLinks,
        };
        [Self::Position, Self::Rates, Self::Accelerations, torque]
    }

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Position => "position",
            Self::Rates => "rates",
            Self::Accelerations => "accelerations",
            Self::TorqueMassless => "torque, massless",
            Self::TorqueWithLinks => "torque, with links",
        }
    }

    pub(crate) fn unit(self) -> &'static str {
        match self {
            Self::Position => "rad",
            Self::Rates => "rad/s",
            Self::Accelerations => "rad/s^2",
            Self::TorqueMassless | Self::TorqueWithLinks => "N m",
        }
    }
}

/// Errors of one quantity.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Errors {
    /// The largest.
    pub(crate) worst: f64,
    /// The largest divided by the largest exact value of its job; of a pose, by 1.
    pub(crate) worst_relative: f64,
    squares: f64,
    pub(crate) count: usize,
}

impl Errors {
    fn push(&mut self, error: f64, largest: f64) {
        // What is not a number must not pass for small.
        let error = if error.is_nan() {
            f64::INFINITY
        } else {
            error.abs()
        };
        self.worst = self.worst.max(error);
        self.worst_relative = self.worst_relative.max(error / largest);
        self.squares += error * error;
        self.count += 1;
    }

    /// These and `other`'s.
    pub(crate) fn with(self, other: &Self) -> Self {
        Self {
            worst: self.worst.max(other.worst),
            worst_relative: self.worst_relative.max(other.worst_relative),
            squares: self.squares + other.squares,
            count: self.count + other.count,
        }
    }

    /// Root of the mean square; 0 of nothing.
    pub(crate) fn rms(&self) -> f64 {
        match self.count {
            0 => 0.0,
            count => (self.squares / count as f64).sqrt(),
        }
    }
}

/// The errors of one number type in one scene.
#[derive(Clone, Debug, Default)]
pub(crate) struct SceneErrors {
    /// Of the stages of the scene, in order.
    pub(crate) stages: [Errors; 4],
    /// Of the tool's place, m, and its angle, rad.
    pub(crate) tool: [Errors; 2],
    /// Ticks without a motion, or whose angles belong to no pose near.
    pub(crate) lost: usize,
}

/// Plays the job of `scene` in the number type `N` against the exact `instants`.
pub(crate) fn measure<N: Number>(
    scene: &Scene,
    instants: &[Instant],
) -> Result<SceneErrors, ReportError> {
    let pipeline::Job {
        machine,
        player,
        units,
    } = pipeline::scene::<N>(scene)
        .map_err(|error| ReportError::Refused(format!("scene {}: {error}", scene.name)))?;
    let largest: [f64; 4] = std::array::from_fn(|stage| {
        let values = instants
            .iter()
            .flat_map(|instant| instant.motors.map(|motor| motor[stage].value().abs()));
        values.fold(0.0, f64::max)
    });
    let mut errors = SceneErrors::default();
    for (setpoint, exact) in player.setpoints().zip(instants) {
        let Ok(motors) = machine.motors(&setpoint) else {
            errors.lost += 1;
            continue;
        };
        let angles = motors.map(|motor| N::angle_to_f64(motor.angle));
        for (leg, motor) in motors.iter().enumerate() {
            let results = [
                angles[leg],
                motor.rate.to_f64() * units.rate_rad_s(),
                motor.acceleration.to_f64() * units.acceleration_rad_s2(),
                motor.torque.to_f64() * units.torque_nm(),
            ];
            for (stage, result) in results.into_iter().enumerate() {
                let truth = exact.motors[leg][stage];
                let error = match stage {
                    0 => angle_error(truth, result),
                    _ => truth.error_of(result),
                };
                errors.stages[stage].push(error, largest[stage]);
            }
        }
        match miss(&exact.inputs, angles) {
            Some([place, angle]) => {
                errors.tool[0].push(place, 1.0);
                errors.tool[1].push(angle, 1.0);
            }
            None => errors.lost += 1,
        }
    }
    Ok(errors)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn statistics_are_of_all_errors() {
        let mut errors = Errors::default();
        errors.push(3.0, 10.0);
        errors.push(-4.0, 10.0);
        assert_eq!((errors.worst, errors.worst_relative), (4.0, 0.4));
        assert_eq!(errors.rms(), 12.5f64.sqrt());
        let mut other = Errors::default();
        other.push(f64::NAN, 1.0);
        assert_eq!(errors.with(&other).worst, f64::INFINITY);
        assert_eq!(errors.with(&Errors::default()), errors);
    }
}
