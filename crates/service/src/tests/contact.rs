//! Contacts: what is one, what the machine does, and what is none.

use super::*;
use trirrr_core::machine::Geometry;
use trirrr_protocol::message::{DriveReading, DriveState, Fault, FaultCode};

crate::scene! {
    /// The thesis machine, which feels what pushes it, and retreats.
    pub(super) Felt [N: ServiceNumber] [N]: Thesis<N>,
    batches = On, update = NoImage, feedback = On, contact = On, retreat = On
}

const FORCE_N: f64 = 1.0;
const MOMENT_NM: f64 = 0.05;

fn contact(reaction: StopCategory) -> ContactParameters {
    ContactParameters {
        force_n: FORCE_N,
        torque_nm: MOMENT_NM,
        bandwidth_hz: 20.0,
        confirm_ticks: 3,
        model_ticks: 4,
        coulomb_nm: [0.0; 3],
        viscous_nm_s_rad: [0.0; 3],
        sliding_rad_s: 0.05,
        late_ticks: 0,
        told_after: 0.0,
        reaction,
        retreat_ticks: 0,
    }
}

/// Machine whose drives hold it where it is told, against `external` torques of the joints.
struct Rig<N: ServiceNumber> {
    bench: Bench<Felt<N>>,
    external: [f64; 3],
    age: u16,
    /// The drives tell of the command before so many others.
    late: usize,
    commanded: Vec<Output<N>>,
    last: Output<N>,
}

impl<N: ServiceNumber> Rig<N> {
    fn new(contact: &ContactParameters) -> Self {
        let geometry = Geometry::<N>::build(&example()).unwrap();
        let watch = FeedbackParameters {
            timeout_ticks: 40,
            enable_ticks: 100,
            still_rad: 1e-3,
            standing_rad: 0.01,
            moving_rad: 0.05,
            window_ticks: 3,
        };
        let feedback = FeedbackCoefficients::build(&watch, &example(), &geometry, home()).unwrap();
        let coefficients = ContactCoefficients::build(contact, PERIOD_S).unwrap();
        let scene = SceneParts {
            feedback: Some(Box::leak(Box::new(feedback))),
            contact: Some(Box::leak(Box::new(coefficients))),
            ..Adjustable::new(example(), LimitParameters::default()).into()
        };
        let bench = Bench::off(scene, home(), settings());
        let last = *bench.service.output();
        let mut rig = Self {
            bench,
            external: [0.0; 3],
            age: 0,
            late: contact.late_ticks.into(),
            commanded: std::vec![last; 8],
            last,
        };
        rig.ticks(3);
        rig.bench.done(Command::Enable);
        rig.ticks(40);
        assert_eq!(rig.bench.state(), State::Idle);
        rig
    }

    fn tick(&mut self) {
        let readings = [0, 1, 2].map(|leg| {
            let told = &self.commanded[self.commanded.len() - 1 - self.late];
            let motor = &told.motors[leg];
            DriveReading {
                state: match self.last.is_on() {
                    true => DriveState::On,
                    false => DriveState::Off,
                },
                age: self.age,
                state_age: 0,
                rate: motor.rate,
                // What the drive does not have to give.
                torque: motor.torque - N::from_f64(self.external[leg]),
                ..DriveReading::unheard(self.last.motors[leg].angle)
            }
        });
        self.bench.service.hear(readings);
        self.last = *self.bench.service.tick();
        self.commanded.push(self.last);
        while self.bench.service.step() {}
        while self.bench.service.outgoing().is_some() {}
    }

    fn ticks(&mut self, ticks: u32) {
        for _ in 0..ticks {
            self.tick();
        }
    }

    /// Torques of the joints by which `wrench` at the tool pushes the machine, at the start: K^T of the rates.
    fn push(&mut self, [x, y, moment]: [f64; 3]) {
        let tick = trirrr_core::tick::Tick::<Dynamic<f64>>::build(&example()).unwrap();
        let rates = |velocity: [f64; 3]| {
            let setpoint = trirrr_core::setpoint::Setpoint {
                pose: home(),
                velocity: velocity.into(),
                acceleration: [0.0; 3].into(),
            };
            let motion = tick.evaluate(&setpoint).unwrap();
            motion.motors.map(|motor| motor.rate)
        };
        // The power of the push is that of the torques, along each axis: three equations, solved by cross products.
        let [a, b, c] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
            .map(|axis| nalgebra::Vector3::<f64>::from(rates(axis)));
        let det: f64 = a.dot(&b.cross(&c));
        let torques = (b.cross(&c) * x + c.cross(&a) * y + a.cross(&b) * moment) * (1.0 / det);
        self.external = torques.into();
    }

