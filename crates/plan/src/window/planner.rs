//! The planner of a service: pieces as they come over the line, and moves as it queues them.

use super::numbered::{Maybe, set};
use super::{Outlook, Window, WindowMove, WindowPiece, WindowRefusal};
use crate::cell::{Limited, Obstacle};
use crate::piece::Piece;
use trirrr_core::model::Model;
use trirrr_core::number::Arithmetic;
use trirrr_core::setpoint::{Ends, Pose};
use trirrr_protocol::message::{Bounded, Move, PathCurve, PathPiece, QuinticMove, Violation};
use trirrr_service::ServiceNumber;
use trirrr_service::admission::{Enclose, Path};
use trirrr_service::features::{PathPlanner, PathStep, Planning};

/// Power and speed of the tool, as in a move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolSetting<N> {
    power: N,
    speed: N,
}

/// Planner of the paths of a service, with room for `PIECES` pieces and `CELLS` cells.
pub struct ServicePlanner<N: ServiceNumber, const PIECES: usize, const CELLS: usize> {
    window: Window<N, ToolSetting<N>, PIECES, CELLS>,
    can_plan: bool,
    is_active: bool,
    /// The last move that was refused.
    refused: Maybe<Violation<N>>,
}

impl<N: ServiceNumber, const PIECES: usize, const CELLS: usize> PathPlanner<N>
    for ServicePlanner<N, PIECES, CELLS>
{
    const EMPTY: Self = Self {
        window: Window::new(Planning::NONE),
        can_plan: false,
        is_active: false,
        refused: Maybe::new(),
    };

    fn set_up(&mut self, planning: Option<Planning<N>>) {
        self.can_plan = planning.is_some();
        self.is_active = false;
        if let Some(planning) = planning {
            self.window.set(planning.convert(N::bound));
        }
    }

    fn can_plan(&self) -> bool {
        self.can_plan
    }

    fn is_active(&self) -> bool {
        self.is_active
    }

    fn begin(&mut self, pose: Pose<N>) {
        self.window.stand(bound(&pose));
        self.is_active = true;
        self.refused.clear();
    }

    fn push(&mut self, piece: &PathPiece<N>) -> bool {
        let Some(from) = self.window.end() else {
            return false;
        };
        let taken = self.window.push(WindowPiece {
            piece: geometry(from, &piece.curve),
            feed: (piece.feed > N::ZERO).then(|| piece.feed.bound()),
            tag: ToolSetting {
                power: piece.tool_power,
                speed: piece.tool_speed,
            },
            number: piece.number,
        });
        if taken && piece.last {
            self.window.close();
        }
        taken
    }

    fn step<M: Model<N = N>>(&mut self, path: &Path<M>) -> PathStep<N> {
        match self.window.step(path) {
            Outlook::Working => PathStep::Working,
            Outlook::Move(planned) => PathStep::Move(quintic(&planned)),
            Outlook::Waiting if !self.window.is_done() => PathStep::Waiting,
            Outlook::Waiting => match self.window.refusal() {
                None if self.window.is_closed() => PathStep::Done,
                None => PathStep::Waiting,
                Some(refusal) => PathStep::Refused {
                    number: refusal.piece,
                    violation: match self.refused.first() {
                        Some(violation) if refusal.obstacle == Obstacle::Refused => *violation,
                        _ => violation(&refusal),
                    },
                },
            },
        }
    }

    fn keep(&mut self) {
        self.window.keep();
    }

    fn cut<M: Model<N = N>>(&mut self, path: &Path<M>, violation: &Violation<N>) {
        set(&mut self.refused, *violation);
        // Below a distance, or out of range, there is none.
        let excess = match violation.limit > N::ZERO {
            true => violation.value.bound().abs().div(violation.limit.bound()) - N::Bound::ONE,
            false => N::Bound::ZERO,
        };
        self.window.cut(path, excess);
    }

    fn drop_path(&mut self) {
        self.is_active = false;
    }
}

fn bound<N: Enclose>(pose: &Pose<N>) -> Pose<N::Bound> {
    Pose {
        position: pose.position.map(N::bound),
        angle: N::angle_bound(pose.angle),
    }
}

/// The piece from `from` along `curve`.
fn geometry<N: Enclose>(from: Pose<N::Bound>, curve: &PathCurve<N>) -> Piece<N::Bound> {
    match curve {
        PathCurve::Line { to } => Piece::line(from, bound(to)),
        PathCurve::Arc {
            centre,
            turn,
            to_angle,
        } => Piece::arc(
            from,
            centre.map(N::bound).into(),
            turn.bound(),
            N::angle_bound(*to_angle),
        ),
        PathCurve::Bezier {
            controls: [first, second],
            to,
        } => Piece::bezier([from, bound(first), bound(second), bound(to)]),
    }
}

fn quintic<N: Enclose>(planned: &WindowMove<N::Bound, ToolSetting<N>>) -> QuinticMove<N> {
    let Ends {
        from,
        to,
        velocities,
        accelerations,
    } = planned.ends;
    let pose = |pose: Pose<N::Bound>| Pose {
        position: pose.position.map(N::from_bound),
        angle: N::angle(N::from_bound(N::Bound::radians(pose.angle))),
    };
    let [start_velocity, end_velocity] =
        velocities.map(|each| <[N::Bound; 3]>::from(each).map(N::from_bound));
    let [start_acceleration, end_acceleration] = accelerations
        .unwrap_or([[N::Bound::ZERO; 3]; 2])
        .map(|each| each.map(N::from_bound));
    QuinticMove {
        common: Move {
            start_velocity,
            end_velocity,
            tool_power: planned.tag.power,
            tool_speed: planned.tag.speed,
            ..Move::rest_to_rest(0, pose(from), pose(to), planned.ticks)
        },
        start_acceleration,
        end_acceleration,
    }
}

/// The obstacle as a violation, without its values.
fn violation<N: Enclose>(refusal: &WindowRefusal<N::Bound>) -> Violation<N> {
    let (what, index) = match refusal.obstacle {
        Obstacle::Reach(leg) => (Bounded::Reach, Some(leg)),
        Obstacle::SerialDistance(leg) => (Bounded::SerialDistance, Some(leg)),
        Obstacle::ParallelDistance => (Bounded::ParallelDistance, None),
        Obstacle::Standing(Limited::Torque(motor)) => (Bounded::Torque, Some(motor)),
        Obstacle::Standing(Limited::Power(motor)) => (Bounded::Power, Some(motor)),
        _ => (Bounded::Range, None),
    };
    Violation {
        what,
        index: index.map(|index| index as u8),
        at: N::from_bound(refusal.p),
        value: N::ZERO,
        error: None,
        limit: N::ZERO,
        certain: false,
        ramp: false,
        shortest: None,
    }
}
