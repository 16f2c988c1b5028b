//! Homing: how a machine without absolute encoders finds out where its motors are.

use crate::drive::{Drive, DriveKind};
use crate::read::{Bound, Place, Section};
use core::f64::consts::{PI, TAU};
use trirrr_core::limits::LimitParameters as Limits;
use trirrr_service::features::{Contact, HomingMotor};

/// Longest time that an input may take to settle, s.
const LONGEST_DEBOUNCE_S: f64 = 1.0;

/// Settings of homing in the scene, in SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Homing {
    /// Kind of contact that the motors meet.
    pub contact: Contact,
    /// True if an input is high where the switch is closed or the drive stalls.
    pub active_high: bool,
    /// The motors.
    pub motors: [HomingMotor; 3],
    /// An input has to be the same for so many ticks, from 1.
    pub debounce_ticks: u16,
    /// A drive that signals a stall while its motor moves is a fault.
    pub stall_is_fault: bool,
}

/// Homing and where it stands in the file, for what is checked later.
pub(crate) struct PlacedHoming {
    pub(crate) homing: Homing,
    pub(crate) angles: Place,
    pub(crate) travel: Place,
}

/// Name of the thing that a motor meets.
#[derive(Clone, Copy)]
enum To {
    Switches,
    HardStops,
}

/// Reads `[homing]`: `Some(None)` where it is left out.
pub(crate) fn read_homing(
    root: &Section,
    rate: Option<f64>,
    limits: Option<&Limits>,
    drives: Option<&[Drive; 3]>,
) -> Option<Option<PlacedHoming>> {
    if !root.has("homing") {
        return Some(None);
    }
    let section = root.section("homing")?;
    let contact = read_contact(&section);
    let has_inputs = !matches!(contact, Some(Contact::Unfelt | Contact::Torque));
    let active_high = match has_inputs && section.has("active") {
        true => section.choice("active", &[("high", true), ("low", false)]),
        false => Some(true),
    };
    let motors = read_motors(&section, contact);
    let debounce_ticks = read_debounce(&section, rate);
    let stall_is_fault = match contact == Some(Contact::Stall) && section.has("stall_fault") {
        true => section.boolean("stall_fault"),
        false => Some(false),
    };
    let homing = Homing {
        contact: contact?,
        active_high: active_high?,
        motors: motors?,
        debounce_ticks: debounce_ticks?,
        stall_is_fault: stall_is_fault?,
    };
    check(&section, &homing, rate?, limits, drives)?;
    Some(Some(PlacedHoming {
        angles: section.place_of("angle_rad"),
        travel: section.place_of("travel_max_rad"),
        homing,
    }))
}

fn read_contact(section: &Section) -> Option<Contact> {
    let names = [("switches", To::Switches), ("hard-stops", To::HardStops)];
    match section.choice("to", &names) {
        Some(To::Switches) => Some(Contact::Switch),
        Some(To::HardStops) if section.has("stall_torque_nm") => {
            if section.has("stall_detection") {
                let reason = "goes without stall_torque_nm: either the drive says that it stalls, or its torque does";
                section.refuse("stall_detection", reason);
                return None;
            }
            Some(Contact::Torque)
        }
        Some(To::HardStops) => match section.boolean("stall_detection")? {
            true => Some(Contact::Stall),
            false => Some(Contact::Unfelt),
        },
        None => {
            section.ignore_rest();
            None
        }
    }
}

fn read_debounce(section: &Section, rate: Option<f64>) -> Option<u16> {
    let seconds = section.number_or("debounce_s", Bound::Within(0.0, LONGEST_DEBOUNCE_S), 0.005)?;
    let ticks = (seconds * rate?).round().max(1.0);
    if ticks > f64::from(u16::MAX) {
        section.refuse("debounce_s", format!("is {ticks} ticks, at most 65535"));
        return None;
    }
    Some(ticks as u16)
}

/// One number for all motors, or three.
fn each<'d>(section: &Section<'d, '_>, key: &'d str, bound: Bound) -> Option<[f64; 3]> {
    if !section.has(key) {
        section.refuse(
            key,
            "missing, expected a number for all motors, or three of them",
        );
        return None;
    }
    section.number_or_three(key, bound)
}

