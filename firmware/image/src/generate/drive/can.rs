//! Drives on the CAN bus as constants.

use super::{DriveError, refuse};
use std::f64::consts::{PI, TAU};
use trirrr_core::units::Units;
use trirrr_drives::can::{FRAME_BITS, frames_per_tick};
use trirrr_scene::{Can, CanProtocol, Drive, DriveKind, Scene};

/// Share of the bus that commands and answers may take.
const BUS_SHARE_MAX: f64 = 0.8;

/// Time of a frame of moteus in bits outside its data: 32 up to the switch of the rate, of which a quarter more is stuffed, and 13 at
/// the end; 218 of length, data and checksum in a fifth of the time, a quarter more of them stuffed.
const MOTEUS_BITS: f64 = 32.0 * 1.25 + 13.0 + 218.0 * 1.25 / 5.0;

/// Largest whole number of thousandths in a frame of an ODrive.
const ODRIVE_FIELD: f64 = 32.767;

/// Constants of the scene's drives.
pub(super) fn cans(
    scene: &Scene,
    drives: &[Drive; 3],
    first: &Can,
    units: &Units,
) -> Result<String, DriveError> {
    check_load(scene, drives, first)?;
    let mut nodes = Vec::new();
    let mut rotors = Vec::new();
    let mut filters = Vec::new();
    for (index, drive) in drives.iter().enumerate() {
        let DriveKind::Can(can) = drive.kind else {
            return refuse(index, "kind", "must be that of drive[1]");
        };
        check_fields(scene, index, drive, &can)?;
        nodes.push(can.node_id);
        rotors.push(format!(
            "trirrr_drives::can::RotorScale::new({:?}, {}, {:?}, {:?}, {:?})\
             .knows(trirrr_drives::can::Absolute::{:?}).positions_within({}).torque_constant({:?})",
            drive.gear_ratio,
            drive.reversed,
            can.zero_rad,
            units.rate_rad_s(),
            units.torque_nm(),
            can.knows,
            can.positions_within_ticks(scene.tick_rate_hz),
            can.torque_constant_nm_a.unwrap_or(0.0),
        ));
        filters.push(match can.protocol {
            CanProtocol::Odrive => (can.node_id << 5, 0x7E0),
            CanProtocol::Mit(mit) => (mit.host_id, 0x7FF),
            // To source 0. The identifier has the node above its lower byte: beyond node 7 it has more than eleven bits.
            CanProtocol::Moteus => (can.node_id << 8, 0x7FFF),
        });
    }
    let (kind, protocol) = protocol(first);
    Ok(format!(
        "pub type Protocol = trirrr_drives::can::{kind};\n\
         pub const PROTOCOL: Protocol = {protocol};\n\
         pub const NODES: [u8; 3] = {nodes:?};\n\
         pub const ROTORS: [trirrr_drives::can::RotorScale; 3] = [{}];\n\
         /// Identifiers of the frames from each drive, and the bits that count.\n\
         pub const FILTERS: [(u16, u16); 3] = {filters:?};\n\
         pub const BIT_RATE_HZ: u32 = {};\n\
         /// Frames from the bus in a tick, at most.\n\
         pub const HEARD: u16 = {};",
        rotors.join(", "),
        first.bit_rate_hz,
        frames_per_tick(first.bit_rate_hz, scene.tick_rate_hz),
    ))
}

/// Type and value of the protocol, of the module `trirrr_drives::can`.
fn protocol(can: &Can) -> (&'static str, String) {
    let path = "trirrr_drives::can::";
    match can.protocol {
        CanProtocol::Odrive => ("Odrive", format!("{path}Odrive")),
        CanProtocol::Moteus => (
            "Moteus",
            format!("{path}Moteus {{ resolution: {path}Resolution::Float }}"),
        ),
        CanProtocol::Mit(mit) => {
            let text = format!(
                "{path}Mit {{ ranges: {path}MitRanges {{ position: {:?}, velocity: {:?}, torque: {:?}, \
                 kp: {:?}, kd: {:?} }}, kp: {:?}, kd: {:?}, answer: {path}Answer::{:?}, host_id: {} }}",
                mit.position_max_rad,
                mit.velocity_max_rad_s,
                mit.torque_max_nm,
                mit.kp_max,
                mit.kd_max,
                mit.kp_nm_rad,
                mit.kd_nm_s_rad,
                mit.answer,
                mit.host_id,
            );
            ("Mit", text)
        }
    }
}

/// Refuses commands and messages that together take too much of the bus: those of the drives go before those of the
/// board.
fn check_load(scene: &Scene, drives: &[Drive; 3], first: &Can) -> Result<(), DriveError> {
    let by_itself: f64 = drives
        .iter()
        .filter_map(Drive::can)
        .map(|can| can.messages_hz)
        .sum();
    let frames = match first.protocol {
        // A command of 24 bytes, and as many in its answer.
        CanProtocol::Moteus => 6.0 * scene.tick_rate_hz * MOTEUS_BITS / f64::from(FRAME_BITS),
        CanProtocol::Odrive => 3.0 * scene.tick_rate_hz + by_itself,
        // Each command is answered.
        CanProtocol::Mit(_) => 6.0 * scene.tick_rate_hz,
    };
    let share = frames * f64::from(FRAME_BITS) / f64::from(first.bit_rate_hz);
    if share <= BUS_SHARE_MAX {
        return Ok(());
    }
    refuse(
        0,
        "bit_rate_hz",
        format!(
            "three commands in each of {} ticks per second and what the drives say take {:.0} % of \
             {} bits per second; {:.0} % may be taken",
            scene.tick_rate_hz,
            100.0 * share,
            first.bit_rate_hz,
            100.0 * BUS_SHARE_MAX
        ),
    )
}

/// Refuses limits of the machine that do not fit the fields of the drive's frames.
fn check_fields(scene: &Scene, index: usize, drive: &Drive, can: &Can) -> Result<(), DriveError> {
    let (velocity_max, torque_max) = match can.protocol {
        // Floats.
        CanProtocol::Moteus => return Ok(()),
        CanProtocol::Odrive => (ODRIVE_FIELD * TAU, ODRIVE_FIELD),
        CanProtocol::Mit(mit) => {
            let turn = drive.gear_ratio * PI;
            if turn > mit.position_max_rad {
                let reason = format!(
                    "half a turn of the joint is {turn:.1} rad of the drive, and a frame holds {:?}",
                    mit.position_max_rad
                );
                return refuse(index, "gear_ratio", reason);
            }
            (mit.velocity_max_rad_s, mit.torque_max_nm)
        }
    };
    let limits = &scene.limits;
    let rates = (
        "rate_rad_s",
        limits.rate_rad_s,
        velocity_max / drive.gear_ratio,
    );
    let torques =
        scene
            .torque
            .then_some(("torque_nm", limits.torque_nm, torque_max * drive.gear_ratio));
    for (key, limit, most) in torques.into_iter().chain([rates]) {
        match limit.map(|limits| limits[index]) {
            Some(limit) if limit <= most => {}
            Some(limit) => {
                let reason = format!(
                    "[limits] {key} is {limit:?} at the joint, and a frame holds {most:.3}"
                );
                return refuse(index, "protocol", reason);
            }
            None => {
                let reason =
                    format!("needs {key} in [limits], at most {most:.3}: a frame holds no more");
                return refuse(index, "protocol", reason);
            }
        }
    }
    Ok(())
}
