//! A CAN bus in the time of the board, for any controller that is modelled by its registers: the simulated drives and the wire of
//! `trirrr-plant`, and the machine that these drives move.
//!
//! A controller lets the bus go on by [`CanBus::step`] to the present time, carries out each event, and
//! [offers](CanBus::offer) the frame that is its next. A frame has up to 64 bytes: one of more than 8 is of CAN FD.

use crate::time::{SECOND, Time};
use anyhow::{Context, Result, anyhow};
use embedded_can::Frame;
use trirrr_plant::bus::{BusFrame, ControllerEvent, DriveModel, Medium, WireFaults};
use trirrr_plant::moved::MovedMachine;
use trirrr_plant::{BusModels, bus_models};
use trirrr_scene::Scene;

/// Frame of classic CAN or of CAN FD.
pub(crate) type WireFrame = BusFrame<64>;

/// Event at a controller.
pub(crate) type BusEvent = ControllerEvent<64>;

/// Failure of a drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum DriveFailure {
    /// Its plug is out: no power, no frames.
    Unplugged,
    /// It is too hot, opens its loop and says so.
    Hot,
}

/// Bus as a controller of the chip sees it.
pub(crate) trait CanBus {
    /// Lets the time go on to `until`, or to the next event at the controller, which is at the time that comes with it.
    fn step(&mut self, until: Time) -> Option<(Time, BusEvent)>;

    /// Sets the frame with which the controller takes part in the next arbitration. A frame under way goes on.
    fn offer(&mut self, frame: Option<WireFrame>);

    /// Returns true while a frame of the controller is under way.
    fn is_sending(&self) -> bool;

    /// The controller takes part, or does not: off the bus, in initialisation, with another bit rate.
    fn set_listening(&mut self, listens: bool);

    /// Returns the time until which nothing happens.
    fn next(&self) -> Option<Time>;

    /// Bits per second of the drives.
    fn bit_rate_hz(&self) -> u32;

    /// Faults of the wire, to inject.
    fn faults(&mut self) -> &mut WireFaults;

    /// Lets a drive fail.
    fn fail(&mut self, leg: usize, failure: DriveFailure);

    /// Gives a drive its power back. It counts `turns` of its rotor more than before.
    fn restart(&mut self, leg: usize, turns: f64);

    /// Share of the time since the start in which frames were on the wire.
    fn load(&self) -> f64;

    /// Frames of the controller that a drive has acknowledged, with the times of their ends.
    fn sent(&self) -> &[(Time, WireFrame)];

    /// Joint angles of the machine with everything that they have turned, rad.
    fn angles(&self) -> [f64; 3];

    /// Torques of the motors at their joints, N m.
    fn torques(&mut self) -> [f64; 3];

    /// Reason for which the machine does not move on.
    fn broken(&self) -> Option<&str>;
}

/// Samples of the drives' loops per second.
const SAMPLE_HZ: u64 = 8000;

const SAMPLE_NS: u64 = 1_000_000_000 / SAMPLE_HZ;

/// Bus of a scene's drives, and the machine that they move.
struct DriveBus<const LONGEST: usize> {
    medium: Medium<LONGEST>,
    bit_rate_hz: u32,
    machine: MovedMachine,
    sampled_ns: u64,
    sent: Vec<(Time, WireFrame)>,
    broken: Option<String>,
}

/// Builds the bus of a scene.
pub(crate) fn of_scene(scene: &Scene) -> Result<Box<dyn CanBus>> {
    let models = bus_models(scene).map_err(|refusal| anyhow!("{refusal}"))?;
    let [first, ..] = scene.drives.as_ref().context("the scene has no drives")?;
    let bit_rate_hz = first.can().context("drives on a bus")?.bit_rate_hz;
    let machine = MovedMachine::build(scene).map_err(|refusal| anyhow!("{refusal}"))?;
    Ok(match models.context("drives on a bus")? {
        BusModels::Classic(models) => Box::new(DriveBus::new(bit_rate_hz, models, machine)),
        BusModels::Flexible(models) => Box::new(DriveBus::new(bit_rate_hz, models, machine)),
    })
}

