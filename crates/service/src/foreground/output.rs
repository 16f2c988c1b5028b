//! Output of a tick: motion, tool, or nothing at all.

use super::super::guard::LimitBreach;
use super::super::handoff::QueuedMove;
use super::{Foreground, Path, TickEnds};
use crate::feature::Optional;
use crate::number::ServiceNumber;
use crate::scene::Scene;
use crate::settings::StopCategory;
use crate::states::{Transition, Trigger};
use trirrr_core::number::Number;
use trirrr_core::setpoint::{JointSetpoint, Setpoint};
use trirrr_core::tick::Motor;
use trirrr_protocol::message::{Acting, Fault, FaultCode};

/// Commands to the motors and the tool until the next tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Output<N: Number> {
    /// The motors. While drives are off, they stand where they were commanded last.
    pub motors: [Motor<N>; 3],
    /// Power of the tool, 0 to 1 of what it can give.
    pub tool: N,
    /// Power of the drives.
    pub power: Power,
    /// True if the brake is released. It holds the motors while their drives cannot.
    pub brake_released: bool,
}

/// Order to the drives, by which they are on or off.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Power {
    /// Off. A drive gets what keeps it off, and nothing else.
    #[default]
    Off,
    /// Off, and in this tick the errors of the drives are cleared.
    Clear,
    /// Off; the drives are asked how they are.
    Check,
    /// On: a drive that was off closes its loop at the angle of the tick, then follows the angles.
    On,
}

impl<N: Number> Output<N> {
    /// Returns true if the drives are to be on.
    #[inline(always)]
    pub fn is_on(&self) -> bool {
        self.power == Power::On
    }
}

impl<N: ServiceNumber, S: Scene<N = N>, E: TickEnds<S>> Foreground<'_, S, E> {
    /// Power of the tool: in proportion to its speed along the path, or constant, and nothing unless the job
    /// runs. Behind an open door nothing, at once, and until the job runs again: on the way to rest the path is left without the tool.
    #[inline]
    pub(super) fn tool(&mut self, setpoint: &Setpoint<N>) -> N {
        if !self.state.is_running() {
            return N::ZERO;
        }
        let power = match &self.travel.current {
            Some(QueuedMove {
                tool: Some(tool), ..
            }) => tool.power(setpoint),
            _ => return N::ZERO,
        };
        // Levels go with the place, also where the tool stays off.
        let power = match self.features.levels.get_mut() {
            Some(levels) => levels.part_of(power, setpoint),
            None => power,
        };
        match self.waits_for_door() {
            true => N::ZERO,
            false => power,
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

    /// Latches a fault. The machine comes to rest as the scene says for its kind; at a second fault on the way, and at one that
    /// leaves no motion, the drives go off at once.
    #[cold]
    pub(super) fn latch(&mut self, broken: LimitBreach<N>) {
        let category = match self.leads(Trigger::FaultOnPath) {
            Some(_) if self.output.is_on() && E::CHANGES_PACE => self.reaction(broken.code),
            _ => StopCategory::Off,
        };
        if !self.state.has_fault() {
            self.ends.tell_fault(Fault {
                code: broken.code,
                index: broken.index,
                value: broken.value,
                limit: broken.limit,
                tick: self.clock,
            });
            self.acting = broken.code.bounded().map_or(Acting::Nothing, Acting::Limit);
        }
        match category {
            StopCategory::Off => self.switch_off(),
            category => {
                self.want_retreat(broken.code);
                self.react(category);
            }
        }
    }

    /// Stop at this fault.
    fn reaction(&self, code: FaultCode) -> StopCategory {
        if let Some(interlocks) = self.features.interlocks.get()
            && code == FaultCode::EmergencyStop
        {
            return interlocks.category();
        }
        match self.features.contact.get() {
            Some(contact) if code.is_contact() => contact.reaction(),
            _ => self.supply.reaction(code),
        }
    }

    /// The drives go off at once: no motion any more, and the queue is dropped.
    fn switch_off(&mut self) {
        self.zero_motion();
        self.output.power = Power::Off;
        self.output.brake_released = false;
        self.supply.fail();
        if let Transition::To(_) = self.change(Trigger::FaultAtOnce, self.acting) {
            if matches!(self.travel.path, Path::Joints | Path::JointsEnded)
                || self.features.is_homing()
            {
                self.ends.take_recovery();
            }
            if let Some(cycle) = self.features.homing() {
                cycle.abandon();
            }
            self.drop_queue();
        }
    }
}
