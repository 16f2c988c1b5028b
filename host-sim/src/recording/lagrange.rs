//! Torques by Lagrange's equations beside those of a run: columns of `ticks.csv`, and the largest difference.

use super::At;
use crate::tick_record::AnyTick;
use trirrr_figures::document::{Facts, digits};
use trirrr_linkage::redundant::scene::{RedundantScene, SliderRecord};
use trirrr_scene::Scene;
use trirrr_scene::words::tick_time;
use trirrr_truth::lagrange::{LagrangeLoads, LagrangeMachine, LagrangeState};

/// Machine by Lagrange's equations, and what it found over a run.
pub struct LagrangeColumns {
    machine: LagrangeMachine,
    wanted: Vec<f64>,
    found: LagrangeFound,
}

/// Differences over a run.
#[derive(Clone, Copy, Debug, Default)]
pub struct LagrangeFound {
    /// Largest difference of a torque, N m. None without a row.
    pub torque: Option<At>,
    /// Greatest torque by Lagrange, N m.
    pub greatest_torque: f64,
    /// Largest difference of a slider's force, N. None without sliders.
    pub force: Option<At>,
    /// Greatest force of a slider by Lagrange, N.
    pub greatest_force: f64,
}

/// State and loads of a machine at one tick.
struct ComparedTick {
    t: f64,
    state: LagrangeState,
    torques: Vec<f64>,
    forces: Vec<Option<f64>>,
}

impl LagrangeColumns {
    /// Columns of a 3-RRR.
    pub fn of_scene(scene: &Scene) -> Self {
        Self {
            machine: LagrangeMachine::from(&scene.parameters),
            wanted: vec![0.0; 3],
            found: LagrangeFound::default(),
        }
    }

    /// Columns of a redundant machine.
    pub fn of_redundant(scene: &RedundantScene) -> Self {
        let sliders = scene.sliders.iter();
        Self {
            machine: LagrangeMachine {
                legs: scene.legs.clone(),
                sliders: sliders.map(|it| it.map(|it| it.parameters())).collect(),
                platform: scene.platform,
                gravity: scene.gravity_m_s2,
                force: scene.wrench_force_n,
                moment: scene.wrench_torque_nm,
            },
            wanted: scene.preload_nm.clone(),
            found: LagrangeFound::default(),
        }
    }

    /// Names of the columns: of each motor, then of each slider.
    pub fn names(&self) -> Vec<String> {
        let motors = (1..=self.machine.legs.len()).map(|leg| format!("tau_lagrange{leg}"));
        let legs = self.machine.slider_legs().into_iter();
        let sliders = legs.map(|leg| format!("Fs_lagrange{}", leg + 1));
        motors.chain(sliders).collect()
    }

    /// Values of a row; not a number where the machine has no motion.
    pub fn row(&mut self, record: &AnyTick) -> Vec<f64> {
        let sliders: Vec<Option<SliderRecord>> = match record.redundant() {
            Some(record) => record.legs.iter().map(|leg| leg.slider).collect(),
            None => vec![None; record.legs()],
        };
        let state = |slider: &Option<SliderRecord>| {
            let slider = slider.unwrap_or_default();
            [slider.position, slider.velocity, slider.acceleration]
        };
        let platform = record.platform();
        self.values(&ComparedTick {
            t: record.t(),
            state: LagrangeState {
                platform: [0, 1, 2].map(|axis| platform.map(|values| values[axis])),
                sliders: sliders.iter().map(state).collect(),
            },
            torques: record.each_leg().map(|leg| leg.torque).collect(),
            forces: sliders
                .iter()
                .map(|it| it.map(|slider| slider.force))
                .collect(),
        })
    }

    fn values(&mut self, tick: &ComparedTick) -> Vec<f64> {
        let Some(loads) = self.machine.loads(&tick.state, &self.wanted) else {
            return vec![f64::NAN; self.names().len()];
        };
        self.found.take(tick, &loads);
        let torques = loads.torques.iter().map(|torque| torque.value());
        let sliders = loads.sliders.iter().flatten().map(|force| force.value());
        torques.chain(sliders).collect()
    }

    /// Differences up to now.
    pub fn found(&self) -> LagrangeFound {
        self.found
    }
}

impl LagrangeFound {
    fn take(&mut self, tick: &ComparedTick, loads: &LagrangeLoads) {
        let larger = |old: &mut Option<At>, value: f64| {
            if old.is_none_or(|old| value > old.value) {
                *old = Some(At { value, t: tick.t });
            }
        };
        for (truth, own) in loads.torques.iter().zip(&tick.torques) {
            larger(&mut self.torque, truth.error_of(*own).abs());
            self.greatest_torque = self.greatest_torque.max(truth.value().abs());
        }
        for (truth, own) in loads.sliders.iter().zip(&tick.forces) {
            if let (Some(truth), Some(own)) = (truth, own) {
                larger(&mut self.force, truth.error_of(*own).abs());
                self.greatest_force = self.greatest_force.max(truth.value().abs());
            }
        }
    }

    /// Lines of a summary.
    fn lines(&self) -> Vec<String> {
        let line = |at: At, greatest: f64, unit: &str, what: &str| {
            let share = match greatest > 0.0 {
                true => format!("{:.1e}", at.value / greatest),
                false => "0".into(),
            };
            format!(
                "largest difference {:.1e} {unit} at t = {} s: {share} of the greatest {what}, {} {unit}",
                at.value,
                tick_time(at.t),
                digits(greatest)
            )
        };
        let torque = self.torque;
        let torque = torque.map(|at| line(at, self.greatest_torque, "N m", "torque"));
        let force = self.force;
        let force = force.map(|at| line(at, self.greatest_force, "N", "slider force"));
        torque.into_iter().chain(force).collect()
    }

    /// Lines of text, and numbers.
    pub fn record(&self) -> Facts {
        Facts::new()
            .text("lagrange", self.lines())
            .data("torque_difference_nm", self.torque.map(At::facts))
            .data("greatest_torque_nm", self.greatest_torque)
            .data("force_difference_n", self.force.map(At::facts))
            .data("greatest_force_n", self.force.map(|_| self.greatest_force))
    }
}
