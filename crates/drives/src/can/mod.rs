//! Drives on the CAN bus: position, velocity and torque to each of them once per tick, and what they say.
//!
//! The frames are those of ODrive ([`Odrive`]), moteus ([`Moteus`]) or the MIT mode of many makers ([`Mit`]). Commands
//! are those of the rotor: the scene has the gear, so set up the drive without one. Positions are unwrapped. Position 0
//! of the drive is a joint angle of the scene, as far as the drive knows it ([`Absolute`]).
//!
//! ```text
//! tick ──> CanDrives::measure <──drains── Bus <──── drives
//!          CanDrives::apply ──one frame for each──> Bus ──>
//! ```
//! No command moves a drive unless the tick says [`Power::On`]. Then the drives prepare for some ticks
//! ([`Protocol::PREPARATION`]) and close their loops at the angles of the tick. No error is cleared but in the tick
//! that says [`Power::Clear`].
//!
//! A drive that restarts while the board stays on may have lost whole turns of its rotor. Where its positions jump by half a turn
//! or more, or were missing for too long ([`RotorScale::positions_within`]), [`DriveReading::restarts`] counts up, and the joint is
//! taken to be at the place nearest to the last one that fits. The service lets no such machine go on before a host knows.

mod classic;
mod fd;
mod heard;
mod listener;
mod load;
mod mit;
mod moteus;
mod odrive;
mod rotor;

pub use classic::{BitTiming, ClassicFrame};
pub use fd::{FdFrame, FdTiming, length_code, length_of};
pub use heard::{Heard, Told};
pub use load::{FRAME_BITS, frames_per_tick};
pub use mit::{Answer, Mit, MitRanges};
pub use moteus::{Moteus, Resolution};
pub use odrive::Odrive;
pub use rotor::{Absolute, RotorCommand, RotorScale, SHORTEST_GAP};

use crate::Failure;
use crate::count::Countable;
use embedded_can::Frame;
use listener::Listener;
use trirrr_protocol::message::{DriveFault, DriveReading};
use trirrr_service::{Output, Power};

/// Controller on the bus, with room for the frames of one tick: one for each drive.
pub trait Bus: embedded_can::nb::Can {
    /// Drops frames that have not gone out, and makes room for others.
    fn abort(&mut self);
}

/// Order to a drive in a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Say {
    /// Switch off.
    Off,
    /// Clear errors; the drive is off.
    Clear,
    /// Tell how it is; the drive is off. The number counts ticks.
    Ask(u8),
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

    /// A command switches a drive on that is off, and each frame is answered. A drive that does not answer gets questions in
    /// place of commands: it may restart, and would go to a place that is whole turns off.
    const COMMAND_SWITCHES_ON: bool = false;

    /// Frame with an order for drive `node`.
    ///
    /// # Errors
    /// [`NoFrame`].
    fn frame<F: Frame>(&self, node: u8, say: &Say) -> Result<F, NoFrame>;

    /// Node that sent `frame`, and the contents; none if it is not for the board.
    fn hear<F: Frame>(&self, frame: &F) -> Option<(u8, Heard)>;
}

/// Three drives on one bus.
#[derive(Debug)]
pub struct CanDrives<N: Countable, P, B> {
    protocol: P,
    bus: B,
    drives: [Listener<N>; 3],
    /// Frames taken from the bus in one tick, at most.
    most_heard: u16,
    /// Ticks since the drives went on, up to the end of the preparation; none while they are off.
    on: Option<u8>,
    /// Ticks that drives were off, modulo 256.
    off_ticks: u8,
}

impl<N: Countable, P: Protocol, B: Bus> CanDrives<N, P, B> {
    /// Drives at `nodes` with joints near `angles`. At most `most_heard` frames are taken from the bus in a tick:
    /// [`frames_per_tick`].
    pub fn new(
        protocol: P,
        bus: B,
        nodes: [u8; 3],
        scales: [RotorScale; 3],
        angles: [N::Angle; 3],
        most_heard: u16,
    ) -> Self {
        let drive = |index: usize| Listener::new(nodes[index], scales[index], angles[index]);
        Self {
            protocol,
            bus,
            drives: [drive(0), drive(1), drive(2)],
            most_heard,
            on: None,
            off_ticks: 0,
        }
    }

