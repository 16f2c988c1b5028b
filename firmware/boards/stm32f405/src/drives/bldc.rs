//! Brushless motors, with PWM from TIM3.

use super::DriveParts;
use crate::dividers::set_pwm;
use crate::pins::OutputC;
use stm32f4xx_hal::gpio::{Output as Out, Pin, PinState};
use stm32f4xx_hal::pac::TIM3;
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::Rcc;
use stm32f4xx_hal::timer::ErasedChannel;
use trirrr_app::scene::Scalar;
use trirrr_app::scene::drive::{ENABLE_HIGH, MOTORS, REVERSED};
use trirrr_drives::bldc::{Bldc, BldcMotor, Bldcs};
use trirrr_drives::{Active, Enable};

/// PWM, Hz: above hearing, and 4,200 counts of duty at 168 MHz.
const PWM_HZ: u32 = 20_000;

/// Drives, as the tick sees them: channels of TIM3, directions on port C.
pub(crate) type BldcDrives =
    Bldcs<BldcMotor<Scalar, ErasedChannel<TIM3>, OutputC>, Pin<'B', 12, Out>>;

/// Builds the power stages, off.
// A function of its own: its symbol shows that the image holds these drives.
#[inline(never)]
pub(crate) fn build(parts: DriveParts, rcc: &mut Rcc) -> (BldcDrives, ()) {
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
    (Bldcs::new(motors, enable), ())
}
