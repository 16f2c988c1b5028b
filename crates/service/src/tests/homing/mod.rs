//! Homing: a machine whose motors are not where they count from, with switches or stops.

mod cycle;
mod faults;
mod random;

use super::*;
use crate::number::ServiceNumber;
use trirrr_core::machine::Geometry;
use trirrr_protocol::message::{DriveReading, DriveState};

/// Stiffness of a drive against a hard stop, N m/rad, and the torque that tells the stop, N m.
const STIFFNESS: f64 = 200.0;
const STALL_TORQUE: f64 = 0.3;

/// Angles of the motors at [`home`], rad.
pub(super) fn home_angles() -> [f64; 3] {
    let geometry = Geometry::<f64>::build(&example()).unwrap();
    geometry.motor_angles(&geometry.position(&home()).unwrap())
}

/// `angle` in (-pi, pi].
pub(super) fn wrapped(angle: f64) -> f64 {
    f64::atan2(f64::sin(angle), f64::cos(angle))
}

/// Switches 0.3 rad from where the motors are at [`home`], all at once.
pub(super) fn parameters(contact: Contact) -> HomingParameters {
    let motor = |angle: f64, positive| HomingMotor {
        angle_rad: wrapped(angle + if positive { 0.3 } else { -0.3 }),
        positive,
        search_rate_rad_s: 0.5,
        latch_rate_rad_s: 0.05,
        acceleration_rad_s2: 1.5,
        back_off_rad: 0.08,
        travel_max_rad: 1.5,
        stall_torque_nm: STALL_TORQUE,
        stage: 0,
    };
    let [a, b, c] = home_angles();
    let pose = home::<f64>();
    timed(HomingParameters {
        contact,
        motors: [motor(a, true), motor(b, false), motor(c, true)],
        debounce_ticks: 3,
        stall_is_fault: false,
        start: [pose.position.x, pose.position.y, pose.angle],
        times: HomingTimes::default(),
    })
}

/// With the times that belong to the rest.
pub(super) fn timed(parameters: HomingParameters) -> HomingParameters {
    HomingParameters {
        times: HomingTimes::new(
            parameters.contact,
            &parameters.motors,
            parameters.debounce_ticks,
            home_angles(),
            PERIOD_S,
            RAMP,
        ),
        ..parameters
    }
}

/// What is wrong with an input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Defect {
    None,
    /// It never closes,
    Open,
    /// or always is.
    Closed,
    /// Once closed, it never opens,
    Sticks,
    /// or it closes once and then never again.
    Once,
    /// It bounces for two ticks whenever it changes.
    Bounces,
}

/// A machine that is homed, with the motors as they truly are.
pub(super) struct Machine<N: ServiceNumber> {
    pub(super) bench: Bench<Homed<N>>,
    pub(super) parameters: HomingParameters,
    /// Where the motors truly are, rad, unwrapped.
    pub(super) truth: [f64; 3],
    pub(super) defects: [Defect; 3],
    /// Whether each input has closed, and opened after that.
    history: [(bool, bool); 3],
    /// Ticks since each switch changed.
    since: [(bool, u32); 3],
    /// A motor is pressed against its stop.
    stalled: [bool; 3],
    before: [f64; 3],
}

impl<N: ServiceNumber> Machine<N> {
    /// Switched on with the motors `offset` rad beyond where they are at [`home`].
    pub(super) fn new(parameters: HomingParameters, offset: [f64; 3]) -> Self {
        let limits = LimitParameters {
            rate_rad_s: Some([1.0; 3]),
            // Fixed point is sure of what is below 2.
            acceleration_rad_s2: Some([1.9; 3]),
            ..LimitParameters::default()
        };
        // Drives tell what the test says, and nobody watches them.
        let scene = SceneParts {
            homing: Some(&*Box::leak(Box::new(HomingCoefficients::build(
                &parameters,
                PERIOD_S,
            )))),
            ..Adjustable::new(example(), limits).into()
        };
        let bench = Bench::of(scene, home());
        let commanded = |motor: &trirrr_core::tick::Motor<N>| N::angle_to_f64(motor.angle);
        let before = bench
            .service
            .foreground
            .output()
            .motors
            .each_ref()
            .map(commanded);
        let angles = home_angles();
        Self {
            bench,
            parameters,
            truth: [0, 1, 2].map(|i| angles[i] + offset[i]),
            defects: [Defect::None; 3],
            history: [(false, false); 3],
            since: [(false, 10); 3],
            stalled: [false; 3],
            before,
        }
    }

    /// How far motor `i` is beyond its reference, towards it.
    pub(super) fn beyond(&self, i: usize) -> f64 {
        let motor = &self.parameters.motors[i];
        let way = wrapped(self.truth[i] - motor.angle_rad);
        motor.sign() * way
    }

