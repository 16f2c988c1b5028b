//! Motors by the figures of their makers.

use super::winding::{BrushlessWinding, StepperWinding};
use serde::Deserialize;

/// The catalogue that is shipped, in TOML.
pub const SHIPPED: &str = include_str!("../../catalogue/motors.toml");

/// Part of the torque at rest below which a motor is at its speed without load: the estimate of a stepper never reaches 0.
const NO_LOAD: f64 = 0.01;

/// Motor by the figures of its maker.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct CatalogueMotor {
    /// Maker and type.
    pub name: String,
    /// Voltage of the supply that the figures are for, V.
    pub supply_v: f64,
    /// Largest torque at rest, N m: of a stepper, the holding torque.
    pub torque_peak_nm: f64,
    /// Torque that the motor gives for any time, N m. Without it nothing is said about heat.
    pub torque_continuous_nm: Option<f64>,
    /// Speed at which no torque is left, rad/s. The torque falls evenly on the way there, unless there is a `curve`. A winding has one
    /// of its own.
    pub speed_no_load_rad_s: Option<f64>,
    /// Points of the torque over the speed, rad/s and N m, with rising speeds: for steppers, the pull-out torque.
    #[serde(default)]
    pub curve: Vec<[f64; 2]>,
    /// Winding of a stepper, from which the pull-out torque is estimated for any supply.
    pub stepper: Option<StepperWinding>,
    /// Winding of a brushless motor, from which the line of its torque follows for any supply.
    pub brushless: Option<BrushlessWinding>,
    /// Inertia of the rotor, at the shaft that the figures are for, kg m^2. Without it margins are those of a rotor that weighs nothing,
    /// and nothing is said that would depend on it.
    pub rotor_inertia_kgm2: Option<f64>,
    /// The figures are those behind a gear of the motor's own; no other one is put on.
    #[serde(default)]
    pub geared: bool,
    /// Mass, kg.
    pub mass_kg: Option<f64>,
    /// Page that the figures come from.
    pub source: String,
    /// Day on which it was read.
    pub date: String,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Catalogue {
    #[serde(default)]
    motor: Vec<CatalogueMotor>,
}

impl CatalogueMotor {
    /// Largest torque at a speed, N m.
    pub fn torque_at(&self, speed_rad_s: f64) -> f64 {
        let (speed, peak) = (speed_rad_s.abs(), self.torque_peak_nm);
        let there = match (&self.stepper, &self.brushless, &self.curve[..]) {
            (Some(winding), ..) => winding.torque_at(speed, self.supply_v, peak),
            (_, Some(winding), _) => winding.torque_at(speed, self.supply_v),
            (.., curve @ [_, _, ..]) => torque_on(curve, speed),
            _ => {
                let no_load = self.speed_no_load_rad_s.unwrap_or(f64::INFINITY);
                (1.0 - speed / no_load) * peak
            }
        };
        there.clamp(0.0, peak)
    }

