//! The units in which a machine and its job fit a number type of little range.
//!
//! Everything that a tick forms is measured in `f64` over the job, and the units are chosen so that
//! all of it stays within what the number type holds, with headroom. What no units can make fit is
//! refused by name.

use crate::Scene;
use crate::player::JobPlayer;
use nalgebra::Vector2;
use std::fmt;
use trirrr_core::inverse::Rotation;
use trirrr_core::limits::LimitParameters;
use trirrr_core::machine::Parameters;
use trirrr_core::model::Dynamic;
use trirrr_core::number::{Fixed, Number};
use trirrr_core::setpoint::Setpoint;
use trirrr_core::tick::{Motion, Tick};
use trirrr_core::torque::links::{InPlane, Massive};
use trirrr_core::torque::payload::Offset;
use trirrr_core::units::Units;

/// Factor by which a quantity may become larger than the job makes it.
const HEADROOM: f64 = 1.25;

/// Bound that a quantity stays below, so that what a stage forms of several of them fits the format.
const RANGE: f64 = Fixed::RANGE;

/// Bound that a coordinate stays below.
const NEAR: f64 = 2.75;

/// Turns that an angle holds.
const MOST_TURNS: f64 = (1_u64 << 31) as f64;

/// Bound of a quantity that a stage only adds to others or subtracts.
const WIDE: f64 = 2.0 * RANGE;

/// The least that a divisor may be: 256 units in the last place.
const LEAST_DIVISOR: f64 = 256.0 * Fixed::UNIT;

/// Most ticks of a job that are looked at; of a longer one, so many evenly over each move.
const MOST_TICKS: u32 = 1 << 20;

/// A quantity that the tick forms.
#[derive(Debug)]
struct TickQuantity {
    name: &'static str,
    unit: &'static str,
    /// Exponents of length, time and mass.
    dimension: [i32; 3],
    limit: f64,
}

macro_rules! quantities {
    ($($constant:ident, $name:literal, $unit:literal, $dimension:expr, $limit:expr;)*) => {
        #[allow(non_camel_case_types, clippy::upper_case_acronyms)]
        #[derive(Clone, Copy)]
        enum Of { $($constant),* }
        const QUANTITIES: &[TickQuantity] = &[
            $(TickQuantity { name: $name, unit: $unit, dimension: $dimension, limit: $limit }),*
        ];
    };
}

quantities! {
    COORDINATE, "the largest coordinate", "m", [1, 0, 0], NEAR;
    ALPHA, "alpha", "rad", [0, 0, 0], MOST_TURNS * std::f64::consts::TAU;
    REACH, "the reach of the longest leg", "m", [1, 0, 0], RANGE;
    RADIUS, "the platform's radius", "m", [1, 0, 0], RANGE / 4.0;
    MOMENT_ARM, "a moment arm about a platform joint times a distal link", "m^2", [2, 0, 0], RANGE;
    DET_A, "the greatest det A", "m^4", [4, 0, 0], RANGE;
    LINEAR_SHAPE, "a coefficient of a move's curve", "m", [1, 0, 0], WIDE;
    ANGULAR_SHAPE, "a coefficient of a move's curve in alpha", "rad", [0, 0, 0], WIDE;
    LINEAR_VELOCITY, "a velocity", "m/s", [1, -1, 0], RANGE;
    LINEAR_ACCELERATION, "an acceleration", "m/s^2", [1, -2, 0], RANGE;
    RATE, "a rate", "rad/s", [0, -1, 0], RANGE;
    RATE_SQUARED, "the square of a rate", "rad^2/s^2", [0, -2, 0], RANGE;
    ACCELERATION, "an angular acceleration", "rad/s^2", [0, -2, 0], RANGE;
    REACTION, "a product of an angular acceleration and two links", "m^2/s^2", [2, -2, 0], RANGE;
    MASS, "a mass", "kg", [0, 0, 1], RANGE;
    INERTIA, "a moment of inertia", "kg m^2", [2, 0, 1], RANGE;
    COUPLING, "the mass of a distal link over the square of its length", "kg/m^2", [-2, 0, 1], RANGE;
    FORCE, "a force", "N", [1, -2, 1], RANGE;
    TORQUE, "a torque", "N m", [2, -2, 1], RANGE;
    FORCE_OVER_LINK, "a force over the length of a distal link", "N/m", [0, -2, 1], RANGE;
    MOMENT_ACROSS, "a force times a distal link", "N m", [2, -2, 1], RANGE;
    POWER, "a power", "W", [2, -3, 1], WIDE;
    JERK, "an angular jerk", "rad/s^3", [0, -3, 0], WIDE;
}

