//! Start, hold, resume, stop, faults and recovery.

use super::super::feed::FeedScale;
use super::super::foreground::slope;
use super::super::guard::{self, Guard, LimitBreach};
use super::super::handoff::{Ahead, Order, Recover};
use super::{Background, at_rest};
use crate::built::Coefficients;
use crate::feature::Feature;
use crate::homing::HomingCoefficients;
use crate::number::ServiceNumber;
use crate::scene::{ChangesOf, ModelOf, Scene};
use crate::states::{Transition, Trigger, next};
use core::borrow::Borrow;
use trirrr_core::inverse::Position;
use trirrr_core::limits::Limits;
use trirrr_core::model::Model;
use trirrr_core::number::Number;
use trirrr_core::setpoint::{JointMove, Pose};
use trirrr_core::status::Status;
use trirrr_core::tick::Tick;
use trirrr_protocol::message::{
    Acting, Bounded, FaultCode, JobAccount, JobLabel, Recovery, Refusal, State, TelemetryFields,
    Violation,
};

impl<N: ServiceNumber, S: Scene<N = N>> Background<'_, S> {
    pub(super) fn start(&mut self) -> Result<(), Refusal<N>> {
        self.start_as(Order::Start)
    }

    /// Begins the job by `order`, a start or a run with the probe.
    #[inline(never)]
    pub(super) fn start_as(&mut self, order: Order) -> Result<(), Refusal<N>> {
        let state = self.leads(Trigger::Start)?;
        self.require_clear_inputs()?;
        self.require_free_limits()?;
        if let Order::Probe { away } = order {
            self.require_contact_ahead(away)?;
        }
        let undecided = self.desk.offered.peek().is_some() || self.is_planning();
        // In idle nothing is under way.
        if self.has_played_all() {
            return Err(if undecided {
                Refusal::Undecided
            } else {
                Refusal::NothingQueued
            });
        }
        let room = |x: usize| self.view.passed.left(&self.admission.admitted.room, x);
        let mut feed = FeedScale::new(self.settings.ramp.ticks);
        feed.aim_at(self.status.feed_percent);
        let enough = feed.is_enough(0, room);
        let rests = Ahead {
            room: self.admission.admitted.room,
            rests: self.admission.rests,
        }
        .rests_from(self.view.begun);
        if !rests && !enough && self.ends.moves.has_room() {
            return Err(if undecided {
                Refusal::Undecided
            } else {
                Refusal::EndsMoving
            });
        }
        self.order(order, state)
    }

    pub(super) fn hold(&mut self) -> Result<(), Refusal<N>> {
        let state = self.leads(Trigger::Hold)?;
        // A door outlasts a hold.
        let is_door = S::Interlocks::EXISTS && self.status.acting == Acting::Door;
        let acting = if is_door { Acting::Door } else { Acting::Hold };
        self.order_as(Order::Hold, state, acting)
    }

    pub(super) fn resume(&mut self) -> Result<(), Refusal<N>> {
        let state = self.leads(Trigger::Resume)?;
        self.require_clear_inputs()?;
        self.order_as(Order::Resume, state, Acting::Resume)
    }

    /// In every state: it never makes a machine move.
    pub(super) fn stop(&mut self) -> Result<(), Refusal<N>> {
        match next(self.status.state, Trigger::Stop) {
            // Only a retreat is to be ended.
            Transition::To(State::Reacting) if !S::Retreat::EXISTS => Ok(()),
            Transition::To(State::Reacting) => self.order(Order::Stop, State::Reacting),
            // In idle, too: it is none until the tick has dropped the queue.
            Transition::To(_) => self.order(Order::Stop, State::Stopping),
            _ => Ok(()),
        }
    }

    pub(super) fn clear_fault(&mut self) -> Result<(), Refusal<N>> {
        let state = self.leads(Trigger::ClearFault(None))?;
        self.require_released_stop()?;
        self.order(Order::ClearFault, state)
    }

    /// Returns the state that `trigger` leads to, or the refusal of a command that does not fit the state.
    #[inline(always)]
    pub(super) fn leads(&self, trigger: Trigger) -> Result<State, Refusal<N>> {
        let follows = next(self.status.state, trigger).state();
        follows.ok_or(Refusal::State(self.status.state))
    }

    /// In every state: the pace changes where the machine moves, and holds from then on.
    pub(super) fn override_feed(&mut self, percent: u8) -> Result<(), Refusal<N>> {
        if !(1..=100).contains(&percent) {
            return Err(Refusal::FeedOverride);
        }
        self.order(Order::FeedOverride { percent }, self.status.state)?;
        self.status.feed_percent = percent;
        Ok(())
    }

    pub(super) fn set_telemetry(
        &mut self,
        every: u16,
        fields: TelemetryFields,
    ) -> Result<(), Refusal<N>> {
        self.order(Order::Telemetry { every, fields }, self.status.state)
    }

    /// Keeps the name of the job whose moves come next.
    pub(super) fn name_job(&mut self, label: &JobLabel) -> Result<(), Refusal<N>> {
        self.require_idle()?;
        self.job_is_over = false;
        self.status.job = Some(JobAccount {
            label: *label,
            first_move: self.status.next,
            first_piece: self.status.piece,
        });
        Ok(())
    }

    pub(super) fn recover(&mut self, recovery: &Recovery<N>) -> Result<(), Refusal<N>> {
        let state = self.leads(Trigger::Recover)?;
        self.require_no_job()?;
        self.require_clear_inputs()?;
        let path = self.joint_path(self.view.angles, &recovery.to, recovery.ticks)?;
        self.send_along(path, recovery.to, Order::Recover, state)
    }

    /// Looks for the motors, and moves them to the start pose from where that ends.
    pub(super) fn home(&mut self) -> Result<(), Refusal<N>> {
        let Some(plan) = self.features.homed().map(HomingCoefficients::plan) else {
            return Err(Refusal::NoHoming);
        };
        let state = self.leads(Trigger::Home)?;
        self.require_no_job()?;
        self.require_clear_inputs()?;
        let limits = &self.coefficients.borrow().limits;
        guard::within(Bounded::Rate, &limits.rate, plan.rates)
            .and_then(|()| {
                let accelerations = plan.accelerations;
                guard::within(Bounded::Acceleration, &limits.acceleration, accelerations)
            })
            .map_err(|broken| too_fast(broken, false))?;
        let path = self.joint_path(plan.from, &plan.to, plan.ticks)?;
        self.send_along(path, plan.to, Order::Home, state)
    }

    /// Gives `order`, with the joint move that belongs to it.
    fn send_along(
        &mut self,
        path: JointMove<N>,
        to: Pose<N>,
        order: Order,
        state: State,
    ) -> Result<(), Refusal<N>> {
        if !self.ends.orders.has_room() || !self.ends.recoveries.send(Recover { path, to }) {
            return Err(Refusal::Busy);
        }
        self.order(order, state)?;
        self.status.end = None;
        Ok(())
    }

    /// Checks that the machine keeps its limits of torque where it stands at `pose`, on a machine whose scene can be replaced. Others have
    /// the check in their tick alone: it would be 3 KB of an image, for a fault that another recovery leads out of.
    #[inline(always)]
    pub(super) fn can_stand(
        tick: &Tick<ModelOf<S>>,
        limits: &Limits<N>,
        pose: Pose<N>,
    ) -> Result<(), Refusal<N>> {
        let has_limit = ModelOf::<S>::TORQUES && limits.torque.is_some();
        if !ChangesOf::<S>::EXISTS || !has_limit {
            return Ok(());
        }
        let standing = tick.evaluate(&at_rest(pose)).map_err(no_motion)?;
        let guard = Guard::of_results(limits);
        guard.check::<ModelOf<S>>(&standing).map_err(breaks)
    }

    /// The joint move from motor angles to where the motors are at `pose`, within the limits.
    fn joint_path(
        &self,
        from: [N::Angle; 3],
        pose: &Pose<N>,
        ticks: u32,
    ) -> Result<JointMove<N>, Refusal<N>> {
        let (x, y) = (pose.position.x, pose.position.y);
        if !(x.is_finite() && y.is_finite() && N::angle_is_finite(pose.angle)) {
            return Err(Refusal::NotFinite);
        }
        if ticks == 0 {
            return Err(Refusal::Duration { longest: u32::MAX });
        }
        let Coefficients { tick, limits, .. } = self.coefficients.borrow();
        let geometry = tick.geometry();
        let position = geometry.position(pose).map_err(no_motion)?;
        self.keeps_clear(&position).map_err(breaks)?;
        Self::can_stand(tick, limits, *pose)?;
        let angles = geometry.motor_angles(&position);
        let path = JointMove::new(from, angles, ticks, self.settings.period);
        let (rates, accelerations) = path.peaks();
        guard::within(Bounded::Rate, &limits.rate, rates)
            .and_then(|()| {
                // A stop on the way adds the ramp's own: the rate over the ramp's duration.
                let slope = slope::<N>(self.settings.ramp.ticks, self.settings.period);
                let [a, b, c] = rates.map(|rate| rate.scaled(slope));
                let [x, y, z] = accelerations;
                let sums = [x + a, y + b, z + c];
                guard::within(Bounded::Acceleration, &limits.acceleration, sums)
            })
            .map_err(|broken| too_fast(broken, true))?;
        Ok(path)
    }

    /// Returns true if every admitted move was begun.
    fn has_played_all(&self) -> bool {
        self.status.admitted == self.view.begun
    }

    /// Refuses unless the machine waits in idle with nothing queued.
    pub(super) fn require_idle(&self) -> Result<(), Refusal<N>> {
        let empty =
            self.desk.offered.peek().is_none() && self.has_played_all() && !self.is_planning();
        if self.status.state == State::Idle && empty {
            Ok(())
        } else {
            Err(Refusal::State(self.status.state))
        }
    }

    /// Refuses while moves are queued in idle.
    fn require_no_job(&self) -> Result<(), Refusal<N>> {
        match self.status.state {
            State::Idle => self.require_idle(),
            _ => Ok(()),
        }
    }

    /// Checks that a pose is no nearer to a singularity than the limits allow.
    pub(super) fn keeps_clear(&self, position: &Position<N>) -> Result<(), LimitBreach<N>> {
        let Coefficients {
            limits, distances, ..
        } = self.coefficients.borrow();
        let breach = |what, index, value, limit| LimitBreach {
            code: FaultCode::Limit(what),
            index,
            value,
            limit,
        };
        let least = limits.serial_distance;
        for (leg, distance) in distances.serial(position).into_iter().enumerate() {
            if !(distance >= least) {
                let leg = Some(leg as u8);
                return Err(breach(Bounded::SerialDistance, leg, distance, least));
            }
        }
        let (distance, least) = (distances.parallel(position), limits.parallel_distance);
        if !(distance >= least) || !(distance > N::ZERO) {
            return Err(breach(Bounded::ParallelDistance, None, distance, least));
        }
        Ok(())
    }
}

