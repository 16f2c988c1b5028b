//! The half that runs once per tick, above everything else.

mod ends;
mod features;
mod interlock;
mod orders;
mod output;
mod play;
mod report;
mod retreat;
mod splice;
mod supply;

pub(super) use ends::{ForegroundEnds, TickEnds};
pub(super) use features::TickFeatures;
pub use output::{Output, Power};

use super::feed::{FeedScale, PathPosition};
use super::guard::{Guard, LimitBreach};
use super::handoff::QueuedMove;
use super::pace::{FULL, Pace, RoomCount};
use super::settings::Settings;
use super::states::{Transition, Trigger, next};
use crate::feature::Optional;
use crate::feedback::Readings;
use crate::homing::Cycle;
use crate::interlock::InterlockReadings;
use crate::number::ServiceNumber;
use crate::scene::{CurvesOf, ModelOf, Scene, Setup};
use core::sync::atomic::Ordering;
use nalgebra::Vector3;
use supply::Supply;
use trirrr_core::number::Number;
use trirrr_core::setpoint::{CurveKind, JointSetpoint, Pose, Setpoint};
use trirrr_core::tick::{Motion, Motor, Tick};
use trirrr_protocol::message::{Acting, FaultCode, Interruption, State, TelemetryFields};

/// The half of the service that runs once per tick.
pub struct Foreground<'q, S: Scene, E: TickEnds<S> = ForegroundEnds<'q, S>> {
    tick: Tick<ModelOf<S>>,
    pub(super) guard: Guard<S::N>,
    pub(super) ends: E,
    pub(super) features: TickFeatures<'q, S, E::Splices>,
    pub(super) supply: Supply,
    pub(super) state: State,
    acting: Acting,
    /// Tick in which the present wait for moves, or way to rest, began.
    since: u32,
    pub(super) travel: PathTravel<S::N, CurvesOf<S>>,
    job: JobPlace,
    /// Pose to which the platform was commanded last.
    pub(super) pose: Pose<S::N>,
    output: Output<S::N>,
    orders_taken: u8,
    /// Something changed that was not reported.
    unreported: bool,
    host: HostWatch,
    sampling: Sampling,
    /// Ticks so far.
    clock: u32,
}

/// Path under way, and the pace on it.
pub(super) struct PathTravel<N: Number, K: CurveKind> {
    path: Path,
    /// The move under way.
    current: Option<QueuedMove<N, K>>,
    position: PathPosition,
    part: Part,
    /// Room of all parts that were begun.
    passed: RoomCount,
    feed: FeedScale,
    /// A hold that the host asked for: it waits to be resumed.
    pub(super) held: bool,
    /// 1 / (R dt): change of the pace per time on a ramp.
    slope: N::Factor,
    counts: Counts<N>,
}

/// Place of the tick in the moves that are queued.
struct JobPlace {
    /// Generation of the queue.
    generation: u8,
    /// Number of the first move that was not begun.
    begun: u32,
    /// Number of the first move that is not over.
    done: u32,
    /// Place at which the last job was left.
    interrupted: Option<Interruption>,
    /// Place at which the job under way lost its tool: at a stop, a fault or an open door. The machine may have gone on from there.
    left: Option<Interruption>,
}

/// Watch over the host.
struct HostWatch {
    /// Silence after which a machine that moves comes to rest, ticks; 0 for never.
    timeout_ticks: u32,
    /// Requests heard so far.
    heard: u32,
    /// Ticks since the last.
    silent: u32,
}

/// Telemetry samples.
struct Sampling {
    /// Ticks from one sample to the next; 0 for none.
    every: u16,
    fields: TelemetryFields,
    /// Ticks until the next sample.
    countdown: u16,
    /// Duration of the last tick, counts of the board's timer.
    duration: u32,
}

/// Path under way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Path {
    None,
    /// A move of the job.
    Move,
    /// The last move of the job, at its end: a tick later it is over.
    Ended,
    /// A recovery, the head of its queue. It stays there until it is over.
    Joints,
    /// A recovery at its end.
    JointsEnded,
}

