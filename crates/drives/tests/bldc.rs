//! Brushless motors: duty to the last count, direction, enable.

mod common;

use common::{Edge, Pin, Random, Scope, output};
use embedded_hal::pwm::{ErrorType, SetDutyCycle};
use std::cell::Cell;
use std::convert::Infallible;
use std::rc::Rc;
use trirrr_core::number::Fixed;
use trirrr_drives::bldc::{Bldc, BldcParameters};
use trirrr_drives::bldc::{BldcMotor, Bldcs};
use trirrr_drives::count::Countable;
use trirrr_drives::{Active, Enable};

/// 84 MHz over 20 kHz.
const FULL: u16 = 4200;

/// A PWM output.
#[derive(Clone, Debug, Default)]
struct Pwm(Rc<Cell<u16>>);

impl ErrorType for Pwm {
    type Error = Infallible;
}

impl SetDutyCycle for Pwm {
    fn max_duty_cycle(&self) -> u16 {
        FULL
    }

    fn set_duty_cycle(&mut self, duty: u16) -> Result<(), Infallible> {
        assert!(duty <= FULL);
        self.0.set(duty);
        Ok(())
    }
}

const DIRECTION: [&str; 3] = ["direction 1", "direction 2", "direction 3"];

fn parameters(index: usize) -> BldcParameters {
    BldcParameters {
        gear_ratio: [1.0, 6.0, 19.0][index],
        resistance_ohm: [0.4, 0.5, 1.1][index],
        torque_constant_nm_a: [0.4, 0.07, 0.03][index],
        back_emf_constant_v_s_rad: [0.4, 0.07, 0.031][index],
        supply_v: 24.0,
        current_limit_a: [4.0, 8.0, 5.0][index],
    }
}

type Drives<N> = Bldcs<BldcMotor<N, Pwm, Pin>, Pin>;

fn drives<N: Countable>(reversed: bool) -> (Drives<N>, [Pwm; 3], Scope) {
    let scope = Scope::default();
    let pwm = [(); 3].map(|()| Pwm::default());
    let motor = |index: usize| {
        let drive = Bldc::<N>::build(&parameters(index));
        BldcMotor::new(
            drive,
            pwm[index].clone(),
            scope.pin(DIRECTION[index]),
            reversed,
        )
    };
    let enable = Enable::new(scope.pin("enable"), Active::High).unwrap();
    let drives = Bldcs::new([motor(0), motor(1), motor(2)], enable);
    (drives, pwm, scope)
}

/// The voltage of the winding in steady state, from the machine's equations, V.
fn voltage(index: usize, torque: f64, rate: f64) -> f64 {
    let p = parameters(index);
    let current = torque / p.gear_ratio / p.torque_constant_nm_a;
    let current = current.clamp(-p.current_limit_a, p.current_limit_a);
    let rotor = rate * p.gear_ratio;
    (p.resistance_ohm * current + p.back_emf_constant_v_s_rad * rotor)
        .clamp(-p.supply_v, p.supply_v)
}

fn duties<N: Countable>(reversed: bool, tolerance: f64, reach: f64) {
    let (mut drives, pwm, scope) = drives::<N>(reversed);
    let mut random = Random(11);
    let mut high = [None; 3];
    let (mut clear, mut full) = (0, 0);
    for _ in 0..5000 {
        // Up to twice the current limit, and beyond the supply.
        let wanted = [0, 1, 2].map(|_| [0.0, random.signed() * reach, random.signed() * reach]);
        drives.apply(&output::<N>(wanted, true)).unwrap();
        for Edge {
            pin, high: level, ..
        } in scope.take()
        {
            if let Some(motor) = DIRECTION.iter().position(|name| *name == pin) {
                high[motor] = Some(level);
            }
        }
        for (index, [_, rate, torque]) in wanted.into_iter().enumerate() {
            let [rate, torque] = [rate, torque].map(|x| N::from_f64(x).to_f64());
            let voltage = voltage(index, torque, rate);
            let counts = voltage.abs() / 24.0 * f64::from(FULL);
            let duty = pwm[index].0.get();
            if ((counts - counts.floor()) - 0.5).abs() > tolerance {
                assert_eq!(f64::from(duty), counts.round(), "{index}: {voltage} V");
                clear += 1;
            }
            if duty > 0 {
                assert_eq!(high[index], Some((voltage > 0.0) != reversed));
            }
            full += i32::from(duty == FULL);
        }
    }
    assert!(clear > 14_000 && full > 100, "{clear} {full}");
}

#[test]
fn the_duty_is_that_of_the_stationary_motor_to_the_last_count() {
    duties::<f64>(false, 1e-9, 60.0);
    // Some 2^-22 of 4200 counts.
    duties::<f32>(true, 5e-3, 60.0);
}

#[test]
fn fixed_point_drives_too() {
    let motor = BldcParameters {
        gear_ratio: 10.0,
        resistance_ohm: 0.5,
        torque_constant_nm_a: 0.05,
        back_emf_constant_v_s_rad: 0.05,
        supply_v: 24.0,
        current_limit_a: 20.0,
    };
    let drive = Bldc::<Fixed>::build(&motor);
    for (torque, rate, counts) in [
        // 3.75 A take 1.875 V of 24 V; 0.75 rad/s take 0.375 V more.
        (1.875, 0.0, 328.125),
        (1.875, 0.75, 393.75),
        (-1.875, 0.75, 262.5),
        (1.2, 1.0, 297.5),
    ] {
        let command = drive.command(
            trirrr_core::number::Arithmetic::from_f64(torque),
            trirrr_core::number::Arithmetic::from_f64(rate),
        );
        let found = f64::from(command.duty.parts(FULL));
        // 2^-28 of the duty is 2e-5 counts: either side of a half.
        assert!((found - counts).abs() <= 0.5 + 2e-5, "{found} {counts}");
    }
}

#[test]
fn off_is_no_duty_and_enable_low_and_comes_first() {
    let (mut drives, pwm, scope) = drives::<f32>(false);
    let all = || pwm.each_ref().map(|pwm| pwm.0.get());
    let enable = |edges: &[Edge]| {
        edges
            .iter()
            .filter(|edge| edge.pin == "enable")
            .map(|edge| edge.high)
            .collect::<Vec<_>>()
    };
    assert_eq!((enable(&scope.take()), all()), (vec![false], [0; 3]));
    let wanted = [[0.0, 1.0, 0.5]; 3];
    drives.apply(&output(wanted, true)).unwrap();
    assert_eq!(enable(&scope.take()), [true]);
    assert!(all().iter().all(|duty| *duty > 0));
    drives.apply(&output(wanted, true)).unwrap();
    assert!(enable(&scope.take()).is_empty());
    // A fault: whatever the motors are said to do.
    drives.apply(&output(wanted, false)).unwrap();
    assert_eq!((enable(&scope.take()), all()), (vec![false], [0; 3]));
    drives.apply(&output(wanted, true)).unwrap();
    assert_eq!(enable(&scope.take()), [true]);
    drives.off();
    assert_eq!((enable(&scope.take()), all()), (vec![false], [0; 3]));
}
