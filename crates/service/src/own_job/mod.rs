//! Job of a machine without a host: the moves are constants, proven when the program is built, and a button or the supply begins it.
//!
//! The tick is that of every machine, its states too; what takes the place of the background is [`OwnJob`]: it hands out the moves of the
//! job, and gives the orders that a host would give.
//!
//! | state | at the button |
//! |---|---|
//! | `Disabled` | the drives go on, the motors are homed where they have to be, and the job begins |
//! | `Idle`, `Unhomed`, `Cleared` | the same without the drives |
//! | `Holding`, behind a door that is closed again | the job goes on |
//! | `Fault` | the fault is acknowledged, where homing finds the motors again; else the machine stays there |
//!
//! A press counts once the button was released, while the emergency stop is released and the door closed. What is under way goes on
//! whatever the button does. Nothing begins by itself but the job of a machine that begins it with the supply, once.

use crate::feature::Feature;
use crate::foreground::{Foreground, TickEnds, TickFeatures};
use crate::handoff::{Ahead, QueuedMove, Recover, SharedCounters};
use crate::homing::{Cycle, HomingCoefficients};
use crate::interlock::{
    ButtonInput, DebouncedInput, InterlockParameters, InterlockReadings, Interlocks, input_bits,
};
use crate::number::ServiceNumber;
use crate::pace::Room;
use crate::scene::{CurvesOf, Machine, ModelOf, Scene, Setup};
use crate::settings::Settings;
use trirrr_core::limits::Limits;
use trirrr_core::machine::Geometry;
use trirrr_core::number::Arithmetic;
use trirrr_core::setpoint::{JointMove, Pose, Setpoint};
use trirrr_core::status::Status;
use trirrr_core::tick::Tick;
use trirrr_core::to_source;
use trirrr_protocol::message::{Fault, State};

/// Number of passes of a job that is repeated until something stops it.
pub const FOREVER: u32 = u32::MAX;

/// Event that begins the job.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JobStart {
    /// The button is pressed.
    Button,
    /// The board is switched on or reset. A failure of its program is none.
    Power,
}

to_source!(pub JobStart in trirrr_service::features: Button, Power);

/// Homing, and the way from where it ends to the start of the job.
pub type OwnHoming<'q, N> = (&'q HomingCoefficients<N>, &'q Recover<N>);

/// All that a machine without a host is built from, in its units.
pub struct OwnJobParts<'q, S: Scene> {
    /// Coefficients of the tick.
    pub tick: &'q Tick<ModelOf<S>>,
    /// Limits of the machine.
    pub limits: &'q Limits<S::N>,
    /// Moves of the job, admitted one behind the other. The last ends at rest; with more than one pass, or with a button, where the first
    /// begins.
    pub moves: &'q [QueuedMove<S::N, CurvesOf<S>>],
    /// Passes of the job; [`FOREVER`].
    pub passes: u32,
    /// Pose at which the job begins, and at which the machine stands when it is switched on.
    pub start: Pose<S::N>,
    /// Angles of the motors there.
    pub angles: [<S::N as Arithmetic>::Angle; 3],
    /// Event that begins the job.
    pub begins: JobStart,
    /// The button, if there is one.
    pub button: Option<ButtonInput>,
    /// Homing, and the way from where it ends to the start.
    pub homing: Option<OwnHoming<'q, S::N>>,
    /// Emergency stop, door and limit switches.
    pub interlocks: InterlockParameters,
}

impl<N: ServiceNumber> Recover<N> {
    /// Way from where homing ends to its start pose, for ticks of `period`.
    ///
    /// # Errors
    /// A start that the machine cannot reach.
    pub fn from_homing(
        homing: &HomingCoefficients<N>,
        geometry: &Geometry<N>,
        period: N::Factor,
    ) -> Result<Self, Status> {
        let plan = homing.plan();
        let angles = geometry.motor_angles(&geometry.position(&plan.to)?);
        Ok(Self {
            path: JointMove::new(plan.from, angles, plan.ticks, period),
            to: plan.to,
        })
    }
}

/// The job, and what begins it. `PACED`: something may slow the machine down on its path, a door or a stop.
pub struct OwnJob<'q, S: Scene, const PACED: bool> {
    moves: &'q [QueuedMove<S::N, CurvesOf<S>>],
    /// Index of the next move; beyond the last while no job is under way.
    next: usize,
    passes: u32,
    /// Passes that are not over.
    left: u32,
    start: Pose<S::N>,
    way: Option<&'q Recover<S::N>>,
    /// The way is the recovery that waits or is under way.
    on_way: bool,
    button: DebouncedInput,
    is_pressed: bool,
    /// Somebody asked for the job: it is on its way.
    is_wanted: bool,
    /// Ticks until the contacts tell what they are.
    settling: u16,
}

