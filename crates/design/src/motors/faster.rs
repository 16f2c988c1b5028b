//! The least time in which a motor does a job.

use super::{CatalogueMotor, JobLoad};
use trirrr_plan::course::Effort;
use trirrr_scene::plan_job;

/// Parts of the speed without load up to which a motor has at least the torque that it has there: a plan knows one limit of the rate and
/// one of the torque, which together lie below the curve.
const CORNERS: [f64; 3] = [0.25, 0.5, 0.75];

/// Part by which a plan may take longer than its bound.
const GAP: f64 = 0.02;

/// Longest and shortest duration of moves that are looked at, in parts of their own.
const SLOWEST: f64 = 64.0;
const FASTEST: f64 = 1.0 / 64.0;

/// Halvings between two durations.
const HALVINGS: u32 = 30;

impl JobLoad<'_> {
    /// Least time in which the motor does the job with a gear, s. A path is planned anew with the rates and torques of the motor, the
    /// rotor's inertia included, in place of the scene's limits of rate, acceleration, torque and power. Moves are played faster or
    /// slower, all by one factor, until the torque at the speed or the heat is at its limit. None: no duration is long enough, or the
    /// inertia of the rotor, which a shorter time asks the most of, is not known.
    pub fn least_time_s(&self, motor: &CatalogueMotor, gear: f64) -> Option<f64> {
        let rotor = motor.rotor_inertia_kgm2?;
        match &self.scene.job.path {
            Some(_) => self.planned_s(motor, gear, rotor),
            None => self.scaled_s(motor, gear),
        }
    }

    fn planned_s(&self, motor: &CatalogueMotor, gear: f64, rotor: f64) -> Option<f64> {
        let path = self.scene.job.path.as_ref()?;
        let mut scene = self.scene.clone();
        // A scene without torques is planned with them here.
        scene.torque = true;
        for leg in &mut scene.parameters.legs {
            leg.rotor_inertia_kgm2 = rotor * gear * gear;
        }
        scene.limits.acceleration_rad_s2 = None;
        scene.limits.power_w = None;
        let effort = Effort {
            gap: GAP,
            ..Effort::default()
        };
        let times = CORNERS.into_iter().filter_map(|part| {
            let speed = part * motor.no_load_rad_s();
            scene.limits.rate_rad_s = Some([speed / gear; 3]);
            scene.limits.torque_nm = Some([motor.torque_at(speed) * gear; 3]);
            let planned = plan_job(&scene, path, effort).ok()?;
            Some(planned.ticks() as f64 * scene.period_s())
        });
        times.reduce(f64::min)
    }

    fn scaled_s(&self, motor: &CatalogueMotor, gear: f64) -> Option<f64> {
        let is_done = |factor: f64| {
            let asked = self.asked(motor, gear, factor);
            let continuous = motor.torque_continuous_nm.unwrap_or(f64::INFINITY);
            asked.peak_margin >= 1.0 && asked.rms_nm <= continuous
        };
        if !is_done(SLOWEST) {
            return None;
        }
        let (mut low, mut high) = (FASTEST, SLOWEST);
        if is_done(low) {
            high = low;
        }
        for _ in 0..HALVINGS {
            // Of factors, so that short ones are as exact.
            let middle = (low * high).sqrt();
            match is_done(middle) {
                true => high = middle,
                false => low = middle,
            }
        }
        Some(high * self.scene.duration_s())
    }
}
