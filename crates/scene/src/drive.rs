//! The drives: what turns a motor's command into torque or motion.

mod bldc;
mod can;
mod mit;

pub use bldc::{Bldc, FaultInput};
pub use can::{Can, CanProtocol, Knows};
pub use mit::{Mit, MitAnswer};

use crate::read::{Bound, Section};
use bldc::read_bldc;
use can::{check_node_ids, difference, read_can};

/// The drive of one motor: a gear with a rotor behind it, and the electronics.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drive {
    /// Rotor turns per turn of the joint, positive.
    pub gear_ratio: f64,
    /// Inertia of the rotor about its own axis, before the gear, kg m^2.
    pub rotor_inertia_kgm2: f64,
    /// True if the joint turns clockwise where the drive thinks that it turns forward.
    pub reversed: bool,
    /// Counts of the rotor's encoder per turn of the rotor, if it has one.
    pub encoder_counts_per_rev: Option<u32>,
    /// Kind of the drive.
    pub kind: DriveKind,
}

/// The level of the line that switches the power stages on, one for all three.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EnableLevel {
    /// On where it is low.
    Low,
    /// On where it is high.
    High,
}

/// The kinds of drive, with what each needs to know.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DriveKind {
    /// A motor whose current an amplifier controls, with the loops of position and rate on the board.
    Bldc(Bldc),
    /// A stepper on step and direction.
    Stepper(Stepper),
    /// A drive of its own on the CAN bus, commanded by position, velocity and torque.
    Can(Can),
}

/// A stepper motor and its driver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stepper {
    /// Full steps per turn of the rotor.
    pub steps_per_rev: u32,
    /// Microsteps per full step.
    pub microsteps: u32,
    /// Largest rate of microsteps, Hz, if the driver has one.
    pub step_rate_limit_hz: Option<f64>,
    /// Holding torque of the rotor, N m, if it is known.
    pub holding_torque_nm: Option<f64>,
    /// Detent torque of the unpowered rotor, N m; 0 where the scene leaves it out.
    pub detent_torque_nm: f64,
    /// One point of the pull-out curve, if it is known.
    pub pull_out: Option<PullOut>,
    /// The level at which the driver is on; low where the scene leaves it out.
    pub enable: EnableLevel,
}

/// The torque that a stepper still has at a rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PullOut {
    /// Torque of the rotor, N m, less than the holding torque.
    pub torque_nm: f64,
    /// Rate of the rotor, rad/s, positive.
    pub rate_rad_s: f64,
}

impl Drive {
    /// Rotor inertia as the joint sees it, N^2 J_r, kg m^2.
    pub fn inertia_at_joint_kgm2(&self) -> f64 {
        self.gear_ratio * self.gear_ratio * self.rotor_inertia_kgm2
    }

    /// Returns true if the drive tells where its motor is.
    pub fn measures(&self) -> bool {
        match self.kind {
            DriveKind::Can(_) => true,
            DriveKind::Bldc(_) => self.encoder_counts_per_rev.is_some(),
            DriveKind::Stepper(_) => false,
        }
    }

    /// The drive on the CAN bus, where it is one.
    pub fn can(&self) -> Option<Can> {
        match self.kind {
            DriveKind::Can(can) => Some(can),
            _ => None,
        }
    }
}

/// The kinds by name, before their parameters are read.
#[derive(Clone, Copy)]
enum KindName {
    Bldc,
    Stepper,
    Can,
}

/// Reads `[[drive]]`: none, one for all three motors, or three.
pub(crate) fn read_drives(root: &Section) -> Option<Option<[Drive; 3]>> {
    let sections = root.sections("drive")?;
    let homes = root.has("homing");
    let read = |section| read_drive(section, homes);
    let drives: Vec<Option<Drive>> = sections.iter().map(read).collect();
    let drives: Option<Vec<Drive>> = drives.into_iter().collect();
    if !matches!(sections.len(), 0 | 1 | 3) {
        let reason = format!(
            "expected one [[drive]] for all three motors, or three, found {}",
            sections.len()
        );
        root.refuse_list("drive", reason);
        return None;
    }
    let drives = match drives?.as_slice() {
        [all] => [*all; 3],
        [first, second, third] => [*first, *second, *third],
        _ => return Some(None),
    };
    check_alike(&sections, &drives)?;
    check_node_ids(&sections, &drives)?;
    Some(Some(drives))
}