    fn fault(&mut self) -> Option<Fault<N>> {
        self.bench.status().fault
    }

    fn start(&mut self, ticks: u32) {
        let status = self.bench.status();
        let from = status.end.unwrap().pose;
        self.bench
            .offer(rest(status.next, from, pose(0.28, 0.28, 0.2), ticks));
        self.bench.done(Command::Start);
        self.ticks(2);
    }
}

/// A force a tenth beyond the threshold is told as it is, one a tenth below is none; in whatever direction.
fn thresholds_hold<N: ServiceNumber>() {
    for step in 0..8 {
        let (sin, cos) = f64::sin_cos(0.8 * f64::from(step));
        for (size, felt) in [(0.9, false), (1.1, true)] {
            let mut rig = Rig::<N>::new(&contact(StopCategory::StopAndHold));
            rig.push([size * FORCE_N * cos, size * FORCE_N * sin, 0.0]);
            rig.ticks(100);
            let fault = rig.fault();
            assert_eq!(
                fault.map(|fault| fault.code),
                felt.then_some(FaultCode::Contact)
            );
            if let Some(fault) = fault {
                let value = fault.value.to_f64();
                assert!((1.0..1.1001).contains(&value), "{value}");
                assert_eq!((fault.index, fault.limit.to_f64()), (None, FORCE_N));
            }
        }
    }
}

#[test]
fn a_force_beyond_the_threshold_is_a_contact() {
    thresholds_hold::<f64>();
    thresholds_hold::<f32>();
}

#[test]
fn a_moment_beyond_its_threshold_is_a_contact() {
    for (size, felt) in [(0.9, None), (-1.1, Some(FaultCode::ContactMoment))] {
        let mut rig = Rig::<f64>::new(&contact(StopCategory::StopAndHold));
        rig.push([0.0, 0.0, size * MOMENT_NM]);
        rig.ticks(100);
        let fault = rig.fault();
        assert_eq!(fault.map(|fault| fault.code), felt);
        if let Some(fault) = fault {
            assert!(
                fault.value < -MOMENT_NM && fault.value > 1.1001 * -MOMENT_NM,
                "{fault:?}"
            );
        }
    }
}

/// The push goes on over the whole reaction: no second fault, which would let go of the platform.
#[test]
fn the_machine_reacts_as_the_scene_says() {
    for (reaction, is_on) in [
        (StopCategory::Off, false),
        (StopCategory::StopThenOff, false),
        (StopCategory::StopAndHold, true),
    ] {
        let mut rig = Rig::<f64>::new(&contact(reaction));
        rig.start(200);
        rig.ticks(50);
        rig.push([3.0, 0.0, 0.0]);
        let mut states = Vec::new();
        for _ in 0..60 {
            rig.tick();
            let state = rig.bench.state();
            if states.last() != Some(&state) {
                states.push(state);
            }
        }
        let expected: &[State] = match reaction {
            StopCategory::Off => &[State::Running, State::Fault],
            _ => &[State::Running, State::Reacting, State::Fault],
        };
        assert_eq!(
            (&states[..], rig.last.is_on()),
            (expected, is_on),
            "{reaction:?}"
        );
        if !is_on {
            continue;
        }
        // Cleared while it is still pushed, it feels that again; let go, it works.
        rig.bench.done(Command::ClearFault);
        rig.ticks(30);
        assert_eq!(rig.bench.state(), State::Fault);
        rig.external = [0.0; 3];
        rig.bench.done(Command::ClearFault);
        rig.ticks(30);
        assert_eq!((rig.bench.state(), rig.fault()), (State::Idle, None));
    }
}

/// A push for less than the confirming ticks is none; neither are drives that say nothing for some ticks, nor old readings.
#[test]
fn a_knock_and_late_readings_are_no_contact() {
    let mut rig = Rig::<f64>::new(&contact(StopCategory::Off));
    rig.push([3.0, 0.0, 0.0]);
    rig.ticks(2);
    rig.external = [0.0; 3];
    rig.ticks(100);
    assert_eq!(rig.fault(), None);
    rig.push([0.5, 0.0, 0.0]);
    for age in [3, 15, 16, 30, 0, 20, 1, 0] {
        rig.age = age;
        rig.ticks(5);
        assert_eq!(rig.fault(), None, "{age}");
    }
}

