//! Motors of a catalogue on a job: which of them do it, with which gear, and how much they have left.

use serde::Deserialize;
use trirrr_core::units::Units;
use trirrr_scene::{JobPlayer, Scene, pipeline};

/// Gears that are tried between a motor without one and its joint.
pub const GEAR_RATIOS: [f64; 8] = [1.0, 2.0, 3.0, 5.0, 7.0, 10.0, 20.0, 50.0];

/// The catalogue that is shipped, in TOML.
pub const SHIPPED: &str = include_str!("../catalogue/motors.toml");

/// Motor by the figures of its maker.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct CatalogueMotor {
    /// Maker and type.
    pub name: String,
    /// Voltage of the supply that the figures are for, V.
    pub supply_v: f64,
    /// Largest torque at rest, N m.
    pub torque_peak_nm: f64,
    /// Torque that the motor gives for any time, N m. Without it nothing is said about heat.
    pub torque_continuous_nm: Option<f64>,
    /// Speed at which no torque is left, rad/s. The torque falls evenly on the way there, unless there is a `curve`.
    pub speed_no_load_rad_s: f64,
    /// Points of the torque over the speed, rad/s and N m, with rising speeds: for steppers, the pull-out torque.
    #[serde(default)]
    pub curve: Vec<[f64; 2]>,
    /// Inertia of the rotor, at the shaft that the figures are for, kg m^2.
    #[serde(default)]
    pub rotor_inertia_kgm2: f64,
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
        let speed = speed_rad_s.abs();
        let [first, _, ..] = &self.curve[..] else {
            return (1.0 - speed / self.speed_no_load_rad_s).max(0.0) * self.torque_peak_nm;
        };
        if speed <= first[0] {
            return first[1].min(self.torque_peak_nm);
        }
        let pair = self.curve.windows(2).find(|pair| speed <= pair[1][0]);
        pair.map_or(0.0, |pair| {
            let part = (speed - pair[0][0]) / (pair[1][0] - pair[0][0]);
            pair[0][1] + part * (pair[1][1] - pair[0][1])
        })
    }

    fn fault(&self) -> Option<String> {
        let positive = [
            ("supply_v", self.supply_v),
            ("torque_peak_nm", self.torque_peak_nm),
            ("speed_no_load_rad_s", self.speed_no_load_rad_s),
        ];
        let optional = [
            ("torque_continuous_nm", self.torque_continuous_nm),
            ("mass_kg", self.mass_kg),
        ];
        let optional = optional
            .into_iter()
            .filter_map(|(key, value)| Some((key, value?)));
        for (key, value) in positive.into_iter().chain(optional) {
            if !(value > 0.0 && value.is_finite()) {
                return Some(format!("{key} = {value}: must be greater than 0"));
            }
        }
        if !(self.rotor_inertia_kgm2 >= 0.0 && self.rotor_inertia_kgm2.is_finite()) {
            let value = self.rotor_inertia_kgm2;
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
        let rises = self.curve.is_sorted_by(|one, other| one[0] < other[0]);
        let is_number =
            |point: &[f64; 2]| point.iter().all(|value| *value >= 0.0 && value.is_finite());
        if self.curve.len() == 1 || !rises || !self.curve.iter().all(is_number) {
            return Some(
                "curve: must have two points or more, with rising speeds and nothing negative"
                    .into(),
            );
        }
        for (key, text) in [
            ("name", &self.name),
            ("source", &self.source),
            ("date", &self.date),
        ] {
            if text.trim().is_empty() {
                return Some(format!("{key}: must not be empty"));
            }
        }
        None
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

/// Motor on a job, all three joints with the same.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidate {
    /// Number of the motor in the catalogue, from 0.
    pub motor: usize,
    /// Turns of the motor per turn of the joint.
    pub gear_ratio: f64,
    /// Least quotient of the torque that there is at the speed and the torque that is asked for; 1 or more: it does the job.
    pub peak_margin: f64,
    /// The same of continuous torque and root mean square, if the catalogue has one.
    pub heat_margin: Option<f64>,
    /// Quotient of the largest speed that is asked for and that without load.
    pub speed_part: f64,
    /// Inertia of the rotor at the joint, over that which the joints feel along the job.
    pub inertia_ratio: f64,
    /// Work that comes back in braking, J, losses not counted.
    pub regenerated_j: f64,
}

impl Candidate {
    /// The least margin.
    pub fn margin(&self) -> f64 {
        self.heat_margin
            .map_or(self.peak_margin, |heat| heat.min(self.peak_margin))
    }

    /// Reason for the least margin: heat, speed or torque.
    pub fn limited_by(&self) -> &'static str {
        match () {
            () if self.heat_margin.is_some_and(|heat| heat < self.peak_margin) => "heat",
            () if self.speed_part >= 1.0 => "speed",
            () => "torque",
        }
    }
}

