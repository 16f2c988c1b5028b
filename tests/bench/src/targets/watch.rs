//! What has to hold in every tick, whatever was asked.

use crate::device::{Device, answer, home};
use trirrr_core::limits::LimitParameters;
use trirrr_protocol::message::{Command, Recovery, Reply, Request, State};
use trirrr_service::Output;

/// Limits of the fuzzed machine.
pub(super) fn limits() -> LimitParameters {
    LimitParameters {
        rate_rad_s: Some([2.0; 3]),
        acceleration_rad_s2: Some([400.0; 3]),
        torque_nm: Some([2.0; 3]),
        power_w: Some([1.0; 3]),
        ..LimitParameters::default()
    }
}

/// What an input got the machine to do.
#[derive(Clone, Debug, Default)]
pub struct Reached {
    /// States, in the order in which they were first met.
    pub states: Vec<State>,
    /// The tool was on.
    pub tool: bool,
    /// Moves played to their end.
    pub moves: u32,
}

/// A machine that is watched in every tick.
pub(super) struct Watched<'q> {
    pub(super) device: Device<'q>,
    /// What it has to keep.
    pub(super) limits: LimitParameters,
    reached: Reached,
}

impl<'q> Watched<'q> {
    pub(super) fn new(device: Device<'q>) -> Self {
        Self {
            device,
            limits: limits(),
            reached: Reached::default(),
        }
    }

    pub(super) fn reached(mut self) -> Reached {
        self.reached.moves = self.device.service.status().done;
        self.reached
    }

    /// One tick.
    pub(super) fn tick(&mut self) {
        let output = self.device.tick();
        let state = self.device.service.state();
        assert!(
            output.tool == 0.0 || state.is_running(),
            "the tool is on in {state:?}"
        );
        assert!((0.0..=1.0).contains(&output.tool), "{output:?}");
        let off = matches!(state, State::Disabled | State::Fault);
        assert!(output.is_on() != off);
        self.assert_within(&output, state);
        self.reached.tool |= output.tool > 0.0;
        if !self.reached.states.contains(&state) {
            self.reached.states.push(state);
        }
    }

    fn assert_within(&self, output: &Output<f64>, state: State) {
        let within = |limits: Option<[f64; 3]>, motor: usize, value: f64, what: &str| {
            // Written so that a value that is not a number is beyond.
            let limit = limits.map_or(f64::MAX, |limits| limits[motor]);
            assert!(
                value.abs() <= limit,
                "{what} of motor {motor} in {state:?}: {output:?}"
            );
        };
        let limits = &self.limits;
        for (index, motor) in output.motors.iter().enumerate() {
            within(limits.rate_rad_s, index, motor.rate, "rate");
            within(
                limits.acceleration_rad_s2,
                index,
                motor.acceleration,
                "acceleration",
            );
            within(limits.torque_nm, index, motor.torque, "torque");
            within(limits.power_w, index, motor.torque * motor.rate, "power");
            assert!(motor.angle.is_finite());
        }
    }

    /// Ticks enough for orders to be taken and a stop to end: where a move leaves no room, it takes until its end.
    fn settle(&mut self) {
        for passed in 0..100_000 {
            if passed >= 64 && self.device.service.state() != State::Stopping {
                return;
            }
            self.device.service.step();
            self.tick();
        }
    }
}

/// Ticks of the recovery with which a machine is left: slow enough for any way that there is.
const RECOVERY: u32 = 20_000;

/// The way out of any state: stop, acknowledge, recover; each command is done. At its end the
/// machine stands idle.
pub(super) fn leave(watched: &mut Watched, mut sequence: u32) {
    let mut ask = |watched: &mut Watched, command: Command<f64>| {
        let request = Request { sequence, command };
        let reply = answer(&mut watched.device, &request);
        sequence = sequence.wrapping_add(1);
        assert_eq!(reply, Reply::Done, "{command:?}");
    };
    watched.settle();
    ask(watched, Command::Stop);
    watched.settle();
    if watched.device.service.state() == State::Fault {
        ask(watched, Command::ClearFault);
        watched.settle();
    }
    if watched.device.service.state() == State::Disabled {
        ask(watched, Command::Enable);
        watched.settle();
    }
    if watched.device.service.state() == State::Cleared {
        let recovery = Recovery {
            to: home(),
            ticks: RECOVERY,
        };
        // At a pace that was asked for the way takes as much longer.
        ask(watched, Command::FeedOverride { percent: 100 });
        watched.settle();
        ask(watched, Command::Recover(recovery));
        for passed in 0..RECOVERY + 10 {
            // A silent host ends a recovery too.
            if passed % 100 == 0 {
                ask(watched, Command::telemetry(0));
            }
            watched.tick();
        }
    }
    assert_eq!(
        watched.device.service.state(),
        State::Idle,
        "no way out: {:?}",
        watched.device.service.status()
    );
}
