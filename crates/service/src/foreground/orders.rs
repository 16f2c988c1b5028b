//! Orders from the background.

use super::super::feed::PathPosition;
use super::super::handoff::{Order, QueuedMove};
use super::{Foreground, ForegroundEnds, Part, Path, TickEnds};
use crate::feature::Optional;
use crate::guard::Guard;
use crate::number::ServiceNumber;
use crate::scene::{CurvesOf, Scene};
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
        let waits = matches!(self.state, State::Idle | State::Cleared);
        if !waits || self.features.is_open() {
            self.ends.take_recovery();
            return false;
        }
        self.drop_queue();
        self.supply.set_lost(true);
        self.travel.path = Path::Joints;
        self.travel.part = Part::WHOLE;
        self.begin();
        self.transition_to(State::Recovering, Acting::Nothing);
        true
    }

    fn hold(&mut self) {
        if self.features.is_open() {
            // The machine holds already, and for a reason that outlasts this one.
            return;
        }
        match self.state {
            State::Running => {
                self.travel.held = true;
                self.transition_to(State::Slowing, Acting::Hold);
            }
            // What it waits for changes: it does not go on by itself any more. A door outlasts it: the path was left without the tool.
            State::Slowing | State::Holding => {
                self.travel.held = true;
                let acting = match self.job.left {
                    Some(_) => Acting::Door,
                    None => Acting::Hold,
                };
                self.transition_to(self.state, acting);
            }
            _ => {}
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
        if self.state != State::Idle || is_blocked || !(enough || full) {
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
        self.transition_to(State::Running, Acting::Nothing);
        true
    }

    pub(crate) fn home(&mut self) {
        let waits = matches!(self.state, State::Unhomed | State::Idle | State::Cleared);
        if !waits || !self.features.needs_homing() || self.features.is_open() {
            self.ends.take_recovery();
            return;
        }
        self.drop_queue();
        if let Some(cycle) = self.features.homing() {
            cycle.begin();
        }
        self.host.silent = 0;
        self.transition_to(State::Homing, Acting::Nothing);
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
        match self.state {
            State::Running | State::Slowing | State::Holding | State::Recovering => {
                self.transition_to(State::Stopping, Acting::Stop);
            }
            State::Stopping => self.transition_to(State::Stopping, Acting::Stop),
            State::Homing => {
                self.features.stop_homing();
                self.transition_to(State::Stopping, Acting::Stop);
            }
            State::Idle => {
                self.drop_queue();
                self.transition_to(State::Idle, Acting::Nothing);
            }
            State::Reacting => self.stop_retreat(),
            State::Fault
            | State::Cleared
            | State::Unhomed
            | State::Disabled
            | State::Enabling
            | State::Disabling => {}
        }
    }
}