/// Old readings are compared with the commands of their ticks: a motion is no contact.
#[test]
fn a_motion_is_no_contact_whatever_the_age_of_the_readings() {
    for late_ticks in [0, 1, 4] {
        let parameters = ContactParameters {
            late_ticks,
            force_n: 1e-9,
            torque_nm: 1e-9,
            ..contact(StopCategory::Off)
        };
        let mut rig = Rig::<f64>::new(&parameters);
        let mut moved = false;
        rig.start(40);
        for _ in 0..60 {
            rig.tick();
            moved |= rig.last.motors[0].rate != 0.0;
            assert_eq!(rig.fault(), None, "{late_ticks}");
        }
        assert!(moved);
    }
}

/// Ticks of a move of [`Rig::start_curve`], and the number of moves.
const CURVE_TICKS: u32 = 15;
const CURVE_MOVES: u32 = 7;

impl Rig<f64> {
    /// Starts along an arc of 4 cm radius, in moves that chain without a stop.
    fn start_curve(&mut self) {
        let status = self.bench.status();
        // Where the drives told it is.
        let from = status.end.unwrap().pose;
        let place = |index: u32| {
            if index == 0 {
                return from;
            }
            let (sin, cos) = f64::sin_cos(0.3 * f64::from(index));
            pose(0.21 + 0.04 * (1.0 - cos), 0.22 + 0.04 * sin, 0.157)
        };
        let velocity = |index: u32| {
            let (sin, cos) = f64::sin_cos(0.3 * f64::from(index));
            let speed = 0.3 * 0.04 / (f64::from(CURVE_TICKS) * PERIOD_S);
            let inside = index > 0 && index < CURVE_MOVES;
            [speed * sin, speed * cos, 0.0].map(|part| if inside { part } else { 0.0 })
        };
        for index in 0..CURVE_MOVES {
            self.bench.offer(trirrr_protocol::message::Move {
                start_velocity: velocity(index),
                end_velocity: velocity(index + 1),
                tool_power: 0.5,
                ..rest(
                    status.next + index,
                    place(index),
                    place(index + 1),
                    CURVE_TICKS,
                )
            });
        }
        self.bench.done(Command::Start);
    }

    fn angles(&self) -> [f64; 3] {
        self.last.motors.map(|motor| motor.angle)
    }
}

