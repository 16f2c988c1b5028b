//! Drives on the CAN bus.

use super::Drive;
use super::mit::{Mit, read_mit};
use crate::read::{Bound, Section};

/// A drive on the CAN bus.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Can {
    /// The frames it speaks.
    pub protocol: CanProtocol,
    /// Its address, different for each drive of a machine.
    pub node_id: u32,
    /// The joint angle at which the drive's own position is 0, rad.
    pub zero_rad: f64,
    /// Meaning of the drive's position after it was switched on.
    pub knows: Knows,
    /// Bits per second on the bus, the same for all: that of moteus is 1 Mbit/s, outside the data.
    pub bit_rate_hz: u32,
    /// Messages per second that the drive sends by itself.
    pub messages_hz: f64,
    /// Torque per current at the rotor, N m/A, of a drive that tells its current; none where it tells its torque.
    pub torque_constant_nm_a: Option<f64>,
}

impl Can {
    /// Returns the longest time between two positions of a drive that has not restarted, in ticks: three periods of those that an
    /// ODrive sends by itself, at least a third of its messages. Others answer in each tick: 0.
    pub fn positions_within_ticks(&self, tick_rate_hz: f64) -> u16 {
        match self.protocol {
            // The cast saturates.
            CanProtocol::Odrive => (9.0 * tick_rate_hz / self.messages_hz).ceil() as u16,
            CanProtocol::Moteus | CanProtocol::Mit(_) => 0,
        }
    }
}

/// Frame layouts of CAN drives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CanProtocol {
    /// mjbots moteus registers over CAN FD; addresses 1 to 127.
    Moteus,
    /// ODrive CANSimple; addresses 0 to 63.
    Odrive,
    /// Frames of the MIT mode; addresses 1 to 127.
    Mit(Mit),
}

/// Meaning of a drive's position after it was switched on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Knows {
    /// The joint's angle.
    Joint,
    /// The rotor's, within its turn.
    Rotor,
    /// Nothing: the machine has to be homed.
    Nothing,
}

/// The protocols by name, before their parameters are read.
#[derive(Clone, Copy)]
enum ProtocolName {
    Moteus,
    Odrive,
    Mit,
}

/// Heartbeats ten times a second and encoder estimates a hundred times, as an ODrive is delivered.
const ODRIVE_MESSAGES_HZ: f64 = 110.0;

/// Reads a drive of a scene that `homes`.
pub(super) fn read_can(section: &Section, homes: bool) -> Option<Can> {
    let protocols = [
        ("mit", ProtocolName::Mit),
        ("moteus", ProtocolName::Moteus),
        ("odrive", ProtocolName::Odrive),
    ];
    let name = section.choice("protocol", &protocols);
    let (low, high) = match name {
        Some(ProtocolName::Moteus | ProtocolName::Mit) => (1, 127),
        Some(ProtocolName::Odrive) => (0, 63),
        None => (0, 127),
    };
    let node_id = section.integer("node_id", low, high);
    let zero = section.number_or("zero_rad", Bound::Finite, 0.0);
    let knows = read_knows(section, name, homes);
    let bit_rate = match name {
        Some(ProtocolName::Odrive) => read_bit_rate(section, 250_000),
        Some(ProtocolName::Mit) => read_bit_rate(section, FASTEST_HZ),
        // Whatever it was going to be.
        None if section.has("bit_rate_hz") => read_bit_rate(section, FASTEST_HZ),
        Some(ProtocolName::Moteus) | None => Some(FASTEST_HZ),
    };
    let messages = match name {
        Some(ProtocolName::Odrive) => {
            section.number_or("messages_hz", Bound::Positive, ODRIVE_MESSAGES_HZ)
        }
        _ => Some(0.0),
    };
    let torque_constant = match name {
        Some(ProtocolName::Odrive) => {
            section.optional_number("torque_constant_nm_a", Bound::Positive)
        }
        _ => None,
    };
    let protocol = match name {
        Some(ProtocolName::Moteus) => Some(CanProtocol::Moteus),
        Some(ProtocolName::Odrive) => Some(CanProtocol::Odrive),
        Some(ProtocolName::Mit) => read_mit(section, node_id).map(CanProtocol::Mit),
        None => {
            section.ignore_rest();
            None
        }
    };
    Some(Can {
        protocol: protocol?,
        node_id: node_id?,
        zero_rad: zero?,
        knows: knows?,
        bit_rate_hz: bit_rate?,
        messages_hz: messages?,
        torque_constant_nm_a: torque_constant,
    })
}