/// A quantity that fits no units, or not those that the others ask for.
#[derive(Clone, Debug, PartialEq)]
pub struct RangeError {
    /// Name of the quantity.
    pub quantity: &'static str,
    /// Its greatest or its least size.
    pub value: f64,
    /// The SI unit of it.
    pub unit: &'static str,
    /// The least and the greatest that the format holds of it.
    pub format: [f64; 2],
}

impl fmt::Display for RangeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ([least, greatest], unit) = (self.format, self.unit);
        let space = if unit.is_empty() { "" } else { " " };
        write!(
            f,
            "{} is {:.3e}{space}{unit}; in fixed point it may be {least:.3e} to {greatest:.3e}{space}{unit}",
            self.quantity, self.value
        )
    }
}

impl std::error::Error for RangeError {}

/// The greatest size of every quantity.
struct GreatestSizes<'p> {
    parameters: &'p Parameters,
    greatest: [f64; QUANTITIES.len()],
    /// The least distances from the singularities.
    serial: f64,
    parallel: f64,
}

/// The machine with room for everything: what a machine has not is zero.
type Everything = Tick<Dynamic<f64, Offset<f64>, Massive<f64, InPlane<f64>>>>;

impl<'p> GreatestSizes<'p> {
    /// Measures what depends on the machine alone.
    fn new(parameters: &'p Parameters) -> Self {
        let mut measured = Self {
            parameters,
            greatest: [0.0; QUANTITIES.len()],
            serial: 1.0,
            parallel: 1.0,
        };
        let p = parameters;
        let largest = |values: [f64; 3]| values.into_iter().fold(0.0, f64::max);
        let radius = largest(p.legs.map(|leg| leg.joint_radius_m));
        let distal = largest(p.legs.map(|leg| leg.distal_m));
        measured.note(Of::RADIUS, radius);
        measured.note(Of::MOMENT_ARM, 2.0 * radius * distal);
        measured.note(Of::DET_A, p.greatest_det_a());
        measured.note(Of::RADIUS, size(p.platform.com_m));
        let gravity = size(p.gravity_m_s2);
        measured.note(Of::LINEAR_ACCELERATION, gravity);
        measured.note(
            Of::FORCE,
            p.platform.mass_kg * gravity + size(p.wrench_force_n),
        );
        measured.note(Of::TORQUE, p.wrench_torque_nm);
        for leg in &p.legs {
            let (l1, l2) = (leg.proximal_m, leg.distal_m);
            let (first, second) = (&leg.proximal, &leg.distal);
            measured.note(Of::COORDINATE, leg.base_m.x);
            measured.note(Of::COORDINATE, leg.base_m.y);
            measured.note(Of::REACH, l1 + l2);
            measured.note(Of::REACTION, gravity * l1.max(l2));
            let across = second.mass_kg * second.com_m;
            let proximal = first.mass_kg * first.com_m * first.com_m
                + first.inertia_kgm2
                + second.mass_kg * l1 * l1
                + leg.rotor_inertia_kgm2;
            let distal = across * second.com_m + second.inertia_kgm2;
            measured.note(Of::INERTIA, proximal);
            measured.note(Of::MASS, first.mass_kg * first.com_m / l1 + second.mass_kg);
            measured.note(Of::MASS, across / l2);
            measured.note(Of::MASS, distal / (l2 * l2));
            measured.note(Of::COUPLING, across / (l2 * l2 * l2));
        }
        measured
    }

    fn note(&mut self, of: Of, value: f64) {
        let greatest = &mut self.greatest[of as usize];
        // What is not a number must not pass for small.
        let held = value.abs() <= *greatest;
        if !held {
            *greatest = value.abs();
        }
    }

