//! Brushless motors in torque mode: PWM and direction.
//!
//! [`Bldc`] has the arithmetic from torque to current to duty, with the current limit and the back-EMF of the
//! commanded rate. Each motor has a PWM input for the share of the supply and a direction input; one enable
//! line serves all.
//!
//! Nothing here measures. The duty belongs to the commanded motion, and so does the torque. A power stage or an
//! encoder with [`crate::joint::Loop`] has to close the loop around the motor; alone, positions drift.

mod command;

pub use command::{Bldc, BldcCommand, BldcParameters, DriveLimit};

use crate::count::Countable;
use crate::{Enable, Failure};
use embedded_hal::digital::OutputPin;
use embedded_hal::pwm::SetDutyCycle;
use trirrr_core::number::Number;
use trirrr_service::Output;

/// Motor with its PWM output and direction pin.
#[derive(Debug)]
pub struct BldcMotor<N, W, D> {
    drive: Bldc<N>,
    pwm: W,
    /// Largest duty of the PWM output.
    full: u16,
    direction: D,
    reversed: bool,
}

impl<N, W: SetDutyCycle, D: OutputPin> BldcMotor<N, W, D> {
    /// Motor whose direction pin is high for counter-clockwise voltage, or low if `reversed`.
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

/// Three motors `M`, each a [`BldcMotor`], and their enable line.
#[derive(Debug)]
pub struct Bldcs<M, E> {
    motors: [M; 3],
    enable: Enable<E>,
}

impl<N, W, D, E> Bldcs<BldcMotor<N, W, D>, E>
where
    N: Countable,
    W: SetDutyCycle,
    D: OutputPin,
    E: OutputPin,
{
    /// Motors with duty 0, drives off.
    pub fn new(motors: [BldcMotor<N, W, D>; 3], enable: Enable<E>) -> Self {
        let mut bldcs = Self { motors, enable };
        bldcs.off();
        bldcs
    }

    /// Sets duties and directions, then enables. Switches the drives off unless the output is enabled.
    ///
    /// # Errors
    /// [`DriveFault::Reported`](trirrr_protocol::message::DriveFault::Reported): a pin or a PWM output
    /// fails. Those of a microcontroller do not.
    #[inline(always)]
    pub fn apply(&mut self, output: &Output<N>) -> Result<(), Failure<N>> {
        if !output.is_on() {
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

    /// Switches the enable line off, then sets all duties to 0. A pin that fails stops neither.
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
