//! Drives that restart while the board stays on: no machine goes on before a host knows, and none with a joint whole turns of a rotor
//! off.

use crate::bench::{Bench, DAMIAO, GEAR, MOTEUS, TIMEOUT_TICKS, actuator, moteus, odrive, wrapped};
use crate::service::{HOME, Measuring, angles_at, service};
use std::f64::consts::TAU;
use trirrr_core::setpoint::Pose;
use trirrr_drives::can::{Odrive, Protocol};
use trirrr_plant::bus::DriveModel;
use trirrr_protocol::message::{
    Command, DriveFault, DriveState, FaultCode, Move, NotEnabled, Reply, State,
};
use trirrr_service::{Power, Service};

/// Turns that a drive has lost or gained by its restart.
const TURNS: [f64; 7] = [-3.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0];

/// One turn of the rotor at the joint, rad.
const TURN: f64 = TAU / GEAR;

/// Angle within which the board has to know a joint, rad: far below a turn of the rotor.
const KNOWN: f64 = 0.02;

/// Machine whose joints follow their commands while its drives are on.
struct Machine<P: Protocol, const LONGEST: usize> {
    service: Service<'static, Measuring>,
    bench: Bench<P, LONGEST>,
    /// Events are written here, for failures.
    story: String,
}

/// State in which a drive restarts.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Before {
    Disabled,
    Idle,
    Running,
    /// The drives were switched on so many ticks ago.
    Enabling(u32),
}

impl<P: Protocol, const LONGEST: usize> Machine<P, LONGEST> {
    fn new(
        protocol: P,
        model: impl Fn(usize) -> Box<dyn DriveModel<LONGEST> + Send>,
        before: Before,
    ) -> Self {
        let joints = angles_at(HOME).unwrap();
        let mut machine = Self {
            service: service(Pose::from_f64(HOME[0], HOME[1], HOME[2])),
            bench: Bench::near(protocol, model, joints, joints.map(|angle| angle + 0.2)),
            story: format!("{before:?}"),
        };
        machine.ticks(60);
        match before {
            Before::Disabled => {}
            Before::Idle => assert_eq!(machine.enable(), State::Idle),
            Before::Running => {
                assert_eq!(machine.enable(), State::Idle);
                machine.set_off();
            }
            Before::Enabling(ticks) => {
                assert_eq!(machine.service.submit(&Command::Enable), Reply::Done);
                machine.ticks(ticks);
            }
        }
        machine
    }

    /// One tick. A machine that is on knows where its joints are.
    fn tick(&mut self) {
        let readings = self.bench.measure();
        self.service.hear(readings);
        let output = *self.service.tick();
        let is_known = |index: usize| {
            let off = wrapped(output.motors[index].angle - self.bench.joints[index]);
            off.abs() < KNOWN
        };
        let is_on = !matches!(
            self.service.state(),
            State::Disabled | State::Enabling | State::Disabling | State::Fault
        );
        let told = &self.story;
        assert!(!is_on || (0..3).all(is_known), "{told}: {output:?}");
        let drives = self.bench.readings.iter_mut().zip(&readings);
        drives.for_each(|(kept, reading)| *kept = *reading);
        for (index, joint) in self.bench.joints.iter_mut().enumerate() {
            if output.power == Power::On && readings[index].state == DriveState::On {
                *joint += wrapped(output.motors[index].angle - *joint);
            }
        }
        if let Err(what) = self.bench.tick_by(&output) {
            self.service.raise(FaultCode::Drive(what), None, 0.0, 0.0);
        }
        while self.service.step() {}
        while self.service.outgoing().is_some() {}
    }

    fn ticks(&mut self, ticks: u32) {
        for _ in 0..ticks {
            self.tick();
        }
    }

    /// Sets off for a pose nearby, and goes on into the middle of the move.
    fn set_off(&mut self) {
        let status = self.service.status();
        let way = Move {
            number: status.next,
            from: status.end.unwrap().pose,
            to: Pose::from_f64(0.25, 0.25, 0.2),
            start_velocity: [0.0; 3],
            end_velocity: [0.0; 3],
            ticks: 400,
            tool_power: 0.0,
            tool_speed: 0.0,
        };
        assert_eq!(self.service.submit(&Command::Move(way)), Reply::Done);
        self.ticks(3);
        assert_eq!(self.service.submit(&Command::Start), Reply::Done);
        self.ticks(150);
        assert_eq!(self.service.state(), State::Running);
    }

    /// Asks for the drives, and waits for the end of that.
    fn enable(&mut self) -> State {
        assert_eq!(self.service.submit(&Command::Enable), Reply::Done);
        for _ in 0..300 {
            self.tick();
            match self.service.state() {
                State::Enabling | State::Disabling => {}
                state => return state,
            }
        }
        panic!("{}: {:?}", self.story, self.service.status());
    }

