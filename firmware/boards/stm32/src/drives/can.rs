//! Drives on the CAN bus: the controller carries a frame to each of them in a tick, and an interrupt takes every frame from them.

pub(crate) use self::BusDrives as Drives;
use super::DriveParts;
use super::bus::BusController;
pub(crate) use super::bus::{Inbox, no_frames, report};
use crate::chip::bus::timing;
use crate::gpio::Pull;
use trirrr_app::outputs::OrEmulated;
use trirrr_app::scene::Scalar;
use trirrr_app::scene::drive::{HEARD, NODES, PROTOCOL, Protocol, ROTORS};
use trirrr_drives::ObeyingDrives;
use trirrr_drives::can::CanDrives;
use trirrr_protocol::message::Clock;

/// Drives, as the tick sees them.
pub(crate) type BusDrives = OrEmulated<CanDrives<Scalar, Protocol, BusController>>;
pub(crate) use trirrr_app::outputs::NoDriveTimer as DriveTimer;

/// Alternate function of the pins of either controller.
const FUNCTION: u8 = 9;

/// Builds the drives on their bus, or those of an emulated board. A board without its crystal takes no part, for its bits
/// would be too long or too short.
// A function of its own: its symbol shows that the image holds these drives.
#[inline(never)]
pub(crate) fn build(parts: DriveParts) -> (BusDrives, DriveTimer) {
    let pins = parts.pins;
    let _ = (
        pins.can_receive
            .into_alternate::<FUNCTION>()
            .internal_resistor(Pull::Up),
        pins.can_transmit.into_alternate::<FUNCTION>(),
    );
    let timing = match parts.clock {
        Clock::Crystal => timing(&parts.clocks),
        _ => None,
    };
    if parts.clock == Clock::Emulated {
        return (OrEmulated::Emulated(ObeyingDrives::new(parts.angles)), ());
    }
    let controller = BusController::start(timing, parts.inbox);
    let drives = CanDrives::new(PROTOCOL, controller, NODES, ROTORS, parts.angles, HEARD);
    (OrEmulated::Real(drives), ())
}
