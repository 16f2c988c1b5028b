//! Time within a move.

use crate::number::Number;

/// Time within a move: the fraction of its duration from the nearer end, where the pose is exact.
pub(super) enum MoveTime<N> {
    /// After the start.
    Start(N),
    /// Before the end.
    End(N),
}

impl<N: Number> MoveTime<N> {
    /// The time of `tick` in a move of `ticks` ticks; beyond the end, the end. `count` is `ticks`,
    /// prepared for fractions.
    #[inline(always)]
    pub(super) fn at(tick: u32, ticks: u32, count: &N::Count) -> Self {
        let left = ticks.saturating_sub(tick);
        let from_start = tick <= left;
        let s = N::fraction(if from_start { tick } else { left }, count);
        if from_start {
            Self::Start(s)
        } else {
            Self::End(s)
        }
    }

    /// The time at the fraction `s` of the duration, 0 to 1.
    #[inline(always)]
    pub(super) fn of(s: N) -> Self {
        if s <= N::HALF {
            Self::Start(s)
        } else {
            Self::End(N::ONE - s)
        }
    }

    /// The time `part` of a tick, less than 1, after `tick`. Whole ticks and the part are divided
    /// separately, because their sum is no integer. That rounds twice, so a whole tick is left to
    /// [`at`](Self::at).
    #[inline(always)]
    pub(super) fn between(tick: u32, part: Option<N>, ticks: u32, count: &N::Count) -> Self {
        let Some(part) = part else {
            return Self::at(tick, ticks, count);
        };
        let left = ticks.saturating_sub(tick);
        let rest = part * N::fraction(1, count);
        if tick < left {
            Self::Start(N::fraction(tick, count) + rest)
        } else if left == 0 {
            Self::End(N::ZERO)
        } else {
            // Not negative: left >= 1 > part.
            Self::End(N::fraction(left, count) - rest)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Ends, Pose, Quintics, Segment, Setpoint};
    use nalgebra::Vector3;

    fn close(a: &Setpoint<f64>, b: &Setpoint<f64>) -> bool {
        (a.pose.position - b.pose.position).abs().max() < 2e-15
            && (a.pose.angle - b.pose.angle).abs() < 2e-15
            && (a.velocity - b.velocity).abs().max() < 4e-14
            && (a.acceleration - b.acceleration).abs().max() < 1e-12
    }

    /// The same path in ticks a quarter as long: its ticks are the quarters.
    #[test]
    fn quarters_are_the_ticks_of_a_finer_move() {
        let (from, to) = (
            Pose::from_f64(0.1, -0.2, 0.3),
            Pose::from_f64(-0.4, 0.3, -0.1),
        );
        let (start, end) = (Vector3::new(0.3, -0.2, 0.5), Vector3::new(0.1, 0.0, -0.4));
        for ticks in [1, 2, 7, 10] {
            let rest = Vector3::zeros();
            let kinds = [
                ([rest, rest], None),
                ([start, end], None),
                ([start, end], Some([[0.5, -1.0, 2.0], [-0.5, 0.25, 1.0]])),
            ];
            for (velocities, accelerations) in kinds {
                let ends = Ends::<f64, Quintics> {
                    from,
                    to,
                    velocities,
                    accelerations,
                };
                let coarse = Segment::new(&ends, ticks, 0.2);
                let fine = Segment::new(&ends, 4 * ticks, 0.05);
                for quarter in 0..=4 * ticks + 3 {
                    let part = (quarter % 4 != 0).then(|| f64::from(quarter % 4) / 4.0);
                    let between = coarse.between(quarter / 4, part);
                    assert!(close(&between, &fine.at(quarter)), "{ticks} {quarter}");
                }
                assert_eq!(coarse.between(ticks, Some(0.75)), coarse.at(ticks));
            }
        }
    }
}
