//! `[contact]`: detection of forces at the tool.

use crate::drive::{CanProtocol, Drive, DriveKind};
use crate::number_type::NumberType;
use crate::read::{Bound, Section};
use trirrr_service::StopCategory;
use trirrr_service::features::ContactParameters;

/// Bandwidth of the observer where the scene does not say, Hz.
const BANDWIDTH_HZ: f64 = 20.0;

/// Ticks that confirm a contact where the scene does not say, and the most.
const CONFIRM_TICKS: (u32, u32) = (2, 1000);

/// Rate of a joint that slides for certain, where the scene does not say, rad/s.
const SLIDING_RAD_S: f64 = 0.05;

/// Time from one model of the pose to the next, s: at 1 m/s the platform moves by 10 mm.
const MODEL_S: f64 = 0.01;

/// Longest way back, in time of the path, s.
const LONGEST_RETREAT_S: f64 = 10.0;

/// Detection of forces at the tool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Greatest force on the platform that is no contact, N,
    pub force_n: f64,
    /// and greatest moment about D, N m.
    pub torque_nm: f64,
    /// Bandwidth of the observer, Hz.
    pub bandwidth_hz: f64,
    /// Ticks in a row beyond a threshold that are a contact.
    pub confirm_ticks: u16,
    /// Friction that is no contact.
    pub friction: ContactFriction,
    /// Ticks by which the drives answer late, and the part of a tick after which they tell their motion.
    pub told: (u16, f64),
    /// Stop at a contact.
    pub reaction: StopCategory,
    /// Time of the path by which the machine goes back after the stop, s; 0 for none.
    pub retreat_s: f64,
}

/// Friction of the motors, at the joints.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactFriction {
    /// Coulomb's, N m.
    pub coulomb_nm: [f64; 3],
    /// Viscous, N m s/rad.
    pub viscous_nm_s_rad: [f64; 3],
    /// Joint rate from which on a joint slides for certain, rad/s.
    pub sliding_rad_s: f64,
}

impl Default for ContactFriction {
    fn default() -> Self {
        Self {
            coulomb_nm: [0.0; 3],
            viscous_nm_s_rad: [0.0; 3],
            sliding_rad_s: SLIDING_RAD_S,
        }
    }
}

impl Contact {
    /// Returns the detection that only estimates: the observer of a scene without `[contact]`.
    pub fn estimating(tick_rate_hz: f64, drive: &Drive) -> Self {
        Self {
            force_n: f64::MAX.sqrt(),
            torque_nm: f64::MAX,
            bandwidth_hz: default_bandwidth(tick_rate_hz),
            confirm_ticks: CONFIRM_TICKS.0 as u16,
            friction: ContactFriction::default(),
            told: told(drive),
            reaction: StopCategory::StopThenOff,
            retreat_s: 0.0,
        }
    }

    /// Returns the settings of the service.
    pub fn parameters(&self, tick_rate_hz: f64) -> ContactParameters {
        ContactParameters {
            force_n: self.force_n,
            torque_nm: self.torque_nm,
            bandwidth_hz: self.bandwidth_hz,
            confirm_ticks: self.confirm_ticks,
            // The cast saturates.
            model_ticks: (MODEL_S * tick_rate_hz).round().max(1.0) as u16,
            coulomb_nm: self.friction.coulomb_nm,
            viscous_nm_s_rad: self.friction.viscous_nm_s_rad,
            sliding_rad_s: self.friction.sliding_rad_s,
            late_ticks: self.told.0,
            told_after: self.told.1,
            reaction: self.reaction,
            retreat_ticks: (self.retreat_s * tick_rate_hz).round() as u32,
        }
    }
}

/// Ticks by which a drive answers late, and the part of a tick after which it tells its motion: an ODrive at any time, other
/// drives on the bus in answer to the next command, before they follow it, a loop on the board at the end of the tick.
fn told(drive: &Drive) -> (u16, f64) {
    match drive.kind {
        DriveKind::Can(can) => match can.protocol {
            CanProtocol::Odrive => (0, 0.5),
            CanProtocol::Moteus | CanProtocol::Mit(_) => (1, 1.0),
        },
        DriveKind::Bldc(_) | DriveKind::Stepper(_) => (0, 1.0),
    }
}

/// Largest bandwidth at a tick rate: the observer follows within a few ticks.
fn largest_bandwidth(tick_rate_hz: f64) -> f64 {
    tick_rate_hz / 4.0
}