    /// Takes what the drives have said since the last tick. Call it once in a tick, before [`apply`](Self::apply).
    #[inline]
    pub fn measure(&mut self) -> [DriveReading<N>; 3] {
        let is_on = self.on == Some(P::PREPARATION);
        for drive in &mut self.drives {
            drive.begin_tick();
        }
        for _ in 0..self.most_heard {
            // A controller off the bus has no frames either; the next command fails.
            let Ok(frame) = self.bus.receive() else {
                break;
            };
            let Some((node, heard)) = self.protocol.hear(&frame) else {
                continue;
            };
            let from = self.drives.iter_mut().find(|drive| drive.node() == node);
            if let Some(drive) = from {
                drive.hear(&heard, is_on);
            }
        }
        self.drives.each_ref().map(Listener::reading)
    }

    /// Carries out the output of the tick: the command of each drive while it is on, and otherwise a question, or the
    /// order to go off. Drives whose position was never heard stay off.
    ///
    /// # Errors
    /// [`DriveFault::BusBusy`]: the frames of the tick before have not all gone out.
    /// [`DriveFault::BusOff`]: the controller is off the bus. [`DriveFault::Range`]: a command does not fit
    /// its frame. [`DriveFault::NotOn`]: a drive is to go on with its joint elsewhere; none does.
    #[inline(always)]
    pub fn apply(&mut self, output: &Output<N>) -> Result<(), Failure<N>> {
        if output.power != Power::On || !self.drives.iter().all(Listener::is_known) {
            self.stay_off(output.power == Power::Clear);
            return Ok(());
        }
        if self.on.is_none() {
            let mut pairs = self.drives.iter().zip(&output.motors);
            if let Some(index) = pairs.position(|(drive, motor)| !drive.stands_at(motor)) {
                return Err(Failure::of(DriveFault::NotOn, Some(index as u8)));
            }
        }
        let since = self.on.unwrap_or(0);
        for (index, (drive, motor)) in self.drives.iter_mut().zip(&output.motors).enumerate() {
            let command = drive.command(motor);
            let say = match since < P::PREPARATION {
                true => Say::Prepare(since, command),
                false if P::COMMAND_SWITCHES_ON && !drive.answers() => Say::Ask(0),
                false => Say::Move(command),
            };
            let sent = send(&self.protocol, &mut self.bus, drive.node(), &say);
            if let Err(what) = sent {
                return Err(Failure::of(what, Some(index as u8)));
            }
        }
        self.on = Some((since + 1).min(P::PREPARATION));
        Ok(())
    }

    /// Switches all drives off and drops commands that have not gone out.
    pub fn off(&mut self) {
        self.stay_off(false);
    }

    /// Tells drives that may be on to go off, again in every tick until they say that they are. Others are asked how
    /// they are. A frame without room may be lost, but for the order to clear errors.
    #[inline(never)]
    fn stay_off(&mut self, clear: bool) {
        if self.on.take().is_some() {
            self.bus.abort();
            for drive in &mut self.drives {
                drive.must_stop();
            }
        }
        self.off_ticks = self.off_ticks.wrapping_add(1);
        for drive in &mut self.drives {
            let say = drive.order_off(clear, self.off_ticks);
            let sent = send(&self.protocol, &mut self.bus, drive.node(), &say);
            if say == Say::Clear && sent.is_ok() {
                drive.cleared();
            }
        }
    }

    /// Follows a new zero of the joint angles: all are greater `by` so much from now on, without a motion. The drives
    /// keep their own zeros.
    pub fn shift(&mut self, by: [N::Angle; 3]) {
        for (drive, by) in self.drives.iter_mut().zip(by) {
            drive.shift(by);
        }
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