/// Returns the refusal of a pose without a motion.
#[inline(never)]
fn no_motion<N: Number>(status: Status) -> Refusal<N> {
    let (code, leg) = FaultCode::of(status);
    let what = code.bounded().unwrap_or(Bounded::Range);
    ends_at(what, leg, N::ZERO, N::ZERO)
}

/// Returns the refusal of a pose at which a limit is broken.
#[inline(never)]
fn breaks<N: Number>(broken: LimitBreach<N>) -> Refusal<N> {
    let what = broken.code.bounded().unwrap_or(Bounded::Range);
    ends_at(what, broken.index, broken.value, broken.limit)
}

/// Returns the refusal of a recovery that breaks a limit at its end.
#[inline(never)]
fn ends_at<N: Number>(what: Bounded, index: Option<u8>, value: N, limit: N) -> Refusal<N> {
    Refusal::Recovery(Violation {
        what,
        index,
        at: N::ONE,
        value,
        error: Some(N::ZERO),
        limit,
        certain: true,
        ramp: false,
        shortest: None,
    })
}

/// Returns the refusal for joint rates or accelerations; `ramp`: those of a stop are in them.
#[inline(never)]
fn too_fast<N: Number>(broken: LimitBreach<N>, ramp: bool) -> Refusal<N> {
    let what = match broken.code {
        FaultCode::Limit(what) => what,
        _ => Bounded::Range,
    };
    // The rate is largest half way, the acceleration at the ends.
    let at = match what {
        Bounded::Rate => N::HALF,
        _ => N::ZERO,
    };
    Refusal::Recovery(Violation {
        what,
        index: broken.index,
        at,
        value: broken.value,
        error: Some(N::ZERO),
        limit: broken.limit,
        certain: true,
        ramp: ramp && what == Bounded::Acceleration,
        shortest: None,
    })
}