    fn input(&mut self, i: usize) -> bool {
        let closed = match self.parameters.contact {
            Contact::Switch => self.beyond(i) >= 0.0,
            Contact::Stall => self.stalled[i],
            Contact::Torque | Contact::Unfelt => false,
        };
        let (was, since) = self.since[i];
        self.since[i] = if was == closed {
            (was, since + 1)
        } else {
            (closed, 0)
        };
        let (once, open) = self.history[i];
        self.history[i] = (once || closed, open || once && !closed);
        match self.defects[i] {
            Defect::None => closed,
            Defect::Open => false,
            Defect::Closed => true,
            Defect::Sticks => closed || once,
            Defect::Once => closed && !open,
            Defect::Bounces if self.since[i].1 == 1 => !closed,
            Defect::Bounces => closed,
        }
    }

    /// Tells the torque of a drive that follows its command, up to its stop.
    fn feel(&mut self) -> [bool; 3] {
        let mut pressed = [false; 3];
        let readings = [0, 1, 2].map(|i| {
            let sign = self.parameters.motors[i].sign();
            let over = self.beyond(i).max(0.0);
            pressed[i] = over > 0.0;
            DriveReading {
                state: DriveState::On,
                torque: N::from_f64(sign * STIFFNESS * over),
                ..DriveReading::unheard(N::angle_from_f64(wrapped(self.before[i] - sign * over)))
            }
        });
        self.bench.service.hear(readings);
        pressed
    }

    /// One tick of service and motors; what holds after any.
    pub(super) fn tick(&mut self) -> Output<N> {
        let pressed = match self.parameters.contact {
            Contact::Torque => self.feel(),
            _ => [false; 3],
        };
        self.bench.inputs = [self.input(0), self.input(1), self.input(2)];
        let rates = self
            .bench
            .service
            .foreground
            .output()
            .motors
            .each_ref()
            .map(|m| m.rate.to_f64());
        let output = self.bench.tick();
        let shift = self.bench.service.foreground.shift();
        let state = self.bench.service.foreground.state();
        for i in 0..3 {
            let (motor, limits) = (&output.motors[i], &self.parameters.motors[i]);
            let angle = N::angle_to_f64(motor.angle);
            let shifted = shift.map_or(0.0, |shift| N::angle_to_f64(shift[i]));
            let moved = wrapped(angle - self.before[i] - shifted);
            self.before[i] = angle;
            self.truth[i] += moved;
            self.stalled[i] = false;
            let loses = matches!(self.parameters.contact, Contact::Stall | Contact::Unfelt);
            if loses && self.beyond(i) > 0.0 {
                // Against the stop: steps are lost.
                let motor = &self.parameters.motors[i];
                self.truth[i] -= self.beyond(i) * motor.sign();
                self.stalled[i] = moved != 0.0;
            }
            let rate = motor.rate.to_f64();
            // A command that led beyond a stop comes back at once.
            let jumps = pressed[i] && self.beyond(i) < 1e-6;
            assert!(moved.abs() < 1.02 * PERIOD_S || jumps, "a jump of {moved}");
            if matches!(state, State::Homing) {
                assert_eq!(motor.torque, N::ZERO);
                let most = limits.search_rate_rad_s * (1.0 + 1e-5);
                assert!(rate.abs() <= most, "{rate}");
                let change = (rate - rates[i]).abs();
                let least = match self.parameters.contact {
                    Contact::Switch => 1.001 * limits.acceleration_rad_s2 * PERIOD_S,
                    // At a stop it stands at once.
                    _ => most,
                };
                assert!(change <= least + 1e-6, "{change}");
            }
        }
        output
    }

    pub(super) fn ticks(&mut self, ticks: u32) {
        for _ in 0..ticks {
            self.tick();
        }
    }

    /// Ticks, with a host that is not silent, until the machine is in `state`.
    #[track_caller]
    pub(super) fn until(&mut self, state: State) {
        for ticks in 0..20_000 {
            self.tick();
            if self.bench.service.foreground.state() == state {
                // So that the host has heard of it.
                self.bench.status();
                return;
            }
            if ticks % 100 == 0 {
                self.bench.ask(Command::Status);
            }
        }
        panic!("never {state:?}, but {:?}", self.bench.status());
    }

    /// Homes the machine, to idle.
    #[track_caller]
    pub(super) fn home(&mut self) {
        self.bench.done(Command::Home);
        self.until(State::Idle);
    }

    /// How far the motors are from where the machine believes them to be.
    pub(super) fn errors(&self) -> [f64; 3] {
        [0, 1, 2].map(|i| wrapped(self.truth[i] - self.before[i]))
    }

    /// Whether they are there, to what the latch rate resolves.
    #[track_caller]
    pub(super) fn is_homed(&mut self) {
        let resolution = 1.05 * PERIOD_S * self.parameters.motors[0].latch_rate_rad_s;
        for (i, error) in self.errors().into_iter().enumerate() {
            // At the closing, the motor may be up to a tick beyond.
            assert!(error.abs() <= resolution + 1e-6, "motor {i}: {error}");
        }
        let status = self.bench.status();
        assert_eq!(status.end.map(|end| end.pose), Some(home()));
        let geometry = Geometry::<N>::build(&example()).unwrap();
        let there = geometry.motor_angles(&geometry.position(&home()).unwrap());
        for (angle, there) in self.before.into_iter().zip(there) {
            let there = N::angle_to_f64(there);
            assert!((angle - there).abs() < 1e-6, "{angle} {there}");
        }
    }
}
