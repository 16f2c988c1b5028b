//! Scenes of redundant machines: machine, loads, limits, sliders and a job in one TOML file.
//!
//! The tables that a 3-RRR has too are read by the readers of `trirrr-scene`. `docs/redundant.md` describes the others.
//! A scene is checked whole when it is read: reach, distances and limits at every tick of its job.

mod check;
mod columns;
mod pipeline;
mod player;
mod read;
mod record;
mod sliders;

pub use columns::{columns, row};
pub use pipeline::RedundantPipeline;
pub use player::RedundantPlayer;
pub use record::{RedundantLegRecord, RedundantRecord, SliderRecord};
pub use sliders::{BestPlace, RedundantSlider, SliderLimits};

use super::{RedundantParameters, SliderParameters};
use nalgebra::Vector2;
use trirrr_core::machine::{LegParameters, PlatformParameters};
use trirrr_scene::{Job, MachineKind};

/// Most ticks of a job: each is checked when the scene is read.
pub const TICKS_MAX: u32 = 1_000_000;

/// Checked scene of a redundant machine.
#[derive(Clone, Debug, PartialEq)]
pub struct RedundantScene {
    /// Kind of the machine.
    pub kind: MachineKind,
    /// Name of the scene, fit to name a folder.
    pub name: String,
    /// Description in the author's words; may be empty.
    pub description: String,
    /// Ticks per second.
    pub tick_rate_hz: f64,
    /// Legs, as many as the kind has. Base joints on sliders are those at slider position 0.
    pub legs: Vec<LegParameters>,
    /// Slider of each leg, if it has one.
    pub sliders: Vec<Option<RedundantSlider>>,
    /// Wanted torque of each motor, N m; zeros for the torques of least norm.
    pub preload_nm: Vec<f64>,
    /// The platform.
    pub platform: PlatformParameters,
    /// Gravity in the plane, m/s^2.
    pub gravity_m_s2: [f64; 2],
    /// External force on the platform at D, N.
    pub wrench_force_n: [f64; 2],
    /// External moment on the platform, N m.
    pub wrench_torque_nm: f64,
    /// Limits of motors and machine.
    pub limits: RedundantLimits,
    /// Moves of the platform.
    pub job: Job,
    /// Position of each leg's slider at the end of each move, m; 0 for a leg without one.
    pub slider_moves: Vec<Vec<f64>>,
    /// Result of `place = "best"`, if a slider has that.
    pub placement: Option<BestPlace>,
    /// Simulation of the real machine, if the scene describes one.
    pub plant: Option<RedundantLoop>,
}

/// Limits that a job must keep at every tick. A list has one number for each motor.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RedundantLimits {
    /// rad/s.
    pub rate_rad_s: Option<Vec<f64>>,
    /// rad/s^2.
    pub acceleration_rad_s2: Option<Vec<f64>>,
    /// N m.
    pub torque_nm: Option<Vec<f64>>,
    /// W.
    pub power_w: Option<Vec<f64>>,
    /// Least distance to a serial singularity.
    pub serial_distance_min: f64,
    /// Least distance to a parallel singularity.
    pub parallel_distance_min: f64,
}

/// Control of the simulated machine, and friction that the feed-forward does not know.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RedundantLoop {
    /// Stiffness of the loop round a motor, N m/rad.
    pub kp_nm_rad: f64,
    /// Damping of the loop round a motor, N m s/rad.
    pub kd_nm_s_rad: f64,
    /// Stiffness of the loop round a slider, N/m.
    pub slider_kp_n_m: f64,
    /// Damping of the loop round a slider, N s/m.
    pub slider_kd_n_s_m: f64,
    /// The loops add torques and forces of the model.
    pub feed_forward: bool,
    /// Viscous friction in each motor's joint, N m s/rad.
    pub friction_nm_s_rad: f64,
    /// Viscous friction of each guide, N s/m.
    pub slider_friction_n_s_m: f64,
    /// Mass on the platform's centre of mass that the model does not know, kg.
    pub extra_mass_kg: f64,
}

impl RedundantScene {
    /// Parameters of the machine.
    ///
    /// Returns `None` where the machine has another number of legs than `LEGS`.
    pub fn parameters<const LEGS: usize>(&self) -> Option<RedundantParameters<LEGS>> {
        let sliders = self.sliders.iter();
        let sliders = sliders.map(|slider| slider.map(|slider| slider.parameters()));
        let sliders: Vec<Option<SliderParameters>> = sliders.collect();
        Some(RedundantParameters {
            legs: self.legs.as_slice().try_into().ok()?,
            sliders: sliders.try_into().ok()?,
            platform: self.platform,
            gravity_m_s2: self.gravity_m_s2.into(),
            wrench_force_n: Vector2::from(self.wrench_force_n),
            wrench_torque_nm: self.wrench_torque_nm,
        })
    }

    /// Legs with a slider, from 0.
    pub fn slider_legs(&self) -> Vec<usize> {
        let legs = self.sliders.iter().enumerate();
        legs.filter_map(|(leg, slider)| slider.map(|_| leg))
            .collect()
    }

    /// Seconds per tick.
    pub fn period_s(&self) -> f64 {
        1.0 / self.tick_rate_hz
    }

    /// Duration of the job in ticks; it has one setpoint more.
    pub fn ticks(&self) -> u32 {
        self.job.ticks()
    }

    /// Duration of the job, s: the binary64 number that is nearest.
    pub fn duration_s(&self) -> f64 {
        f64::from(self.ticks()) / self.tick_rate_hz
    }
}