fn read_drive(section: &Section, homes: bool) -> Option<Drive> {
    let gear_ratio = section.number_or("gear_ratio", Bound::Positive, 1.0);
    let rotor = section.number_or("rotor_inertia_kgm2", Bound::NotNegative, 0.0);
    let reversed = match section.has("reversed") {
        true => section.boolean("reversed"),
        false => Some(false),
    };
    let kinds = [
        ("bldc", KindName::Bldc),
        ("stepper", KindName::Stepper),
        ("can", KindName::Can),
    ];
    let kind = match section.choice("kind", &kinds) {
        Some(KindName::Bldc) => read_bldc(section).map(DriveKind::Bldc),
        Some(KindName::Stepper) => read_stepper(section).map(DriveKind::Stepper),
        Some(KindName::Can) => read_can(section, homes).map(DriveKind::Can),
        None => {
            section.ignore_rest();
            None
        }
    };
    let encoder = match kind {
        Some(DriveKind::Stepper(_)) => Some(None),
        _ => read_encoder(section),
    };
    let drive = Drive {
        gear_ratio: gear_ratio?,
        rotor_inertia_kgm2: rotor?,
        reversed: reversed?,
        encoder_counts_per_rev: encoder?,
        kind: kind?,
    };
    if !drive.inertia_at_joint_kgm2().is_finite() {
        section.refuse(
            "gear_ratio",
            "the rotor's inertia at the joint, N^2 J_r, is not a finite number",
        );
        return None;
    }
    Some(drive)
}

fn read_encoder(section: &Section) -> Option<Option<u32>> {
    let key = "encoder_counts_per_rev";
    match section.has(key) {
        true => section.integer(key, 4, 1 << 30).map(Some),
        false => Some(None),
    }
}

fn read_stepper(section: &Section) -> Option<Stepper> {
    let steps_per_rev = section.integer("steps_per_rev", 1, 100_000);
    let microsteps = section.integer("microsteps", 1, 1024);
    let step_rate_limit_hz = section.optional_number("step_rate_limit_hz", Bound::Positive);
    let holding_torque_nm = section.optional_number("holding_torque_nm", Bound::Positive);
    let detent_torque_nm = section.number_or("detent_torque_nm", Bound::NotNegative, 0.0);
    let pull_out = read_pull_out(section, holding_torque_nm);
    let enable = read_enable(section, EnableLevel::Low);
    Some(Stepper {
        steps_per_rev: steps_per_rev?,
        microsteps: microsteps?,
        step_rate_limit_hz,
        holding_torque_nm,
        detent_torque_nm: detent_torque_nm?,
        pull_out: pull_out?,
        enable: enable?,
    })
}

fn read_enable(section: &Section, default: EnableLevel) -> Option<EnableLevel> {
    match section.has("enable") {
        true => section.choice(
            "enable",
            &[("low", EnableLevel::Low), ("high", EnableLevel::High)],
        ),
        false => Some(default),
    }
}

/// `pull_out_torque_nm` and `pull_out_rate_rad_s`: both or neither.
fn read_pull_out(section: &Section, holding_torque_nm: Option<f64>) -> Option<Option<PullOut>> {
    let (torque, rate) = ("pull_out_torque_nm", "pull_out_rate_rad_s");
    if !section.has(torque) && !section.has(rate) {
        return Some(None);
    }
    let torque_nm = section.number(torque, Bound::Positive);
    let rate_rad_s = section.number(rate, Bound::Positive);
    let (torque_nm, rate_rad_s) = (torque_nm?, rate_rad_s?);
    if !holding_torque_nm.is_some_and(|holding| torque_nm < holding) {
        section.refuse(
            torque,
            "must be less than holding_torque_nm, which it is compared with",
        );
        return None;
    }
    Some(Some(PullOut {
        torque_nm,
        rate_rad_s,
    }))
}

/// Refuses drives that no board drives together: of two kinds, or that disagree on what they share.
fn check_alike(sections: &[Section], drives: &[Drive; 3]) -> Option<()> {
    let [first, others @ ..] = drives;
    // One section for all three has nothing to disagree with.
    for (at, other) in sections.iter().skip(1).zip(others) {
        let differs = match (first.kind, other.kind) {
            (DriveKind::Bldc(a), DriveKind::Bldc(b)) => bldc::difference(&a, &b),
            (DriveKind::Stepper(a), DriveKind::Stepper(b)) if a.enable != b.enable => {
                Some(("enable", "one line switches all three"))
            }
            (DriveKind::Can(a), DriveKind::Can(b)) => difference(&a, &b),
            (DriveKind::Stepper(_), DriveKind::Stepper(_)) => None,
            _ => Some(("kind", "a board drives three of one kind")),
        };
        let encoders = [first, other].map(|drive| drive.encoder_counts_per_rev.is_some());
        let one = "all three have an encoder, or none";
        let differs =
            differs.or((encoders[0] != encoders[1]).then_some(("encoder_counts_per_rev", one)));
        if let Some((key, why)) = differs {
            at.refuse(key, format!("must be that of drive[1]: {why}"));
            return None;
        }
    }
    Some(())
}
