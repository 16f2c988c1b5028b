//! Brushless motors, with PWM from TIM3.

use super::Parts;
use crate::dividers::set_pwm;
use crate::pins::OutputC;
use stm32f4xx_hal::gpio::{Output as Out, Pin, PinState};
use stm32f4xx_hal::pac::TIM3;
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::Rcc;
use stm32f4xx_hal::timer::ErasedChannel;
use trirrr_app::Output;
use trirrr_app::outputs::Outputs;
use trirrr_app::scene::Scalar;
use trirrr_app::scene::drive::{ENABLE_HIGH, MOTORS, REVERSED};
use trirrr_drives::bldc::Bldc;
use trirrr_drives::bldc::{BldcMotor, Bldcs};
use trirrr_drives::{Active, Enable, Failure};

/// PWM, Hz: above hearing, and 4,200 counts of duty at 168 MHz.
const PWM_HZ: u32 = 20_000;

/// Drives, as the tick sees them.
pub(crate) struct Drives(Bldcs<Motor, Pin<'B', 12, Out>>);

/// Motor on a channel of TIM3, its direction on port C.
type Motor = BldcMotor<Scalar, ErasedChannel<TIM3>, OutputC>;

impl Outputs for Drives {
    #[inline(always)]
    fn apply(&mut self, output: &Output) -> Result<(), Failure<Scalar>> {
        self.0.apply(output)
    }
}

/// No work between two ticks.
pub(crate) type Slot = ();

/// Builds the power stages, off.
// A function of its own: its symbol shows that the image holds these drives.
#[inline(never)]
pub(crate) fn build(parts: Parts, rcc: &mut Rcc) -> (Drives, Slot) {
    let c = parts.port_c.split(rcc);
    let (active, off) = match ENABLE_HIGH {
        true => (Active::High, PinState::Low),
        false => (Active::Low, PinState::High),
    };
    let enable = parts.pb12.into_push_pull_output_in_state(off);
    let Ok(enable) = Enable::new(enable, active);

    let (_, (pwm_1, pwm_2, pwm_3, _)) = parts.tim3.pwm_hz(PWM_HZ.Hz(), rcc);
    set_pwm(parts.clocks.timers, PWM_HZ);
    let mut pwm = [
        pwm_1.with(c.pc6).erase(),
        pwm_2.with(c.pc7).erase(),
        pwm_3.with(c.pc8).erase(),
    ];
    for channel in &mut pwm {
        channel.set_duty(0);
        channel.enable();
    }
    let [pwm_1, pwm_2, pwm_3] = pwm;
    let [m1, m2, m3] = const { MOTORS }.each_ref().map(Bldc::<Scalar>::build);
    let [r1, r2, r3] = REVERSED;
    let direction_1 = c.pc3.into_push_pull_output().into();
    let direction_2 = c.pc4.into_push_pull_output().into();
    let direction_3 = c.pc5.into_push_pull_output().into();
    let motors = [
        BldcMotor::new(m1, pwm_1, direction_1, r1),
        BldcMotor::new(m2, pwm_2, direction_2, r2),
        BldcMotor::new(m3, pwm_3, direction_3, r3),
    ];
    (Drives(Bldcs::new(motors, enable)), ())
}
