//! Output of a tick: motion, tool, or nothing at all.

use super::super::guard::LimitBreach;
use super::super::handoff::QueuedMove;
use super::super::homing::Homing;
use super::super::scene::Scene;
use super::{Foreground, Path};
use crate::number::ServiceNumber;
use trirrr_core::number::Number;
use trirrr_core::setpoint::{JointSetpoint, Setpoint};
use trirrr_core::tick::Motor;
use trirrr_protocol::message::{Acting, Fault, State};

/// Commands to the motors and the tool until the next tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Output<N: Number> {
    /// The motors. In fault and cleared they stand where they were commanded last.
    pub motors: [Motor<N>; 3],
    /// Power of the tool, 0 to 1 of what it can give.
    pub tool: N,
    /// True if the drives are on. They are off while a fault is latched.
    pub enabled: bool,
}

impl<N: ServiceNumber, S: Scene<N = N>> Foreground<'_, S> {
    /// Power of the tool: in proportion to its speed along the path, and nothing unless the job
    /// runs.
    #[inline]
    pub(super) fn tool(&self, setpoint: &Setpoint<N>) -> N {
        if !self.state.is_running() {
            return N::ZERO;
        }
        match &self.current {
            Some(QueuedMove {
                tool: Some(tool), ..
            }) => tool.power(setpoint),
            _ => N::ZERO,
        }
    }

    /// A tick of a recovery: no torque, for where the platform is says nothing.
    pub(super) fn follow(&mut self, joints: &JointSetpoint<N>) {
        for (index, motor) in self.output.motors.iter_mut().enumerate() {
            let part = |values: &[N; 3]| values.get(index).copied().unwrap_or(N::ZERO);
            if let Some(angle) = joints.angles.get(index) {
                motor.angle = *angle;
            }
            motor.rate = part(&joints.rates);
            motor.acceleration = part(&joints.accelerations);
            motor.torque = N::ZERO;
        }
        self.output.tool = N::ZERO;
    }

    /// Neither motion nor tool: the motors stay at their last angles.
    pub(super) fn zero_motion(&mut self) {
        for motor in &mut self.output.motors {
            motor.rate = N::ZERO;
            motor.acceleration = N::ZERO;
            motor.torque = N::ZERO;
        }
        self.output.tool = N::ZERO;
    }

    /// Latches a fault: no motion any more, the queue is dropped, the drives go off. Returns the setpoint of a
    /// machine that stands.
    #[cold]
    pub(super) fn latch(&mut self, broken: LimitBreach<N>) -> Setpoint<N> {
        self.zero_motion();
        self.output.enabled = false;
        if self.state != State::Fault {
            // There is room: the one before was taken before it was cleared.
            self.faults.send(Fault {
                code: broken.code,
                index: broken.index,
                value: broken.value,
                limit: broken.limit,
                tick: self.clock,
            });
            if matches!(self.path, Path::Joints | Path::JointsEnded) || self.homing.is_under_way() {
                self.recoveries.discard();
            }
            self.homing.abandon();
            self.drop_queue();
            let acting = broken.code.bounded().map_or(Acting::Nothing, Acting::Limit);
            self.transition_to(State::Fault, acting);
        }
        Self::standing(self.pose)
    }
}
