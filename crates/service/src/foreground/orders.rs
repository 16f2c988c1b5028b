//! Orders from the background.

use super::super::feed::PathPosition;
use super::super::handoff::{Order, QueuedMove};
use super::{Foreground, ForegroundEnds, Part, Path, TickEnds};
use crate::feature::Optional;
use crate::guard::Guard;
use crate::number::ServiceNumber;
use crate::scene::{CurvesOf, Scene};
use crate::states::{Transition, Trigger};
use trirrr_core::setpoint::wrapped;
use trirrr_protocol::message::{Acting, State};

impl<'q, N: ServiceNumber, S: Scene<N = N>> Foreground<'_, S, ForegroundEnds<'q, S>> {
    /// Handles one order, or discards one stale move. Returns true if a path started in this tick: its first setpoint is this
    /// tick's. An order that does not fit the state, because the state changed while it was on its way, changes nothing.
    #[inline]
    pub(super) fn take_queued_order(&mut self) -> bool {
        if self.travel.path == Path::None
            && self
                .ends
                .moves
                .peek()
                .is_some_and(|next| self.is_stale(next))
        {
            // One per tick; orders given after the queue was dropped wait until it is empty.
            self.ends.moves.discard();
            return false;
        }
        let Some(order) = self.ends.orders.receive() else {
            return false;
        };
        self.orders_taken = self.orders_taken.wrapping_add(1);
        self.unreported = true;
        match order {
            Order::Start => return self.start(),
            Order::Probe { away } => return self.start_probing(away),
            Order::Hold => self.hold(),
            // The state may be older than the door.
            Order::Resume => self.travel.held = self.features.is_open(),
            Order::Stop => self.stop(),
            Order::ClearFault => self.clear_fault(),
            Order::Enable => self.enable(),
            Order::Disable => self.disable(),
            Order::Place => self.place(),
            Order::Drives { every } => {
                if let Some(watch) = self.features.feedback.get_mut() {
                    watch.sample_every(every);
                }
            }
            Order::Recover => return self.recover(),
            Order::Home => self.home(),
            Order::Output { on, off } => {
                if let Some(digital) = self.features.digital.get_mut() {
                    digital.switch(on, off, self.state);
                }
            }
            Order::FeedOverride { percent } => self.travel.feed.aim_at(percent),
            Order::Telemetry { every, fields } => {
                (self.sampling.every, self.sampling.fields) = (every, fields);
                self.sampling.countdown = 0;
            }
            Order::Adopt => {
                if let Some(setups) = self.features.setups.get_mut()
                    && let Some(setup) = setups.receive()
                {
                    self.tick = setup.tick;
                    self.guard = Guard::of_results(&setup.limits);
                    self.pose = setup.pose;
                    if let Some(by) = setup.shift {
                        self.shift_by(by);
                    }
                }
            }
        }
        false
    }

    /// Takes changed encoder offsets: the motors stand, at other angles.
    fn shift_by(&mut self, by: [N::Angle; 3]) {
        for (motor, by) in self.output.motors.iter_mut().zip(by) {
            motor.angle = wrapped::<N>(motor.angle + by);
        }
        if let Some(cycle) = self.features.homing() {
            cycle.add_offsets(by);
        }
        if let Some(watch) = self.features.feedback.get_mut() {
            watch.forget(&self.output.motors);
        }
        if let Some(shifted) = self.features.shifted.get_mut() {
            *shifted = Some(by);
        }
    }

    pub(super) fn is_stale(&self, planned: &QueuedMove<N, CurvesOf<S>>) -> bool {
        planned.generation != self.job.generation
    }

    fn start_probing(&mut self, away: bool) -> bool {
        let probe = self.features.probe.get_mut();
        if !probe.is_some_and(|probe| probe.is_ready(away)) || !self.start() {
            return false;
        }
        if let Some(probe) = self.features.probe.get_mut() {
            probe.arm(away);
        }
        true
    }

    fn recover(&mut self) -> bool {
        let (Some(state), false) = (self.leads(Trigger::Recover), self.features.is_open()) else {
            self.ends.take_recovery();
            return false;
        };
        self.drop_queue();
        self.supply.set_lost(true);
        self.travel.path = Path::Joints;
        self.travel.part = Part::WHOLE;
        self.begin();
        self.enter(state, Trigger::Recover, Acting::Nothing);
        true
    }

    fn hold(&mut self) {
        if self.features.is_open() {
            // The machine holds already, and for a reason that outlasts this one.
            return;
        }
        // A door outlasts it: the path was left without the tool.
        let acting = match self.job.left {
            Some(_) => Acting::Door,
            None => Acting::Hold,
        };
        if let Transition::To(_) = self.change(Trigger::Hold, acting) {
            self.travel.held = true;
        }
    }
}

impl<N: ServiceNumber, S: Scene<N = N>, E: TickEnds<S>> Foreground<'_, S, E> {
    pub(crate) fn start(&mut self) -> bool {
        let full = self.gets_no_more();
        let ahead = self.ahead();
        let room = |x: usize| self.travel.passed.room.left(&ahead.room, x);
        let enough =
            E::IS_WHOLE || ahead.rests_from(self.job.begun) || self.travel.feed.is_enough(0, room);
        let is_blocked = self.features.is_open() || self.features.is_at_limit();
        let Some(state) = self.leads(Trigger::Start) else {
            return false;
        };
        if is_blocked || !(enough || full) {
            return false;
        }
        if !self.begin_next() {
            return false;
        }
        self.begin();
        if !enough {
            // More does not fit in: slowly, as what there is allows.
            self.travel.feed.end();
        }
        self.enter(state, Trigger::Start, Acting::Nothing);
        true
    }

    pub(crate) fn home(&mut self) {
        let fits = self.features.needs_homing() && !self.features.is_open();
        let (Some(state), true) = (self.leads(Trigger::Home), fits) else {
            self.ends.take_recovery();
            return;
        };
        self.drop_queue();
        if let Some(cycle) = self.features.homing() {
            cycle.begin();
        }
        self.host.silent = 0;
        self.enter(state, Trigger::Home, Acting::Nothing);
    }

    /// At the start of a path, which starts at rest: normal speed at once.
    pub(super) fn begin(&mut self) {
        self.travel.position = PathPosition::START;
        self.features.begin_path();
        self.travel.feed.start();
        self.travel.held = false;
        self.host.silent = 0;
    }

    pub(super) fn stop(&mut self) {
        self.stop_by(Trigger::Stop);
    }

    /// Stops because of `trigger`, a stop or a disable.
    pub(super) fn stop_by(&mut self, trigger: Trigger) {
        let acting = match self.state {
            State::Idle => Acting::Nothing,
            State::Reacting => self.acting,
            _ => Acting::Stop,
        };
        match self.change(trigger, acting) {
            Transition::To(State::Idle) => self.drop_queue(),
            Transition::To(State::Reacting) => self.stop_retreat(),
            Transition::To(_) => self.features.stop_homing(),
            _ => {}
        }
    }
}