    /// Notes what the limits allow the moves beyond the job.
    fn limits(&mut self, limits: &LimitParameters) {
        let all = |values: Option<[f64; 3]>| values.into_iter().flatten();
        for rate in all(limits.rate_rad_s) {
            self.note(Of::RATE, rate);
            self.note(Of::RATE_SQUARED, rate * rate);
        }
        for acceleration in all(limits.acceleration_rad_s2) {
            self.note(Of::ACCELERATION, acceleration);
        }
        for torque in all(limits.torque_nm) {
            self.note(Of::TORQUE, torque);
        }
        for power in all(limits.power_w) {
            self.note(Of::POWER, power);
        }
        for jerk in all(limits.jerk_rad_s3) {
            self.note(Of::JERK, jerk);
        }
        self.serial = self.serial.min(limits.serial_distance_min);
        self.parallel = self.parallel.min(limits.parallel_distance_min);
    }

    /// The curve of a move whose displacement has these parts, in a time T, with these velocities
    /// at its ends times T.
    fn curve(&mut self, of: [Of; 3], t: f64, h: f64, t_v: [f64; 2]) {
        let [shape, velocity, acceleration] = of;
        if t_v == [0.0, 0.0] {
            self.note(shape, h);
            self.note(velocity, 6.0 * h / t);
            self.note(acceleration, 6.0 * h / (t * t));
            return;
        }
        let [a, b] = t_v;
        // Seen from either end; what is formed of c2 and c3 on the way has both at their largest.
        for (a, b) in [(a, b), (b, a)] {
            let c2 = 3.0 * h - 2.0 * a - b;
            let c3 = a + b - 2.0 * h;
            self.note(shape, a.abs() + 2.0 * c2.abs() + 1.5 * c3.abs());
        }
    }

    /// Notes what a quintic forms of the coefficients of its `shape`, with a quarter of the square of its duration
    /// times the accelerations at its ends.
    fn quintic(&mut self, shape: Of, h: f64, t_v: [f64; 2], e: [f64; 2]) {
        let [a, b] = t_v;
        let [e0, e1] = e.map(f64::abs);
        let (m, n) = (((h - a) + (h - b)).abs(), (b - a).abs());
        let k = e0 + e1 + 1.5 * m;
        self.note(shape, m.max(2.0 * (e0 + e1)));
        // The functions that they are multiplied by, in the derivative and in the second one.
        self.note(
            shape,
            a.abs().max(b.abs()) + 0.75 * m + 0.5 * n + 0.5 * (e0 + e1 + k),
        );
        self.note(shape, 3.0 * m + 1.5 * n + 2.0 * (e0 + e1 + k));
    }

    /// Notes what a tick forms on the way to `motion`.
    fn motion(&mut self, setpoint: &Setpoint<f64>, motion: &Motion<f64>) {
        let p = self.parameters;
        let (v, a) = (setpoint.velocity, setpoint.acceleration);
        self.note(Of::COORDINATE, setpoint.pose.position.x);
        self.note(Of::COORDINATE, setpoint.pose.position.y);
        self.note(Of::LINEAR_VELOCITY, size(v.xy()));
        self.note(Of::RATE, v.z);
        self.note(Of::RATE_SQUARED, v.z * v.z);
        self.note(Of::ACCELERATION, a.z);
        self.note(Of::LINEAR_ACCELERATION, size(a.xy()));
        let rotation = Rotation::new(setpoint.pose.angle);
        let s = size(rotation.apply(p.platform.com_m));
        let a_com = size(a.xy()) + s * (a.z.abs() + v.z * v.z) + size(p.gravity_m_s2);
        self.note(Of::LINEAR_ACCELERATION, a_com);
        let mut force = p.platform.mass_kg * a_com + size(p.wrench_force_n);
        let mut moment = p.platform.inertia_kgm2 * a.z.abs() + s * force + p.wrench_torque_nm.abs();
        let mut longest: f64 = 0.0;
        for (index, leg) in motion.legs.iter().enumerate() {
            let (links, rates, acc) = (&leg.position.links, &leg.rates, &leg.accelerations);
            let (l1, l2) = (p.legs[index].proximal_m, p.legs[index].distal_m);
            longest = longest.max(l2);
            self.serial = self.serial.min(links.r1_cross_r2.abs() / (l1 * l2));
            self.note(Of::LINEAR_VELOCITY, size(leg.position.velocity(&v)));
            self.note(
                Of::LINEAR_ACCELERATION,
                size(leg.position.acceleration(setpoint)),
            );
            for (rate, acceleration) in [(rates.proximal, acc.proximal), (rates.distal, acc.distal)]
            {
                self.note(Of::RATE, rate);
                self.note(Of::RATE_SQUARED, rate * rate);
                self.note(Of::ACCELERATION, acceleration);
                let reaction = (acceleration.abs() + rate * rate) * l1 * l2;
                if !p.links_are_massless() {
                    self.note(Of::REACTION, reaction);
                }
            }
            let q = motion.loads[index].distal_over_l2_sq.unwrap_or(0.0).abs();
            self.note(Of::FORCE_OVER_LINK, q);
            self.note(Of::TORQUE, motion.loads[index].at_motor.unwrap_or(0.0));
            force += q * l2;
            let c = size(leg.position.platform_joint);
            moment += 2.0 * c * q * l2;
            moment += c * (p.platform.mass_kg * a_com + size(p.wrench_force_n));
            self.note(Of::FORCE_OVER_LINK, motion.forces.along[index]);
            self.note(Of::FORCE, motion.forces.along[index] * l2);
            self.note(Of::TORQUE, motion.motors[index].torque);
            let power = motion.motors[index].torque * motion.motors[index].rate;
            self.note(Of::POWER, power);
        }
        self.note(Of::FORCE, force);
        self.note(Of::TORQUE, moment);
        self.note(Of::MOMENT_ACROSS, force * longest);
        let greatest = p.greatest_det_a();
        self.parallel = self.parallel.min(motion.forces.det_a.abs() / greatest);
    }