    /// Speed at which no torque is left, rad/s; of an estimate, less than a hundredth of that at rest.
    pub fn no_load_rad_s(&self) -> f64 {
        if let Some(speed) = self.speed_no_load_rad_s {
            return speed;
        }
        if let Some([speed, _]) = self.curve.last() {
            return *speed;
        }
        let is_left = |speed: f64| self.torque_at(speed) > NO_LOAD * self.torque_peak_nm;
        let mut high = 1.0;
        while is_left(high) && high < 1e6 {
            high *= 2.0;
        }
        let mut low = 0.0;
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            match is_left(middle) {
                true => low = middle,
                false => high = middle,
            }
        }
        high
    }

    /// The motor on another supply, V: one without a winding stays as its maker describes it.
    pub fn at_supply(&self, supply_v: f64) -> Self {
        let has_winding = self.stepper.is_some() || self.brushless.is_some();
        Self {
            supply_v: if has_winding { supply_v } else { self.supply_v },
            ..self.clone()
        }
    }

    /// Least supply at which the motor gives `torque_nm` at a speed, V; none where the figures say nothing of other supplies.
    pub(super) fn supply_for(&self, torque_nm: f64, speed_rad_s: f64) -> Option<f64> {
        let (torque, speed) = (torque_nm.abs(), speed_rad_s.abs());
        if let Some(winding) = &self.stepper {
            return Some(winding.supply_for(torque, speed, self.torque_peak_nm));
        }
        if let Some(winding) = &self.brushless {
            return Some(winding.supply_for(torque, speed));
        }
        let no_load = self.speed_no_load_rad_s.filter(|_| self.curve.is_empty())?;
        // The line moves with the voltage, and does not tilt.
        let left = 1.0 - torque / self.torque_peak_nm;
        Some(match left > 0.0 {
            true => self.supply_v * speed / no_load / left,
            false => f64::INFINITY,
        })
    }

    /// Origin of the torque over the speed, in words.
    pub fn curve_source(&self) -> &'static str {
        match () {
            () if self.stepper.is_some() => "estimated",
            () if self.brushless.is_some() => "winding",
            () if !self.curve.is_empty() => "curve",
            () => "line",
        }
    }

    fn fault(&self) -> Option<String> {
        let mut positive = vec![
            ("supply_v", self.supply_v),
            ("torque_peak_nm", self.torque_peak_nm),
        ];
        let optional = [
            ("torque_continuous_nm", self.torque_continuous_nm),
            ("speed_no_load_rad_s", self.speed_no_load_rad_s),
            ("mass_kg", self.mass_kg),
        ];
        positive.extend(
            optional
                .into_iter()
                .filter_map(|(key, value)| Some((key, value?))),
        );
        positive.extend(self.stepper.iter().flat_map(StepperWinding::figures));
        positive.extend(self.brushless.iter().flat_map(BrushlessWinding::figures));
        for (key, value) in positive {
            if !(value > 0.0 && value.is_finite()) {
                return Some(format!("{key} = {value}: must be greater than 0"));
            }
        }
        if let Some(value) = self.rotor_inertia_kgm2
            && !(value >= 0.0 && value.is_finite())
        {
            return Some(format!(
                "rotor_inertia_kgm2 = {value}: must not be negative"
            ));
        }
        if self
            .torque_continuous_nm
            .is_some_and(|torque| torque > self.torque_peak_nm)
        {
            return Some("torque_continuous_nm: must not be greater than torque_peak_nm".into());
        }
        self.curve_fault().or_else(|| {
            let texts = [
                ("name", &self.name),
                ("source", &self.source),
                ("date", &self.date),
            ];
            let empty = texts.into_iter().find(|(_, text)| text.trim().is_empty());
            empty.map(|(key, _)| format!("{key}: must not be empty"))
        })
    }

    fn curve_fault(&self) -> Option<String> {
        let rises = self.curve.is_sorted_by(|one, other| one[0] < other[0]);
        let is_number =
            |point: &[f64; 2]| point.iter().all(|value| *value >= 0.0 && value.is_finite());
        if self.curve.len() == 1 || !rises || !self.curve.iter().all(is_number) {
            return Some(
                "curve: must have two points or more, with rising speeds and nothing negative"
                    .into(),
            );
        }
        let given = [
            ("curve", !self.curve.is_empty()),
            ("stepper", self.stepper.is_some()),
            ("brushless", self.brushless.is_some()),
        ];
        let given: Vec<&str> = given
            .into_iter()
            .filter_map(|(key, is_there)| is_there.then_some(key))
            .collect();
        match (&given[..], self.speed_no_load_rad_s) {
            ([], None) => Some(
                "speed_no_load_rad_s: missing; or give a curve, or a winding as stepper or brushless"
                    .into(),
            ),
            ([first, second, ..], _) => Some(format!(
                "{second}: the torque over the speed is given by {first} already"
            )),
            ([key @ ("stepper" | "brushless")], Some(_)) => Some(format!(
                "speed_no_load_rad_s: follows from {key}; leave it out"
            )),
            _ => None,
        }
    }
}

/// Torque on straight lines between points; none beyond the last one.
fn torque_on(curve: &[[f64; 2]], speed: f64) -> f64 {
    match curve {
        [first, ..] if speed <= first[0] => first[1],
        _ => {
            let pair = curve.windows(2).find(|pair| speed <= pair[1][0]);
            pair.map_or(0.0, |pair| {
                let part = (speed - pair[0][0]) / (pair[1][0] - pair[0][0]);
                pair[0][1] + part * (pair[1][1] - pair[0][1])
            })
        }
    }
}

/// Reads a catalogue: TOML with a `[[motor]]` for each.
///
/// # Errors
/// No such file in words, or the first motor with a figure that is none, with its number and name.
pub fn read_catalogue(text: &str) -> Result<Vec<CatalogueMotor>, String> {
    let Catalogue { motor: motors } = toml::from_str(text).map_err(|error| error.to_string())?;
    if motors.is_empty() {
        return Err("no [[motor]] in the catalogue".into());
    }
    for (index, motor) in motors.iter().enumerate() {
        if let Some(fault) = motor.fault() {
            return Err(format!("motor[{}] ({}): {fault}", index + 1, motor.name));
        }
        let same = |other: &CatalogueMotor| other.name == motor.name;
        if motors[..index].iter().any(same) {
            return Err(format!(
                "motor[{}]: there is another {}",
                index + 1,
                motor.name
            ));
        }
    }
    Ok(motors)
}
