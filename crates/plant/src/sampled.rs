//! The joint controllers as a drive runs them: the core's drive code at a rate of its own, fed by
//! the ticks.

use super::control::{Commands, Measured, SampledController};
use crate::refusal::Refusal;
use crate::source::TickSource;
use std::f64::consts::TAU;
use trirrr_core::number::Number;
use trirrr_drives::bldc::{Bldc, BldcParameters};
use trirrr_drives::count::Countable;
use trirrr_drives::joint::{Loop, Reference};
use trirrr_drives::stepper::{Schedule, StepMotor, StepsPerTurn};
use trirrr_scene::{DriveKind, Scene, Timing};

/// The controllers of the three joints in the number type `N`.
pub struct Sampled<N: Countable> {
    source: Box<dyn TickSource>,
    per_tick: u32,
    /// Seconds from one sample to the next.
    period: N,
    joints: [Joint<N>; 3],
}

struct Joint<N: Countable> {
    reference: Reference<N>,
    /// None for a stepper.
    inner: Option<Loop<N>>,
    stage: Stage<N>,
}

/// What a joint's drive makes of its command.
enum Stage<N: Countable> {
    Torque,
    Voltage {
        drive: Bldc<N>,
        supply_v: f64,
    },
    Steps {
        motor: StepMotor<N>,
        schedule: Schedule,
        /// Position before the tick's steps.
        before: i32,
        microstep_rad: f64,
    },
}

impl<N: Countable> Sampled<N> {
    /// The controllers of `scene`, fed by `source`; the machine stands with its joints at `start`.
    ///
    /// # Errors
    /// A setpoint without a motion, or a drive without a model.
    pub fn build(
        scene: &Scene,
        mut source: Box<dyn TickSource>,
        start: [f64; 3],
    ) -> Result<Self, Refusal> {
        let controller = scene.plant.as_ref().and_then(|plant| plant.controller);
        let per_tick = match controller.map(|controller| controller.timing) {
            Some(Timing::Sampled { per_tick }) => per_tick,
            _ => 1,
        };
        let rate_hz = scene.tick_rate_hz * f64::from(per_tick);
        let stage = |leg: usize| -> Result<Stage<N>, Refusal> {
            let Some(drives) = &scene.drives else {
                return Ok(Stage::Torque);
            };
            let drive = &drives[leg];
            match drive.kind {
                DriveKind::Bldc(bldc) => Ok(Stage::Voltage {
                    drive: Bldc::build(&BldcParameters {
                        gear_ratio: drive.gear_ratio,
                        resistance_ohm: bldc.resistance_ohm,
                        torque_constant_nm_a: bldc.torque_constant_nm_a,
                        back_emf_constant_v_s_rad: bldc.back_emf_constant_v_s_rad,
                        supply_v: bldc.supply_v,
                        current_limit_a: bldc.current_limit_a,
                    }),
                    supply_v: bldc.supply_v,
                }),
                DriveKind::Stepper(stepper) => {
                    let per_turn = stepper.steps_per_rev * stepper.microsteps;
                    let fastest = stepper.step_rate_limit_hz.unwrap_or(f64::INFINITY);
                    let most = (fastest / scene.tick_rate_hz)
                        .floor()
                        .min(f64::from(i32::MAX));
                    let at = N::angle_from_f64(start[leg]);
                    Ok(Stage::Steps {
                        motor: StepMotor::new(
                            StepsPerTurn::new(per_turn, drive.gear_ratio),
                            most as u32,
                            at,
                        ),
                        schedule: Schedule::new(0, per_tick),
                        before: 0,
                        microstep_rad: TAU / (f64::from(per_turn) * drive.gear_ratio),
                    })
                }
                DriveKind::Can(_) => Err(Refusal::Scene {
                    key: "drive.kind".into(),
                    reason: "a CAN drive has no model of its motor".into(),
                }),
            }
        };
        let tick = source.start()?;
        let joint = |leg: usize| -> Result<Joint<N>, Refusal> {
            let stage = stage(leg)?;
            let by_torque = !matches!(stage, Stage::Steps { .. });
            let inner = match controller {
                Some(controller) if by_torque => Some(Loop::build(
                    controller.kp_nm_rad[leg],
                    controller.kd_nm_s_rad[leg],
                    controller.feed_forward,
                )),
                _ => None,
            };
            Ok(Joint {
                reference: lowered(&tick[leg]),
                inner,
                stage,
            })
        };
        Ok(Self {
            joints: [joint(0)?, joint(1)?, joint(2)?],
            source,
            per_tick,
            period: N::from_f64(1.0 / rate_hz),
        })
    }

    /// Takes the tick at sample `sample`.
    fn take(&mut self, sample: u64) -> Result<(), Refusal> {
        let number = u32::try_from(sample / u64::from(self.per_tick)).unwrap_or(u32::MAX);
        let references = self.source.tick(number)?;
        let ticks = N::ratio(self.per_tick, 1) * self.period;
        for (leg, joint) in self.joints.iter_mut().enumerate() {
            joint.reference = lowered(&references[leg]);
            if let Stage::Steps {
                motor,
                schedule,
                before,
                ..
            } = &mut joint.stage
            {
                // The steps of this tick end where the next begins.
                let target = joint.reference.after(ticks).angle;
                *before = motor.position();
                let steps = motor
                    .move_to(target)
                    .map_err(|reason| Refusal::TooManySteps { motor: leg, reason })?;
                *schedule = Schedule::new(steps, self.per_tick);
            }
        }
        Ok(())
    }
}

/// A reference in the number type of the drive.
fn lowered<N: Number>(reference: &Reference<f64>) -> Reference<N> {
    Reference {
        angle: N::angle_from_f64(reference.angle),
        rate: N::from_f64(reference.rate),
        acceleration: N::from_f64(reference.acceleration),
        torque: N::from_f64(reference.torque),
    }
}

impl<N: Countable> SampledController for Sampled<N> {
    #[inline]
    fn sample(&mut self, tick: u64, measured: &[Measured; 3]) -> Result<Commands, Refusal> {
        let slot = (tick % u64::from(self.per_tick)) as u32;
        if slot == 0 {
            self.take(tick)?;
        }
        let mut commands = Commands::default();
        let elapsed = N::ratio(slot, 1) * self.period;
        for (leg, joint) in self.joints.iter().enumerate() {
            let reference = joint.reference.after(elapsed);
            commands.angle[leg] = N::angle_to_f64(reference.angle);
            let measured = &measured[leg];
            let rate = N::from_f64(measured.rate);
            let torque = joint.inner.as_ref().map_or(N::ZERO, |inner| {
                inner.torque(&reference, N::angle_from_f64(measured.angle), rate)
            });
            commands.held[leg] = match &joint.stage {
                Stage::Torque => torque.to_f64(),
                Stage::Voltage { drive, supply_v } => {
                    let command = drive.command(torque, rate);
                    commands.limited[leg] = command.limited;
                    command.duty.to_f64() * supply_v
                }
                Stage::Steps {
                    schedule,
                    before,
                    microstep_rad,
                    ..
                } => f64::from(before.wrapping_add(schedule.due(slot))) * microstep_rad,
            };
        }
        Ok(commands)
    }
}
