//! A machine that has to be homed, with switches that fail.

use super::super::feedback::angles_at;
use super::super::homing::{home_angles, parameters, timed, wrapped};
use super::*;

/// Most acts on the way to a state in the short search.
const DEPTH: usize = 4;

struct HomedMachine {
    bench: Bench<Homed<f64>>,
    references: [HomingMotor; 3],
    /// Angles of the motors as they truly are, rad, and those that were commanded last.
    truth: [f64; 3],
    commanded: [f64; 3],
    switches: Switches,
}

impl HomedMachine {
    /// Angle of motor `i` beyond its switch, rad.
    fn beyond(&self, i: usize) -> f64 {
        let reference = &self.references[i];
        reference.sign() * wrapped(self.truth[i] - reference.angle_rad)
    }

    /// The switches of the motors, as they are at the end of the last tick.
    fn closed(&self) -> [bool; 3] {
        [0, 1, 2].map(|i| match self.switches {
            Switches::Open => false,
            Switches::Closed => true,
            Switches::FirstClosed if i == 0 => true,
            Switches::True | Switches::FirstClosed => self.beyond(i) >= 0.0,
        })
    }

    fn angles(&self) -> [f64; 3] {
        let motors = &self.bench.service.foreground.output().motors;
        motors.each_ref().map(|motor| motor.angle)
    }
}

impl Explored for HomedMachine {
    type Scene = Homed<f64>;

    const ACTS: &'static [Act] = &[
        Act::Ask(Ask::Enable),
        Act::Ask(Ask::Home),
        Act::Ask(Ask::Start),
        Act::Ask(Ask::Hold),
        Act::Ask(Ask::Resume),
        Act::Ask(Ask::Stop),
        Act::Ask(Ask::Disable),
        Act::Ask(Ask::ClearFault),
        Act::Ask(Ask::Recover),
        Act::Ask(Ask::RecoverFar),
        Act::Ask(Ask::Offer),
        Act::Ask(Ask::Retarget),
        Act::World(World::Switches(Switches::True)),
        Act::World(World::Switches(Switches::Open)),
        Act::World(World::Switches(Switches::Closed)),
        Act::World(World::Switches(Switches::FirstClosed)),
        Act::Fails(FaultCode::Drive(DriveFault::Reported)),
        Act::Fails(FaultCode::Overrun),
        Act::Ticks(1),
        Act::Ticks(7),
        Act::Ticks(20),
        // As long as homing takes.
        Act::Ticks(80),
        Act::Silence,
    ];

    const STARTS: &'static [&'static [Act]] = &[
        &[],
        &[
            Act::Ask(Ask::Enable),
            Act::Ticks(7),
            Act::Ask(Ask::Home),
            Act::Ticks(90),
        ],
    ];

    /// The motors are 0.01 rad from where they count from.
    fn switched_on() -> Self {
        let parameters = quick();
        let coefficients = HomingCoefficients::build(&parameters, PERIOD_S);
        let scene = SceneParts {
            homing: Some(&*Box::leak(Box::new(coefficients))),
            ..Adjustable::new(example(), LimitParameters::default()).into()
        };
        let mut machine = Self {
            bench: Bench::with_room::<4>(scene, home(), timed_settings()),
            references: parameters.motors,
            truth: home_angles().map(|angle| angle + 0.01),
            commanded: [0.0; 3],
            switches: Switches::True,
        };
        machine.commanded = machine.angles();
        machine
    }

    fn bench(&mut self) -> &mut Bench<Homed<f64>> {
        &mut self.bench
    }

    fn tick(&mut self) -> Output<f64> {
        self.bench.inputs = self.closed();
        let output = self.bench.tick();
        let shift = self.bench.service.foreground.shift().unwrap_or_default();
        let angles = self.angles();
        for i in 0..3 {
            self.truth[i] += wrapped(angles[i] - self.commanded[i] - shift[i]);
        }
        self.commanded = angles;
        output
    }

    fn change(&mut self, world: World) {
        if let World::Switches(switches) = world {
            self.switches = switches;
        }
    }

    /// A motor that a broken switch has let through is turned back by hand.
    fn mend(&mut self) {
        self.switches = Switches::True;
        for i in 0..3 {
            let reference = self.references[i];
            if self.beyond(i) > reference.back_off_rad {
                self.truth[i] = reference.angle_rad - reference.sign() * reference.back_off_rad;
            }
        }
    }

    /// The switches, what they tell, and where each motor is going: to its switch or back, in the first approach or the second.
    fn world(&self) -> String {
        let motors = &self.bench.service.foreground.output().motors;
        let latch = self.references[0].latch_rate_rad_s * 1.01;
        let way = |i: usize| {
            let rate = motors[i].rate * self.references[i].sign();
            (rate > 0.0, rate < 0.0, rate.abs() > latch)
        };
        let closed = self.closed();
        format!("{:?} {closed:?} {:?}", self.switches, [0, 1, 2].map(way))
    }
}

/// Homing in little time: switches 0.05 rad away, on the side from which the offered moves lead away.
fn quick() -> HomingParameters {
    let parameters = parameters(Contact::Switch);
    let home = home_angles();
    let away = angles_at([0.25, 0.25, 0.18]).unwrap();
    let motors = [0, 1, 2].map(|i| {
        let positive = wrapped(away[i] - home[i]) < 0.0;
        let reference = if positive { 0.05 } else { -0.05 };
        HomingMotor {
            angle_rad: wrapped(home[i] + reference),
            positive,
            search_rate_rad_s: 1.0,
            latch_rate_rad_s: 0.25,
            acceleration_rad_s2: 20.0,
            back_off_rad: 0.015,
            travel_max_rad: 0.5,
            ..parameters.motors[i]
        }
    });
    timed(HomingParameters {
        motors,
        debounce_ticks: 2,
        ..parameters
    })
}

#[test]
fn homing_is_survivable_and_has_a_way_out() {
    let kinds = explore::<HomedMachine>(Some(DEPTH)).kinds;
    assert_taken(taken::HOMED_MACHINE);
    // All there are.
    assert_eq!(kinds.len(), 14, "{kinds:?}");
}

/// The search ends by itself: there are no other states.
#[test]
#[ignore = "takes minutes; cargo xtask nightly"]
fn all_states_of_homing_are_explored() {
    assert!(explore::<HomedMachine>(None).deepest > DEPTH);
}
