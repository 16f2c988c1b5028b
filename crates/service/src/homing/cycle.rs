//! The motors on their way to their switches or stops.

use super::Progress;
use super::coefficients::{HomingAxis, HomingCoefficients};
use super::input::Input;
use super::parameters::Contact;
use crate::feature::Optional;
use crate::feedback::Readings;
use trirrr_core::number::Number;
use trirrr_core::setpoint::{JointMove, JointSetpoint};
use trirrr_core::setpoint::{shorter_way, wrapped};
use trirrr_core::tick::Motor;
use trirrr_protocol::message::FaultCode;

/// Stages there may be.
const STAGES: u8 = 3;

/// Homing of a machine, and where it stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Cycle<'a, N: Number, O = ()> {
    coefficients: &'a HomingCoefficients<N>,
    /// Encoder offsets that the coefficients do not have, in a scene that can be changed.
    offsets: O,
    searches: [Search<N>; 3],
    phase: Phase<N>,
    /// Ticks of the phase that are over.
    ticks: u32,
    stage: u8,
    shift: Option<[N::Angle; 3]>,
}

/// Knowledge of one motor so far.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Search<N: Number> {
    input: Input,
    /// Angle of the motor when its input last began to change; at a stop that is felt by the torque, its measured one.
    changed_at: N::Angle,
    /// Angle of the motor when its input closed; none while it is on its way.
    found: Option<N::Angle>,
}

/// Action of the motors of a stage.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Phase<N: Number> {
    /// Nothing is under way.
    Ended,
    /// They stand until the inputs are settled.
    Settling(After),
    /// They run towards the reference, in the first approach or the second.
    Running(Approach),
    /// They move back.
    Backing(JointMove<N>, After),
    /// They come to rest, and it is given up.
    Stopping,
}

/// Approaches to a reference.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Approach {
    Search,
    Latch,
}

/// Movement after which the motors stand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum After {
    /// Nothing yet.
    Beginning,
    /// They have left switches that were closed at the start.
    Leaving,
    Search,
    Latch,
}

impl<N: Number> HomingAxis<N> {
    /// Returns true if a motor with this torque presses against its stop.
    fn presses(&self, torque: N) -> bool {
        match self.search > N::ZERO {
            true => torque >= self.stall_torque,
            false => torque <= self.stall_torque,
        }
    }

    /// The rate a tick after `rate`, on the way to `wanted`, and the acceleration until then.
    fn towards(&self, rate: N, wanted: N) -> (N, N) {
        let missing = wanted - rate;
        if missing > self.slope {
            (rate + self.slope, self.acceleration)
        } else if missing < -self.slope {
            (rate - self.slope, -self.acceleration)
        } else if missing > N::ZERO {
            (wanted, self.acceleration)
        } else if missing < N::ZERO {
            (wanted, -self.acceleration)
        } else {
            (wanted, N::ZERO)
        }
    }
}

impl<'a, N: Number, O: Optional<Option<[N::Angle; 3]>>> Cycle<'a, N, O> {
    /// Before it has begun.
    pub(crate) fn new(coefficients: &'a HomingCoefficients<N>, offsets: O) -> Self {
        let search = |axis: &HomingAxis<N>| Search {
            input: Input::default(),
            changed_at: axis.contact,
            found: None,
        };
        Self {
            coefficients,
            offsets,
            searches: coefficients.axes.each_ref().map(search),
            phase: Phase::Ended,
            ticks: 0,
            stage: 0,
            shift: None,
        }
    }

    pub(crate) fn listen(
        &mut self,
        inputs: [bool; 3],
        motors: &[Motor<N>; 3],
        readings: Option<&Readings<N>>,
    ) {
        self.shift = None;
        let HomingCoefficients {
            contact,
            debounce_ticks,
            axes,
            ..
        } = self.coefficients;
        if let (Contact::Torque, Some(readings)) = (contact, readings) {
            let parts = self.searches.iter_mut().zip(axes).zip(readings);
            for ((search, axis), reading) in parts {
                search
                    .input
                    .read(axis.presses(reading.torque), *debounce_ticks);
                search.changed_at = reading.angle;
            }
            return;
        }
        for ((search, closed), motor) in self.searches.iter_mut().zip(inputs).zip(motors) {
            if search.input.read(closed, *debounce_ticks) {
                search.changed_at = motor.angle;
            }
        }
    }

    pub(crate) fn stalled(&self, motors: &[Motor<N>; 3]) -> Option<u8> {
        if !self.coefficients.stall_is_fault || self.is_under_way() {
            return None;
        }
        let mut all = self.searches.iter().zip(motors);
        let stalls = |(search, motor): (&Search<N>, &Motor<N>)| {
            search.input.is_closed() && motor.rate != N::ZERO
        };
        all.position(stalls).map(|motor| motor as u8)
    }

    pub(crate) fn begin(&mut self) {
        let stages = self.coefficients.axes.iter().map(|axis| axis.stage);
        self.enter_stage(stages.min().unwrap_or(0));
    }