    fn clear(&mut self) {
        assert_eq!(self.service.submit(&Command::ClearFault), Reply::Done);
        self.ticks(40);
        assert_eq!(self.service.state(), State::Disabled, "{}", self.story);
    }

    /// The drives in `legs` have no power for `gap` ticks, in which their joints turn by `turned`, and count `turns` more behind it.
    fn restart(&mut self, legs: &[usize], gap: u32, turned: f64, turns: f64) {
        self.story += &format!(", {legs:?} off for {gap} ticks, {turned} rad, {turns} turns");
        if gap > 0 {
            for leg in legs {
                self.bench.medium().drive(*leg).die();
            }
        }
        for _ in 0..gap {
            self.tick();
            // What the last command leaves it, and then a hand.
            for leg in legs {
                self.bench.joints[*leg] += turned / f64::from(gap);
            }
        }
        for leg in legs {
            self.bench.medium().drive(*leg).restart(turns);
        }
        self.ticks(40);
    }

    /// Angles that the host is told after a restart; none if the machine was refused for another reason.
    fn told(&mut self) -> Option<[Option<f64>; 3]> {
        match self.service.status().not_enabled {
            Some(NotEnabled::Restarted { angles }) => Some(angles),
            _ => None,
        }
    }

    /// The machine is not enabled before the host was told of the drives in `legs` and acknowledges that; then it is, where it stands.
    /// Returns false if its joints were turned to where there is no pose, or more than one: it is not enabled there, either.
    fn comes_back(&mut self, legs: &[usize]) -> bool {
        let story = self.story.clone();
        if self.service.state() == State::Fault {
            self.clear();
        }
        assert_eq!(self.enable(), State::Disabled, "{story}");
        let told = self.told().unwrap_or_else(|| panic!("{story}"));
        for (leg, (told, joint)) in told.into_iter().zip(self.bench.joints).enumerate() {
            assert_eq!(told.is_some(), legs.contains(&leg), "{story}: {told:?}");
            let off = told.map_or(0.0, |angle| wrapped(angle - joint));
            assert!(off.abs() < KNOWN, "{story}: {off}");
        }
        // Asked once more, the answer is the same.
        assert_eq!(self.enable(), State::Disabled, "{story}");
        assert!(self.told().is_some());
        self.clear();
        let state = self.enable();
        let why = self.service.status().not_enabled;
        let is_nowhere = matches!(why, Some(NotEnabled::NoPose | NotEnabled::ManyPoses));
        assert!(state == State::Idle || is_nowhere, "{story}: {why:?}");
        state == State::Idle
    }
}

/// Runs `check` on a machine of each kind of drive that knows a turn of its rotor.
macro_rules! each_kind {
    ($before:expr, $check:expr) => {
        $check(&mut Machine::new(Odrive, odrive, $before));
        $check(&mut Machine::new(MOTEUS, moteus, $before));
        $check(&mut Machine::new(DAMIAO, actuator(DAMIAO), $before));
    };
}

/// Power is gone for longer than the timeout, and the joint turns by less than half a turn of the rotor meanwhile.
#[test]
fn a_drive_whose_power_was_gone_is_known_again_and_acknowledged() {
    let (mut enabled, mut all) = (0, 0);
    for before in [Before::Disabled, Before::Idle, Before::Running] {
        for turns in TURNS {
            for turned in [0.0, 0.4 * TURN, -0.4 * TURN] {
                let gap = u32::from(TIMEOUT_TICKS) + 30;
                each_kind!(before, |machine: &mut Machine<_, _>| {
                    machine.restart(&[1], gap, turned, turns);
                    let comes_back = machine.comes_back(&[1]);
                    assert!(comes_back || turned != 0.0, "{}", machine.story);
                    enabled += i32::from(comes_back);
                    all += 1;
                });
            }
        }
    }
    assert!(enabled > all * 2 / 3, "{enabled} of {all}");
    println!("{all} restarts with a gap: {enabled} enabled where they stand, 0 elsewhere");
}

/// Without a gap that is too long, restarts show in a jump; one that loses no turn changes nothing.
#[test]
fn a_drive_that_restarts_unnoticed_is_not_whole_turns_off() {
    for before in [Before::Disabled, Before::Idle, Before::Running] {
        for turns in TURNS {
            for gap in [0, 4] {
                each_kind!(before, |machine: &mut Machine<_, _>| {
                    machine.restart(&[2], gap, 0.0, turns);
                    if before != Before::Disabled && turns != 0.0 {
                        let fault = machine.service.status().fault.map(|fault| fault.code);
                        let codes = [DriveFault::Restarted, DriveFault::NotOn];
                        assert!(
                            codes
                                .map(|code| Some(FaultCode::Drive(code)))
                                .contains(&fault),
                            "{}: {fault:?}",
                            machine.story
                        );
                    }
                    if turns != 0.0 {
                        assert!(machine.comes_back(&[2]));
                        return;
                    }
                    if machine.service.state() == State::Fault {
                        machine.clear();
                    }
                    if machine.service.state() == State::Disabled {
                        assert_eq!(machine.enable(), State::Idle, "{}", machine.story);
                    }
                });
            }
        }
    }
}