impl<'q, N, S, const PACED: bool> Foreground<'q, S, OwnJob<'q, S, PACED>>
where
    N: ServiceNumber,
    S: Scene<
            N = N,
            Levels = (),
            Feedback = (),
            Contact = (),
            Retreat = (),
            Probe = (),
            Digital = (),
        >,
    S::Machine: Machine<Changes = ()>,
{
    /// Tick of a machine that plays a job of its own. It stands at the start of the job, its drives off.
    pub fn alone(parts: OwnJobParts<'q, S>, settings: &Settings<N>) -> Self {
        const {
            assert!(
                PACED || S::Interlocks::BITS & input_bits::DOOR == 0,
                "a door holds the machine on its path"
            );
        }
        let OwnJobParts { start: pose, .. } = parts;
        let setup = Setup {
            tick: *parts.tick,
            limits: *parts.limits,
            pose,
            shift: None,
        };
        let job = OwnJob {
            moves: parts.moves,
            next: parts.moves.len(),
            passes: parts.passes,
            left: 0,
            start: pose,
            way: parts.homing.map(|(_, way)| way),
            on_way: false,
            button: DebouncedInput::active(parts.button.map_or(1, |button| button.debounce_ticks)),
            is_pressed: false,
            is_wanted: parts.begins == JobStart::Power,
            settling: parts.interlocks.settling_ticks(),
        };
        let features = TickFeatures::<S, ()> {
            splices: (),
            setups: (),
            shifted: (),
            levels: (),
            homing: S::Homing::of(|| {
                let cycle = |(homing, _)| Cycle::new(homing, ());
                parts.homing.map(cycle)
            }),
            feedback: (),
            contact: (),
            trail: (),
            interlocks: S::Interlocks::of(|| Interlocks::new(&parts.interlocks)),
            probe: (),
            digital: (),
        };
        Self::new(setup, parts.angles, settings, job, features)
    }
}

impl<N: ServiceNumber, S: Scene<N = N>, const PACED: bool> TickEnds<S> for OwnJob<'_, S, PACED> {
    type Splices = ();
    const CHANGES_PACE: bool = PACED;
    const IS_WHOLE: bool = true;

    #[inline(always)]
    fn shared(&self) -> Option<&SharedCounters> {
        None
    }

    #[inline(always)]
    fn next_move(&self) -> Option<&QueuedMove<N, CurvesOf<S>>> {
        self.moves.get(self.next)
    }

    #[inline]
    fn take_move(&mut self) -> Option<QueuedMove<N, CurvesOf<S>>> {
        let taken = *self.moves.get(self.next)?;
        self.next += 1;
        if self.next == self.moves.len() && self.left > 1 {
            self.next = 0;
            if self.left != FOREVER {
                self.left -= 1;
            }
        }
        Some(taken)
    }

    #[inline(always)]
    fn fill(&self) -> [usize; 2] {
        [0, usize::MAX]
    }

    #[inline(always)]
    fn ahead(&self) -> Ahead {
        Ahead {
            room: Room::NONE,
            rests: 0,
        }
    }

    #[inline(always)]
    fn drop_moves(&mut self) {
        self.next = self.moves.len();
    }

    #[inline(always)]
    fn recovery(&self) -> Option<&Recover<N>> {
        self.way.filter(|_| S::Homing::EXISTS && self.on_way)
    }

    #[inline(always)]
    fn take_recovery(&mut self) -> Option<Recover<N>> {
        let way = self.recovery().copied();
        self.on_way = false;
        way
    }

    #[inline]
    fn take_order(tick: &mut Foreground<'_, S, Self>) -> bool {
        tick.take_own_order()
    }

    #[inline]
    fn sense(&mut self, readings: InterlockReadings) {
        // Without a button no reading is active.
        self.is_pressed |= self.button.read(readings.button) && self.button.is_active();
    }

    #[inline(always)]
    fn tell_fault(&mut self, _: Fault<N>) {}

    #[inline(always)]
    fn report(_: &mut Foreground<'_, S, Self>, _: &Setpoint<N>) {}
}

impl<N: ServiceNumber, S: Scene<N = N>, const PACED: bool> Foreground<'_, S, OwnJob<'_, S, PACED>> {
    /// Gives the order that this tick needs, and obeys it. Returns true if the job started in it.
    fn take_own_order(&mut self) -> bool {
        let is_pressed = core::mem::take(&mut self.ends.is_pressed);
        if self.ends.settling > 0 {
            self.ends.settling -= 1;
            return false;
        }
        if self.features.is_open() || self.features.is_pressed() {
            self.ends.is_wanted = false;
            return false;
        }
        match self.state {
            State::Disabled | State::Idle | State::Unhomed | State::Cleared => {
                self.ends.is_wanted |= is_pressed;
                self.ends.is_wanted && self.approach_job()
            }
            State::Holding if is_pressed => {
                self.travel.held = false;
                false
            }
            State::Fault => {
                self.ends.is_wanted = false;
                // Motors that lost their places, and cannot find them, stay off.
                if is_pressed && (self.features.needs_homing() || !self.supply.is_lost()) {
                    self.clear_fault();
                }
                false
            }
            _ => false,
        }
    }

    /// Takes the next step to the job, from a machine at rest. Returns true if that is its start.
    #[inline(never)]
    fn approach_job(&mut self) -> bool {
        if self.state == State::Disabled {
            self.enable();
            return false;
        }
        let is_at_start = self.state == State::Idle && self.pose == self.ends.start;
        if is_at_start {
            self.ends.is_wanted = false;
            (self.ends.next, self.ends.left) = (0, self.ends.passes);
            let starts = self.start();
            if !starts {
                self.ends.drop_moves();
            }
            return starts;
        }
        // Away from the start, homing alone leads there.
        self.ends.is_wanted = self.features.needs_homing();
        if self.ends.is_wanted {
            self.ends.on_way = true;
            self.home();
        }
        false
    }
}
