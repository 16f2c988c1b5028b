//! Actuators that take frames of the MIT mode, and the ranges of their fields.

use crate::read::{Bound, Section};

/// A drive that takes frames of the MIT mode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mit {
    /// Largest position of either sign, rad.
    pub position_max_rad: f64,
    /// Largest velocity of either sign, rad/s.
    pub velocity_max_rad_s: f64,
    /// Largest torque of either sign, N m.
    pub torque_max_nm: f64,
    /// Largest gain of the position, N m/rad.
    pub kp_max: f64,
    /// Largest gain of the velocity, N m s/rad.
    pub kd_max: f64,
    /// Gain of the position at the drive, N m/rad.
    pub kp_nm_rad: f64,
    /// Gain of the velocity at the drive, N m s/rad.
    pub kd_nm_s_rad: f64,
    /// Layout of the answers.
    pub answer: MitAnswer,
    /// Identifier of the answers.
    pub host_id: u32,
}

/// Layout of the answers of a drive in the MIT mode.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MitAnswer {
    /// Damiao.
    Damiao,
    /// RobStride, and CyberGear with the firmware that has the mode.
    RobStride,
    /// T-Motor (CubeMars) AK.
    TMotor,
}

/// Ranges of a model: rad, rad/s, N m, N m/rad, N m s/rad; and its answers.
#[derive(Clone, Copy)]
struct Model([f64; 5], MitAnswer);

const fn damiao(position: f64, velocity: f64, torque: f64) -> Model {
    Model([position, velocity, torque, 500.0, 5.0], MitAnswer::Damiao)
}

const fn t_motor(velocity: f64, torque: f64) -> Model {
    Model([12.5, velocity, torque, 500.0, 5.0], MitAnswer::TMotor)
}

const fn robstride(velocity: f64, torque: f64, kp: f64, kd: f64) -> Model {
    Model([12.57, velocity, torque, kp, kd], MitAnswer::RobStride)
}

/// Models by name, as their makers deliver them; `docs/scene.md` names the sources.
const MODELS: [(&str, Model); 27] = [
    ("ak10-9", t_motor(50.0, 65.0)),
    ("ak60-6", t_motor(50.0, 15.0)),
    ("ak70-10", t_motor(50.0, 25.0)),
    ("ak80-6", t_motor(76.0, 12.0)),
    ("ak80-64", t_motor(8.0, 144.0)),
    ("ak80-9", t_motor(50.0, 18.0)),
    (
        "cybergear",
        Model([12.5, 30.0, 12.0, 500.0, 5.0], MitAnswer::RobStride),
    ),
    ("dm3507", damiao(12.5, 50.0, 5.0)),
    ("dm4310", damiao(12.5, 30.0, 10.0)),
    ("dm4310-48v", damiao(12.5, 50.0, 10.0)),
    ("dm4340", damiao(12.5, 10.0, 28.0)),
    ("dm4340-48v", damiao(12.5, 10.0, 28.0)),
    ("dm6006", damiao(12.5, 45.0, 20.0)),
    ("dm8006", damiao(12.5, 45.0, 40.0)),
    ("dm8009", damiao(12.5, 45.0, 54.0)),
    ("dm10010", damiao(12.5, 20.0, 200.0)),
    ("dm10010l", damiao(12.5, 25.0, 200.0)),
    ("dmg6220", damiao(12.5, 45.0, 10.0)),
    ("dmh3510", damiao(12.5, 280.0, 1.0)),
    ("dmh6215", damiao(12.5, 45.0, 10.0)),
    ("rs00", robstride(33.0, 14.0, 500.0, 5.0)),
    ("rs01", robstride(44.0, 17.0, 500.0, 5.0)),
    ("rs02", robstride(44.0, 17.0, 500.0, 5.0)),
    ("rs03", robstride(20.0, 60.0, 5000.0, 100.0)),
    ("rs04", robstride(15.0, 120.0, 5000.0, 100.0)),
    ("rs05", robstride(50.0, 5.5, 500.0, 5.0)),
    ("rs06", robstride(50.0, 36.0, 5000.0, 100.0)),
];

/// Reads the keys of the MIT mode: a `model`, or ranges and the layout of the answers; ranges that are given go before
/// those of the model.
pub(super) fn read_mit(section: &Section, node_id: Option<u32>) -> Option<Mit> {
    let model = match section.has("model") {
        true => Some(section.choice("model", &MODELS)?),
        false => None,
    };
    let ranges = model.map(|Model(ranges, _)| ranges);
    let range = |key, at: usize| match ranges {
        Some(ranges) => section.number_or(key, Bound::Positive, ranges[at]),
        None => section.number(key, Bound::Positive),
    };
    let position = range("position_max_rad", 0);
    let velocity = range("velocity_max_rad_s", 1);
    let torque = range("torque_max_nm", 2);
    let kp_max = section.number_or("kp_max", Bound::Positive, ranges.map_or(500.0, |r| r[3]));
    let kd_max = section.number_or("kd_max", Bound::Positive, ranges.map_or(5.0, |r| r[4]));
    let answers = [
        ("damiao", MitAnswer::Damiao),
        ("robstride", MitAnswer::RobStride),
        ("t-motor", MitAnswer::TMotor),
    ];
    let answer = match model {
        Some(Model(_, answer)) if !section.has("answer") => Some(answer),
        _ => section.choice("answer", &answers),
    };
    let gain =
        |key, most: Option<f64>| section.number(key, Bound::Within(0.0, most.unwrap_or(f64::MAX)));
    let (kp, kd) = (gain("kp_nm_rad", kp_max), gain("kd_nm_s_rad", kd_max));
    let host_id = match section.has("host_id") {
        true => section.integer("host_id", 0, 0x7FF),
        false => Some(0),
    };
    if answer == Some(MitAnswer::Damiao) && node_id.is_some_and(|id| id > 15) {
        section.refuse(
            "node_id",
            "must be from 1 to 15: a Damiao answers with four bits of it",
        );
        return None;
    }
    Some(Mit {
        position_max_rad: position?,
        velocity_max_rad_s: velocity?,
        torque_max_nm: torque?,
        kp_max: kp_max?,
        kd_max: kd_max?,
        kp_nm_rad: kp?,
        kd_nm_s_rad: kd?,
        answer: answer?,
        host_id: host_id?,
    })
}

impl Mit {
    /// Key in which two drives differ.
    pub(super) fn difference(&self, other: &Self) -> Option<&'static str> {
        let keys = |mit: &Self| {
            [
                ("position_max_rad", mit.position_max_rad),
                ("velocity_max_rad_s", mit.velocity_max_rad_s),
                ("torque_max_nm", mit.torque_max_nm),
                ("kp_max", mit.kp_max),
                ("kd_max", mit.kd_max),
                ("kp_nm_rad", mit.kp_nm_rad),
                ("kd_nm_s_rad", mit.kd_nm_s_rad),
                ("answer", f64::from(mit.answer as u8)),
                ("host_id", mit.host_id.into()),
            ]
        };
        let pairs = keys(self).into_iter().zip(keys(other));
        let mut different = pairs.filter(|((_, a), (_, b))| a != b);
        different.next().map(|((key, _), _)| key)
    }
}
