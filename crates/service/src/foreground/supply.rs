//! Switching the drives on and off, with the times that they and the brake take.

use super::output::Power;
use super::{Foreground, Path, Target, TickEnds};
use crate::feature::Optional;
use crate::feedback::EnableProgress;
use crate::guard::LimitBreach;
use crate::number::ServiceNumber;
use crate::scene::Scene;
use crate::settings::{PowerTimes, Reactions, StopCategory};
use crate::states::{Known, Transition, Trigger};
use trirrr_protocol::message::{Acting, DriveFault, DriveState, FaultCode, State};

/// Progress of switching on or off.
pub(crate) struct Supply {
    times: PowerTimes,
    phase: EnablePhase,
    /// Ticks until the state that follows.
    countdown: u16,
    /// The machine comes to rest to be switched off.
    ends: bool,
    reactions: Reactions,
    /// Stop of the fault that is latched.
    category: StopCategory,
    /// A fault was latched, or motors were moved one by one: the pose of the platform is not known.
    lost: bool,
}

/// Phase in which a machine is enabled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum EnablePhase {
    /// The drives tell where they are,
    Check,
    /// the background finds the pose,
    Place,
    /// the drives go on,
    Close,
    /// and are on.
    Done,
}

impl Supply {
    pub(super) fn new(times: PowerTimes, reactions: Reactions) -> Self {
        Self {
            times,
            phase: EnablePhase::Done,
            countdown: 0,
            ends: false,
            reactions,
            category: StopCategory::Off,
            lost: false,
        }
    }

    /// Stop at this fault.
    pub(super) fn reaction(&self, code: FaultCode) -> StopCategory {
        self.reactions.to(code)
    }

    /// The drives go off by a fault.
    pub(super) fn fail(&mut self) {
        self.ends = false;
        self.lost = true;
    }

    /// Returns true if the pose of the platform is not known.
    pub(crate) fn is_lost(&self) -> bool {
        self.lost
    }

    /// The pose of the platform is known, or is not.
    pub(super) fn set_lost(&mut self, lost: bool) {
        self.lost = lost;
    }
}

