//! `[controller]`: the loops of position and rate around motors that are driven by torque, on a board and in the plant.

use crate::read::{Bound, Place, Section};
use trirrr_drives::joint::LoopParameters;

/// The joint controller: tau = kp e + kd (rate_ref - rate) + ki (integral of e) \[+ tau_ref\], with e = theta_ref - theta.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Controller {
    /// When it acts.
    pub timing: Timing,
    /// Proportional gain at each joint, N m/rad.
    pub kp_nm_rad: [f64; 3],
    /// Derivative gain at each joint, N m s/rad.
    pub kd_nm_s_rad: [f64; 3],
    /// Integral gain at each joint, N m/(rad s); 0 with continuous timing.
    pub ki_nm_rad_s: [f64; 3],
    /// True if the controller adds the torque of the setpoint.
    pub feed_forward: bool,
    /// Bandwidth of the rate that is found from the counts of an encoder, rad/s.
    pub encoder_bandwidth_rad_s: f64,
}

impl Controller {
    /// Controller of joint `leg`, 0 to 2, which gives up to `torque_max_nm` of either sign and is sampled `rate_hz` times per second.
    pub fn of_joint(&self, leg: usize, torque_max_nm: f64, rate_hz: f64) -> LoopParameters {
        LoopParameters {
            kp_nm_rad: self.kp_nm_rad[leg],
            kd_nm_s_rad: self.kd_nm_s_rad[leg],
            ki_nm_rad_s: self.ki_nm_rad_s[leg],
            feed_forward: self.feed_forward,
            torque_max_nm,
            period_s: 1.0 / rate_hz,
        }
    }

    /// Rate of its samples, Hz, at ticks of `tick_rate_hz`; none with continuous timing.
    pub fn sample_rate_hz(&self, tick_rate_hz: f64) -> Option<f64> {
        match self.timing {
            Timing::Continuous => None,
            Timing::Sampled { per_tick } => Some(tick_rate_hz * f64::from(per_tick)),
        }
    }
}

/// When a controller acts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Timing {
    /// At every instant.
    Continuous,
    /// Sampled; its command is held until the next sample.
    Sampled {
        /// Samples in each tick; the samples' rate is the tick rate times this.
        per_tick: u32,
    },
}

/// Fastest joint controller, Hz.
const FASTEST_HZ: f64 = 1e6;
/// Bandwidth of the encoders' rates where the scene does not say, rad/s: as an ODrive is delivered.
const BANDWIDTH_RAD_S: f64 = 1000.0;

/// Reads `[controller]`: `Some(None)` where there is none. `tick_rate_hz` is `None` where it was refused.
pub(crate) fn read_controller(
    root: &Section,
    tick_rate_hz: Option<f64>,
) -> Option<Option<Controller>> {
    if !root.has("controller") {
        return Some(None);
    }
    let section = root.section("controller")?;
    let gain = |key| {
        section.has(key).then_some(()).or_else(|| {
            section.refuse(key, "missing, expected a number, or three");
            None
        })?;
        section.number_or_three(key, Bound::NotNegative)
    };
    let (kp, kd) = (gain("kp_nm_rad"), gain("kd_nm_s_rad"));
    let ki = match section.has("ki_nm_rad_s") {
        true => section.number_or_three("ki_nm_rad_s", Bound::NotNegative),
        false => Some([0.0; 3]),
    };
    let bandwidth = section.number_or("encoder_bandwidth_rad_s", Bound::Positive, BANDWIDTH_RAD_S);
    let feed_forward = match section.has("feed_forward") {
        true => section.boolean("feed_forward"),
        false => Some(true),
    };
    let sampled = match section.has("timing") {
        true => section.choice("timing", &[("continuous", false), ("sampled", true)]),
        false => Some(true),
    };
    let timing = match sampled {
        Some(false) => Some(Timing::Continuous),
        Some(true) => read_rate(&section, tick_rate_hz),
        None => {
            section.ignore_rest();
            None
        }
    };
    let (timing, ki) = (timing?, ki?);
    if timing == Timing::Continuous && ki != [0.0; 3] {
        let reason = "must be 0 with timing = \"continuous\": the integral is that of samples";
        section.refuse("ki_nm_rad_s", reason);
        return None;
    }
    Some(Some(Controller {
        timing,
        kp_nm_rad: kp?,
        kd_nm_s_rad: kd?,
        ki_nm_rad_s: ki,
        feed_forward: feed_forward?,
        encoder_bandwidth_rad_s: bandwidth?,
    }))
}

/// `rate_hz`, a whole multiple of the tick rate.
fn read_rate(section: &Section, tick_rate_hz: Option<f64>) -> Option<Timing> {
    if !section.has("rate_hz") {
        return Some(Timing::Sampled { per_tick: 1 });
    }
    let rate = section.number("rate_hz", Bound::Within(1.0, FASTEST_HZ))?;
    let ticks = tick_rate_hz?;
    let per_tick = (rate / ticks).round();
    if per_tick < 1.0 || (rate - per_tick * ticks).abs() > 1e-9 * rate {
        let reason = format!("must be a whole multiple of tick_rate_hz = {ticks}");
        section.refuse("rate_hz", reason);
        return None;
    }
    Some(Timing::Sampled {
        per_tick: per_tick as u32,
    })
}

/// Refuses a controller that is not sampled, because of `why`.
pub(crate) fn refuse_continuous(root: &Section, why: &str) {
    let place = Place {
        value: None,
        ..root.place_of("controller")
    };
    let reason =
        format!("timing = \"continuous\": {why}, so that the controller has to be sampled");
    root.refuse_at(&place, reason);
}
