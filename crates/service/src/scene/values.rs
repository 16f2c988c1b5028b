//! Values of a scene that an image takes over the line: all of a scene that is not a type of the image.

use super::{Adjustable, Machine};
use crate::contact::ContactParameters;
use crate::curves::PlayedCurves;
use crate::feedback::{FeedbackCoefficients, FeedbackParameters};
use crate::homing::{HomingMotor, HomingParameters};
use crate::number::ServiceNumber;
use crate::pace::Ramp;
use crate::planner::{PathPlanner, Planning};
use crate::settings::{PowerTimes, Reactions, SceneIdentity, Settings};
use nalgebra::Vector2;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};
use trirrr_core::limits::LimitParameters;
use trirrr_core::machine::{LegParameters, Parameters, PlatformParameters};
use trirrr_core::model::{Model, ModelKind};
use trirrr_core::setpoint::Pose;
use trirrr_core::torque::{links::LinksKind, payload::PayloadKind};
use trirrr_core::units::Units;
use trirrr_protocol::message::scene::{Leg, Limits, Platform};
use trirrr_protocol::message::{NAME_CAPACITY, SceneNeed, UpdateRefusal};
use trirrr_protocol::wire::schema;

/// Values of a scene. Its machine is in SI units; what the service counts with is in ticks and in the units of the image.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct SceneValues {
    /// Key of the scene; not 0.
    pub key: u32,
    /// Name, ASCII, zeros behind it.
    pub name: [u8; NAME_CAPACITY],
    /// Units of length, time and mass in the image, as exponents of two of m, s and kg.
    pub units: [i8; 3],
    /// Pose at the start: x and y of D, m, and alpha, rad.
    pub start: [f64; 3],
    /// The legs.
    pub legs: [Leg; 3],
    /// The platform and its loads.
    pub platform: Platform,
    /// Limits.
    pub limits: Limits,
    /// Ramp of a hold, a stop and a resume.
    pub ramp: Ramp,
    /// Silence of the host after which a machine that moves comes to rest, ticks; 0 for never.
    pub host_timeout_ticks: u32,
    /// One telemetry sample every so many ticks; 0 for none.
    pub telemetry_every: u16,
    /// Times that the drives and the brake take.
    pub power: PowerTimes,
    /// Stops at faults.
    pub reactions: Reactions,
    /// Tolerances and steps of the planner of paths, in the units of the image.
    pub planning: Option<Planning<f64>>,
    /// Homing, in the units of the image.
    pub homing: Option<HomingParameters>,
    /// Watch over the drives.
    pub feedback: Option<FeedbackParameters>,
    /// Detection of contacts.
    pub contact: Option<ContactParameters>,
    /// Steps of steppers.
    pub steppers: Option<[StepperValues; 3]>,
}

/// Steps of a motor.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct StepperValues {
    /// Microsteps of a turn of the motor, positive.
    pub microsteps: u32,
    /// Turns of the motor in a turn of the joint, positive.
    pub gear_ratio: f64,
    /// The motor turns against the joint.
    pub reversed: bool,
}

/// Needs of a model of this kind: those of its torques, its payload and its links.
pub fn needs_of_model(kind: ModelKind) -> impl Iterator<Item = SceneNeed> {
    let (torques, payload, links) = match kind {
        ModelKind::Kinematic => (false, PayloadKind::Centred, LinksKind::Massless),
        ModelKind::Dynamic(payload, links) => (true, payload, links),
    };
    [
        (torques, SceneNeed::Torques),
        (payload >= PayloadKind::Offset, SceneNeed::PayloadOffset),
        (links >= LinksKind::Rotors, SceneNeed::Rotors),
        (links >= LinksKind::MassiveHorizontal, SceneNeed::LinkMasses),
        (links >= LinksKind::MassiveInPlane, SceneNeed::Gravity),
    ]
    .into_iter()
    .filter_map(|(is_needed, need)| is_needed.then_some(need))
}

impl SceneValues {
    /// Key of the layout of the values.
    pub const LAYOUT: u64 = schema::key::<Self, ()>();

    /// Most bytes of the values.
    pub const LONGEST: usize = schema::longest::<Self>();

    fn in_units(&self) -> Units {
        let [length, time, mass] = self.units.map(i32::from);
        Units { length, time, mass }
    }

    /// Machine in the units of the image.
    pub fn parameters(&self) -> Parameters {
        let platform = &self.platform;
        self.in_units().parameters(&Parameters {
            legs: self.legs.each_ref().map(LegParameters::from),
            platform: PlatformParameters {
                mass_kg: platform.mass_kg,
                inertia_kgm2: platform.inertia_kgm2,
                com_m: Vector2::from(platform.com_m),
                tool_point_m: Vector2::from(platform.tool_point_m),
            },
            gravity_m_s2: Vector2::from(platform.gravity_m_s2),
            wrench_force_n: Vector2::from(platform.wrench_force_n),
            wrench_torque_nm: platform.wrench_torque_nm,
        })
    }

