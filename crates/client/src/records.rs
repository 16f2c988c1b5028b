//! Telemetry as the records of a run.

use crate::describe::Units;
use trirrr_core::status::Status;
use trirrr_protocol::message::{State, Telemetry, Transmit};
use trirrr_scene::pipeline::Pipeline;
use trirrr_scene::record::Record;

/// Turns the samples of one job into records.
///
/// A sample carries the setpoint and what it asked of the motors. What else a record holds (the
/// distal links, det A, the distances to singularity) follows from the setpoint and the scene, by
/// the core that the machine runs: the same bits.
pub struct Samples<'a, N: Transmit> {
    evaluator: &'a dyn Pipeline<N>,
    units: Units,
    /// Whether the machine computes torques.
    torque: bool,
    /// The machine's tick at which the job started.
    start: Option<u32>,
    /// The tick of the last record.
    last: Option<u32>,
    missing: u64,
    differing: u64,
}

impl<'a, N: Transmit> Samples<'a, N> {
    /// Of a job on the machine that `evaluator` is the pipeline of, in `units`. `torque`: whether it
    /// computes torques; the samples of one that does not hold 0 there.
    pub fn new(evaluator: &'a dyn Pipeline<N>, units: Units, torque: bool) -> Self {
        Self {
            evaluator,
            units,
            torque,
            start: None,
            last: None,
            missing: 0,
            differing: 0,
        }
    }

    /// Whether there was a sample.
    pub fn have_begun(&self) -> bool {
        self.start.is_some()
    }

    /// Ticks of the job, `every` apart, that no sample came of: the line lost them, or the machine
    /// dropped them.
    pub fn missing(&self) -> u64 {
        self.missing
    }

    /// Samples in which the machine's motors are not where the scene puts them: it runs another
    /// scene, or another version of the core.
    pub fn differing(&self) -> u64 {
        self.differing
    }

    /// The record of a sample, its time counted from the start of the job.
    ///
    /// # Errors
    /// The setpoint has no motion on this machine.
    pub fn record(&mut self, sample: &Telemetry<N>, every: u16) -> Result<Record, Status> {
        let start = *self.start.get_or_insert_with(|| started(sample));
        if let Some(last) = self.last {
            let steps = sample.tick.wrapping_sub(last) / u32::from(every.max(1));
            self.missing += u64::from(steps.saturating_sub(1));
        }
        self.last = Some(sample.tick);
        let t = f64::from(sample.tick.wrapping_sub(start)) / self.units.tick_rate_hz;
        let mut computed = self.evaluator.evaluate(t, &sample.setpoint)?;
        if !self.torque {
            for leg in &mut computed.legs {
                (leg.torque, leg.power) = (0.0, 0.0);
            }
        }
        let mut record = computed;
        let rate = 1.0 / self.units.time_s;
        let torque =
            self.units.mass_kg * (self.units.length_m * rate) * (self.units.length_m * rate);
        for (i, leg) in record.legs.iter_mut().enumerate() {
            leg.th1 = N::angle_to_f64(sample.angles[i]);
            leg.dth1 = sample.rates[i].to_f64() * rate;
            leg.ddth1 = sample.accelerations[i].to_f64() * (rate * rate);
            leg.torque = sample.torques[i].to_f64() * torque;
            leg.power = (sample.torques[i] * sample.rates[i]).to_f64() * (torque * rate);
        }
        self.differing += u64::from(record != computed);
        record.tool = sample.tool.to_f64();
        Ok(record)
    }
}

/// Whether a sample belongs to a job: the machine plays it, or stands on its path.
pub fn is_of_a_job(state: State) -> bool {
    match state {
        State::Running | State::Slowing | State::Stopping | State::Holding => true,
        State::Idle
        | State::Fault
        | State::Cleared
        | State::Recovering
        | State::Unhomed
        | State::Homing => false,
    }
}

/// The tick at which the job of its first sample started.
fn started<N: Transmit>(sample: &Telemetry<N>) -> u32 {
    sample.tick.wrapping_sub(sample.at)
}
