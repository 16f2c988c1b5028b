//! Machine behind amplifiers and encoders: set values of PWM in, counts of the encoders out.

use crate::time::{MICROSECOND, Time, seconds};
use anyhow::{Context, Result, anyhow};
use std::f64::consts::TAU;
use trirrr_drives::bldc::{AmplifierParameters, torque_of};
use trirrr_plant::moved::MovedMachine;
use trirrr_scene::Scene;

/// Shortest time that the machine is moved on by: between registers that are written together nothing turns.
const SHORTEST: Time = MICROSECOND;

pub(crate) struct Rotors {
    machine: MovedMachine,
    amplifiers: [AmplifierParameters; 3],
    /// Counts per rad of the joint, negative where reversed.
    counts_per_rad: [f64; 3],
    start: [f64; 3],
    counted: [i64; 3],
    at: Time,
    /// A wire of the encoder is broken: it does not count.
    pub(crate) broken_wire: [bool; 3],
    /// Reason for which the machine does not move on.
    pub(crate) broken: Option<String>,
}

impl Rotors {
    /// Builds the machine of a scene at rest at the start of its job.
    pub(crate) fn of_scene(scene: &Scene) -> Result<Self> {
        let machine = MovedMachine::build(scene).map_err(|refusal| anyhow!("{refusal}"))?;
        let loops = scene.loop_motors().context("motors with encoders")?;
        let drives = scene.drives.as_ref().context("drives")?;
        let mut counts_per_rad = [0.0; 3];
        for (counts, drive) in counts_per_rad.iter_mut().zip(drives) {
            let per_rev = drive.encoder_counts_per_rev.context("an encoder")?;
            let sign = if drive.reversed { -1.0 } else { 1.0 };
            *counts = sign * f64::from(per_rev) * drive.gear_ratio / TAU;
        }
        Ok(Self {
            start: machine.angles(),
            machine,
            amplifiers: loops.map(|motor| motor.amplifier),
            counts_per_rad,
            counted: [0; 3],
            at: 0,
            broken_wire: [false; 3],
            broken: None,
        })
    }

    /// Joint angles, rad.
    pub(crate) fn angles(&self) -> [f64; 3] {
        self.machine.angles()
    }

    /// Lets the machine go on to `now` with set values of so many `counts` of `full`; none while the amplifiers are off. Returns
    /// the counts that the encoders have made.
    pub(crate) fn advance(&mut self, now: Time, set: Option<[(u16, u16); 3]>) -> [i32; 3] {
        let passed = now.saturating_sub(self.at);
        if passed < SHORTEST || self.broken.is_some() {
            return [0; 3];
        }
        self.at = now;
        let mut torques = [0.0; 3];
        if let Some(set) = set {
            for (leg, torque) in torques.iter_mut().enumerate() {
                let (counts, full) = set[leg];
                *torque = torque_of(&self.amplifiers[leg], counts, full);
            }
        }
        if let Err(refusal) = self.machine.advance(torques, seconds(passed)) {
            self.broken = Some(refusal.to_string());
        }
        let angles = self.machine.angles();
        let mut turned = [0; 3];
        for (leg, turned) in turned.iter_mut().enumerate() {
            let count = (self.counts_per_rad[leg] * (angles[leg] - self.start[leg])).round() as i64;
            let new = count - self.counted[leg];
            self.counted[leg] = count;
            if !self.broken_wire[leg] {
                *turned = new as i32;
            }
        }
        turned
    }
}
