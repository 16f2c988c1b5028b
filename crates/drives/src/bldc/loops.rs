//! Half above the tick: from counts to torque to duty.

use super::amplifier::{Amplifier, AmplifierParameters};
use super::encoder::{Encoder, EncoderScale};
use super::line::{Counted, LoopLine, Measurements};
use crate::Enable;
use crate::count::Countable;
use crate::joint::{Loop, LoopParameters, Reference};
use core::f64::consts::TAU;
use core::ops::Deref;
use embedded_hal::digital::OutputPin;
use embedded_hal::pwm::SetDutyCycle;

/// Ticks without a reference after which the loops let go: the tick hangs.
const PATIENCE_TICKS: u32 = 3;

/// A motor with an amplifier and an encoder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoopMotor {
    /// Set value of the amplifier.
    pub amplifier: AmplifierParameters,
    /// Scale of the encoder.
    pub encoder: EncoderScale,
    /// Bandwidth of the rate that is found from counts, rad/s.
    pub encoder_bandwidth_rad_s: f32,
    /// Angle by which the gear gives way to a torque at the joint, rad/(N m); 0 for a stiff one. The rotor is sent ahead by so much.
    pub compliance_rad_nm: f32,
    /// Controller of the joint.
    pub controller: LoopParameters,
}

/// Motor, its output and the state of its loop.
#[derive(Debug)]
struct LoopJoint<W> {
    encoder: Encoder,
    inner: Loop<f32>,
    amplifier: Amplifier,
    compliance: f32,
    pwm: W,
}

/// Loops of three joints, to be run from a timer.
#[derive(Debug)]
pub struct Loops<L, W, E> {
    line: L,
    joints: [LoopJoint<W>; 3],
    enable: Enable<E>,
    /// Samples in a tick.
    per_tick: u32,
    period_s: f32,
    /// rad/s per 2^-32 of a turn in a sample.
    rate_unit: f32,
    round: u32,
    /// Samples since the round began.
    sample: u32,
    references: [Counted; 3],
}

impl<L, W, E> Loops<L, W, E>
where
    L: Deref<Target = LoopLine>,
    W: SetDutyCycle,
    E: OutputPin,
{
    /// Loops that are off, with no current, whose encoders stand at count 0. `per_tick` samples in each tick, positive. The period
    /// of their controllers has to be that of the samples.
    pub fn new(
        line: L,
        motors: &[LoopMotor; 3],
        pwm: [W; 3],
        enable: Enable<E>,
        per_tick: u32,
    ) -> Self {
        let [first, second, third] = motors;
        let period_s = first.controller.period_s as f32;
        let [pwm_1, pwm_2, pwm_3] = pwm;
        let joint = |motor: &LoopMotor, pwm: W| LoopJoint {
            encoder: Encoder::new(motor.encoder, motor.encoder_bandwidth_rad_s, period_s),
            inner: Loop::build(&motor.controller),
            amplifier: Amplifier::build(&motor.amplifier, pwm.max_duty_cycle()),
            compliance: motor.compliance_rad_nm,
            pwm,
        };
        let mut loops = Self {
            line,
            joints: [
                joint(first, pwm_1),
                joint(second, pwm_2),
                joint(third, pwm_3),
            ],
            enable,
            per_tick,
            period_s,
            rate_unit: (TAU / 4_294_967_296.0) as f32 / period_s,
            round: 0,
            sample: u32::MAX,
            references: [Counted::default(); 3],
        };
        loops.release();
        loops
    }

    /// Returns the outputs of the set values, to be started.
    pub fn outputs(&mut self) -> [&mut W; 3] {
        self.joints.each_mut().map(|joint| &mut joint.pwm)
    }

    /// Runs a sample: `counters` of the encoders, and `failed` of the amplifiers. The loops are on in samples of ticks that
    /// ask for it, while no amplifier has failed.
    #[inline(always)]
    pub fn sample(&mut self, counters: [u16; 3], failed: [bool; 3]) {
        for (joint, counter) in self.joints.iter_mut().zip(counters) {
            joint.encoder.sample(counter);
        }
        let torques = match self.follows(failed) {
            true => self.drive(),
            false => {
                self.release();
                [0.0; 3]
            }
        };
        self.line.publish(&Measurements {
            turns: self.joints.each_ref().map(|joint| joint.encoder.turn()),
            torques,
            failed,
        });
    }

    /// Takes the references of a new round. Returns true if there is a motion to follow.
    #[inline(always)]
    fn follows(&mut self, failed: [bool; 3]) -> bool {
        if !self.line.is_on() || failed != [false; 3] {
            // The round under way is over: it does not begin again when the failure ends.
            self.sample = u32::MAX;
            self.round = self.line.round();
            return false;
        }
        let round = self.line.round();
        if round != self.round {
            self.round = round;
            self.references = self.line.references(round);
            self.sample = 0;
        } else {
            self.sample = self.sample.saturating_add(1);
        }
        self.sample < PATIENCE_TICKS.saturating_mul(self.per_tick)
    }

    #[inline(always)]
    fn drive(&mut self) -> [f32; 3] {
        // Late references do not carry the motion farther than their tick.
        let elapsed = self.sample.min(self.per_tick) as f32 * self.period_s;
        let mut torques = [0.0; 3];
        let each = self.joints.iter_mut().zip(&self.references);
        for ((joint, reference), given) in each.zip(&mut torques) {
            let rate = joint.encoder.rate() * self.rate_unit;
            // In whole numbers up to here: binary32 has no more than 24 bits for a turn, and has them for the difference.
            let ahead = reference.turn.wrapping_sub(joint.encoder.turn());
            let reference = Reference {
                angle: f32::angle_of(ahead) + joint.compliance * reference.torque,
                rate: reference.rate,
                acceleration: reference.acceleration,
                torque: reference.torque,
            };
            let asked = joint.inner.torque(&reference.after(elapsed), 0.0, rate);
            let torque = asked.torque;
            // A pin of a microcontroller does not fail.
            let _ = joint.pwm.set_duty_cycle(joint.amplifier.counts(torque));
            *given = torque;
        }
        let _ = self.enable.switch(true);
        torques
    }

    /// Switches the amplifiers off, then sets their currents to 0.
    #[inline(always)]
    fn release(&mut self) {
        let _ = self.enable.switch(false);
        for joint in &mut self.joints {
            joint.inner.reset();
            let _ = joint.pwm.set_duty_cycle(joint.amplifier.counts(0.0));
        }
    }
}