    /// The units: the smallest of length that hold the machine, the largest of time that hold its
    /// motion in those, the smallest of mass that hold its forces in both.
    fn units(&self) -> Result<Units, RangeError> {
        let mut units = Units::SI;
        // Which base unit a quantity decides: the last of the three that it has.
        units.length = self
            .exponent(&units, |d| d[1] == 0 && d[2] == 0, 0)
            .unwrap_or(0);
        units.time = self
            .exponent(&units, |d| d[1] != 0 && d[2] == 0, 1)
            .unwrap_or(0);
        units.mass = self.exponent(&units, |d| d[2] != 0, 2).unwrap_or(0);
        for (quantity, &greatest) in QUANTITIES.iter().zip(&self.greatest) {
            let [l, t, m] = quantity.dimension;
            let unit = units.of(l, t, m);
            let held = HEADROOM * greatest <= quantity.limit * unit;
            if !held {
                return Err(RangeError {
                    quantity: quantity.name,
                    value: greatest,
                    unit: quantity.unit,
                    format: [Fixed::UNIT * unit, quantity.limit * unit / HEADROOM],
                });
            }
        }
        let area = units.of(2, 0, 0);
        let least = |quantity, value, unit: &'static str, one: f64| {
            // Written so that what is not a number is refused.
            let held = value >= LEAST_DIVISOR * one;
            match held {
                true => Ok(()),
                false => Err(RangeError {
                    quantity,
                    value,
                    unit,
                    format: [LEAST_DIVISOR * one, RANGE * one],
                }),
            }
        };
        for leg in &self.parameters.legs {
            let products = leg.proximal_m * leg.distal_m;
            let name = "the least r1 x r2 of a leg";
            least(name, self.serial * products, "m^2", area)?;
        }
        let det_a = self.parallel * self.parameters.greatest_det_a();
        least("the least det A", det_a, "m^4", area * area)?;
        Ok(units)
    }

    /// The exponent of base unit `base` that the quantities among those of dimension `which` ask
    /// for, the other base units being chosen; `None` if they are all zero.
    fn exponent(&self, units: &Units, which: fn(&[i32; 3]) -> bool, base: usize) -> Option<i32> {
        let asked = QUANTITIES
            .iter()
            .zip(&self.greatest)
            .filter_map(|(quantity, &greatest)| {
                let dimension = quantity.dimension;
                let power = dimension[base];
                if power == 0 || !which(&dimension) || greatest == 0.0 || !greatest.is_finite() {
                    return None;
                }
                let [mut l, mut t, mut m] = dimension;
                *[&mut l, &mut t, &mut m][base] = 0;
                // value <= limit unit^power.
                let bound = (HEADROOM * greatest / (quantity.limit * units.of(l, t, m))).log2();
                let exponent = bound / f64::from(power);
                // A positive power asks for at least so much, a negative one for at most.
                Some(if power > 0 {
                    exponent.ceil()
                } else {
                    exponent.floor()
                })
            });
        let chosen = match base {
            1 => asked.fold(f64::INFINITY, f64::min),
            _ => asked.fold(f64::NEG_INFINITY, f64::max),
        };
        // Squares, cubes and fourth powers of the units are formed.
        chosen
            .is_finite()
            .then(|| chosen.clamp(-200.0, 200.0) as i32)
    }
}

