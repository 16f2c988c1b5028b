//! A bus that is there: drives on it as state machines, and a wire on which frames take the time of their bits.
//!
//! | | by the documents of |
//! |---|---|
//! | [`OdriveModel`] | ODrive, CANSimple of firmware 0.6 |
//! | [`MoteusModel`] | moteus, registers in CAN FD frames |
//! | [`MitModel`] | makers of actuators with the MIT mode |
//!
//! The board's side is [`Endpoint`], the bus of `trirrr_drives::can::CanDrives`: the code of an image talks to these
//! drives. A controller that is modelled by its registers [steps](Medium::step) the bus instead. A model measures its rotor through an encoder and an observer, and computes torque by position, velocity and
//! the torque that it was told. Faults are injected by methods of [`DriveModel`], and on the wire by [`WireFaults`].

mod frame;
mod medium;
mod mit;
mod model;
mod moteus;
mod odrive;

pub use frame::BusFrame;
pub use medium::{ControllerEvent, Endpoint, Medium, OffBus, WireFaults};
pub use mit::MitModel;
pub use model::{DriveModel, Servo};
pub use moteus::MoteusModel;
pub use odrive::OdriveModel;
