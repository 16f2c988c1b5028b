//! What the image does.

use crate::clock::Clock;
use crate::scene::{Links, MOVES, NAME, PARAMETERS, PERIOD, Payload, Scalar, TICK_RATE_HZ};
use cortex_m::singleton;
use defmt_rtt as _;
use panic_probe as _;
use trirrr_core::number::Number;
use trirrr_core::tick::{Motor, Tick};
use trirrr_image::segments;

type SceneTick = Tick<Scalar, Payload, Links>;

#[cortex_m_rt::entry]
fn main() -> ! {
    let tick = match SceneTick::build(&PARAMETERS) {
        Ok(tick) => tick,
        // Not by the error's Display: it would bring the formatting of floats into the image.
        Err(error) => defmt::panic!(
            "scene {=str}: {} of leg {} is {=f64}",
            NAME,
            defmt::Debug2Format(&error.quantity),
            error.leg.map(|leg| leg + 1),
            error.value
        ),
    };
    let tick: &'static SceneTick = defmt::unwrap!(
        singleton!(TICK: SceneTick = tick),
        "the program starts once"
    );
    let peripherals = defmt::unwrap!(cortex_m::Peripherals::take(), "the program starts once");
    let mut clock = Clock::start(peripherals.SYST, TICK_RATE_HZ);
    defmt::info!("scene {=str}, {=f64} ticks per second", NAME, TICK_RATE_HZ);

    play(tick, &mut clock);
    loop {
        cortex_m::asm::wfi();
    }
}

/// Evaluates the job, one tick per tick, and logs once a second.
fn play(tick: &SceneTick, clock: &mut Clock) {
    let ticks_per_report = TICK_RATE_HZ as u32;
    let mut done: u32 = 0;
    let mut late: u32 = 0;
    let mut latest = None;
    for segment in segments::<Scalar>(&MOVES, PERIOD) {
        for index in 0..segment.ticks() {
            late += clock.wait();
            match tick.evaluate(&segment.at(index)) {
                Ok(motion) => latest = Some(motion.motors),
                Err(status) => {
                    defmt::error!("tick {=u32}: {}", done, defmt::Display2Format(&status));
                    return;
                }
            }
            if let Some(motors) = &latest
                && done.is_multiple_of(ticks_per_report)
            {
                report(done, late, motors);
            }
            done += 1;
        }
    }
    if let Some(motors) = &latest {
        defmt::info!("the job is done, {=u32} ticks", done);
        report(done - 1, late, motors);
    }
}

/// The status line: where the motors are and what they would have to give.
fn report(tick: u32, late: u32, motors: &[Motor<Scalar>; 3]) {
    let angles = motors.map(|motor| Scalar::angle_to_f64(motor.angle));
    let torques = motors.map(|motor| motor.torque.to_f64());
    defmt::info!(
        "tick {=u32}, late {=u32}: angles {} rad, torques {} N m",
        tick,
        late,
        angles,
        torques
    );
}