/// Wherever on its path a contact comes, the machine goes back on it: over joints that it has passed, no faster than it came,
/// without a jump, by the time that the scene says or to the start.
#[test]
fn after_a_contact_the_machine_goes_back_on_its_path() {
    // The greatest joint rate of the job at normal speed.
    let mut rig = Rig::<f64>::new(&contact(StopCategory::Off));
    rig.start_curve();
    let rates = core::iter::repeat_with(|| {
        rig.tick();
        rig.last.motors.map(|motor| motor.rate.abs())
    });
    let normal = rates.take(110).flatten().fold(0.0, f64::max);
    for (reaction, is_on) in [
        (StopCategory::StopAndHold, true),
        (StopCategory::StopThenOff, false),
    ] {
        for retreat_ticks in [0, 20, 300] {
            for at in (2..100).step_by(9) {
                let mut rig = Rig::<f64>::new(&ContactParameters {
                    retreat_ticks,
                    ..contact(reaction)
                });
                rig.start_curve();
                let mut way = Vec::from([rig.angles()]);
                for _ in 0..at {
                    rig.tick();
                    way.push(rig.angles());
                }
                rig.push([3.0, 0.0, 0.0]);
                let mut rates = rig.last.motors.map(|motor| motor.rate);
                let (mut turned, mut fastest) = (None, 0.0_f64);
                while rig.bench.state() != State::Fault {
                    rig.tick();
                    assert!(way.len() < 2000, "never at rest");
                    assert!(rig.last.tool == 0.0 || rig.bench.state() == State::Running);
                    if !rig.last.is_on() {
                        break;
                    }
                    let motors = &rig.last.motors;
                    for (motor, rate) in motors.iter().zip(&rates) {
                        let change = (motor.rate - rate) / PERIOD_S;
                        assert!(change.abs() < 12.0, "{at}: {change} rad/s^2");
                    }
                    rates = motors.each_ref().map(|motor| motor.rate);
                    let rests = rates.iter().all(|rate| *rate == 0.0);
                    if rests && turned.is_none() && rig.bench.state() == State::Reacting {
                        turned = Some(way.len());
                    }
                    if turned.is_some() {
                        fastest = rates
                            .iter()
                            .fold(fastest, |most, rate| most.max(rate.abs()));
                    }
                    way.push(rig.angles());
                }
                assert_eq!(rig.last.is_on(), is_on);
                let moved_back = turned.is_some_and(|turned| {
                    let (there, end) = (way[turned], way.last().unwrap());
                    (0..3).any(|i| there[i] != end[i])
                });
                assert_eq!(moved_back, retreat_ticks > 0, "{reaction:?} {at}");
                let Some(turned) = turned.filter(|_| moved_back) else {
                    continue;
                };
                assert!(fastest <= 0.5001 * normal, "{fastest} of {normal}");
                // Each place of the way back lies on the way there, further and further back.
                let near = |place: &[f64; 3], index: usize| {
                    let [a, b] = [way[index], way[index + 1]];
                    let along = [0, 1, 2].map(|i| b[i] - a[i]);
                    let square: f64 = along.iter().map(|each| each * each).sum();
                    let dot: f64 = (0..3).map(|i| along[i] * (place[i] - a[i])).sum();
                    let share = (dot / square.max(1e-30)).clamp(0.0, 1.0);
                    (0..3)
                        .map(|i| (place[i] - a[i] - share * along[i]).powi(2))
                        .sum::<f64>()
                        .sqrt()
                };
                let mut index = turned - 1;
                for place in &way[turned..] {
                    while index > 0 && near(place, index) > 3e-5 {
                        index -= 1;
                    }
                    assert!(near(place, index) <= 3e-5, "{at}: {}", near(place, index));
                }
                if retreat_ticks == 300 {
                    // The start of the job, but for the rest of a tick.
                    let off = (0..3).map(|i| (way.last().unwrap()[i] - way[0][i]).abs());
                    assert!(off.fold(0.0, f64::max) < 2e-3, "{at}");
                }
            }
        }
    }
}

/// What did not come by a contact is no reason to go back; nor does a machine that stands begin to move.
#[test]
fn only_a_contact_in_motion_makes_the_machine_go_back() {
    let parameters = ContactParameters {
        retreat_ticks: 50,
        ..contact(StopCategory::StopAndHold)
    };
    let mut rig = Rig::<f64>::new(&parameters);
    let stands = rig.angles();
    rig.push([3.0, 0.0, 0.0]);
    rig.ticks(100);
    assert_eq!((rig.bench.state(), rig.angles()), (State::Fault, stands));
    let mut rig = Rig::<f64>::new(&parameters);
    rig.start_curve();
    rig.ticks(50);
    rig.bench.done(Command::Stop);
    rig.ticks(40);
    assert_eq!(rig.bench.state(), State::Idle);
    let stands = rig.angles();
    rig.push([3.0, 0.0, 0.0]);
    rig.ticks(100);
    assert_eq!((rig.bench.state(), rig.angles()), (State::Fault, stands));
}

/// A machine that goes back comes to rest as soon as it can when it is told to, by a stop or by switching it off.
#[test]
fn a_stop_ends_the_way_back() {
    for command in [Command::Stop, Command::Disable] {
        let mut rig = Rig::<f64>::new(&ContactParameters {
            retreat_ticks: 300,
            ..contact(StopCategory::StopAndHold)
        });
        rig.start_curve();
        rig.ticks(90);
        rig.push([3.0, 0.0, 0.0]);
        // The way back begins; alone it would take some 150 ticks.
        rig.ticks(45);
        assert_eq!(rig.bench.state(), State::Reacting);
        let rate = rig.last.motors[0].rate;
        assert!(rate != 0.0);
        rig.bench.done(command);
        let mut ticks = 0;
        while rig.bench.state() == State::Reacting {
            rig.tick();
            let rates = rig.last.motors.map(|motor| motor.rate);
            assert!(rates[0] * rate >= 0.0, "it turns round");
            ticks += 1;
        }
        assert_eq!(rig.bench.state(), State::Fault);
        // Half of the ramp's own time, where the limits leave room for it.
        assert!(
            ticks <= u32::from(RAMP) / 2 + 2,
            "{command:?}: {ticks} ticks"
        );
        rig.ticks(5);
        assert!(rig.last.is_on() && rig.last.motors[0].rate == 0.0);
    }
}