    pub(crate) fn stop(&mut self) {
        // Once: each would begin the ramp anew.
        if !matches!(self.phase, Phase::Ended | Phase::Stopping) {
            self.enter(Phase::Stopping);
        }
    }

    pub(crate) fn abandon(&mut self) {
        self.enter(Phase::Ended);
    }

    pub(crate) fn is_under_way(&self) -> bool {
        self.phase != Phase::Ended
    }

    pub(crate) fn add_offsets(&mut self, by: [N::Angle; 3]) {
        if let Some(offsets) = self.offsets.get_mut() {
            let mut sum = offsets.unwrap_or([N::angle(N::ZERO); 3]);
            for (offset, by) in sum.iter_mut().zip(by) {
                *offset = *offset + by;
            }
            *offsets = Some(sum);
        }
    }

    pub(crate) fn shift(&self) -> Option<[N::Angle; 3]> {
        self.shift
    }

    pub(crate) fn advance(&mut self, motors: &[Motor<N>; 3]) -> Progress<N> {
        self.ticks = self.ticks.saturating_add(1);
        match self.phase {
            Phase::Ended => Progress::Stopped,
            Phase::Settling(after) => {
                if self.ticks > u32::from(self.coefficients.debounce_ticks) {
                    self.go_on(after, motors)
                } else {
                    Progress::Moving(standing(motors))
                }
            }
            Phase::Running(approach) => self.run(approach, motors),
            Phase::Backing(path, after) => {
                if self.ticks >= path.ticks() {
                    self.enter(Phase::Settling(after));
                    return Progress::Moving(path.between(path.ticks(), None));
                }
                Progress::Moving(path.between(self.ticks, None))
            }
            Phase::Stopping => {
                if motors.iter().all(|motor| motor.rate == N::ZERO) {
                    self.enter(Phase::Ended);
                    return Progress::Stopped;
                }
                self.turn(motors, |_, _| N::ZERO)
            }
        }
    }

    fn enter(&mut self, phase: Phase<N>) {
        self.phase = phase;
        self.ticks = 0;
    }

    fn enter_stage(&mut self, stage: u8) {
        self.stage = stage;
        self.enter(Phase::Settling(After::Beginning));
    }

    fn enter_approach(&mut self, approach: Approach) {
        for search in &mut self.searches {
            search.found = None;
        }
        self.enter(Phase::Running(approach));
    }

    /// Starts the next phase once the motors have stood long enough for their inputs to be true.
    fn go_on(&mut self, after: After, motors: &[Motor<N>; 3]) -> Progress<N> {
        let (axes, stage) = (&self.coefficients.axes, self.stage);
        let feels = self.coefficients.contact != Contact::Unfelt;
        let is_closed = |axis: &HomingAxis<N>, search: &Search<N>| {
            feels && axis.stage == stage && search.input.is_closed()
        };
        let closed = axes
            .iter()
            .zip(&self.searches)
            .position(|(axis, search)| is_closed(axis, search));
        match (after, closed) {
            (After::Beginning, Some(_)) => {
                self.back_off(motors, After::Leaving, |axis, search, at| {
                    match is_closed(axis, search) {
                        true => at + N::angle(axis.leave),
                        false => at,
                    }
                });
            }
            (After::Leaving, Some(motor)) => {
                let code = FaultCode::HomingClosedAtStart;
                return self.fail(code, motor, |axis| axis.leave.abs());
            }
            (After::Search | After::Latch, Some(motor)) => {
                let code = FaultCode::HomingNotReleased;
                return self.fail(code, motor, |axis| axis.back.abs());
            }
            (After::Beginning | After::Leaving, None) => self.enter_approach(Approach::Search),
            (After::Search, None) => self.enter_approach(Approach::Latch),
            (After::Latch, None) => {
                let is_left = |next: &u8| axes.iter().any(|axis| axis.stage == *next);
                let Some(next) = (stage + 1..STAGES).find(is_left) else {
                    self.enter(Phase::Ended);
                    return Progress::Done;
                };
                self.enter_stage(next);
            }
        }
        Progress::Moving(standing(motors))
    }

    /// A tick of an approach.
    fn run(&mut self, approach: Approach, motors: &[Motor<N>; 3]) -> Progress<N> {
        let mut motors = *motors;
        let contact = self.coefficients.contact;
        let references = approach == Approach::Latch || contact == Contact::Unfelt;
        if let Err((motor, limit)) = self.look(approach, references, &mut motors) {
            return self.fail(FaultCode::HomingNotFound, motor, |_| limit);
        }
        let stage = self.stage;
        let axes = self.coefficients.axes.iter().zip(&self.searches);
        let are_there = axes.zip(&motors).all(|((axis, search), motor)| {
            axis.stage != stage || search.found.is_some() && motor.rate == N::ZERO
        });
        if !are_there {
            return self.turn(&motors, |axis, search| match (search.found, approach) {
                (Some(_), _) => N::ZERO,
                (None, Approach::Search) => axis.search,
                (None, Approach::Latch) => axis.latch,
            });
        }
        let after = match references {
            true => After::Latch,
            false => After::Search,
        };
        self.back_off(&motors, after, |axis, search, at| match search.found {
            Some(_) if axis.stage == stage && references => axis.park,
            Some(found) if axis.stage == stage => found + N::angle(axis.back),
            _ => at,
        });
        Progress::Moving(standing(&motors))
    }