impl<N: ServiceNumber, S: Scene<N = N>, E: TickEnds<S>> Foreground<'_, S, E> {
    /// Switches the drives on: at once, or, if they tell where they are, once they have told it.
    pub(crate) fn enable(&mut self) {
        let Transition::To(_) = self.change(Trigger::Enable, Acting::Nothing) else {
            return;
        };
        self.supply.countdown = self.supply.times.enable_ticks();
        self.output.power = Power::On;
        let needs_homing = self.features.needs_homing();
        if let Some(watch) = self.features.measuring() {
            watch.begin();
            if needs_homing {
                watch.acknowledge(true);
            }
            self.supply.phase = EnablePhase::Check;
            self.output.power = Power::Check;
        }
    }

    /// Comes to rest, then switches the drives off.
    pub(super) fn disable(&mut self) {
        match self.leads(Trigger::Disable) {
            Some(State::Reacting) if !self.output.is_on() => {}
            // The drives hold after a fault: they go off, and the fault stays.
            Some(state @ State::Reacting) => {
                self.supply.category = StopCategory::StopThenOff;
                self.enter(state, Trigger::Disable, self.acting);
                self.end_reaction();
            }
            Some(state @ State::Disabling) => {
                self.begin_disabling(state, Trigger::Disable, Acting::Nothing);
            }
            Some(_) => {
                self.supply.ends = true;
                self.stop_by(Trigger::Disable);
            }
            None => {}
        }
    }

    /// Acknowledges a fault, and the angles of drives that have restarted. The drives stay off; in this tick their errors are
    /// cleared.
    pub(crate) fn clear_fault(&mut self) {
        // The order may be older than the stop.
        if self.features.is_pressed() {
            return;
        }
        if let Some(interlocks) = self.features.interlocks.get_mut() {
            interlocks.acknowledge();
        }
        if let Some(watch) = self.features.feedback.get_mut() {
            watch.acknowledge(false);
        }
        let known = self.output.is_on().then(|| self.known());
        if self.change(Trigger::ClearFault(known), self.acting) == Transition::To(State::Disabled) {
            self.supply.countdown = 1;
        }
    }

    /// The motion has come to rest for good.
    pub(super) fn end_motion(&mut self, known: Known, acting: Acting) {
        if self.state == State::Reacting {
            return self.end_reaction();
        }
        // Nobody switches off a machine with a job of its own.
        let ends = !E::IS_WHOLE && self.supply.ends;
        match self.leads(Trigger::EndsOff).filter(|_| ends) {
            Some(state) => self.begin_disabling(state, Trigger::EndsOff, acting),
            None => _ = self.change(Trigger::Ends(known), acting),
        }
    }

    /// Comes to rest because of a fault, on the path if there is one.
    pub(super) fn react(&mut self, category: StopCategory) {
        self.supply.category = category;
        self.output.tool = N::ZERO;
        let moves = matches!(
            self.state,
            State::Running | State::Slowing | State::Stopping | State::Recovering | State::Homing
        );
        self.features.stop_homing();
        self.change(Trigger::FaultOnPath, self.acting);
        if !moves {
            self.end_reaction();
        }
    }

    /// The machine stands after a fault: the brake engages, unless the drives hold it.
    fn end_reaction(&mut self) {
        self.drop_queue();
        self.supply.ends = false;
        if self.supply.category == StopCategory::StopAndHold {
            self.change(Trigger::Reacted, self.acting);
            return;
        }
        self.engage_brake();
    }

    fn begin_disabling(&mut self, state: State, trigger: Trigger, acting: Acting) {
        self.drop_queue();
        self.supply.ends = false;
        self.engage_brake();
        self.enter(state, trigger, acting);
    }

    fn engage_brake(&mut self) {
        self.supply.countdown = self.supply.times.brake_engage_ticks;
        self.output.brake_released = false;
    }

    /// A tick of a machine whose drives are off, go on, or go off.
    #[inline(never)]
    pub(super) fn switch(&mut self) -> Target<N> {
        if self.state == State::Enabling && !self.is_closed() {
            return self.stand();
        }
        let left = self.supply.countdown;
        let counting = left > 0;
        self.supply.countdown = left.saturating_sub(1);
        match self.state {
            State::Enabling => {
                let release = self.supply.times.brake_release_ticks;
                self.output.brake_released = left <= release;
                if !counting {
                    self.change(Trigger::DrivesOn(self.known()), self.acting);
                }
            }
            State::Disabling | State::Reacting if counting => {}
            State::Disabling => {
                self.output.power = Power::Off;
                self.change(Trigger::DrivesOff, self.acting);
            }
            State::Reacting => {
                self.output.power = Power::Off;
                // Without current a motor without an encoder may lose its place.
                self.supply.lost = true;
                self.change(Trigger::DrivesOff, self.acting);
            }
            _ => {
                self.output.power = match counting {
                    true => Power::Clear,
                    false => Power::Off,
                };
            }
        }
        self.stand()
    }

    /// Returns what is known of where the machine stands.
    fn known(&self) -> Known {
        match (self.features.needs_homing(), self.supply.lost) {
            (true, _) => Known::NOTHING,
            (false, true) => Known::ANGLES,
            (false, false) => Known::POSE,
        }
    }

    /// Stands where the machine is known to be, or only where its motors are.
    pub(super) fn stand(&mut self) -> Target<N> {
        let holds = self.output.is_on() && !self.features.needs_homing() && !self.supply.lost;
        match holds {
            true => Target::Setpoint(Self::standing(self.pose)),
            false => Target::Still,
        }
    }

    /// A tick of a machine that is being enabled. Returns true once its drives are on.
    #[inline]
    fn is_closed(&mut self) -> bool {
        let needs_homing = self.features.needs_homing();
        let Some(watch) = self.features.measuring() else {
            return true;
        };
        let wanted = match self.supply.phase {
            EnablePhase::Check => DriveState::Off,
            EnablePhase::Place => return false,
            EnablePhase::Close => DriveState::On,
            EnablePhase::Done => return true,
        };
        match watch.wait_for(wanted) {
            EnableProgress::Waiting => {}
            EnableProgress::Refused => self.give_up(),
            EnableProgress::Done(angles) if wanted == DriveState::Off => {
                for (motor, angle) in self.output.motors.iter_mut().zip(angles) {
                    motor.angle = angle;
                }
                self.unreported = true;
                match needs_homing {
                    true => self.close(),
                    false => {
                        watch.ask_for_pose();
                        self.supply.phase = EnablePhase::Place;
                    }
                }
            }
            EnableProgress::Done(_) => {
                watch.forget(&self.output.motors);
                self.supply.phase = EnablePhase::Done;
            }
        }
        false
    }

    /// The background has found the pose: the drives close where they are, unless a joint has moved since.
    pub(super) fn place(&mut self) {
        let Some(place) = self.ends.take_recovery() else {
            return;
        };
        if self.state != State::Enabling || self.supply.phase != EnablePhase::Place {
            return;
        }
        let stands = self
            .features
            .feedback
            .get_mut()
            .is_some_and(|watch| watch.stands_at(&self.output.motors));
        match stands {
            true => {
                self.pose = place.to;
                self.supply.lost = false;
                self.close();
            }
            false => self.give_up(),
        }
    }

    fn close(&mut self) {
        self.supply.phase = EnablePhase::Close;
        self.output.power = Power::On;
    }

    /// The machine is not enabled: the drives go off, the brake has not let go.
    fn give_up(&mut self) {
        self.output.power = Power::Off;
        self.supply.countdown = 0;
        self.change(Trigger::DrivesOff, self.acting);
    }

    /// Watches the drives that are on.
    #[inline]
    pub(super) fn watch(&mut self) {
        let motors = &self.output.motors;
        let cycle = self.features.homing();
        let stalled = cycle.and_then(|cycle| cycle.stalled(motors));
        if let Some(motor) = stalled.filter(|_| self.output.is_on()) {
            self.latch(LimitBreach {
                code: FaultCode::Drive(DriveFault::Stalled),
                index: Some(motor),
                value: N::ONE,
                limit: N::ZERO,
            });
        }
        // Drives that go on, also of a machine that is disabled meanwhile, are not on yet.
        let is_on = self.output.is_on() && self.supply.phase == EnablePhase::Done;
        let Some(watch) = self.features.feedback.get_mut().filter(|_| is_on) else {
            return;
        };
        // A motor that searches may stand against its stop.
        let follows = self.state != State::Homing;
        let watched = watch.check(&self.output.motors, follows);
        // What pushes the machine may push it on during the stop, and while the drives hold it: no second fault.
        let torques_are_known = match self.state {
            State::Idle | State::Running | State::Slowing | State::Holding => true,
            State::Stopping => matches!(self.travel.path, Path::Move | Path::Ended),
            _ => false,
        };
        let felt = match (self.features.contact.get_mut(), watch.readings()) {
            (Some(contact), Some(readings)) if torques_are_known => {
                contact.check(readings, &self.output.motors, &self.pose)
            }
            (Some(contact), _) => {
                contact.pause();
                Ok(())
            }
            (None, _) => Ok(()),
        };
        if let Err(breach) = watched.and(felt) {
            self.latch(breach);
        }
    }
}
