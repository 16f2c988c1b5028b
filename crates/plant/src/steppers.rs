//! Stepper drives as on a board: the tick's half, the slots, and drivers that count their pulses.

use crate::control::{Commands, Measured};
use crate::driver::{DriverInput, Drivers, Pin};
use crate::drives::{SimulatedDrives, reference};
use crate::refusal::Refusal;
use std::f64::consts::TAU;
use std::sync::Arc;
use trirrr_core::units::Units;
use trirrr_drives::count::Countable;
use trirrr_drives::joint::Reference;
use trirrr_drives::stepper::StepsPerTurn;
use trirrr_drives::stepper::{self, Axis, Line, Slots, Steppers};
use trirrr_drives::{Active, Enable};
use trirrr_scene::{DriveKind, EnableLevel, Scene, Stepper};
use trirrr_service::Output;

/// Three stepper drives and their motors' drivers.
pub(crate) struct SimulatedSteppers<'l, N: Countable> {
    steppers: Steppers<'l, N>,
    slots: Slots<'l, Pin, Pin, Pin>,
    drivers: Arc<Drivers>,
    /// Angle of the joint for a microstep of its driver, rad; negative for a reversed drive.
    microstep_rad: [f64; 3],
    units: Units,
    references: [Reference<f64>; 3],
    /// Time from one slot to the next, s.
    period_s: f64,
}

/// The steppers of `scene`, where its drives are some.
pub(crate) fn of_scene(scene: &Scene) -> Option<[Stepper; 3]> {
    let stepper = |index: usize| match scene.drives.as_ref()?[index].kind {
        DriveKind::Stepper(stepper) => Some(stepper),
        _ => None,
    };
    Some([stepper(0)?, stepper(1)?, stepper(2)?])
}

/// Slots in each tick on a board, whose timer is set by the fastest of `motors`.
///
/// # Errors
/// [`Refusal::Scene`]: a motor without `step_rate_limit_hz`.
pub(crate) fn slots_per_tick(scene: &Scene, motors: &[Stepper; 3]) -> Result<u32, Refusal> {
    let mut most = 0;
    for motor in motors {
        let limit = motor.step_rate_limit_hz.ok_or_else(|| Refusal::Scene {
            key: "drive.step_rate_limit_hz".into(),
            reason: "missing: the timer that puts the steps out is set by it".into(),
        })?;
        most = most.max(stepper::most_per_tick(limit, scene.tick_rate_hz));
    }
    Ok(stepper::slots_per_tick(most))
}

impl<'l, N: Countable> SimulatedSteppers<'l, N> {
    /// Builds the drives of `motors` with `per_tick` slots in each tick, for ticks in `units`. The
    /// joints stand at `start`.
    ///
    /// # Errors
    /// [`Refusal::Scene`]: no drives.
    pub(crate) fn build(
        scene: &Scene,
        motors: &[Stepper; 3],
        per_tick: u32,
        units: Units,
        start: [f64; 3],
        line: &'l Line,
    ) -> Result<Self, Refusal> {
        let drives = scene.drives.ok_or_else(|| Refusal::Scene {
            key: "drive".into(),
            reason: "missing".into(),
        })?;
        let gear = |index: usize| drives[index].gear_ratio;
        let per_turn = motors.map(|motor| motor.steps_per_rev * motor.microsteps);
        // Two slots for each microstep, and one for the direction.
        let room = per_tick.saturating_sub(1) / 2;
        let most = motors.map(|motor| {
            let limit = motor.step_rate_limit_hz.unwrap_or(f64::INFINITY);
            stepper::most_per_tick(limit, scene.tick_rate_hz).min(room)
        });
        let (active, on_high) = match motors[0].enable {
            EnableLevel::Low => (Active::Low, false),
            EnableLevel::High => (Active::High, true),
        };
        let drivers = Drivers::new(on_high);
        let axis = |index: usize| {
            let step = drivers.pin(DriverInput::Step(index));
            let direction = drivers.pin(DriverInput::Direction(index));
            let Ok(axis) = Axis::new(step, direction, drives[index].reversed);
            axis
        };
        let Ok(enable) = Enable::new(drivers.pin(DriverInput::Enable), active);
        Ok(Self {
            steppers: Steppers::new(
                [0, 1, 2].map(|index| StepsPerTurn::new(per_turn[index], gear(index))),
                most,
                start.map(N::angle_from_f64),
                line,
            ),
            slots: Slots::new(line, [axis(0), axis(1), axis(2)], enable, per_tick),
            microstep_rad: [0, 1, 2].map(|index| {
                let size = TAU / (f64::from(per_turn[index]) * gear(index));
                if drives[index].reversed { -size } else { size }
            }),
            drivers,
            units,
            references: start.map(Reference::standing),
            period_s: scene.period_s() / f64::from(per_tick),
        })
    }
}

impl<N: Countable> SimulatedDrives<N> for SimulatedSteppers<'_, N> {
    fn tick(&mut self, output: &Output<N>) -> Result<(), Refusal> {
        self.references = output
            .motors
            .each_ref()
            .map(|motor| reference(motor, &self.units));
        self.steppers
            .apply(output)
            .map_err(|failure| Refusal::Drive {
                motor: failure.drive.unwrap_or(0).into(),
                reason: format!(
                    "{:.3} times as many microsteps in a tick as it can put out",
                    failure.value.to_f64()
                ),
            })
    }

    fn sample(&mut self, slot: u32, _: &[Measured; 3]) -> Commands {
        let Ok(()) = self.slots.slot();
        let elapsed = f64::from(slot) * self.period_s;
        let microsteps = self.drivers.microsteps();
        Commands {
            held: [0, 1, 2].map(|leg| f64::from(microsteps[leg]) * self.microstep_rad[leg]),
            angle: self
                .references
                .map(|reference| reference.after(elapsed).angle),
            limited: [None; 3],
        }
    }
}
