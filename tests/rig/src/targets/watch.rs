//! What has to hold in every tick, whatever was asked.

use crate::device::Device;
use trirrr_core::limits::LimitParameters;
use trirrr_core::message::State;

/// Limits of the fuzzed machine.
pub(super) fn limits() -> LimitParameters {
    LimitParameters {
        rate_rad_s: Some([1.5; 3]),
        acceleration_rad_s2: Some([200.0; 3]),
        torque_nm: Some([0.2; 3]),
        power_w: Some([0.1; 3]),
        ..LimitParameters::default()
    }
}

/// One tick, watched.
pub(super) fn tick(device: &mut Device, limits: &LimitParameters) {
    let output = device.tick();
    let state = device.foreground.state();
    assert!(
        output.tool == 0.0 || state.is_running(),
        "the tool is on in {state:?}"
    );
    assert!((0.0..=1.0).contains(&output.tool), "{output:?}");
    assert_eq!(output.enabled, state != State::Fault);
    let within = |limit: Option<[f64; 3]>, motor: usize, value: f64, what: &str| {
        // Written so that a value that is not a number is beyond.
        let limit = limit.map_or(f64::MAX, |limit| limit[motor]);
        assert!(
            value.abs() <= limit,
            "{what} of motor {motor} in {state:?}: {output:?}"
        );
    };
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

/// The way out of any state: stop, acknowledge, recover. At its end the machine stands idle.
pub(super) fn leave(device: &mut Device, limits: &LimitParameters, ask: &mut Ask<'_>) {
    use trirrr_core::message::{Command, Recovery};
    settle(device, limits);
    ask(device, Command::Stop);
    settle(device, limits);
    if device.foreground.state() == State::Fault {
        ask(device, Command::ClearFault);
        settle(device, limits);
    }
    if device.foreground.state() == State::Cleared {
        let recovery = Recovery {
            to: crate::device::home(),
            // Slow enough for any way that there is.
            ticks: 20_000,
        };
        ask(device, Command::Recover(recovery));
        for passed in 0..20_010 {
            // A host that is silent ends a recovery too.
            if passed % 100 == 0 {
                ask(device, Command::Telemetry { every: 0 });
            }
            tick(device, limits);
        }
    }
    assert_eq!(
        device.foreground.state(),
        State::Idle,
        "no way out: {:?}",
        device.background.status()
    );
}

/// Asks a request with the right sequence number, which has to be executed.
pub(super) type Ask<'a> = dyn FnMut(&mut Device, trirrr_core::message::Command<f64>) + 'a;

/// Ticks enough for orders to be taken and any ramp to end.
fn settle(device: &mut Device, limits: &LimitParameters) {
    for _ in 0..64 {
        device.background.step();
        tick(device, limits);
    }
}
