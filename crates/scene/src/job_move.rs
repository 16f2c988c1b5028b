//! A move of a job, and the work of its tool.

use crate::read::{Bound, Section};
use nalgebra::Vector3;
use std::f64::consts::TAU;
use trirrr_core::number::Number;
use trirrr_core::setpoint::{Ends, Pose, Quintics, Segment};
use trirrr_core::units::Units;

/// One move, a polynomial in time on every coordinate: a cubic, or a quintic with accelerations at its ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JobMove {
    /// Pose at its start.
    pub from: Pose<f64>,
    /// Pose at its end.
    pub to: Pose<f64>,
    /// (vx, vy, alphadot) at its start, m/s and rad/s.
    pub start_velocity: Vector3<f64>,
    /// (vx, vy, alphadot) at its end, m/s and rad/s.
    pub end_velocity: Vector3<f64>,
    /// (ax, ay, alphaddot) at both ends of a quintic, m/s^2 and rad/s^2; none for a cubic.
    pub accelerations: Option<[Vector3<f64>; 2]>,
    /// Duration in ticks, positive.
    pub duration_ticks: u32,
    /// Work of the tool on the way; none: it is off.
    pub tool: Option<Tool>,
}

/// Work of the tool in a move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tool {
    /// Power at `speed_m_s`, 0 to 1 of what the tool can give.
    pub power: f64,
    /// Speed of the reference point D along the path at which the tool has that power, m/s,
    /// positive. The power follows the true speed in proportion, up to 1. 0: it is the same at every speed.
    pub speed_m_s: f64,
}

impl JobMove {
    /// The move in `units`.
    pub(crate) fn in_units(&self, units: &Units) -> Self {
        Self {
            from: units.pose(&self.from),
            to: units.pose(&self.to),
            start_velocity: units.velocity(&self.start_velocity),
            end_velocity: units.velocity(&self.end_velocity),
            accelerations: self
                .accelerations
                .map(|both| both.map(|one| units.acceleration(&one))),
            tool: self.tool.map(|tool| Tool {
                speed_m_s: tool.speed_m_s / units.of(1, -1, 0),
                ..tool
            }),
            ..*self
        }
    }

    /// Returns the move with the numbers that the number type `N` has for it in `units`: those that are played. In SI units.
    pub(crate) fn rounded<N: Number>(&self, units: &Units) -> Self {
        let own = self.in_units(units);
        let pose = |pose: &Pose<f64>| {
            let held = Pose::<N>::from_f64(pose.position.x, pose.position.y, pose.angle);
            // Fixed point has no whole turns.
            let angle = N::angle_to_f64(held.angle);
            Pose {
                position: held.position.map(N::to_f64),
                angle: angle + TAU * ((pose.angle - angle) / TAU).round(),
            }
        };
        let number = |number: f64| N::from_f64(number).to_f64();
        let held = Self {
            from: pose(&own.from),
            to: pose(&own.to),
            start_velocity: own.start_velocity.map(number),
            end_velocity: own.end_velocity.map(number),
            accelerations: own
                .accelerations
                .map(|both| both.map(|one| one.map(number))),
            tool: own.tool.map(|tool| Tool {
                power: number(tool.power),
                speed_m_s: number(tool.speed_m_s),
            }),
            ..own
        };
        // Units are powers of two.
        held.in_units(&units.inverse())
    }

    /// Returns what the curve of the move is given by, in the number type `N`.
    pub fn ends<N: Number>(&self) -> Ends<N, Quintics> {
        let pose = |pose: &Pose<f64>| Pose::from_f64(pose.position.x, pose.position.y, pose.angle);
        let number = |v: &Vector3<f64>| v.map(N::from_f64);
        Ends {
            from: pose(&self.from),
            to: pose(&self.to),
            velocities: [number(&self.start_velocity), number(&self.end_velocity)],
            accelerations: self
                .accelerations
                .map(|both| both.each_ref().map(|one| number(one).into())),
        }
    }

    /// Builds the move in the number type `N`, in `ticks` ticks of `period_s` in place of its own.
    pub fn segment<N: Number>(&self, ticks: u32, period_s: f64) -> Segment<N, Quintics> {
        Segment::new(&self.ends(), ticks, N::factor_from_f64(period_s))
    }
}

/// The tool of a move: `Some(None)` where it is left out.
pub(crate) fn read_tool(each: &Section) -> Option<Option<Tool>> {
    if !each.has("tool") {
        return Some(None);
    }
    let tool = each.section("tool")?;
    let power = tool.number("power", Bound::Within(0.0, 1.0));
    let speed = tool.number_or("speed_m_s", Bound::Positive, 0.0);
    Some(Some(Tool {
        power: power?,
        speed_m_s: speed?,
    }))
}