/// Target that a tick sets for the machine.
enum Target<N: Number> {
    Setpoint(Setpoint<N>),
    Joints(JointSetpoint<N>),
    /// The place where the machine is.
    Still,
}

impl<'q, N: ServiceNumber, S: Scene<N = N>, E: TickEnds<S>> Foreground<'q, S, E> {
    pub(super) fn new(
        setup: Setup<ModelOf<S>>,
        angles: [N::Angle; 3],
        settings: &Settings<N>,
        ends: E,
        features: TickFeatures<'q, S, E::Splices>,
    ) -> Self {
        let feed = FeedScale::new(settings.ramp.ticks);
        let motor = |angle| Motor {
            angle,
            rate: N::ZERO,
            acceleration: N::ZERO,
            torque: N::ZERO,
        };
        Self {
            tick: setup.tick,
            guard: Guard::of_results(&setup.limits),
            ends,
            features,
            supply: Supply::new(settings.power, settings.reactions),
            state: State::Disabled,
            acting: Acting::Nothing,
            since: 0,
            travel: PathTravel {
                path: Path::None,
                current: None,
                position: PathPosition::START,
                part: Part::WHOLE,
                passed: RoomCount::NOTHING,
                slope: slope::<N>(settings.ramp.ticks, settings.period),
                counts: Counts::new(&feed),
                feed,
                held: false,
            },
            job: JobPlace {
                generation: 0,
                begun: 0,
                done: 0,
                interrupted: None,
                left: None,
            },
            pose: setup.pose,
            output: Output {
                motors: angles.map(motor),
                tool: N::ZERO,
                power: Power::Off,
                brake_released: false,
            },
            orders_taken: 0,
            unreported: false,
            host: HostWatch {
                timeout_ticks: settings.host_timeout_ticks,
                heard: 0,
                silent: 0,
            },
            sampling: Sampling {
                every: settings.telemetry_every,
                fields: TelemetryFields::ALL,
                countdown: 0,
                duration: 0,
            },
            clock: 0,
        }
    }

    /// One tick of a machine that needs no inputs: takes an order, goes on along the path, computes
    /// and checks what the motors have to do, and samples. Never waits.
    #[inline]
    pub fn tick(&mut self) -> &Output<N> {
        self.tick_with([false; 3])
    }

    /// One tick, with the inputs of homing as they are now, that is where the motors were commanded
    /// in the last tick: for each motor whether its switch is closed, or its drive says that it
    /// stalls. Otherwise as [`Foreground::tick`].
    #[inline]
    pub fn tick_with(&mut self, inputs: [bool; 3]) -> &Output<N> {
        self.tick_observed(inputs, |_, _| {})
    }

    /// Computes one tick as [`Foreground::tick_with`]. `observe` sees the setpoint and the motion
    /// that the tick plays, if there is one.
    #[inline]
    pub fn tick_observed(
        &mut self,
        inputs: [bool; 3],
        observe: impl FnOnce(&Setpoint<N>, &Motion<N>),
    ) -> &Output<N> {
        self.features.begin_tick(inputs, &self.output.motors);
        self.listen();
        self.watch();
        self.take_splice();
        self.features.drop_stale(self.job.generation);
        self.check_interlocks();
        let started = E::take_order(self);
        let target = self.advance(started);
        let setpoint = match target {
            Target::Setpoint(setpoint) => match self.tick.evaluate(&setpoint) {
                Ok(motion) => {
                    if let Err(broken) = self.check(&motion) {
                        self.latch(broken);
                    }
                    if self.output.is_on() {
                        observe(&setpoint, &motion);
                        self.output.motors = motion.motors;
                        self.output.tool = self.tool(&setpoint);
                        self.pose = setpoint.pose;
                        setpoint
                    } else {
                        Self::standing(self.pose)
                    }
                }
                Err(status) => {
                    self.latch(LimitBreach::of(status));
                    Self::standing(self.pose)
                }
            },
            Target::Joints(joints) => {
                if !self.state.has_fault()
                    && let Err(broken) = self.guard.check_joints(&joints)
                {
                    self.latch(broken);
                }
                if self.output.is_on() {
                    self.follow(&joints);
                }
                Self::standing(self.pose)
            }
            Target::Still => {
                self.zero_motion();
                Self::standing(self.pose)
            }
        };
        self.clock = self.clock.wrapping_add(1);
        if let Some(shared) = self.ends.shared() {
            shared.tick.store(self.clock, Ordering::Relaxed);
        }
        let runs = self.tool_runs();
        if self.features.settle(runs, self.clock) {
            self.note_change();
        }
        E::report(self, &setpoint);
        self.features.sample(self.clock);
        &self.output
    }

