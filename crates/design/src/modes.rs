//! The eight working modes of a machine on one job.

use trirrr_core::machine::Elbow;
use trirrr_core::units::Units;
use trirrr_scene::record::Record;
use trirrr_scene::{JobPlayer, Scene, pipeline};

/// Result of a job in one working mode.
#[derive(Clone, Debug, PartialEq)]
pub struct ModeResult {
    /// Signs of the elbows.
    pub elbows: [Elbow; 3],
    /// First reason why the job cannot be done, with its time, s. None: every instant keeps reach and distances.
    pub fault: Option<ModeFault>,
    /// Figures of the job until the fault, if there is an instant before it.
    pub figures: Option<ModeFigures>,
}

/// Reason why a working mode does not do a job.
#[derive(Clone, Debug, PartialEq)]
pub struct ModeFault {
    /// Time in the job, s.
    pub t_s: f64,
    /// The reason, in words.
    pub reason: String,
}

/// Figures of a job in one working mode.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct ModeFigures {
    /// Largest torques, N m.
    pub torque_peak_nm: [f64; 3],
    /// Root mean squares of the torques, N m.
    pub torque_rms_nm: [f64; 3],
    /// Largest rates, rad/s.
    pub rate_peak_rad_s: [f64; 3],
    /// Largest powers, W.
    pub power_peak_w: [f64; 3],
    /// Work that the motors give, J; what they take back is not counted.
    pub work_j: f64,
    /// Least distance to a serial singularity, 0 to 1.
    #[serde(rename = "serial_distance_min")]
    pub serial_min: f64,
    /// Least distance to the parallel singularity, 0 to 1.
    #[serde(rename = "parallel_distance_min")]
    pub parallel_min: f64,
    /// Largest part of a limit of the scene (rate, acceleration, torque, power); 0 without limits.
    pub limit_part: f64,
    /// Part of the time in which a motor is at 95 % of a limit or more.
    pub time_at_limits: f64,
}

impl ModeResult {
    /// Returns true if the motors keep their limits, too.
    pub fn is_feasible(&self) -> bool {
        self.fault.is_none()
            && self
                .figures
                .is_some_and(|figures| figures.limit_part <= 1.0 + 1e-6)
    }

    /// The elbows as `+-+`.
    pub fn name(&self) -> String {
        self.elbows
            .iter()
            .map(|elbow| if elbow.sign() > 0.0 { '+' } else { '-' })
            .collect()
    }
}

/// Does the job of `scene`, the same motion of the platform, in another working mode.
///
/// # Errors
/// The machine is refused.
pub fn in_mode(scene: &Scene, elbows: [Elbow; 3]) -> Result<ModeResult, String> {
    let mut changed = scene.clone();
    for (leg, elbow) in changed.parameters.legs.iter_mut().zip(elbows) {
        leg.elbow = elbow;
    }
    job_in(&changed, 1.0)
}

/// The eight working modes.
pub const MODES: [[Elbow; 3]; 8] = {
    use Elbow::{Negative as N, Positive as P};
    [
        [P, P, P],
        [N, P, P],
        [P, N, P],
        [N, N, P],
        [P, P, N],
        [N, P, N],
        [P, N, N],
        [N, N, N],
    ]
};

/// Does the job of `scene` in the working mode of the scene, in `factor` times its duration.
///
/// # Errors
/// The machine is refused.
pub fn job_in(scene: &Scene, factor: f64) -> Result<ModeResult, String> {
    // With torques, also where the tick of the scene computes none.
    let machine = pipeline::build_in::<f64>(&scene.parameters, Units::SI)
        .map_err(|error| error.to_string())?;
    let player = JobPlayer::<f64>::new(&scene.job, scene.period_s());
    let period_s = factor * scene.period_s();
    let mut sums = Sums::default();
    let mut side = None;
    let mut fault = None;
    for (tick, mut setpoint) in player.setpoints().enumerate() {
        let t_s = tick as f64 * period_s;
        setpoint.velocity /= factor;
        setpoint.acceleration /= factor * factor;
        let record = match machine.evaluate(t_s, &setpoint) {
            Ok(record) => record,
            Err(status) => {
                let reason = status.to_string();
                fault = Some(ModeFault { t_s, reason });
                break;
            }
        };
        let own = record.det_a > 0.0;
        if let Some(reason) = broken(scene, &record, *side.get_or_insert(own)) {
            fault = Some(ModeFault { t_s, reason });
            break;
        }
        sums.add(scene, &record, period_s);
    }
    Ok(ModeResult {
        elbows: scene.parameters.legs.each_ref().map(|leg| leg.elbow),
        fault,
        figures: sums.figures(),
    })
}

/// Condition of reach that a pose breaks.
fn broken(scene: &Scene, record: &Record, side: bool) -> Option<String> {
    let limits = &scene.limits;
    for (index, leg) in record.legs.iter().enumerate() {
        if leg.serial < limits.serial_distance_min {
            return Some(format!(
                "leg {} is {:.4} from its serial singularity, at least {} is asked for",
                index + 1,
                leg.serial,
                limits.serial_distance_min
            ));
        }
    }
    if record.parallel < limits.parallel_distance_min {
        return Some(format!(
            "the machine is {:.4} from a parallel singularity, at least {} is asked for",
            record.parallel, limits.parallel_distance_min
        ));
    }
    ((record.det_a > 0.0) != side).then(|| "the machine passes a parallel singularity".into())
}

#[derive(Default)]
struct Sums {
    count: f64,
    peaks: [[f64; 3]; 3],
    squares: [f64; 3],
    work_j: f64,
    distances: Option<[f64; 2]>,
    limit_part: f64,
    at_limits: f64,
}

impl Sums {
    fn add(&mut self, scene: &Scene, record: &Record, period_s: f64) {
        let limits = &scene.limits;
        let mut part: f64 = 0.0;
        for (motor, leg) in record.legs.iter().enumerate() {
            let values = [leg.torque, leg.dth1, leg.power];
            for (peaks, value) in self.peaks.iter_mut().zip(values) {
                peaks[motor] = peaks[motor].max(value.abs());
            }
            self.squares[motor] += leg.torque * leg.torque;
            self.work_j += leg.power.max(0.0) * period_s;
            for (limit, value) in [
                (limits.torque_nm, leg.torque),
                (limits.rate_rad_s, leg.dth1),
                (limits.acceleration_rad_s2, leg.ddth1),
                (limits.power_w, leg.power),
            ] {
                if let Some(limit) = limit {
                    part = part.max(value.abs() / limit[motor]);
                }
            }
        }
        self.limit_part = self.limit_part.max(part);
        self.at_limits += f64::from(u8::from(part >= 0.95));
        let serial = record.legs.iter().map(|leg| leg.serial).fold(1.0, f64::min);
        let [least, parallel] = self.distances.unwrap_or([1.0; 2]);
        self.distances = Some([least.min(serial), parallel.min(record.parallel)]);
        self.count += 1.0;
    }

    fn figures(self) -> Option<ModeFigures> {
        let [serial_min, parallel_min] = self.distances?;
        let [torque_peak_nm, rate_peak_rad_s, power_peak_w] = self.peaks;
        Some(ModeFigures {
            torque_peak_nm,
            torque_rms_nm: self.squares.map(|sum| (sum / self.count).sqrt()),
            rate_peak_rad_s,
            power_peak_w,
            work_j: self.work_j,
            serial_min,
            parallel_min,
            limit_part: self.limit_part,
            time_at_limits: self.at_limits / self.count,
        })
    }
}
