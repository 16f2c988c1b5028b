//! Moves that a host offers: cubics, quintics, and several of them at once.

use super::Transmit;
use crate::wire::checksum;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};
use trirrr_core::number::Number;
use trirrr_core::setpoint::{Pose, Setpoint};

/// One cubic move.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(bound = "N: Transmit")]
#[postcard(bound = "N: Transmit")]
pub struct Move<N: Number> {
    /// Counts the moves one by one, modulo 2^32; [`Status`](super::Status) says which is expected.
    pub number: u32,
    /// Start pose: the bits of the end of the last move, or of the pose in which the machine stands.
    pub from: Pose<N>,
    /// End pose.
    pub to: Pose<N>,
    /// (vx, vy, alphadot) at its start: the bits of the velocity at the end of the last move.
    pub start_velocity: [N; 3],
    /// (vx, vy, alphadot) at its end.
    pub end_velocity: [N; 3],
    /// Duration in ticks, positive.
    pub ticks: u32,
    /// The tool's power at `tool_speed`, 0 to 1 of what it can give; 0 for none.
    pub tool_power: N,
    /// Speed of the tool along the path at which it has `tool_power`, positive. The power follows the true speed in
    /// proportion, up to 1. 0: the power is the same at every speed, and at rest.
    pub tool_speed: N,
}

/// One quintic move: a polynomial of the fifth degree in time. An image whose scene has none answers `NoQuintics` and
/// does not read its content.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(bound = "N: Transmit")]
#[postcard(bound = "N: Transmit")]
pub struct QuinticMove<N: Number> {
    /// All that it has in common with a cubic one.
    pub common: Move<N>,
    /// (ax, ay, alphaddot) at its start: the bits of `Status.end`, which are those of the end of the last move if it
    /// was a quintic, and otherwise 0.
    pub start_acceleration: [N; 3],
    /// (ax, ay, alphaddot) at its end.
    pub end_acceleration: [N; 3],
}

/// Most moves of a [`MoveBatch`].
pub const BATCH: usize = 4;

/// Several moves, each from where the last one ends, without what the machine knows already.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(bound = "N: Transmit")]
#[postcard(bound = "N: Transmit")]
pub struct MoveBatch<N: Number> {
    /// Number of the first move, as in a [`Move`](super::Move). The others are counted on from it.
    pub number: u32,
    /// CRC-32 of the bytes of the setpoint from which the first move starts: `Status.end`, without the byte that says
    /// that there is one. The acceleration behind a cubic is 0.
    pub check: u32,
    /// The moves, from the first place on and without gaps.
    pub steps: [Option<MoveStep<N>>; BATCH],
}

/// One move of a batch.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(bound = "N: Transmit")]
#[postcard(bound = "N: Transmit")]
pub struct MoveStep<N: Number> {
    /// End pose.
    pub to: Pose<N>,
    /// (vx, vy, alphadot) at its end.
    pub velocity: [N; 3],
    /// (ax, ay, alphaddot) at its end, of a quintic; none of a cubic.
    pub acceleration: Option<[N; 3]>,
    /// Duration in ticks, positive.
    pub ticks: u32,
    /// Setting of the tool; none for no power.
    pub tool: Option<ToolSetting<N>>,
}

/// Setting of the tool, as in a [`Move`](super::Move).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(bound = "N: Transmit")]
#[postcard(bound = "N: Transmit")]
pub struct ToolSetting<N: Number> {
    /// Power of the tool, 0 to 1.
    pub power: N,
    /// Speed of the tool at which it has that power; 0 for the same power at any speed.
    pub speed: N,
}

/// A move of either kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AnyMove<N: Number> {
    /// A cubic.
    Cubic(Move<N>),
    /// A quintic.
    Quintic(QuinticMove<N>),
}

impl<N: Number> Move<N> {
    /// Returns move `number` from rest at `from` to rest at `to` in `ticks` ticks, with the tool off.
    pub fn rest_to_rest(number: u32, from: Pose<N>, to: Pose<N>, ticks: u32) -> Self {
        Self {
            number,
            from,
            to,
            start_velocity: [N::ZERO; 3],
            end_velocity: [N::ZERO; 3],
            ticks,
            tool_power: N::ZERO,
            tool_speed: N::ZERO,
        }
    }

    /// Returns true if the move is at rest at both ends.
    pub fn is_rest_to_rest(&self) -> bool {
        self.starts_at_rest() && self.ends_at_rest()
    }

    /// Returns true if the move starts at rest.
    pub fn starts_at_rest(&self) -> bool {
        self.start_velocity == [N::ZERO; 3]
    }