    /// Takes what the drives tell, before the tick. An older telling counts as one that the drives repeat.
    #[inline]
    pub fn hear(&mut self, readings: Readings<N>) {
        if let Some(watch) = self.features.feedback.get_mut() {
            watch.hear(readings);
        }
    }

    /// Takes what the contacts of the interlocks tell, before the tick. A machine whose owner says nothing keeps the last.
    #[inline]
    pub fn sense(&mut self, readings: InterlockReadings) {
        self.ends.sense(readings);
        let inputs = self.features.interlocks.get_mut();
        let changed = inputs.is_some_and(|all| all.sense(readings));
        let probe = self.features.probe.get_mut();
        let probed = probe.is_some_and(|probe| probe.read(readings.probe));
        if changed | probed {
            self.note_change();
        }
    }

    /// Takes the levels of the spare inputs, before the tick. A machine whose owner says nothing keeps the last.
    #[inline]
    pub fn sense_digital(&mut self, readings: u8) {
        if let Some(digital) = self.features.digital.get_mut() {
            digital.sense(readings);
        }
    }

    /// Returns the spare outputs that are on, a bit for each: none after a fault from outside, too.
    #[inline]
    pub fn digital_outputs(&self) -> u8 {
        let runs = self.tool_runs();
        self.features
            .digital
            .get()
            .map_or(0, |digital| digital.outputs(runs))
    }

    /// Returns the output of the last tick.
    pub fn output(&self) -> &Output<N> {
        &self.output
    }

    /// Returns the state of the machine.
    pub fn state(&self) -> State {
        self.state
    }

    /// Returns true while the tool may be on: a job runs, and no door is open, or was since the job ran last.
    #[inline]
    pub fn tool_runs(&self) -> bool {
        self.state.is_running() && !self.waits_for_door()
    }

    /// Latches a fault from outside: a drive's, the board's, a tick that came too late. To be called
    /// between two ticks; the next one gives out no more motion. A fault that is latched already
    /// stays.
    pub fn raise(&mut self, code: FaultCode, index: Option<u8>, value: N, limit: N) {
        self.latch(LimitBreach {
            code,
            index,
            value,
            limit,
        });
    }

    /// Reports the latency of the last tick, from when it was due until its outputs were written, and the period, both in counts of
    /// the board's timer. Returns false and latches an [overrun](FaultCode::Overrun) if the tick took longer than the
    /// period; the [output](Foreground::output) is off then.
    #[inline]
    pub fn report_timing(&mut self, duration: u32, period: u32) -> bool {
        if let Some(shared) = self.ends.shared() {
            self.sampling.duration = duration;
            if duration > shared.longest.load(Ordering::Relaxed) {
                shared.longest.store(duration, Ordering::Relaxed);
            }
        }
        let in_time = duration <= period;
        if !in_time {
            self.overrun(duration, period);
        }
        in_time
    }

    /// Counts a tick that came too late, of a machine that keeps no deadlines.
    pub fn count_late(&mut self) {
        if let Some(shared) = self.ends.shared() {
            super::handoff::count(&shared.late);
        }
    }

    #[cold]
    fn overrun(&mut self, duration: u32, period: u32) {
        if self.ends.shared().is_none() {
            // Nobody is told how late it was.
            return self.raise(FaultCode::Overrun, None, N::ONE, N::ONE);
        }
        // Two periods are the most that every board can tell.
        let late = (duration - period).min(period);
        let value = N::ONE + N::ratio(late, period);
        self.raise(FaultCode::Overrun, None, value, N::ONE);
    }

