//! Drives between the service and the plant: outputs of ticks in, commands of motors out.

use crate::control::{Commands, Measured};
use crate::refusal::Refusal;
use trirrr_core::number::Number;
use trirrr_core::tick::Motor;
use trirrr_core::units::Units;
use trirrr_drives::joint::Reference;
use trirrr_protocol::message::DriveReading;
use trirrr_service::Output;

/// The three drives of a machine whose ticks are in the number type `N`.
pub(crate) trait SimulatedDrives<N: Number>: Send {
    /// Returns what the drives tell at the begin of a tick, for a service that watches them; none of drives that tell
    /// nothing. Drives that nobody watches are judged here, in the [tick](Self::tick).
    fn measure(&mut self) -> Option<[DriveReading<N>; 3]> {
        None
    }

    /// Takes the output of a tick.
    ///
    /// # Errors
    /// [`Refusal::Drive`]: a drive cannot do what the tick commands.
    fn tick(&mut self, output: &Output<N>) -> Result<(), Refusal>;

    /// Takes sample `slot` of the tick, counted from 0, and returns what the motors are told until
    /// the next sample.
    fn sample(&mut self, slot: u32, measured: &[Measured; 3]) -> Commands;
}

/// Reference of one motor in SI units and the number type `D` of a drive, from a tick in `units`.
pub(crate) fn reference<N: Number, D: Number>(motor: &Motor<N>, units: &Units) -> Reference<D> {
    Reference {
        angle: D::angle_from_f64(N::angle_to_f64(motor.angle)),
        rate: D::from_f64(motor.rate.to_f64() * units.rate_rad_s()),
        acceleration: D::from_f64(motor.acceleration.to_f64() * units.acceleration_rad_s2()),
        torque: D::from_f64(motor.torque.to_f64() * units.torque_nm()),
    }
}

/// Motor that stands at `angle`.
pub(crate) fn standing<N: Number>(angle: N::Angle) -> Motor<N> {
    Motor {
        angle,
        rate: N::ZERO,
        acceleration: N::ZERO,
        torque: N::ZERO,
    }
}
