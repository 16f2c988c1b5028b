//! Drives on the CAN bus: CAN1 carries a frame for each of them in a tick.

use super::DriveParts;
use super::controller::Controller;
use stm32f4xx_hal::rcc::Rcc;
use trirrr_app::scene::Scalar;
use trirrr_app::scene::drive::{BIT_RATE_HZ, NODES, RATE_RAD_S, ROTORS, TORQUE_NM};
use trirrr_drives::can::{BitTiming, CanDrives, Odrive, RotorScale};

/// Drives, as the tick sees them.
pub(crate) type OdriveDrives = CanDrives<Scalar, Odrive, Controller>;

const fn scale((gear_ratio, reversed, zero_rad): (f64, bool, f64)) -> RotorScale {
    RotorScale::new(gear_ratio, reversed, zero_rad, RATE_RAD_S, TORQUE_NM)
}

const SCALES: [RotorScale; 3] = [scale(ROTORS[0]), scale(ROTORS[1]), scale(ROTORS[2])];

/// Builds the drives on their bus. An emulated board has no bus.
// A function of its own: its symbol shows that the image holds these drives.
#[inline(never)]
pub(crate) fn build(parts: DriveParts, rcc: &mut Rcc) -> (OdriveDrives, ()) {
    let _ = (
        parts.pb8.into_alternate::<9>().internal_pull_up(true),
        parts.pb9.into_alternate::<9>(),
    );
    let controller = match parts.is_emulated {
        true => Controller::absent(parts.can1),
        false => Controller::start(
            parts.can1,
            rcc,
            BitTiming::new(parts.clocks.apb1, BIT_RATE_HZ),
        ),
    };
    let drives = CanDrives::new(Odrive, controller, NODES, SCALES, parts.angles);
    (drives, ())
}