/// A drive that goes on by any command, and comes back before it counts as silent: it gets no command for turns that it has lost.
#[test]
fn a_moteus_that_comes_back_is_not_driven_whole_turns_away() {
    for gap in 4..u32::from(TIMEOUT_TICKS) - 2 {
        let mut machine = Machine::new(MOTEUS, moteus, Before::Idle);
        machine.bench.medium().drive(1).die();
        machine.ticks(gap);
        assert_eq!(machine.service.state(), State::Idle);
        machine.bench.medium().drive(1).restart(1.0);
        for _ in 0..20 {
            machine.tick();
            assert_eq!(machine.bench.torques()[1], 0.0, "{gap}");
        }
        assert_eq!(machine.service.state(), State::Fault);
    }
}

/// At any tick of enabling.
#[test]
fn a_drive_that_restarts_while_the_machine_is_enabled_stops_that() {
    for ticks in (0..60).step_by(3) {
        for turns in [-1.0, 2.0] {
            each_kind!(Before::Enabling(ticks), |machine: &mut Machine<_, _>| {
                machine.restart(&[0], 0, 0.0, turns);
                machine.ticks(300);
                let state = machine.service.state();
                assert!(
                    matches!(state, State::Disabled | State::Fault),
                    "{}: {state:?}",
                    machine.story
                );
                if state == State::Fault {
                    machine.clear();
                }
                if machine.told().is_none() {
                    assert_eq!(machine.enable(), State::Disabled, "{}", machine.story);
                }
                assert!(machine.told().is_some(), "{}", machine.story);
                machine.clear();
                assert_eq!(machine.enable(), State::Idle, "{}", machine.story);
            });
        }
    }
}

/// The supply of all drives, as an emergency stop cuts it.
#[test]
fn all_drives_that_have_restarted_are_told_together() {
    for turns in TURNS {
        each_kind!(Before::Running, |machine: &mut Machine<_, _>| {
            machine.restart(&[0, 1, 2], 500, 0.0, turns);
            assert!(machine.comes_back(&[0, 1, 2]));
        });
    }
}

/// A hand turns the joint farther than the drive can tell: nothing goes on without a person who has seen the angle that the board
/// takes it for. What was acknowledged before counts for nothing.
#[test]
fn a_joint_that_was_turned_too_far_is_not_enabled_by_itself() {
    for turned in [0.7 * TURN, -1.3 * TURN, 2.0 * TURN] {
        each_kind!(Before::Idle, |machine: &mut Machine<_, _>| {
            machine.restart(&[1], 300, 0.0, 1.0);
            assert!(machine.comes_back(&[1]));
            assert_eq!(machine.service.submit(&Command::Disable), Reply::Done);
            machine.ticks(100);
            machine.restart(&[1], 300, turned, -2.0);
            // The host has not been told: its acknowledgement is none.
            machine.clear();
            assert_eq!(machine.enable(), State::Disabled, "{}", machine.story);
            let [_, told, _] = machine.told().unwrap();
            let off = wrapped(told.unwrap() - machine.bench.joints[1]);
            assert!((off / TURN).round().abs() >= 1.0, "{off}");
            // And again behind that.
            machine.restart(&[1], 300, 0.0, 0.0);
            machine.clear();
            assert_eq!(machine.enable(), State::Disabled, "{}", machine.story);
            assert!(machine.told().is_some());
        });
    }
}

/// A drive that comes later than the board, or has stayed on while the board was off, has restarted for nobody.
#[test]
fn a_drive_that_is_silent_at_first_has_not_restarted() {
    each_kind!(Before::Disabled, |machine: &mut Machine<_, _>| {
        assert_eq!(machine.enable(), State::Idle);
        assert_eq!(machine.told(), None);
    });
    let joints = angles_at(HOME).unwrap();
    let mut machine = Machine {
        service: service(Pose::from_f64(HOME[0], HOME[1], HOME[2])),
        bench: Bench::near(Odrive, odrive, joints, joints.map(|angle| angle + 0.2)),
        story: "late".into(),
    };
    machine.restart(&[0], 300, 0.0, 2.0);
    assert_eq!(machine.enable(), State::Idle);
}
