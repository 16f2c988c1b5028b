//! Motors of a catalogue on a job: which of them do it, with which gear, and how much they have left.

mod catalogue;
mod faster;
mod winding;

pub use catalogue::{CatalogueMotor, SHIPPED, read_catalogue};
pub use winding::{BrushlessWinding, StepperWinding};

use nalgebra::Vector3;
use trirrr_core::setpoint::Setpoint;
use trirrr_core::units::Units;
use trirrr_scene::{JobPlayer, Scene, pipeline};

/// Gears that are tried between a motor without one and its joint.
pub const GEAR_RATIOS: [f64; 8] = [1.0, 2.0, 3.0, 5.0, 7.0, 10.0, 20.0, 50.0];

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
    /// Largest torque that is asked for, at the shaft of the motor, N m.
    pub torque_peak_nm: f64,
    /// Root mean square of it, of the motor with the largest, N m.
    pub torque_rms_nm: f64,
    /// Quotient of the largest speed that is asked for and that without load.
    pub speed_part: f64,
    /// Least supply that does the job, V; none where the figures say nothing of other supplies. Infinite: none is enough.
    pub supply_needed_v: Option<f64>,
    /// Inertia of the rotor at the joint, over that which the joints feel along the job; none where it is not known.
    pub inertia_ratio: Option<f64>,
    /// Work that each motor brings back in braking, rotor included, J, of all three: losses are not counted, nor that another motor may
    /// take it from a common supply. None where the inertia of the rotor is not known.
    pub regenerated_j: Option<f64>,
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

/// A joint at an instant, without rotor.
#[derive(Clone, Copy, Debug)]
struct JointPoint {
    rate: f64,
    acceleration: f64,
    torque: f64,
    /// Torque at the same place, at rest.
    standing: f64,
}

impl JointPoint {
    /// Speed and torque at the shaft of a motor, with the job in `factor` times its duration.
    fn at_rotor(&self, motor: &CatalogueMotor, gear: f64, factor: f64) -> [f64; 2] {
        // What moves takes torque with the square of the pace; what stands does not.
        let pace = 1.0 / (factor * factor);
        let torque = self.standing + pace * (self.torque - self.standing);
        let rotor = motor.rotor_inertia_kgm2.unwrap_or(0.0);
        let own = torque / gear + rotor * gear * pace * self.acceleration;
        [gear * self.rate / factor, own]
    }
}

/// Rates, accelerations and torques that a job asks of the joints, without rotors.
#[derive(Clone, Debug)]
pub struct JobLoad<'a> {
    scene: &'a Scene,
    /// The three joints at each tick.
    points: Vec<[JointPoint; 3]>,
    /// Inertia that a joint feels, kg m^2.
    inertia_kgm2: f64,
}

impl<'a> JobLoad<'a> {
    /// Looks at the job of `scene`. Rotors of its drives are left out.
    ///
    /// # Errors
    /// The machine is refused, or a setpoint of the job has no motion.
    pub fn of(scene: &'a Scene) -> Result<Self, String> {
        let mut bare = scene.parameters;
        for leg in &mut bare.legs {
            leg.rotor_inertia_kgm2 = 0.0;
        }
        let machine =
            pipeline::build_in::<f64>(&bare, Units::SI).map_err(|error| error.to_string())?;
        let player = JobPlayer::<f64>::new(&scene.job, scene.period_s());
        let points = player.setpoints().map(|setpoint| {
            let standing = Setpoint {
                pose: setpoint.pose,
                velocity: Vector3::zeros(),
                acceleration: Vector3::zeros(),
            };
            let of = |setpoint| {
                machine
                    .evaluate(0.0, setpoint)
                    .map_err(|status| status.to_string())
            };
            let (moving, standing) = (of(&setpoint)?, of(&standing)?);
            Ok([0, 1, 2].map(|joint| {
                let leg = &moving.legs[joint];
                JointPoint {
                    rate: leg.dth1,
                    acceleration: leg.ddth1,
                    torque: leg.torque,
                    standing: standing.legs[joint].torque,
                }
            }))
        });
        let points = points.collect::<Result<Vec<_>, String>>()?;
        Ok(Self {
            scene,
            inertia_kgm2: joint_inertia(&points),
            points,
        })
    }

    /// Speeds and torques at the shafts of all three motors, tick by tick.
    pub fn rotor_points(&self, motor: &CatalogueMotor, gear: f64) -> Vec<[f64; 2]> {
        let joints = self.points.iter().flatten();
        joints
            .map(|joint| joint.at_rotor(motor, gear, 1.0))
            .collect()
    }

