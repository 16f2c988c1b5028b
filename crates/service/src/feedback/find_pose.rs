//! Pose of a machine that was just measured: from its joint angles alone.

use super::parameters::FeedbackCoefficients;
use crate::number::ServiceNumber;
use trirrr_core::machine::Geometry;
use trirrr_core::number::Number;
use trirrr_core::setpoint::{Pose, shorter_way};
use trirrr_protocol::message::NotEnabled;

/// Places from which a pose is sought: as many angles of the platform, a full turn.
const GUESSES: u8 = 24;

/// Newton steps from a guess; most take four to six.
const MOST_STEPS: u32 = 24;

/// Search for the pose of joint angles, one guess at a time. A pose counts if its elbows are those of the scene, and if it lies on the
/// side of det A on which the job starts.
pub(crate) struct PoseSearch<N: Number> {
    angles: [N::Angle; 3],
    /// Pose near which the machine stood last.
    near: Pose<N>,
    guess: u8,
    found: Option<Pose<N>>,
}

/// Pose at `angles` to which Newton's method leads from `guess`, within half a turn of it; none if it leads nowhere.
pub(crate) fn pose_near<N: ServiceNumber>(
    coefficients: &FeedbackCoefficients<N>,
    angles: &[N::Angle; 3],
    guess: Pose<N>,
) -> Option<Pose<N>> {
    let found = coefficients.forward.solve(angles, guess, MOST_STEPS).ok()?;
    let turned = N::radians(found.pose.angle - guess.angle).abs();
    (turned <= N::radians(N::half_turn())).then_some(found.pose)
}

impl<N: ServiceNumber> PoseSearch<N> {
    /// Begins the search for the pose at `angles`, `near` one first.
    pub(crate) fn new(angles: [N::Angle; 3], near: Pose<N>) -> Self {
        Self {
            angles,
            near,
            guess: 0,
            found: None,
        }
    }

    /// Tries the next guess. Returns the end of the search: the only pose, or why there is none.
    pub(crate) fn step(
        &mut self,
        coefficients: &FeedbackCoefficients<N>,
        geometry: &Geometry<N>,
    ) -> Option<Result<Pose<N>, NotEnabled<N>>> {
        if self.guess > GUESSES {
            return Some(self.found.ok_or(NotEnabled::NoPose));
        }
        let guess = self.guess(coefficients);
        self.guess += 1;
        let forward = &coefficients.forward;
        let found = pose_near(coefficients, &self.angles, guess)?;
        let way = shorter_way::<N>(found.angle - self.near.angle);
        let pose = Pose {
            angle: self.near.angle + N::angle(way),
            ..found
        };
        if !self.fits(coefficients, geometry, &pose) {
            return None;
        }
        let travel = |other: &Pose<N>| forward.travel(other, &pose);
        match &self.found {
            None => self.found = Some(pose),
            // The same again: Newton's method ends within the rounding.
            Some(other) if travel(other) <= forward.size() * N::ratio(1, 1024) => {}
            Some(_) => return Some(Err(NotEnabled::ManyPoses)),
        }
        None
    }

    /// The pose near which the machine stood, then one for each angle of the platform: there the distal links balance.
    fn guess(&self, coefficients: &FeedbackCoefficients<N>) -> Pose<N> {
        if self.guess == 0 {
            return self.near;
        }
        // From half a turn behind the start to half a turn ahead of it.
        let half = N::radians(N::half_turn());
        let turned = N::ratio(2 * u32::from(self.guess - 1), u32::from(GUESSES)) - N::ONE;
        let angle = coefficients.start.angle + N::angle(turned * half);
        coefficients.forward.balanced(&self.angles, angle)
    }

    /// Returns true if the machine of the scene stands at `pose` with these angles.
    fn fits(
        &self,
        coefficients: &FeedbackCoefficients<N>,
        geometry: &Geometry<N>,
        pose: &Pose<N>,
    ) -> bool {
        let Ok(position) = geometry.position(pose) else {
            return false;
        };
        let angles = geometry.motor_angles(&position);
        let mut pairs = self.angles.iter().zip(&angles);
        pairs.all(|(measured, angle)| {
            shorter_way::<N>(*measured - *angle).abs() <= coefficients.watch.still
        }) && coefficients.forward.side(&self.angles, pose) == coefficients.side
    }
}
