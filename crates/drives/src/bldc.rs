//! Brushless motors in torque mode: PWM and direction.
//!
//! Torque to current to duty as [`crate::command::bldc`] has it, with the current limit and the
//! back-EMF of the rate that the tick commands. Each motor has a PWM input for the share of the supply
//! and a direction input; one enable line serves all.
//!
//! Nothing here measures: the duty is that of the commanded motion, so the torque is that of a motor
//! which keeps to it. What it does not keep to has to be closed around it, in the power stage or by an
//! encoder and [`crate::command::joint::Loop`]; alone, positions drift.

use crate::command::bldc::Bldc;
use crate::command::count::Countable;
use crate::{Enable, Failure};
use embedded_hal::digital::OutputPin;
use embedded_hal::pwm::SetDutyCycle;
use trirrr_core::number::Number;
use trirrr_service::Output;

/// One motor with its PWM output and direction pin.
#[derive(Debug)]
pub struct BldcMotor<N, W, D> {
    drive: Bldc<N>,
    pwm: W,
    /// Its largest duty.
    full: u16,
    direction: D,
    reversed: bool,
}

impl<N, W: SetDutyCycle, D: OutputPin> BldcMotor<N, W, D> {
    /// The direction pin is high for counter-clockwise voltage, low for it if `reversed`.
    pub fn new(drive: Bldc<N>, pwm: W, direction: D, reversed: bool) -> Self {
        Self {
            drive,
            full: pwm.max_duty_cycle(),
            pwm,
            direction,
            reversed,
        }
    }
}

/// Three motors and their enable line.
#[derive(Debug)]
pub struct Bldcs<N, W, D, E> {
    motors: [BldcMotor<N, W, D>; 3],
    enable: Enable<E>,
}

impl<N, W, D, E> Bldcs<N, W, D, E>
where
    N: Countable,
    W: SetDutyCycle,
    D: OutputPin,
    E: OutputPin,
{
    /// All duties 0, drives off.
    pub fn new(motors: [BldcMotor<N, W, D>; 3], enable: Enable<E>) -> Self {
        let mut bldcs = Self { motors, enable };
        bldcs.off();
        bldcs
    }

    /// Sets duties and directions, then enables. Off where the output is.
    ///
    /// # Errors
    /// [`DriveFault::Reported`](trirrr_protocol::message::DriveFault::Reported): a pin or a PWM output
    /// fails; those of a microcontroller do not.
    #[inline(always)]
    pub fn apply(&mut self, output: &Output<N>) -> Result<(), Failure<N>> {
        if !output.enabled {
            self.off();
            return Ok(());
        }
        for (index, (motor, to)) in self.motors.iter_mut().zip(&output.motors).enumerate() {
            let duty = motor.drive.command(to.torque, to.rate).duty;
            let forward = (duty < N::ZERO) == motor.reversed;
            let turned = match forward {
                true => motor.direction.set_high().is_ok(),
                false => motor.direction.set_low().is_ok(),
            };
            let set = motor.pwm.set_duty_cycle(duty.parts(motor.full)).is_ok();
            if !(turned && set) {
                return Err(reported(index as u8));
            }
        }
        match self.enable.switch(true) {
            Ok(_) => Ok(()),
            Err(_) => Err(reported(0)),
        }
    }

    /// Enable off, then all duties 0. As much of it as can be done is.
    #[inline]
    pub fn off(&mut self) {
        let _ = self.enable.switch(false);
        for motor in &mut self.motors {
            let _ = motor.pwm.set_duty_cycle_fully_off();
        }
    }
}

#[cold]
fn reported<N: Number>(drive: u8) -> Failure<N> {
    Failure::of(trirrr_protocol::message::DriveFault::Reported, Some(drive))
}
