//! Amplifiers and encoders, with the loops that an image runs: its half in the tick, its samples, and what is around them.

use crate::control::{Commands, Measured};
use crate::drives::{SimulatedDrives, reference, standing};
use crate::motor::wrapped;
use crate::power_stage::{DriveLimit, PowerStage};
use crate::refusal::Refusal;
use embedded_hal::digital::{self, OutputPin};
use embedded_hal::pwm::{self, SetDutyCycle};
use std::convert::Infallible;
use std::f64::consts::TAU;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU16, Ordering};
use trirrr_core::units::Units;
use trirrr_drives::bldc::{
    AmplifierParameters, Bldcs, LoopLine, LoopMotor, LoopUnits, Loops, torque_of,
};
use trirrr_drives::count::Countable;
use trirrr_drives::joint::Reference;
use trirrr_drives::{Active, Enable};
use trirrr_protocol::message::DriveReading;
use trirrr_scene::{Drive, DriveKind, Scene};
use trirrr_service::{Output, Power};

/// Counts per second of the timer that makes the set values, as on the STM32F405.
const TIMER_HZ: f64 = 84e6;

/// Faults to inject into a motor with an amplifier and an encoder.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LoopFaults {
    /// The amplifier has failed: it gives no current, and tells it.
    pub failed: bool,
    /// The amplifier gives no current, and does not tell.
    pub dead: bool,
    /// The encoder has stopped to count.
    pub stuck: bool,
    /// Counts that the encoder has lost or gained.
    pub slipped: i32,
}

/// Three motors with amplifiers and encoders, and a board's loops around them.
pub struct SimulatedLoops {
    tick: Bldcs<Arc<LoopLine>>,
    loops: Loops<Arc<LoopLine>, SetValue, EnableLine>,
    outputs: Arc<LoopOutputs>,
    full: u16,
    motors: [SimulatedMotor; 3],
    units: Units,
    references: [Reference<f64>; 3],
    period_s: f64,
    /// Faults to inject, by motor.
    pub faults: [LoopFaults; 3],
}

/// Motor, its amplifier and its encoder.
struct SimulatedMotor {
    amplifier: AmplifierParameters,
    stage: PowerStage,
    /// Counts per rad of the joint, negative where reversed.
    counts_per_rad: f64,
    /// Angle at count 0, and the present one with everything that it has turned, rad.
    start: f64,
    angle: f64,
    counter: u16,
}

/// Outputs of a board.
#[derive(Debug, Default)]
struct LoopOutputs {
    counts: [AtomicU16; 3],
    on: AtomicBool,
}

/// PWM output of the set value of motor `.1`, of `.2` counts.
struct SetValue(Arc<LoopOutputs>, usize, u16);

/// Line that enables the amplifiers, which are on where it is high.
struct EnableLine(Arc<LoopOutputs>);

impl pwm::ErrorType for SetValue {
    type Error = Infallible;
}

impl SetDutyCycle for SetValue {
    fn max_duty_cycle(&self) -> u16 {
        self.2
    }

    fn set_duty_cycle(&mut self, duty: u16) -> Result<(), Infallible> {
        self.0.counts[self.1].store(duty, Ordering::Relaxed);
        Ok(())
    }
}

impl digital::ErrorType for EnableLine {
    type Error = Infallible;
}

impl OutputPin for EnableLine {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.0.on.store(false, Ordering::Relaxed);
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.0.on.store(true, Ordering::Relaxed);
        Ok(())
    }
}

impl SimulatedLoops {
    /// Builds the motors of `scene` with `per_tick` samples in each tick, for ticks in `units`, their joints at `start`; none
    /// unless the scene has [loops](Scene::loop_motors).
    pub fn build<N: Countable>(
        scene: &Scene,
        per_tick: u32,
        units: Units,
        start: [f64; 3],
    ) -> Option<Self> {
        let loops = scene.loop_motors()?;
        let drives = scene.drives?;
        let motor = |leg: usize| SimulatedMotor::build(&drives[leg], &loops[leg], start[leg]);
        let motors = [motor(0)?, motor(1)?, motor(2)?];
        let DriveKind::Bldc(first) = drives[0].kind else {
            return None;
        };
        let full = (TIMER_HZ / first.command_hz).min(f64::from(u16::MAX)) as u16;
        let line = Arc::new(LoopLine::new());
        let outputs = Arc::new(LoopOutputs::default());
        let set_value = |leg| SetValue(Arc::clone(&outputs), leg, full);
        let Ok(enable) = Enable::new(EnableLine(Arc::clone(&outputs)), Active::High);
        let loop_units = LoopUnits {
            rate_rad_s: units.rate_rad_s() as f32,
            acceleration_rad_s2: units.acceleration_rad_s2() as f32,
            torque_nm: units.torque_nm() as f32,
            tick_rate_hz: scene.tick_rate_hz as f32,
        };
        let angles = start.map(N::angle_from_f64);
        Some(Self {
            tick: Bldcs::new::<N>(Arc::clone(&line), loop_units, angles),
            loops: Loops::new(
                line,
                &loops,
                [set_value(0), set_value(1), set_value(2)],
                enable,
                per_tick,
            ),
            outputs,
            full,
            motors,
            units,
            references: start.map(Reference::standing),
            period_s: scene.period_s() / f64::from(per_tick),
            faults: [LoopFaults::default(); 3],
        })
    }

