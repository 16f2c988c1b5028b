//! Drives on the CAN bus: the controller carries a frame to each of them in a tick, and an interrupt takes every frame from them.

pub(super) mod handover;

use super::controller::{BusController, BusFrame};
use super::{DriveParts, DriveTimer};
use crate::parts::Rcc;
use heapless::spsc::Queue;
use trirrr_app::outputs::OrEmulated;
use trirrr_app::scene::Scalar;
use trirrr_app::scene::drive::{FILTERS, HEARD, NODES, PROTOCOL, Protocol, ROTORS};
use trirrr_drives::ObeyingDrives;
use trirrr_drives::can::CanDrives;
use trirrr_protocol::message::Clock;

/// Drives, as the tick sees them.
pub(crate) type BusDrives = OrEmulated<CanDrives<Scalar, Protocol, BusController>>;

/// Queue of the frames that came in: a tick's, and the place that stays empty.
pub(crate) type Inbox = Queue<BusFrame, { HEARD as usize + 1 }>;

/// Builds the drives on their bus, or those of an emulated board. A board without its crystal takes no part, for its bits
/// would be too long or too short.
// A function of its own: its symbol shows that the image holds these drives.
#[inline(never)]
pub(crate) fn build(parts: DriveParts, rcc: &mut Rcc) -> (BusDrives, DriveTimer) {
    let _ = (
        parts
            .pins
            .can_receive
            .into_alternate::<9>()
            .internal_pull_up(true),
        parts.pins.can_transmit.into_alternate::<9>(),
    );
    let (frames, inbox) = parts.inbox.split();
    let timing = match parts.clock {
        Clock::Crystal => BusController::timing(&parts.clocks),
        _ => None,
    };
    if parts.clock == Clock::Emulated {
        return (OrEmulated::Emulated(ObeyingDrives::new(parts.angles)), ());
    }
    let controller =
        BusController::start(parts.peripherals.can, rcc, timing, &FILTERS, frames, inbox);
    let drives = CanDrives::new(PROTOCOL, controller, NODES, ROTORS, parts.angles, HEARD);
    (OrEmulated::Real(drives), ())
}

/// Logs frames that were lost since the last call, which the queue has room for.
pub(crate) fn report() {
    let lost = handover::take_lost();
    if lost > 0 {
        defmt::error!("{=u32} frames from the bus were lost", lost);
    }
}
