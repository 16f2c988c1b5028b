//! Section "lagrange": torques of the core, by virtual work, beside those of Lagrange's equations.

mod core_loads;
mod variants;

use super::page::Page;
use super::progress::Progress;
use super::table::{Table, two_digits};
use crate::error::ReportError;
use core_loads::CoreLoads;
use rayon::prelude::*;
use trirrr_truth::lagrange::{LagrangeMachine, LagrangeState};
use variants::{Variant, all};

/// States of each job, evenly.
const OF_JOB: usize = 101;
/// Random states of each machine, each on a machine of its own.
const RANDOM: usize = 100;

/// Steps of the section: the machines.
pub(crate) const STEPS: usize = variants::COUNT;

/// Differences of one machine, over all its states.
struct LagrangeDifference {
    /// The machine.
    name: &'static str,
    /// Loads on it besides the motors.
    loads: &'static str,
    /// States that were compared, of the move and random ones.
    states: [usize; 2],
    /// Greatest difference of a motor's torque over the greatest torque of the state.
    torque: f64,
    /// Greatest difference of a slider's force over the greatest force of the state, in base joints and sliders; none
    /// without sliders.
    force: Option<f64>,
    /// Least distance to a parallel singularity among the states.
    parallel: f64,
}

fn compare(variant: &Variant) -> LagrangeDifference {
    let mut found = LagrangeDifference {
        name: variant.name,
        loads: variant.loads,
        states: [0; 2],
        torque: 0.0,
        force: None,
        parallel: f64::INFINITY,
    };
    for part in 0..OF_JOB {
        let state = &variant.job[part * (variant.job.len() - 1) / (OF_JOB - 1)];
        found.states[0] += usize::from(found.take(&variant.machine, state, &variant.wanted));
    }
    let mut seed = 0;
    while found.states[1] < RANDOM && seed < 100 * RANDOM as u64 {
        seed += 1;
        let (machine, state, wanted) = variant.random(seed);
        found.states[1] += usize::from(found.take(&machine, &state, &wanted));
    }
    found
}

impl LagrangeDifference {
    /// Compares one state. Returns `false` where the machine has no motion, or is near a singularity.
    fn take(&mut self, machine: &LagrangeMachine, state: &LagrangeState, wanted: &[f64]) -> bool {
        let Some(core) = CoreLoads::of(machine, state, wanted) else {
            return false;
        };
        let Some(loads) = machine.loads(state, wanted) else {
            return false;
        };
        let largest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
        let scale = largest(&mut loads.torques.iter().map(|it| it.value().abs()));
        let torques = loads.torques.iter().zip(&core.torques);
        let off = largest(&mut torques.map(|(truth, &own)| truth.error_of(own).abs()));
        self.torque = self.torque.max(off / scale);
        let forces = loads.sliders.iter().zip(&core.forces);
        for (truth, own) in forces {
            if let (Some(truth), Some(own)) = (truth, own) {
                let off = truth.error_of(*own).abs() / core.force_scale;
                self.force = Some(self.force.unwrap_or(0.0).max(off));
            }
        }
        self.parallel = self.parallel.min(core.parallel);
        true
    }
}

/// Writes the section.
pub(super) fn write(page: &mut Page, progress: &Progress<'_>) -> Result<(), ReportError> {
    let variants = all()?;
    let found: Vec<LagrangeDifference> = variants
        .par_iter()
        .map(|variant| progress.step(compare(variant)))
        .collect();
    page.heading(2, "Torques beside Lagrange's equations");
    page.paragraph(
        "Each machine on the ticks of its job, and random machines of the kind in random states. The differences are \
         those of the core in f64, relative to the greatest torque and the greatest force of the state.",
    );
    let mut table = Table::new(&[
        "machine",
        "with",
        "states of the job",
        "random states",
        "least parallel distance",
        "torques",
        "slider forces",
    ]);
    for each in &found {
        table.row([
            each.name.into(),
            each.loads.into(),
            each.states[0].to_string(),
            each.states[1].to_string(),
            two_digits(each.parallel),
            two_digits(each.torque),
            each.force.map_or_else(|| "-".into(), two_digits),
        ]);
    }
    page.block("lagrange", true, &table.markdown());
    page.csv("lagrange.csv", &table)
}