/// `absolute`: what the drive knows. An encoder behind a gear sees a turn of the rotor, that of an actuator for the MIT
/// mode the joint.
fn read_knows(section: &Section, name: Option<ProtocolName>, homes: bool) -> Option<Knows> {
    let key = "absolute";
    let choices = [
        ("joint", Knows::Joint),
        ("rotor", Knows::Rotor),
        ("nothing", Knows::Nothing),
    ];
    if !section.has(key) {
        return Some(match (name, homes) {
            (_, true) => Knows::Nothing,
            (Some(ProtocolName::Mit), false) => Knows::Joint,
            _ => Knows::Rotor,
        });
    }
    let knows = section.choice(key, &choices)?;
    let reason = match (knows, homes) {
        (Knows::Joint, true) => {
            "the drive knows the angle of its joint, for which [homing] searches: leave one of them out"
        }
        (Knows::Nothing, false) => {
            "a drive that knows nothing needs [homing], or an encoder that knows more"
        }
        _ => return Some(knows),
    };
    section.refuse(key, reason);
    None
}

/// Fastest bus of classic CAN; that of moteus outside the data of its CAN FD frames.
const FASTEST_HZ: u32 = 1_000_000;

/// Rates that the drives can be set to.
const BIT_RATES_HZ: [u32; 4] = [125_000, 250_000, 500_000, FASTEST_HZ];

fn read_bit_rate(section: &Section, delivered: u32) -> Option<u32> {
    let key = "bit_rate_hz";
    if !section.has(key) {
        return Some(delivered);
    }
    let rate = section.integer(key, 1, FASTEST_HZ)?;
    if !BIT_RATES_HZ.contains(&rate) {
        section.refuse(key, "must be 125000, 250000, 500000 or 1000000 (Hz)");
        return None;
    }
    Some(rate)
}

/// Key in which two drives on one bus disagree, and the reason why they may not.
pub(super) fn difference(a: &Can, b: &Can) -> Option<(&'static str, &'static str)> {
    let bus = "all three are on one bus";
    let code = "an image has one for all three";
    match (a.protocol, b.protocol) {
        (CanProtocol::Moteus, CanProtocol::Moteus) | (CanProtocol::Odrive, CanProtocol::Odrive) => {
        }
        (CanProtocol::Mit(a), CanProtocol::Mit(b)) => {
            if let Some(key) = a.difference(&b) {
                return Some((key, code));
            }
        }
        _ => return Some(("protocol", bus)),
    }
    (a.bit_rate_hz != b.bit_rate_hz).then_some(("bit_rate_hz", bus))
}

/// Refuses two drives at one address, one `[[drive]]` for three addresses included.
pub(super) fn check_node_ids(sections: &[Section], drives: &[Drive; 3]) -> Option<()> {
    let ids = drives.map(|drive| drive.can().map(|can| can.node_id));
    for later in 1..3 {
        let Some(id) = ids[later] else { continue };
        let Some(earlier) = ids[..later].iter().position(|other| *other == Some(id)) else {
            continue;
        };
        let reason = match sections {
            [_] => "every drive needs an address of its own: give three [[drive]]".into(),
            _ => format!("is already the address of drive[{}]", earlier + 1),
        };
        sections[later.min(sections.len() - 1)].refuse("node_id", reason);
        return None;
    }
    Some(())
}
