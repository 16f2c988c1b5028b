//! Torque over the speed from the data of a winding.

use serde::Deserialize;
use std::f64::consts::SQRT_2;

/// Winding of a two-phase stepper with a bipolar driver that holds its current.
///
/// The pull-out torque is an estimate: that of a synchronous motor on a sinusoidal voltage, `T = k V / Z - k^2 w R / Z^2`, and at most the
/// holding torque. The current is `(V - k w) / (R + j p w L)` as phasors; `T` is `k` times its part in phase with the back EMF `k w`, at
/// the load angle where that is largest. `V` is the supply, `w` the speed, `Z^2 = R^2 + (p w L)^2`
/// with the electrical time constant `L / R` and `p` a quarter of the steps of a turn. The constant `k` is the holding torque over the
/// currents of both phases, `sqrt(2)` times the rated one. Resonance, iron and the driver take torque from that: plan with a half.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct StepperWinding {
    /// Resistance of a phase, ohm.
    pub resistance_ohm: f64,
    /// Inductance of a phase, H.
    pub inductance_h: f64,
    /// Rated current of a phase, both on, A.
    pub current_a: f64,
    /// Full steps of a turn.
    pub steps_per_rev: u32,
}

impl StepperWinding {
    pub(super) fn figures(&self) -> [(&'static str, f64); 4] {
        [
            ("stepper.resistance_ohm", self.resistance_ohm),
            ("stepper.inductance_h", self.inductance_h),
            ("stepper.current_a", self.current_a),
            ("stepper.steps_per_rev", f64::from(self.steps_per_rev)),
        ]
    }

    fn impedance_ohm(&self, speed: f64) -> f64 {
        let electrical = 0.25 * f64::from(self.steps_per_rev) * speed;
        self.resistance_ohm.hypot(electrical * self.inductance_h)
    }

    fn torque_constant_nm_a(&self, holding_nm: f64) -> f64 {
        holding_nm / (SQRT_2 * self.current_a)
    }

    /// Torque that the voltage allows, N m; the holding torque is not its limit here.
    pub(super) fn torque_at(&self, speed: f64, supply_v: f64, holding_nm: f64) -> f64 {
        let (constant, impedance) = (
            self.torque_constant_nm_a(holding_nm),
            self.impedance_ohm(speed),
        );
        let lost_v = constant * speed * self.resistance_ohm / impedance;
        constant * (supply_v - lost_v) / impedance
    }

    /// The same for the voltage, V; without bound beyond the holding torque.
    pub(super) fn supply_for(&self, torque: f64, speed: f64, holding_nm: f64) -> f64 {
        if torque > holding_nm {
            return f64::INFINITY;
        }
        let (constant, impedance) = (
            self.torque_constant_nm_a(holding_nm),
            self.impedance_ohm(speed),
        );
        impedance * torque / constant + constant * speed * self.resistance_ohm / impedance
    }
}

/// Winding of a brushless motor, by the figures of a direct current through two of its terminals.
///
/// The torque falls on the line `T = k (V - k w) / R`, and is at most the peak torque. A controller with field-oriented control has the same
/// line: its current of amplitude `i` gives `1.5 k i / sqrt(3)`, its voltage has the amplitude `V / sqrt(3)`, and `R` is that of two phases.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct BrushlessWinding {
    /// Resistance between two terminals, ohm: twice that of a phase in star.
    pub resistance_ohm: f64,
    /// Torque constant, N m/A: 60 / (2 pi KV) for KV in turns per minute and volt.
    pub torque_constant_nm_a: f64,
    /// Pairs of poles: electrical turns for one of the rotor.
    pub pole_pairs: u32,
}

impl BrushlessWinding {
    pub(super) fn figures(&self) -> [(&'static str, f64); 3] {
        [
            ("brushless.resistance_ohm", self.resistance_ohm),
            ("brushless.torque_constant_nm_a", self.torque_constant_nm_a),
            ("brushless.pole_pairs", f64::from(self.pole_pairs)),
        ]
    }

    pub(super) fn torque_at(&self, speed: f64, supply_v: f64) -> f64 {
        let constant = self.torque_constant_nm_a;
        constant * (supply_v - constant * speed) / self.resistance_ohm
    }

    pub(super) fn supply_for(&self, torque: f64, speed: f64) -> f64 {
        let constant = self.torque_constant_nm_a;
        torque * self.resistance_ohm / constant + constant * speed
    }
}