fn default_bandwidth(tick_rate_hz: f64) -> f64 {
    BANDWIDTH_HZ.min(largest_bandwidth(tick_rate_hz))
}

/// Parts of the scene that a detection depends on; none where the scene has been refused there.
pub(crate) struct ContactNeeds {
    pub(crate) rate: Option<f64>,
    pub(crate) number: Option<NumberType>,
    pub(crate) torque: Option<bool>,
    /// A drive that tells where it is, and its torque.
    pub(crate) drive: Option<Drive>,
}

impl ContactNeeds {
    /// Reason why the machine cannot detect contacts, if there is one.
    fn obstacle(&self) -> Option<&'static str> {
        if self.torque == Some(false) {
            return Some("needs the torques that torque = false leaves out");
        }
        (self.number == Some(NumberType::Fixed))
            .then_some("needs a number type with a floating point: f32, micromath or f64")
    }
}

/// Reads `[contact]`, with `reaction` from `[faults]`; none without the table.
pub(crate) fn read_contact(
    root: &Section,
    needs: &ContactNeeds,
    reaction: Option<Option<StopCategory>>,
) -> Option<Option<Contact>> {
    if !root.has("contact") {
        if let Some(Some(_)) = reaction {
            root.refuse(
                "faults",
                "contact needs the table [contact], which says what a contact is",
            );
            return None;
        }
        return Some(None);
    }
    let section = root.section("contact")?;
    let force = section.number("force_n", Bound::Positive);
    let torque = section.number("torque_nm", Bound::Positive);
    let bandwidth = match needs.rate {
        Some(rate) => {
            let most = largest_bandwidth(rate);
            let bandwidth =
                section.number_or("bandwidth_hz", Bound::Positive, default_bandwidth(rate));
            if bandwidth.is_some_and(|bandwidth| bandwidth > most) {
                let reason = format!("must be at most a quarter of tick_rate_hz, {most} (Hz)");
                section.refuse("bandwidth_hz", reason);
                return None;
            }
            bandwidth
        }
        None => section.number_or("bandwidth_hz", Bound::Positive, BANDWIDTH_HZ),
    };
    let (default, most) = CONFIRM_TICKS;
    let confirm = match section.has("confirm_ticks") {
        true => section.integer("confirm_ticks", 1, most),
        false => Some(default),
    };
    let friction = read_friction(&section);
    let retreat = read_retreat(&section, reaction);
    let Some(drive) = &needs.drive else {
        root.refuse(
            "contact",
            "needs drives that tell their torque: kind = \"can\", or \"bldc\" with encoder_counts_per_rev",
        );
        return None;
    };
    if let Some(reason) = needs.obstacle() {
        root.refuse("contact", reason);
        return None;
    }
    Some(Some(Contact {
        force_n: force?,
        torque_nm: torque?,
        bandwidth_hz: bandwidth?,
        confirm_ticks: confirm? as u16,
        friction: friction?,
        told: told(drive),
        reaction: reaction?.unwrap_or(StopCategory::StopThenOff),
        retreat_s: retreat?,
    }))
}

/// Reads `retreat_s`, 0 without the key. A machine whose drives go off at once goes nowhere.
fn read_retreat(section: &Section, reaction: Option<Option<StopCategory>>) -> Option<f64> {
    let key = "retreat_s";
    if !section.has(key) {
        return Some(0.0);
    }
    let seconds = section.number(key, Bound::Within(0.0, LONGEST_RETREAT_S))?;
    if reaction == Some(Some(StopCategory::Off)) && seconds > 0.0 {
        let reason = "the drives go off at once with [faults] contact = 0: take 1 or 2";
        section.refuse(key, reason);
        return None;
    }
    Some(seconds)
}

fn read_friction(section: &Section) -> Option<ContactFriction> {
    let default = ContactFriction::default();
    if !section.has("friction") {
        return Some(default);
    }
    let section = section.section("friction")?;
    let each = |key| match section.has(key) {
        true => section.number_or_three(key, Bound::NotNegative),
        false => Some([0.0; 3]),
    };
    let coulomb = each("coulomb_nm");
    let viscous = each("viscous_nm_s_rad");
    let sliding = section.number_or("sliding_rad_s", Bound::Positive, default.sliding_rad_s);
    Some(ContactFriction {
        coulomb_nm: coulomb?,
        viscous_nm_s_rad: viscous?,
        sliding_rad_s: sliding?,
    })
}