fn read_motors(section: &Section, contact: Option<Contact>) -> Option<[HomingMotor; 3]> {
    let angle = each(section, "angle_rad", Bound::Within(-PI, PI));
    let direction = each(section, "direction", Bound::Sign);
    let search = each(section, "search_rate_rad_s", Bound::Positive);
    let latch = match contact {
        // There is but one approach.
        Some(Contact::Unfelt) => search,
        _ => each(section, "latch_rate_rad_s", Bound::Positive),
    };
    let acceleration = each(section, "acceleration_rad_s2", Bound::Positive);
    let stall_torque = match contact {
        Some(Contact::Torque) => each(section, "stall_torque_nm", Bound::Positive),
        _ => Some([0.0; 3]),
    };
    let back_off = each(section, "back_off_rad", Bound::Positive);
    let travel = each(section, "travel_max_rad", Bound::Within(0.0, PI));
    let sequence = match section.has("sequence") {
        true => section
            .number_or_three("sequence", Bound::Within(1.0, 3.0))
            .filter(|stages| {
                let whole = stages.iter().all(|stage| stage.fract() == 0.0);
                if !whole {
                    section.refuse("sequence", "must be whole numbers");
                }
                whole
            }),
        false => Some([1.0; 3]),
    };
    let (angle, direction, search, latch) = (angle?, direction?, search?, latch?);
    let (acceleration, back_off) = (acceleration?, back_off?);
    let (travel, sequence, stall_torque) = (travel?, sequence?, stall_torque?);
    Some([0, 1, 2].map(|i| HomingMotor {
        angle_rad: angle[i],
        positive: direction[i] > 0.0,
        search_rate_rad_s: search[i],
        latch_rate_rad_s: latch[i],
        acceleration_rad_s2: acceleration[i],
        back_off_rad: back_off[i],
        travel_max_rad: travel[i],
        stall_torque_nm: stall_torque[i],
        stage: sequence[i] as u8 - 1,
    }))
}

/// Checks the rules that involve more than one key.
fn check(
    section: &Section,
    homing: &Homing,
    rate: f64,
    limits: Option<&Limits>,
    drives: Option<&[Drive; 3]>,
) -> Option<()> {
    let mut good = true;
    let mut refuse = |key: &str, reason: String| {
        section.refuse(key, reason);
        good = false;
    };
    let tells = drives.is_some_and(|drives| drives.iter().all(Drive::measures));
    if homing.contact == Contact::Torque && !tells {
        let reason = "needs drives that tell their torque: kind = \"can\", or \"bldc\" with encoder_counts_per_rev";
        refuse("stall_torque_nm", reason.into());
    }
    for (i, motor) in homing.motors.iter().enumerate() {
        let (number, search) = (i + 1, motor.search_rate_rad_s);
        if motor.latch_rate_rad_s > search {
            refuse(
                "latch_rate_rad_s",
                format!("of motor {number} is beyond its search rate"),
            );
        }
        if motor.back_off_rad >= motor.travel_max_rad {
            refuse(
                "back_off_rad",
                format!("of motor {number} is not less than its largest travel"),
            );
        }
        let overrun = motor.overrun_rad(homing.contact, homing.debounce_ticks, 1.0 / rate);
        if motor.back_off_rad + overrun >= PI {
            let reason = format!(
                "motor {number} would run {overrun:.3} rad beyond its switch before it stands; \
                 with the way back that is more than half a turn"
            );
            refuse("search_rate_rad_s", reason);
        }
        let limit = |values: Option<[f64; 3]>| values.map(|values| values[i]);
        if let Some(most) = limits.and_then(|limits| limit(limits.rate_rad_s))
            && search > most
        {
            refuse(
                "search_rate_rad_s",
                format!("of motor {number} is beyond [limits] rate_rad_s, {most:?} (rad/s)"),
            );
        }
        if let Some(most) = limits.and_then(|limits| limit(limits.acceleration_rad_s2))
            && motor.acceleration_rad_s2 > most
        {
            refuse(
                "acceleration_rad_s2",
                format!(
                    "of motor {number} is beyond [limits] acceleration_rad_s2, {most:?} (rad/s^2)"
                ),
            );
        }
        match drives.map(|drives| drives[i].kind) {
            Some(DriveKind::Stepper(stepper)) => {
                let gear = drives.map_or(1.0, |drives| drives[i].gear_ratio);
                let steps = f64::from(stepper.steps_per_rev) * f64::from(stepper.microsteps);
                let hz = search * gear * steps / TAU;
                if let Some(most) = stepper.step_rate_limit_hz
                    && hz > most
                {
                    refuse(
                        "search_rate_rad_s",
                        format!(
                            "takes {hz:.0} microsteps per second of motor {number}, its driver {most:?}"
                        ),
                    );
                }
            }
            Some(DriveKind::Bldc(bldc)) => {
                let gear = drives.map_or(1.0, |drives| drives[i].gear_ratio);
                let most = gear * bldc.torque_constant_nm_a * bldc.current_limit_a;
                if homing.contact == Contact::Torque && motor.stall_torque_nm >= most {
                    let reason = format!(
                        "motor {number} never gives that: its current limit makes {most:?} N m at the joint"
                    );
                    refuse("stall_torque_nm", reason);
                }
                let counts = drives.and_then(|drives| drives[i].encoder_counts_per_rev);
                if counts.is_none() {
                    let reason = "a [[drive]] of kind \"bldc\" follows an angle, and so can search, only with \
                                  encoder_counts_per_rev";
                    refuse("to", reason.into());
                } else if homing.contact == Contact::Unfelt {
                    let reason = "a [[drive]] of kind \"bldc\" pushes against a stop with all its torque until \
                                  something tells: take switches, or stall_torque_nm";
                    refuse("to", reason.into());
                }
            }
            // It follows an angle; whether it has to search is checked with its own keys.
            Some(DriveKind::Can(_)) | None => {}
        }
    }
    good.then_some(())
}
