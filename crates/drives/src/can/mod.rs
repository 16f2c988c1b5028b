//! Drives on the CAN bus: position, velocity and torque, once per tick.
//!
//! The frames are those of ODrive ([`Odrive`]) or moteus ([`Moteus`]). Commands are those of the rotor: the scene
//! has the gear, so set up the drive without one. Positions are absolute and unwrapped. Position 0 of the drive
//! is a joint angle of the scene, and at the start the joint is within half a turn of that angle.
//!
//! A protocol may need some ticks to prepare before the first command ([`Protocol::PREPARATION`]). While drives
//! are off, every tick repeats the frame that switches them off.

mod classic;
mod moteus;
mod odrive;
mod rotor;

pub use classic::{BitTiming, ClassicFrame};
pub use moteus::{Moteus, Resolution};
pub use odrive::Odrive;
pub use rotor::{RotorCommand, RotorScale};

use crate::Failure;
use crate::count::Countable;
use embedded_can::Frame;
use rotor::Rotor;
use trirrr_protocol::message::DriveFault;
use trirrr_service::Output;

/// Controller on the bus, with room for the frames of one tick: one for each drive.
pub trait Bus: embedded_can::nb::Can {
    /// Drops frames that have not gone out.
    fn abort(&mut self);
}

/// Order to a drive in a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Say {
    /// Switch off.
    Off,
    /// Prepare: a step of [`Protocol::PREPARATION`], counted from 0.
    Prepare(u8, RotorCommand),
    /// Follow this command.
    Move(RotorCommand),
}

/// Refusal to make a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoFrame {
    /// Frames of this bus are too short: moteus needs CAN FD.
    TooLong,
    /// A value does not fit its field.
    Range,
}

/// Protocol of a kind of drive.
pub trait Protocol {
    /// Ticks from switching on to the first command.
    const PREPARATION: u8;

    /// Frame with an order for drive `node`.
    ///
    /// # Errors
    /// [`NoFrame`].
    fn frame<F: Frame>(&self, node: u8, say: &Say) -> Result<F, NoFrame>;

    /// Node and error code, never 0, if `frame` reports an error.
    fn error<F: Frame>(&self, frame: &F) -> Option<(u8, u32)>;
}

/// Three drives on one bus.
#[derive(Debug)]
pub struct CanDrives<N: Countable, P, B> {
    protocol: P,
    bus: B,
    nodes: [u8; 3],
    rotors: [Rotor<N>; 3],
    /// Ticks since the drives went on, up to the end of the preparation; none while they are off.
    on: Option<u8>,
}

/// Frames taken from the bus in one tick, at most.
const HEARD: usize = 3;

impl<N: Countable, P: Protocol, B: Bus> CanDrives<N, P, B> {
    /// Drives at `nodes` with joints at `angles`.
    pub fn new(
        protocol: P,
        bus: B,
        nodes: [u8; 3],
        scales: [RotorScale; 3],
        angles: [N::Angle; 3],
    ) -> Self {
        let rotor = |index: usize| Rotor::new(scales[index], angles[index]);
        Self {
            protocol,
            bus,
            nodes,
            rotors: [rotor(0), rotor(1), rotor(2)],
            on: None,
        }
    }

    /// Sends the command of the tick to each drive. Switches the drives off unless the output is enabled.
    ///
    /// # Errors
    /// [`DriveFault::BusBusy`]: the frames of the tick before have not all gone out.
    /// [`DriveFault::BusOff`]: the controller is off the bus. [`DriveFault::Range`]: a command does not fit
    /// its frame. [`DriveFault::Reported`]: a drive reports an error.
    #[inline(always)]
    pub fn apply(&mut self, output: &Output<N>) -> Result<(), Failure<N>> {
        if !output.enabled {
            self.off();
            return Ok(());
        }
        let since = self.on.unwrap_or(0);
        for (index, (rotor, motor)) in self.rotors.iter_mut().zip(&output.motors).enumerate() {
            let command = rotor.command(motor);
            let say = match since < P::PREPARATION {
                true => Say::Prepare(since, command),
                false => Say::Move(command),
            };
            let node = self.nodes.get(index).copied().unwrap_or(0);
            let sent = send(&self.protocol, &mut self.bus, node, &say);
            if let Err(what) = sent {
                return Err(Failure::of(what, Some(index as u8)));
            }
        }
        self.on = Some((since + 1).min(P::PREPARATION));
        self.listen()
    }

    /// Switches all drives off and drops commands that have not gone out. Every tick repeats this, so a frame
    /// without room may be lost.
    #[inline(never)]
    pub fn off(&mut self) {
        if self.on.take().is_some() {
            self.bus.abort();
        }
        for node in self.nodes {
            let _ = send(&self.protocol, &mut self.bus, node, &Say::Off);
        }
        // Reports of drives that are off do not matter.
        for _ in 0..HEARD {
            let _ = self.bus.receive();
        }
    }

    #[inline(always)]
    fn listen(&mut self) -> Result<(), Failure<N>> {
        for _ in 0..HEARD {
            let frame = match self.bus.receive() {
                Ok(frame) => frame,
                Err(nb::Error::WouldBlock) => break,
                Err(nb::Error::Other(_)) => return Err(Failure::of(DriveFault::BusOff, None)),
            };
            // During the preparation an error may be the old one, which is being cleared.
            if self.on < Some(P::PREPARATION) {
                continue;
            }
            if let Some((node, code)) = self.protocol.error(&frame)
                && let Some(index) = self.nodes.iter().position(|other| *other == node)
            {
                return Err(Failure {
                    value: N::ratio(code, 1),
                    ..Failure::of(DriveFault::Reported, Some(index as u8))
                });
            }
        }
        Ok(())
    }
}

/// Sends one frame.
#[inline(always)]
fn send<P: Protocol, B: Bus>(
    protocol: &P,
    bus: &mut B,
    node: u8,
    say: &Say,
) -> Result<(), DriveFault> {
    let frame = match protocol.frame(node, say) {
        Ok(frame) => frame,
        Err(NoFrame::Range | NoFrame::TooLong) => return Err(DriveFault::Range),
    };
    match bus.transmit(&frame) {
        Ok(None) => Ok(()),
        // The controller has dropped an older frame for this one: a drive has missed its command.
        Ok(Some(_)) | Err(nb::Error::WouldBlock) => Err(DriveFault::BusBusy),
        Err(nb::Error::Other(_)) => Err(DriveFault::BusOff),
    }
}