/// Rates, accelerations and torques of the three joints at an instant, without rotors.
type JointPoint = [[f64; 3]; 3];

/// All motors on the job of `scene`, each with the gear that leaves the most; the greatest margins come first. Rotors of the
/// scene's drives are left out, and those of the catalogue put in.
///
/// # Errors
/// The machine is refused, or a setpoint of the job has no motion.
pub fn candidates(scene: &Scene, motors: &[CatalogueMotor]) -> Result<Vec<Candidate>, String> {
    let mut bare = scene.clone();
    for leg in &mut bare.parameters.legs {
        leg.rotor_inertia_kgm2 = 0.0;
    }
    let machine = pipeline::build_in::<f64>(&bare.parameters, Units::SI)
        .map_err(|error| error.to_string())?;
    let player = JobPlayer::<f64>::new(&bare.job, bare.period_s());
    let points = player.setpoints().map(|setpoint| {
        let record = machine
            .evaluate(0.0, &setpoint)
            .map_err(|status| status.to_string())?;
        Ok(record.legs.map(|leg| [leg.dth1, leg.ddth1, leg.torque]))
    });
    let points = points.collect::<Result<Vec<JointPoint>, String>>()?;
    let inertia = joint_inertia(&points);
    let joints = points.iter().flatten();
    let returned_w = joints.map(|[rate, _, torque]| (-torque * rate).max(0.0));
    let regenerated_j = returned_w.sum::<f64>() * bare.period_s();
    let mut found: Vec<Candidate> = motors
        .iter()
        .enumerate()
        .filter_map(|(index, motor)| {
            let ratios = if motor.geared {
                &GEAR_RATIOS[..1]
            } else {
                &GEAR_RATIOS
            };
            let each = ratios.iter().map(|&gear| {
                let [peak_margin, heat_margin, speed_part] = margins(motor, gear, &points);
                Candidate {
                    motor: index,
                    gear_ratio: gear,
                    peak_margin,
                    heat_margin: motor.torque_continuous_nm.map(|_| heat_margin),
                    speed_part,
                    inertia_ratio: motor.rotor_inertia_kgm2 * gear * gear / inertia,
                    regenerated_j,
                }
            });
            each.max_by(|one, other| one.margin().total_cmp(&other.margin()))
        })
        .collect();
    found.sort_by(|one, other| other.margin().total_cmp(&one.margin()));
    Ok(found)
}

/// Mean of torque times acceleration over that of squares of accelerations: the inertia that a joint feels.
fn joint_inertia(points: &[JointPoint]) -> f64 {
    let sums =
        points
            .iter()
            .flatten()
            .fold([0.0; 2], |[torque, square], [_, acceleration, own]| {
                [
                    torque + (own * acceleration).abs(),
                    square + acceleration * acceleration,
                ]
            });
    if sums[1] > 0.0 {
        sums[0] / sums[1]
    } else {
        f64::INFINITY
    }
}

/// Margins of torque and of heat, and the part of the speed, with a gear. Without a continuous torque the margin of heat is none.
fn margins(motor: &CatalogueMotor, gear: f64, points: &[JointPoint]) -> [f64; 3] {
    let mut peak_margin = f64::INFINITY;
    let mut speed: f64 = 0.0;
    let mut squares = [0.0; 3];
    for point in points {
        for ([rate, acceleration, torque], square) in point.iter().zip(&mut squares) {
            let own = torque / gear + motor.rotor_inertia_kgm2 * gear * acceleration;
            let there = motor.torque_at(gear * rate);
            if own != 0.0 {
                peak_margin = peak_margin.min(there / own.abs());
            }
            speed = speed.max(gear * rate.abs());
            *square += own * own;
        }
    }
    if speed >= motor.speed_no_load_rad_s {
        peak_margin = 0.0;
    }
    let rms = squares.map(|sum| (sum / points.len().max(1) as f64).sqrt());
    let rms = rms.into_iter().fold(0.0, f64::max);
    let heat_margin = motor.torque_continuous_nm.unwrap_or(f64::NAN) / rms;
    [peak_margin, heat_margin, speed / motor.speed_no_load_rad_s]
}