impl<const LONGEST: usize> DriveBus<LONGEST> {
    fn new(
        bit_rate_hz: u32,
        models: [Box<dyn DriveModel<LONGEST> + Send>; 3],
        machine: MovedMachine,
    ) -> Self {
        Self {
            medium: Medium::new(bit_rate_hz, models),
            bit_rate_hz,
            machine,
            sampled_ns: 0,
            sent: Vec::new(),
            broken: None,
        }
    }

    /// Takes a sample of the drives' loops, and moves the machine up to the next.
    fn sample(&mut self) {
        let angles = self.machine.angles();
        let period_s = 1.0 / SAMPLE_HZ as f64;
        let torques = [0, 1, 2].map(|leg| self.medium.drive(leg).sample(angles[leg], period_s));
        if self.broken.is_none()
            && let Err(refusal) = self.machine.advance(torques, period_s)
        {
            self.broken = Some(refusal.to_string());
        }
        self.sampled_ns += SAMPLE_NS;
    }
}

/// Time in whole ns, not later than `time`.
fn ns(time: Time) -> u64 {
    (u128::from(time) * 1_000_000_000 / u128::from(SECOND)) as u64
}

/// Time of `ns`, not earlier.
fn of_ns(ns: u64) -> Time {
    (u128::from(ns) * u128::from(SECOND)).div_ceil(1_000_000_000) as Time
}

/// The same frame of another longest one, if it has room.
fn converted<const FROM: usize, const TO: usize>(frame: &BusFrame<FROM>) -> Option<BusFrame<TO>> {
    match frame.is_remote_frame() {
        true => Frame::new_remote(frame.id(), frame.dlc()),
        false => Frame::new(frame.id(), frame.data()),
    }
}

impl<const LONGEST: usize> CanBus for DriveBus<LONGEST> {
    fn step(&mut self, until: Time) -> Option<(Time, BusEvent)> {
        let until = ns(until);
        loop {
            let due = self.sampled_ns;
            if let Some((at, event)) = self.medium.step(until.min(due)) {
                let time = of_ns(at);
                let event = match event {
                    ControllerEvent::NotAcknowledged => BusEvent::NotAcknowledged,
                    ControllerEvent::BitError => BusEvent::BitError,
                    ControllerEvent::Sent(frame) => {
                        let frame: WireFrame = converted(&frame)?;
                        self.sent.push((time, frame.clone()));
                        BusEvent::Sent(frame)
                    }
                    ControllerEvent::Received(frame) => BusEvent::Received(converted(&frame)?),
                };
                return Some((time, event));
            }
            if due > until {
                return None;
            }
            self.sample();
        }
    }

    fn offer(&mut self, frame: Option<WireFrame>) {
        self.medium.offer(frame.as_ref().and_then(converted));
    }

    fn is_sending(&self) -> bool {
        self.medium.is_sending()
    }

    fn set_listening(&mut self, listens: bool) {
        self.medium.faults.board_is_off = !listens;
    }

    fn next(&self) -> Option<Time> {
        self.medium.next_ns().map(of_ns)
    }

    fn bit_rate_hz(&self) -> u32 {
        self.bit_rate_hz
    }

    fn faults(&mut self) -> &mut WireFaults {
        &mut self.medium.faults
    }

    fn fail(&mut self, leg: usize, failure: DriveFailure) {
        let drive = self.medium.drive(leg);
        match failure {
            DriveFailure::Unplugged => drive.die(),
            DriveFailure::Hot => drive.heat(),
        }
    }

    fn restart(&mut self, leg: usize, turns: f64) {
        self.medium.drive(leg).restart(turns);
    }

    fn load(&self) -> f64 {
        self.medium.load()
    }

    fn sent(&self) -> &[(Time, WireFrame)] {
        &self.sent
    }

    fn angles(&self) -> [f64; 3] {
        self.machine.angles()
    }

    fn torques(&mut self) -> [f64; 3] {
        [0, 1, 2].map(|leg| self.medium.drive(leg).servo().torque)
    }

    fn broken(&self) -> Option<&str> {
        self.broken.as_deref()
    }
}
