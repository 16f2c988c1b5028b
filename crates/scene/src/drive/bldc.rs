//! Motors with an amplifier that controls their current.

use super::{EnableLevel, read_enable};
use crate::read::{Bound, Section};

/// A brushless motor as a direct-current equivalent, before the gear, and the amplifier that controls its current.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bldc {
    /// Winding resistance, ohm, positive.
    pub resistance_ohm: f64,
    /// Winding inductance, H, positive.
    pub inductance_h: f64,
    /// Torque per current, N m/A, positive.
    pub torque_constant_nm_a: f64,
    /// Back-EMF per rotor rate, V s/rad, positive; the torque constant where the scene leaves it
    /// out, for in SI units an ideal motor has the two equal.
    pub back_emf_constant_v_s_rad: f64,
    /// Supply voltage, V, positive.
    pub supply_v: f64,
    /// Largest current of either sign, A, positive.
    pub current_limit_a: f64,
    /// The level at which the amplifier is on; high where the scene leaves it out.
    pub enable: EnableLevel,
    /// Duty of the set value for the full scale backward, and forward; 0 to 1, not the same.
    pub command_duty: [f64; 2],
    /// Current at the ends of the set value, A; the current limit where the scene leaves it out.
    pub full_scale_a: f64,
    /// PWM frequency of the set value, Hz.
    pub command_hz: f64,
    /// Output of the amplifier that tells a failure.
    pub fault: FaultInput,
    /// Stiffness of the gear, seen at the joint, N m/rad, if the loops are to turn the rotor ahead by what the gear gives way.
    pub stiffness_nm_rad: Option<f64>,
}

/// Level of an amplifier's output that tells a failure. A cut wire tells one, too.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FaultInput {
    /// Failed where it is low; the input is pulled down.
    Low,
    /// Failed where it is high; the input is pulled up.
    High,
    /// The amplifier has no such output.
    None,
}

/// Duties and PWM frequency as amplifiers with a PWM set value take them: ESCON, Maxon, and others.
const DUTY: [f64; 2] = [0.1, 0.9];
const COMMAND_HZ: f64 = 5000.0;
/// Slowest and fastest PWM of the set value, Hz. The counter of a board has 16 bits.
const COMMAND_HZ_FROM_TO: (f64, f64) = (50.0, 100e3);

pub(super) fn read_bldc(section: &Section) -> Option<Bldc> {
    let resistance = section.number("resistance_ohm", Bound::Positive);
    let inductance = section.number("inductance_h", Bound::Positive);
    let torque_constant = section.number("torque_constant_nm_a", Bound::Positive);
    let back_emf = section.number_or(
        "back_emf_constant_v_s_rad",
        Bound::Positive,
        torque_constant.unwrap_or(1.0),
    );
    let supply = section.number("supply_v", Bound::Positive);
    let current_limit = section.number("current_limit_a", Bound::Positive);
    let enable = read_enable(section, EnableLevel::High);
    let duty = read_duty(section);
    let full_scale = section.number_or(
        "full_scale_a",
        Bound::Positive,
        current_limit.unwrap_or(1.0),
    );
    let (slow, fast) = COMMAND_HZ_FROM_TO;
    let command_hz = section.number_or("command_hz", Bound::Within(slow, fast), COMMAND_HZ);
    let stiffness = section.optional_number("stiffness_nm_rad", Bound::Positive);
    let fault = match section.has("fault") {
        true => section.choice(
            "fault",
            &[
                ("low", FaultInput::Low),
                ("high", FaultInput::High),
                ("none", FaultInput::None),
            ],
        ),
        false => Some(FaultInput::Low),
    };
    let (current_limit, full_scale) = (current_limit?, full_scale?);
    if full_scale < current_limit {
        let reason = format!(
            "the amplifier cannot be told more than this, and current_limit_a is {current_limit}"
        );
        section.refuse("full_scale_a", reason);
        return None;
    }
    Some(Bldc {
        resistance_ohm: resistance?,
        inductance_h: inductance?,
        torque_constant_nm_a: torque_constant?,
        back_emf_constant_v_s_rad: back_emf?,
        supply_v: supply?,
        current_limit_a: current_limit,
        enable: enable?,
        command_duty: duty?,
        full_scale_a: full_scale,
        command_hz: command_hz?,
        fault: fault?,
        stiffness_nm_rad: stiffness,
    })
}

fn read_duty(section: &Section) -> Option<[f64; 2]> {
    let key = "command_duty";
    if !section.has(key) {
        return Some(DUTY);
    }
    let duty = section.numbers(key, Bound::Within(0.0, 1.0))?;
    if duty[0] == duty[1] {
        section.refuse(key, "both ends are the same: no current can be told");
        return None;
    }
    Some(duty)
}

/// Key in which two amplifiers of one board disagree, and the reason why they may not.
pub(super) fn difference(a: &Bldc, b: &Bldc) -> Option<(&'static str, &'static str)> {
    let differs = [
        (
            a.enable != b.enable,
            "enable",
            "one line switches all three",
        ),
        (
            a.command_hz != b.command_hz,
            "command_hz",
            "one timer makes all three set values",
        ),
        (
            a.fault != b.fault,
            "fault",
            "an image reads all three alike",
        ),
    ];
    let found = differs.into_iter().find(|(differs, ..)| *differs);
    found.map(|(_, key, why)| (key, why))
}