    /// All motors on the job. The rotors of the catalogue count, and each motor has the gear that leaves the most. A rotor of unknown
    /// inertia would leave the more the higher the gear: such a motor has the lowest gear that does the job, and comes behind the others.
    /// Before that the greatest margins come first.
    pub fn candidates(&self, motors: &[CatalogueMotor]) -> Vec<Candidate> {
        let best = motors.iter().enumerate().filter_map(|(index, motor)| {
            let ratios = if motor.geared {
                &GEAR_RATIOS[..1]
            } else {
                &GEAR_RATIOS
            };
            let mut each = ratios
                .iter()
                .map(|&gear| self.with_gear((index, motor), gear));
            let least = motor.rotor_inertia_kgm2.is_none();
            let least = least.then(|| each.clone().find(|it| it.margin() >= 1.0));
            let most = |one: &Candidate, other: &Candidate| one.margin().total_cmp(&other.margin());
            least.flatten().or_else(|| each.by_ref().max_by(most))
        });
        let mut found: Vec<Candidate> = best.collect();
        found.sort_by(|one, other| {
            let is_known = |it: &Candidate| it.inertia_ratio.is_some();
            let margins = other.margin().total_cmp(&one.margin());
            is_known(other).cmp(&is_known(one)).then(margins)
        });
        found
    }

    fn with_gear(&self, (index, motor): (usize, &CatalogueMotor), gear: f64) -> Candidate {
        let asked = self.asked(motor, gear, 1.0);
        let supply_of = |[speed, torque]: [f64; 2]| motor.supply_for(torque, speed);
        let points = self.rotor_points(motor, gear);
        let returned_w = points
            .iter()
            .map(|[speed, torque]| (-speed * torque).max(0.0));
        let regenerated_j = returned_w.sum::<f64>() * self.scene.period_s();
        let supplies: Vec<_> = points.into_iter().map(supply_of).collect();
        Candidate {
            motor: index,
            gear_ratio: gear,
            peak_margin: asked.peak_margin,
            heat_margin: motor
                .torque_continuous_nm
                .map(|torque| torque / asked.rms_nm),
            torque_peak_nm: asked.peak_nm,
            torque_rms_nm: asked.rms_nm,
            speed_part: asked.speed_part,
            supply_needed_v: supplies
                .into_iter()
                .try_fold(0.0, |most: f64, each| Some(most.max(each?))),
            inertia_ratio: motor
                .rotor_inertia_kgm2
                .map(|rotor| rotor * gear * gear / self.inertia_kgm2),
            regenerated_j: motor.rotor_inertia_kgm2.map(|_| regenerated_j),
        }
    }

    /// Torques and speed that the job asks of a motor with a gear, in `factor` times its duration.
    fn asked(&self, motor: &CatalogueMotor, gear: f64, factor: f64) -> AskedTorque {
        let mut peak_margin = f64::INFINITY;
        let (mut peak_nm, mut speed) = (0.0_f64, 0.0_f64);
        let mut squares = [0.0; 3];
        for joints in &self.points {
            for (joint, square) in joints.iter().zip(&mut squares) {
                let [rate, own] = joint.at_rotor(motor, gear, factor);
                if own != 0.0 {
                    peak_margin = peak_margin.min(motor.torque_at(rate) / own.abs());
                }
                peak_nm = peak_nm.max(own.abs());
                speed = speed.max(rate.abs());
                *square += own * own;
            }
        }
        let speed_part = speed / motor.no_load_rad_s();
        if speed_part >= 1.0 {
            peak_margin = 0.0;
        }
        let rms = squares.map(|sum| (sum / self.points.len().max(1) as f64).sqrt());
        AskedTorque {
            peak_margin,
            peak_nm,
            rms_nm: rms.into_iter().fold(0.0, f64::max),
            speed_part,
        }
    }
}

struct AskedTorque {
    peak_margin: f64,
    peak_nm: f64,
    rms_nm: f64,
    speed_part: f64,
}

/// Mean of torque times acceleration over that of squares of accelerations: the inertia that a joint feels.
fn joint_inertia(points: &[[JointPoint; 3]]) -> f64 {
    let joints = points.iter().flatten();
    let sums = joints.fold([0.0; 2], |[torque, square], joint| {
        [
            torque + (joint.torque * joint.acceleration).abs(),
            square + joint.acceleration * joint.acceleration,
        ]
    });
    if sums[1] > 0.0 {
        sums[0] / sums[1]
    } else {
        f64::INFINITY
    }
}