    /// Limits in the units of the image.
    pub fn limits(&self) -> LimitParameters {
        self.in_units().limits(&LimitParameters::from(&self.limits))
    }

    /// Start in the units of the image.
    pub fn start<N: ServiceNumber>(&self) -> Pose<N> {
        let [x, y, alpha] = self.start;
        let unit = self.in_units().length_m();
        Pose::from_f64(x / unit, y / unit, alpha)
    }

    /// Settings of the service; what is not a value is as in `own`, those of the image.
    pub fn settings<N: ServiceNumber>(&self, own: &Settings<N>) -> Settings<N> {
        let units = self.in_units();
        let of_image = &own.scene;
        Settings {
            period: N::factor_from_f64(units.time(1.0 / of_image.tick_rate_hz)),
            ramp: self.ramp,
            host_timeout_ticks: self.host_timeout_ticks,
            telemetry_every: self.telemetry_every,
            power: self.power,
            reactions: self.reactions,
            planning: self.planning.map(|planning| planning.convert(N::from_f64)),
            scene: SceneIdentity {
                key: self.key,
                name: self.name,
                length_m: units.length_m(),
                time_s: units.time_s(),
                mass_kg: units.of(0, 0, 1),
                ..*of_image
            },
            ..*own
        }
    }

    /// Checks that an image of the model `M`, the moves `K` and the planner `P`, with the settings `own`, can play the scene: as it will be
    /// built at the start.
    ///
    /// # Errors
    /// A part that the model lacks, a quantity that is refused, a start out of reach, or numbers that no scene has.
    pub fn check<M, K, P>(&self, own: &Settings<M::N>) -> Result<(), UpdateRefusal>
    where
        M: Model<N: ServiceNumber>,
        K: PlayedCurves,
        P: PathPlanner<M::N>,
    {
        let parameters = self.parameters();
        let has = |need: &SceneNeed| needs_of_model(M::KIND).any(|own| own == *need);
        let kind = ModelKind::of(&parameters, M::TORQUES);
        if let Some(lacking) = needs_of_model(kind).find(|need| !has(need)) {
            return Err(UpdateRefusal::SceneNeeds(lacking));
        }
        if self.key == 0 || self.ramp.ticks == 0 || !self.is_finite() {
            return Err(UpdateRefusal::SceneLayout);
        }
        let scene = Adjustable::<M, K, P>::new(parameters, self.limits());
        // By reference: they are kilobytes, and a move is another copy on a board's stack.
        let built = scene.coefficients(&self.settings(own));
        let built = match &built {
            Ok(built) => built,
            Err(error) => {
                return Err(UpdateRefusal::SceneValue {
                    quantity: error.quantity,
                    leg: error.leg.map(|leg| leg as u8),
                });
            }
        };
        let (geometry, start) = (built.tick.geometry(), self.start());
        if geometry.position(&start).is_err() {
            return Err(UpdateRefusal::SceneStart);
        }
        let is_out_of_reach = |feedback: &FeedbackParameters| {
            FeedbackCoefficients::build(feedback, &parameters, geometry, start).is_none()
        };
        match &self.feedback {
            Some(feedback) if is_out_of_reach(feedback) => Err(UpdateRefusal::SceneStart),
            _ => Ok(()),
        }
    }

    /// Returns true if the numbers that no builder checks are finite, and those of the steppers positive.
    fn is_finite(&self) -> bool {
        let finite = |numbers: &[f64]| numbers.iter().all(|number| number.is_finite());
        let planning = self.planning.is_none_or(|it| {
            let ([a, b], [c, d]) = (it.tolerances, it.bends);
            finite(&[it.period, it.step, a, b, c, d, it.lever, it.hold_rate])
        });
        let homing = self.homing.is_none_or(|homing| {
            let motor = |it: &HomingMotor| {
                finite(&[it.angle_rad, it.search_rate_rad_s, it.latch_rate_rad_s])
                    && finite(&[it.acceleration_rad_s2, it.back_off_rad])
                    && finite(&[it.travel_max_rad, it.stall_torque_nm])
            };
            finite(&homing.start) && homing.motors.iter().all(motor)
        });
        let feedback = self.feedback.is_none_or(|feedback| {
            finite(&[
                feedback.still_rad,
                feedback.standing_rad,
                feedback.moving_rad,
            ])
        });
        let contact = self.contact.is_none_or(|it| {
            let ([a, b, c], [d, e, f]) = (it.coulomb_nm, it.viscous_nm_s_rad);
            finite(&[it.force_n, it.torque_nm, it.bandwidth_hz, it.told_after])
                && finite(&[a, b, c, d, e, f, it.sliding_rad_s])
        });
        let steppers = self.steppers.is_none_or(|motors| {
            let motor = |it: &StepperValues| it.microsteps > 0 && it.gear_ratio > 0.0;
            motors.iter().all(motor) && finite(&motors.map(|motor| motor.gear_ratio))
        });
        finite(&self.start) && planning && homing && feedback && contact && steppers
    }
}