fn size(v: Vector2<f64>) -> f64 {
    f64::hypot(v.x, v.y)
}

/// Units in which fixed point holds the machine with the motions of `setpoints`. A setpoint that
/// has no motion, which the tick says, asks for nothing but room for its place.
///
/// # Errors
/// [`RangeError`].
pub fn units_of_setpoints<'s>(
    parameters: &Parameters,
    setpoints: impl IntoIterator<Item = &'s Setpoint<f64>>,
) -> Result<Units, RangeError> {
    let mut measured = GreatestSizes::new(parameters);
    let tick = Everything::build(parameters).ok();
    for setpoint in setpoints {
        measured.note(Of::COORDINATE, setpoint.pose.position.x);
        measured.note(Of::COORDINATE, setpoint.pose.position.y);
        measured.note(Of::ALPHA, setpoint.pose.angle);
        if let Some(Ok(motion)) = tick.as_ref().map(|tick| tick.evaluate(setpoint)) {
            measured.motion(setpoint, &motion);
        }
    }
    measured.units()
}

/// Units in which fixed point holds the scene's machine, its limits and its job.
///
/// # Errors
/// [`RangeError`].
pub fn units_of_scene(scene: &Scene) -> Result<Units, RangeError> {
    let parameters = &scene.parameters;
    let mut measured = GreatestSizes::new(parameters);
    measured.limits(&scene.limits);
    for motor in scene.homing.iter().flat_map(|homing| &homing.motors) {
        measured.note(Of::RATE, motor.search_rate_rad_s);
        measured.note(Of::ACCELERATION, motor.acceleration_rad_s2);
    }
    for each in &scene.job.moves {
        let t = f64::from(each.duration_ticks) * scene.period_s();
        let h = each.to.position - each.from.position;
        let (v0, v1) = (each.start_velocity * t, each.end_velocity * t);
        let linear = [
            Of::LINEAR_SHAPE,
            Of::LINEAR_VELOCITY,
            Of::LINEAR_ACCELERATION,
        ];
        let angular = [Of::ANGULAR_SHAPE, Of::RATE, Of::ACCELERATION];
        let turn = each.to.angle - each.from.angle;
        measured.note(Of::ALPHA, each.from.angle);
        measured.note(Of::ALPHA, each.to.angle);
        let accelerations = each
            .accelerations
            .map(|both| both.map(|one| one * (0.25 * t * t)));
        for (axis, (of, h)) in [(linear, h.x), (linear, h.y), (angular, turn)]
            .into_iter()
            .enumerate()
        {
            let t_v = [v0[axis], v1[axis]];
            match accelerations {
                None => measured.curve(of, t, h, t_v),
                Some([e0, e1]) => measured.quintic(of[0], h, t_v, [e0[axis], e1[axis]]),
            }
        }
    }
    if let Ok(tick) = Everything::build(parameters) {
        let player = JobPlayer::<f64>::new(&scene.job, scene.period_s());
        let step = (player.ticks() / MOST_TICKS).max(1);
        for at in (0..=player.ticks()).step_by(step as usize) {
            let setpoint = player.at(at);
            if let Ok(motion) = tick.evaluate(&setpoint) {
                measured.motion(&setpoint, &motion);
            }
        }
    }
    measured.units()
}

/// The units that `scene` runs in, in the number type `N`: SI for those that reach far enough.
///
/// # Errors
/// [`RangeError`].
pub fn units<N: Number>(scene: &Scene) -> Result<Units, RangeError> {
    match N::PROPAGATES_NON_FINITE {
        true => Ok(Units::SI),
        false => units_of_scene(scene),
    }
}