    /// Returns the angles that this tick has added to the motors' commanded angles without moving the
    /// motors. A tick does so where homing has found a motor's reference, and for changed encoder offsets. A drive that counts steps
    /// adds the shift to the angle that it counts from.
    #[inline]
    pub fn shift(&self) -> Option<[N::Angle; 3]> {
        let offsets = self.features.shifted.get().copied().flatten();
        let homing = self.features.homing.get().and_then(Option::as_ref);
        homing.and_then(Cycle::shift).or(offsets)
    }

    /// Sets the angles of the motors as encoders measured them. Accepted only at rest. The platform's pose is unknown afterwards
    /// until a [recovery](trirrr_protocol::message::Command::Recover). Returns false if the machine moves.
    pub fn set_position(&mut self, angles: [N::Angle; 3]) -> bool {
        let transition = next(self.state, Trigger::Measured);
        let has_moves = self.travel.current.is_some() || self.next_move().is_some();
        if transition == Transition::Refused || (self.state == State::Idle && has_moves) {
            return false;
        }
        for (motor, angle) in self.output.motors.iter_mut().zip(angles) {
            motor.angle = angle;
        }
        self.supply.set_lost(true);
        if transition != Transition::Kept {
            self.drop_queue();
            self.change(Trigger::Measured, Acting::Nothing);
        }
        self.note_change();
        true
    }

    /// Checks the results of a tick. A machine that stops because of a fault keeps no limit but its path.
    #[inline]
    fn check(&self, motion: &Motion<N>) -> Result<(), LimitBreach<N>> {
        match self.state {
            State::Reacting => Ok(()),
            _ => self.guard.check::<ModelOf<S>>(motion),
        }
    }

    /// Counts the silence of the host.
    #[inline]
    fn listen(&mut self) {
        let Some(shared) = self.ends.shared() else {
            return;
        };
        let heard = shared.heard.load(Ordering::Relaxed);
        if heard != self.host.heard {
            self.host.heard = heard;
            self.host.silent = 0;
            return;
        }
        self.host.silent = self.host.silent.saturating_add(1);
        let moves = self.leads(Trigger::Silence).is_some();
        if moves && self.host.timeout_ticks != 0 && self.host.silent >= self.host.timeout_ticks {
            self.miss_host();
        }
    }

    /// The host is lost. A job waits on its path for one that resumes it; other motion ends.
    #[cold]
    fn miss_host(&mut self) {
        match self.change(Trigger::Silence, Acting::Silence) {
            Transition::To(State::Stopping) => self.features.stop_homing(),
            _ => self.travel.held = true,
        }
    }

    /// Something changed that was not reported, if anybody is told.
    #[inline(always)]
    pub(super) fn note_change(&mut self) {
        if self.ends.shared().is_some() {
            self.unreported = true;
        }
    }

    /// Goes where `trigger` leads, if anywhere, for a reason. Returns where that is.
    #[inline(always)]
    pub(super) fn change(&mut self, trigger: Trigger, acting: Acting) -> Transition {
        let transition = next(self.state, trigger);
        if let Transition::To(state) = transition {
            self.enter(state, trigger, acting);
        }
        transition
    }

    /// Goes to `state`, to which `trigger` leads.
    #[inline(always)]
    pub(super) fn enter(&mut self, state: State, trigger: Trigger, acting: Acting) {
        #[cfg(test)]
        crate::tests::take_note(self.state, trigger);
        let _ = trigger;
        self.transition_to(state, acting);
    }

    /// Returns the state that `trigger` leads to, if it leads on.
    #[inline(always)]
    pub(super) fn leads(&self, trigger: Trigger) -> Option<State> {
        next(self.state, trigger).state()
    }

    #[inline(never)]
    fn transition_to(&mut self, state: State, acting: Acting) {
        if self.state != state || self.acting != acting {
            if self.ends.shared().is_some() {
                self.account(state, acting);
            }
            if !plays(state) {
                self.leave();
            }
            if state == State::Running {
                self.job.left = None;
            }
            self.features.enter(state, plays(state));
            self.state = state;
            self.acting = acting;
            self.note_change();
        }
    }