    /// Finds the motors that are there. With `references`, it sets their angles from the reference.
    ///
    /// # Errors
    /// Returns a motor that should be there, and how far it may go.
    fn look(
        &mut self,
        approach: Approach,
        references: bool,
        motors: &mut [Motor<N>; 3],
    ) -> Result<(), (usize, N)> {
        let HomingCoefficients {
            contact,
            times,
            axes,
            ..
        } = self.coefficients;
        let most = match approach {
            Approach::Search => &times.search,
            Approach::Latch => &times.latch,
        };
        let offsets = self.offsets.get().and_then(Option::as_ref);
        let mut shifts = [N::angle(N::ZERO); 3];
        let parts = axes.iter().zip(&mut self.searches).zip(motors).zip(most);
        for (index, (((axis, search), motor), most)) in parts.enumerate() {
            if axis.stage != self.stage || search.found.is_some() {
                continue;
            }
            let (closed, over) = (search.input.is_closed(), self.ticks > *most);
            let at = match contact {
                Contact::Switch | Contact::Torque if closed => search.changed_at,
                // The commanded angle went on while the motor stood.
                Contact::Stall if closed => motor.angle,
                Contact::Unfelt if over => motor.angle,
                _ if over => {
                    let limit = match approach {
                        Approach::Search => axis.travel,
                        Approach::Latch => axis.back.abs() + axis.back.abs(),
                    };
                    return Err((index, limit));
                }
                _ => continue,
            };
            search.found = Some(at);
            let offset = offsets.and_then(|all| all.get(index));
            let reference = match offset {
                Some(offset) => wrapped::<N>(axis.contact + *offset),
                None => axis.contact,
            };
            if *contact != Contact::Switch {
                // It stands already.
                motor.rate = N::ZERO;
            }
            if references {
                let passed = shorter_way::<N>(motor.angle - at);
                let angle = wrapped::<N>(reference + N::angle(passed));
                if let Some(shift) = shifts.get_mut(index) {
                    *shift = angle - motor.angle;
                }
                motor.angle = angle;
                self.shift = Some(shifts);
            }
            if *contact == Contact::Torque {
                // The command is ahead of the joint by what presses it: it comes back.
                motor.angle = match references {
                    true => reference,
                    false => at,
                };
            }
        }
        Ok(())
    }

    /// The motors of the stage take the rates that `wanted` gives, the others stand.
    fn turn(
        &self,
        motors: &[Motor<N>; 3],
        wanted: impl Fn(&HomingAxis<N>, &Search<N>) -> N,
    ) -> Progress<N> {
        let mut joints = standing(motors);
        let parts = joints.angles.iter_mut().zip(&mut joints.rates);
        let parts = parts.zip(&mut joints.accelerations).zip(motors);
        let axes = self.coefficients.axes.iter().zip(&self.searches);
        for ((axis, search), (((angle, rate), acceleration), motor)) in axes.zip(parts) {
            if axis.stage != self.stage {
                continue;
            }
            (*rate, *acceleration) = axis.towards(motor.rate, wanted(axis, search));
            let mean = (motor.rate + *rate) * N::HALF;
            let way = mean.scaled(self.coefficients.period);
            *angle = wrapped::<N>(motor.angle + N::angle(way));
        }
        Progress::Moving(joints)
    }

    /// The motors move to where `target` says, from where they stand.
    fn back_off(
        &mut self,
        motors: &[Motor<N>; 3],
        after: After,
        target: impl Fn(&HomingAxis<N>, &Search<N>, N::Angle) -> N::Angle,
    ) {
        let HomingCoefficients {
            times,
            axes,
            period,
            ..
        } = self.coefficients;
        let from = motors.each_ref().map(|motor| motor.angle);
        let mut to = from;
        for ((axis, search), to) in axes.iter().zip(&self.searches).zip(&mut to) {
            *to = wrapped::<N>(target(axis, search, *to));
        }
        let path = JointMove::new(from, to, times.back_off, *period);
        self.enter(Phase::Backing(path, after));
    }

    fn fail(
        &self,
        code: FaultCode,
        motor: usize,
        limit: impl Fn(&HomingAxis<N>) -> N,
    ) -> Progress<N> {
        Progress::Failed {
            code,
            motor: motor as u8,
            limit: self.coefficients.axes.get(motor).map_or(N::ZERO, limit),
        }
    }
}

/// The motors wait where they are.
fn standing<N: Number>(motors: &[Motor<N>; 3]) -> JointSetpoint<N> {
    JointSetpoint {
        angles: motors.each_ref().map(|motor| motor.angle),
        rates: [N::ZERO; 3],
        accelerations: [N::ZERO; 3],
    }
}