    /// Returns true if the move ends at rest.
    pub fn ends_at_rest(&self) -> bool {
        self.end_velocity == [N::ZERO; 3]
    }
}

impl<N: Number> MoveBatch<N> {
    /// The moves.
    pub fn steps(&self) -> impl Iterator<Item = &MoveStep<N>> {
        self.steps.iter().map_while(Option::as_ref)
    }

    /// The moves as they are offered one by one, the first from `start`.
    pub fn moves(&self, start: &Setpoint<N>) -> impl Iterator<Item = AnyMove<N>> {
        let (mut start, mut number) = (*start, self.number);
        self.steps().map(move |step| {
            let each = step.from(&start, number);
            (start, number) = (each.end(), number.wrapping_add(1));
            each
        })
    }
}

impl<N: Transmit> MoveBatch<N> {
    /// Batch of as many of `moves` as follow on each other without a gap, the first behind `start`, from number `number` on.
    pub fn new(number: u32, start: &Setpoint<N>, moves: &[AnyMove<N>]) -> Self {
        let mut batch = Self {
            number,
            // A setpoint has a length that is known beforehand.
            check: checksum(start).unwrap_or_default(),
            steps: [None; BATCH],
        };
        let mut start = *start;
        for (place, each) in batch.steps.iter_mut().zip(moves) {
            let step = each.step();
            if step.from(&start, each.common().number) != *each {
                break;
            }
            start = each.end();
            *place = Some(step);
        }
        batch
    }
}

impl<N: Number> MoveStep<N> {
    /// The move of number `number` that starts at `start`: with the accelerations at both ends, if it is a quintic.
    pub fn from(&self, start: &Setpoint<N>, number: u32) -> AnyMove<N> {
        let tool = self.tool.unwrap_or(ToolSetting {
            power: N::ZERO,
            speed: N::ZERO,
        });
        let common = Move {
            number,
            from: start.pose,
            to: self.to,
            start_velocity: start.velocity.into(),
            end_velocity: self.velocity,
            ticks: self.ticks,
            tool_power: tool.power,
            tool_speed: tool.speed,
        };
        let accelerations = |end| [start.acceleration.into(), end];
        AnyMove::new(common, self.acceleration.map(accelerations))
    }
}

impl<N: Number> From<&Move<N>> for AnyMove<N> {
    fn from(cubic: &Move<N>) -> Self {
        Self::Cubic(*cubic)
    }
}

impl<N: Number> From<&AnyMove<N>> for AnyMove<N> {
    fn from(any: &AnyMove<N>) -> Self {
        *any
    }
}

impl<N: Number> AnyMove<N> {
    /// A move with these accelerations at its ends, or a cubic without any.
    pub fn new(common: Move<N>, accelerations: Option<[[N; 3]; 2]>) -> Self {
        match accelerations {
            None => Self::Cubic(common),
            Some([start_acceleration, end_acceleration]) => Self::Quintic(QuinticMove {
                common,
                start_acceleration,
                end_acceleration,
            }),
        }
    }

    /// All that both kinds have in common.
    pub fn common(&self) -> &Move<N> {
        match self {
            Self::Cubic(common) | Self::Quintic(QuinticMove { common, .. }) => common,
        }
    }

    /// The move with another number.
    pub fn numbered(mut self, number: u32) -> Self {
        match &mut self {
            Self::Cubic(common) | Self::Quintic(QuinticMove { common, .. }) => {
                common.number = number;
            }
        }
        self
    }

    /// The setpoint at its end. A cubic goes on without an acceleration.
    pub fn end(&self) -> Setpoint<N> {
        let Move {
            to, end_velocity, ..
        } = *self.common();
        let [_, acceleration] = self.accelerations().unwrap_or([[N::ZERO; 3]; 2]);
        Setpoint {
            pose: to,
            velocity: end_velocity.into(),
            acceleration: acceleration.into(),
        }
    }

    /// The move as one of a [`MoveBatch`].
    pub fn step(&self) -> MoveStep<N> {
        let common = self.common();
        let (power, speed) = (common.tool_power, common.tool_speed);
        MoveStep {
            to: common.to,
            velocity: common.end_velocity,
            acceleration: self.accelerations().map(|[_, end]| end),
            ticks: common.ticks,
            tool: (power != N::ZERO || speed != N::ZERO).then_some(ToolSetting { power, speed }),
        }
    }

    /// The accelerations at both ends of a quintic.
    pub fn accelerations(&self) -> Option<[[N; 3]; 2]> {
        match self {
            Self::Cubic(_) => None,
            Self::Quintic(each) => Some([each.start_acceleration, each.end_acceleration]),
        }
    }
}