    /// Switches on, with joints that brakes hold where they stand.
    pub(crate) fn enable<N: Countable>(&mut self) {
        let start = self.motors.each_ref().map(|motor| motor.start);
        self.apply(&Output {
            motors: start.map(|angle| standing::<N>(N::angle_from_f64(angle))),
            tool: N::ZERO,
            power: Power::On,
            brake_released: false,
        });
        self.step(start);
    }

    /// Returns what the loops have measured.
    pub fn measure<N: Countable>(&mut self) -> [DriveReading<N>; 3] {
        self.tick.measure()
    }

    /// Gives the loops the output of a tick.
    pub fn apply<N: Countable>(&mut self, output: &Output<N>) {
        self.references = output
            .motors
            .each_ref()
            .map(|motor| reference(motor, &self.units));
        self.tick.apply(output);
    }

    /// Follows a new zero of the joint angles.
    pub fn shift<N: Countable>(&mut self, by: [N::Angle; 3]) {
        self.tick.shift::<N>(by);
    }

    /// Runs a sample of the loops with joints at `angles`, rad, in any turn. Returns the torques that the amplifiers are to
    /// give, N m.
    pub fn step(&mut self, angles: [f64; 3]) -> [f64; 3] {
        for ((motor, angle), faults) in self.motors.iter_mut().zip(angles).zip(&self.faults) {
            motor.angle += wrapped(angle - motor.angle);
            if !faults.stuck {
                let count = (motor.counts_per_rad * (motor.angle - motor.start)).round() as i64;
                motor.counter = (count + i64::from(faults.slipped)) as u16;
            }
        }
        let counters = self.motors.each_ref().map(|motor| motor.counter);
        self.loops
            .sample(counters, self.faults.map(|faults| faults.failed));
        let on = self.outputs.on.load(Ordering::Relaxed);
        let mut torques = [0.0; 3];
        for (leg, torque) in torques.iter_mut().enumerate() {
            let faults = &self.faults[leg];
            if on && !faults.failed && !faults.dead {
                let counts = self.outputs.counts[leg].load(Ordering::Relaxed);
                *torque = torque_of(&self.motors[leg].amplifier, counts, self.full);
            }
        }
        torques
    }
}

impl SimulatedMotor {
    fn build(drive: &Drive, looped: &LoopMotor, start: f64) -> Option<Self> {
        let counts = f64::from(drive.encoder_counts_per_rev?) * drive.gear_ratio / TAU;
        Some(Self {
            amplifier: looped.amplifier,
            stage: PowerStage::of(drive)?,
            counts_per_rad: if drive.reversed { -counts } else { counts },
            start,
            angle: start,
            counter: 0,
        })
    }
}

impl<N: Countable> SimulatedDrives<N> for SimulatedLoops {
    fn measure(&mut self) -> Option<[DriveReading<N>; 3]> {
        Some(Self::measure(self))
    }

    fn tick(&mut self, output: &Output<N>) -> Result<(), Refusal> {
        self.apply(output);
        Ok(())
    }

    fn sample(&mut self, slot: u32, measured: &[Measured; 3]) -> Commands {
        let torques = self.step(measured.map(|measured| measured.angle));
        let elapsed = f64::from(slot) * self.period_s;
        let mut commands = Commands {
            angle: self
                .references
                .map(|reference| reference.after(elapsed).angle),
            ..Commands::default()
        };
        for (leg, motor) in self.motors.iter().enumerate() {
            let torque = torques[leg];
            let (voltage, limited) = motor.stage.voltage(torque, measured[leg].rate);
            commands.held[leg] = voltage;
            // The set value has steps.
            let most = motor.stage.torque_max_nm() * (1.0 - 1e-3);
            commands.limited[leg] = match (limited, torque.abs() >= most) {
                (true, _) => Some(DriveLimit::Voltage),
                (false, true) => Some(DriveLimit::Current),
                (false, false) => None,
            };
        }
        commands
    }
}
