//! Telemetry as the records of a run.

use crate::describe::Units;
use crate::runner::PlayedTick;
use trirrr_core::status::Status;
use trirrr_protocol::message::{State, Telemetry, TelemetryFields, Transmit};
use trirrr_scene::pipeline::Pipeline;
use trirrr_scene::record::Record;

/// Turns the samples of one job into records.
///
/// A sample carries the setpoint and the twelve results for the motors. The rest of a record (distal
/// links, det A, distances to singularity) comes from the motion that the machine played. Over a
/// line there is no motion: the same model computes it again from the setpoint, to the same bits.
pub struct Samples<'a, N: Transmit> {
    pipeline: &'a dyn Pipeline<N>,
    units: Units,
    /// Tick of the machine at which the job started.
    start: Option<u32>,
    /// Tick of the last record.
    last: Option<u32>,
    missing: u64,
    differing: u64,
}

impl<'a, N: Transmit> Samples<'a, N> {
    /// Takes the samples of a job on a machine with the model of `pipeline`, in `units`.
    pub fn new(pipeline: &'a dyn Pipeline<N>, units: Units) -> Self {
        Self {
            pipeline,
            units,
            start: None,
            last: None,
            missing: 0,
            differing: 0,
        }
    }

    /// Returns true if there was a sample.
    pub fn have_begun(&self) -> bool {
        self.start.is_some()
    }

    /// Returns the number of samples that the line lost or the machine dropped.
    pub fn missing(&self) -> u64 {
        self.missing
    }

    /// Returns the number of samples in which the motors are not where the scene puts them: the
    /// machine runs another scene, or another version of the core.
    pub fn differing(&self) -> u64 {
        self.differing
    }

    /// Returns the record of a tick in this program, its time counted from the start of the job.
    ///
    /// # Errors
    /// [`Status::OutOfRange`] if a value of the record is not finite.
    pub fn played(&mut self, tick: &PlayedTick<N>) -> Result<Record, Status> {
        let sample = &tick.sample;
        let t = self.time(sample, 1);
        let mut record = match &tick.motion {
            Some(motion) => self.pipeline.record(t, &sample.setpoint, motion)?,
            // A machine that stands computes no motion.
            None => self.pipeline.evaluate(t, &sample.setpoint)?,
        };
        record.tool = sample.tool.to_f64();
        Ok(record)
    }

    /// Returns the record of a sample that came over a line, its time counted from the start of the
    /// job. Samples come `every` ticks, with the fields of the setpoint and the tool. What they lack of the motors is computed.
    ///
    /// # Errors
    /// [`Status`] of a setpoint without a motion on this machine.
    pub fn record(&mut self, sample: &Telemetry<N>, every: u16) -> Result<Record, Status> {
        let t = self.time(sample, every);
        let computed = self.pipeline.evaluate(t, &sample.setpoint)?;
        let mut record = computed;
        let has = |field| sample.fields.contain(field);
        let rate = 1.0 / self.units.time_s;
        let torque =
            self.units.mass_kg * (self.units.length_m * rate) * (self.units.length_m * rate);
        for (i, leg) in record.legs.iter_mut().enumerate() {
            if has(TelemetryFields::ANGLES) {
                leg.th1 = N::angle_to_f64(sample.angles[i]);
            }
            if has(TelemetryFields::RATES) {
                leg.dth1 = sample.rates[i].to_f64() * rate;
            }
            if has(TelemetryFields::ACCELERATIONS) {
                leg.ddth1 = sample.accelerations[i].to_f64() * (rate * rate);
            }
            if has(TelemetryFields::TORQUES) {
                leg.torque = sample.torques[i].to_f64() * torque;
            }
            if has(TelemetryFields::RATES | TelemetryFields::TORQUES) {
                leg.power = (sample.torques[i] * sample.rates[i]).to_f64() * (torque * rate);
            }
        }
        self.differing += u64::from(record != computed);
        record.tool = sample.tool.to_f64();
        Ok(record)
    }

    /// Returns the time since the start of the job, s, and counts the samples that are missing.
    fn time(&mut self, sample: &Telemetry<N>, every: u16) -> f64 {
        let start = *self.start.get_or_insert_with(|| started(sample));
        if let Some(last) = self.last {
            let steps = sample.tick.wrapping_sub(last) / u32::from(every.max(1));
            self.missing += u64::from(steps.saturating_sub(1));
        }
        self.last = Some(sample.tick);
        f64::from(sample.tick.wrapping_sub(start)) / self.units.tick_rate_hz
    }
}

/// Returns true if a sample in `state` belongs to a job: the machine plays it, or stands on its path.
pub fn is_of_a_job(state: State) -> bool {
    match state {
        State::Running | State::Slowing | State::Stopping | State::Holding | State::Reacting => {
            true
        }
        State::Idle
        | State::Fault
        | State::Cleared
        | State::Recovering
        | State::Unhomed
        | State::Homing
        | State::Disabled
        | State::Enabling
        | State::Disabling => false,
    }
}

/// Tick at which the job of its first sample started.
fn started<N: Transmit>(sample: &Telemetry<N>) -> u32 {
    sample.tick.wrapping_sub(sample.at)
}
