//! Limits that a scene ought to have.

use crate::Scene;

/// A limit of the motors that a scene does not have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MissingLimit {
    /// The joint rate: any move is admitted, however fast.
    Rate,
    /// The torque at the joint, of a scene that computes torques: any move is admitted, whatever it asks of motors and gears.
    Torque,
}

impl MissingLimit {
    /// Key in `[limits]`.
    pub fn key(self) -> &'static str {
        match self {
            Self::Rate => "rate_rad_s",
            Self::Torque => "torque_nm",
        }
    }

    /// Consequence of the missing limit, and the line that a scene is to have.
    fn advice(self) -> [&'static str; 2] {
        match self {
            Self::Rate => [
                "however fast it turns the motors",
                "`rate_rad_s = ...` (rad/s)",
            ],
            Self::Torque => ["whatever torque it takes", "`torque_nm = ...` (N m)"],
        }
    }
}

impl Scene {
    /// Returns the limits that the motors ought to have, and that the scene leaves out: of the rate, and of the torque where it computes
    /// torques.
    pub fn missing_limits(&self) -> Vec<MissingLimit> {
        let rate = self.limits.rate_rad_s.is_none();
        let torque = self.torque && self.limits.torque_nm.is_none();
        let rate = rate.then_some(MissingLimit::Rate);
        rate.into_iter()
            .chain(torque.then_some(MissingLimit::Torque))
            .collect()
    }

    /// Returns a warning of the [missing limits](Self::missing_limits) that says what to write; none if none is missing.
    pub fn limits_warning(&self) -> Option<String> {
        let missing = self.missing_limits();
        let list = |part: &dyn Fn(&MissingLimit) -> &'static str, and: &str| {
            missing.iter().map(part).collect::<Vec<_>>().join(and)
        };
        (!missing.is_empty()).then(|| {
            format!(
                "scene {} has no {} in [limits]: a move is admitted {}. Write what the motors and their gears stand, at the \
                 joint: {}",
                self.name,
                list(&|limit| limit.key(), " and no "),
                list(&|limit| limit.advice()[0], " and "),
                list(&|limit| limit.advice()[1], " and "),
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The thesis scene with these lines for its limits.
    fn limited(limits: &str, torque: bool) -> Scene {
        let text = include_str!("../../../scenes/thesis.toml");
        let (before, rest) = text.split_once("[limits]\n").expect("limits");
        let (_, job) = rest.split_once("[job]").expect("a job");
        let text = format!("torque = {torque}\n{before}[limits]\n{limits}\n[job]{job}");
        Scene::parse(&text, "limited.toml").unwrap_or_else(|error| panic!("{error}"))
    }

    #[test]
    fn a_scene_says_which_limits_it_lacks() {
        use MissingLimit::{Rate, Torque};
        for (limits, torque, missing) in [
            ("", true, &[Rate, Torque][..]),
            (
                "acceleration_rad_s2 = 100.0\npower_w = 50.0",
                true,
                &[Rate, Torque],
            ),
            ("rate_rad_s = 9.0", true, &[Torque]),
            ("torque_nm = [9.0, 8.0, 7.0]", true, &[Rate]),
            ("rate_rad_s = 9.0\ntorque_nm = 9.0", true, &[]),
            ("", false, &[Rate]),
            ("rate_rad_s = 9.0", false, &[]),
        ] {
            let scene = limited(limits, torque);
            assert_eq!(scene.missing_limits(), missing, "{limits:?} {torque}");
            let warning = scene.limits_warning();
            assert_eq!(warning.is_none(), missing.is_empty(), "{warning:?}");
            for limit in missing {
                let said = warning.as_deref().unwrap_or_default();
                assert_eq!(
                    said.matches(limit.key()).count(),
                    2,
                    "missing, and to write: {said}"
                );
            }
        }
    }

    #[test]
    fn a_warning_says_what_is_missing_what_that_means_and_what_to_write() {
        assert_eq!(
            limited("", true).limits_warning().as_deref(),
            Some(
                "scene thesis has no rate_rad_s and no torque_nm in [limits]: a move is admitted however fast it turns the \
                 motors and whatever torque it takes. Write what the motors and their gears stand, at the joint: \
                 `rate_rad_s = ...` (rad/s) and `torque_nm = ...` (N m)"
            )
        );
    }
}