    /// Counts the ticks of what ends here: a wait for moves, a way to rest.
    #[inline(never)]
    fn account(&mut self, state: State, acting: Acting) {
        let Some(shared) = self.ends.shared() else {
            return;
        };
        let took = self.clock.wrapping_sub(self.since);
        let was_dry = self.acting == Acting::QueueDry;
        let slows = |state| matches!(state, State::Slowing | State::Stopping | State::Reacting);
        if was_dry && acting != Acting::QueueDry {
            let dry = shared.dry.load(Ordering::Relaxed);
            shared.dry.store(dry.wrapping_add(took), Ordering::Relaxed);
        }
        if !was_dry && slows(self.state) && !slows(state) {
            let longest = shared.longest_stop.load(Ordering::Relaxed);
            // That in which it comes to rest is one of them.
            let longest = longest.max(took.wrapping_add(1));
            shared.longest_stop.store(longest, Ordering::Relaxed);
        }
        let goes_on = match was_dry {
            true => acting == Acting::QueueDry,
            false => slows(self.state) && slows(state) && acting != Acting::QueueDry,
        };
        if !goes_on {
            self.since = self.clock;
        }
    }

    /// Drops everything that is queued: it is of a generation that is over.
    #[inline(never)]
    fn drop_queue(&mut self) {
        self.leave();
        self.tell_left();
        self.job.generation = self.job.generation.wrapping_add(1);
        self.ends.drop_moves();
        self.travel.path = Path::None;
        self.travel.current = None;
        self.travel.position = PathPosition::START;
        self.travel.passed = RoomCount::NOTHING;
        self.features.drop_queue();
        self.travel.feed.end();
        self.travel.held = false;
        self.job.done = self.job.begun;
        self.note_change();
    }

    /// The tool of the job goes off for good. The first place of a job counts: on the way to rest the path is left without the tool.
    #[inline(never)] // size: docs/size.md, rule 3
    fn leave(&mut self) {
        if let (None, true, Path::Move | Path::Ended, Some(current)) = (
            self.job.left,
            plays(self.state),
            self.travel.path,
            &self.travel.current,
        ) {
            self.job.left = Some(Interruption {
                number: current.number,
                at: self.travel.position.tick,
            });
        }
    }

    /// The job is over: a host is told where it was left, if it was.
    #[inline(never)] // size: docs/size.md, rule 3
    fn tell_left(&mut self) {
        if let Some(left) = self.job.left.take()
            && self.ends.shared().is_some()
        {
            self.job.interrupted = Some(left);
        }
    }

    /// The platform stands at `pose`.
    fn standing(pose: Pose<N>) -> Setpoint<N> {
        let zero = Vector3::new(N::ZERO, N::ZERO, N::ZERO);
        Setpoint {
            pose,
            velocity: zero,
            acceleration: zero,
        }
    }
}

/// Returns true if a job is under way in `state`, and may go on.
fn plays(state: State) -> bool {
    matches!(state, State::Running | State::Slowing | State::Holding)
}

/// Part of a move with rates of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Part {
    index: u32,
    /// Tick of the move at which it ends.
    end: u32,
    pace: Pace,
}

impl Part {
    /// That of a recovery: the ramp is part of its check.
    const WHOLE: Self = Self {
        index: 0,
        end: u32::MAX,
        pace: Pace::FULL,
    };
}

/// Counts to take fractions of.
struct Counts<N: Number> {
    /// T, for the pace.
    level: N::Count,
    /// 2 T, for the position within a tick.
    part: N::Count,
    /// For the change of the pace in a tick.
    change: N::Count,
}

impl<N: Number> Counts<N> {
    fn new(feed: &FeedScale) -> Self {
        Self {
            level: N::count(feed.top()),
            part: N::count(2 * feed.top()),
            change: N::count(u32::from(FULL)),
        }
    }
}

/// u' on a ramp of `ramp` ticks: 1 / (R dt).
pub(super) fn slope<N: Number>(ramp: u16, period: N::Factor) -> N::Factor {
    N::factor_over(N::quotient(1, u32::from(ramp.max(1))), period)
}
