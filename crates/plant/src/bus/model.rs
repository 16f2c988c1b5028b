//! Parts that every simulated drive on the bus has.

use super::frame::BusFrame;
use std::collections::VecDeque;
use std::f64::consts::TAU;
use trirrr_drives::joint::{Loop, LoopParameters, Reference};

/// A drive on the bus, as a state machine.
pub trait DriveModel<const LONGEST: usize> {
    /// Takes a frame that ended at `now_ns`.
    fn receive(&mut self, frame: &BusFrame<LONGEST>, now_ns: u64);

    /// Lets the time go on to `now_ns`: cyclic messages are made, watchdogs run out.
    fn at(&mut self, now_ns: u64);

    /// Time of the next cyclic message; none of a drive that only answers.
    fn next_ns(&self) -> Option<u64> {
        None
    }

    /// Closes the loops at a sample: torque at the joint, N m, for a joint at `angle` with everything that it has
    /// turned, rad, `period_s` after the sample before.
    fn sample(&mut self, angle: f64, period_s: f64) -> f64;

    /// Fault to inject: it leaves its loop, without an error.
    fn idle(&mut self);

    /// State after power-up: off, without an error and without a command.
    fn start(&mut self);

    /// Fault to inject: it is too hot, until [`cool`](Self::cool).
    fn heat(&mut self);

    /// The part that all drives have.
    fn common(&self) -> &Common<LONGEST>;

    /// The same, to be changed.
    fn common_mut(&mut self) -> &mut Common<LONGEST>;

    /// The frame that waits for the bus.
    fn waiting(&self) -> Option<&BusFrame<LONGEST>> {
        self.common().outbox.first()
    }

    /// The frame that waited has gone out.
    fn sent(&mut self) {
        self.common_mut().outbox.pop();
    }

    /// The motor's loops and its encoder.
    fn servo(&mut self) -> &mut Servo {
        &mut self.common_mut().servo
    }

    /// Fault to inject: the drive has lost its power.
    fn die(&mut self) {
        let common = self.common_mut();
        common.is_alive = false;
        common.outbox.clear();
    }

    /// Fault to inject: the drive has power again, or had none for a moment. It counts `turns` more than before.
    fn restart(&mut self, turns: f64) {
        let common = self.common_mut();
        common.is_alive = true;
        common.outbox.clear();
        common.servo.offset += turns;
        common.servo.estimate = None;
        self.start();
    }

    /// Returns true while it has power.
    fn is_alive(&self) -> bool {
        self.common().is_alive
    }

    /// It is cool again. The error stays until it is cleared.
    fn cool(&mut self) {
        self.common_mut().is_hot = false;
    }

    /// Fault to inject: it is not calibrated.
    fn lose_calibration(&mut self) {
        self.common_mut().is_calibrated = false;
        self.idle();
    }
}

/// Part that all drives have.
#[derive(Debug)]
pub struct Common<const LONGEST: usize> {
    pub(super) servo: Servo,
    pub(super) is_alive: bool,
    pub(super) is_calibrated: bool,
    pub(super) is_hot: bool,
    pub(super) outbox: Outbox<LONGEST>,
}

impl<const LONGEST: usize> Common<LONGEST> {
    /// Drive that is calibrated, cool and has power.
    pub(super) fn new(servo: Servo) -> Self {
        Self {
            servo,
            is_alive: true,
            is_calibrated: true,
            is_hot: false,
            outbox: Outbox::default(),
        }
    }
}

/// Bandwidth of the observer of the encoder, rad/s: as an ODrive is delivered.
const ENCODER_BANDWIDTH: f64 = 1000.0;

/// A motor's loops and its encoder, behind a gear.
#[derive(Clone, Debug)]
pub struct Servo {
    /// Turns of the rotor per turn of the joint, negative where reversed.
    gear: f64,
    /// Joint angle of the drive's position 0, rad.
    zero: f64,
    /// Turns that the drive has lost or gained: whole ones at power-on, others where the encoder slips.
    pub offset: f64,
    /// Estimates of the encoder: turns and turns per second; none before the first sample.
    estimate: Option<[f64; 2]>,
    /// Gains at the joint.
    gains: [f64; 2],
    /// Torque at the joint, N m.
    pub torque: f64,
}

/// Command of a rotor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct RotorTarget {
    /// Turns.
    pub(super) position: f64,
    /// Turns per second.
    pub(super) velocity: f64,
    /// N m at the rotor.
    pub(super) torque: f64,
}

impl Servo {
    /// Servo of `gear` turns of the rotor per turn of the joint, whose position is 0 at joint angle `zero`, with the
    /// gains `kp` and `kd` at the joint.
    pub fn new(gear: f64, zero: f64, [kp, kd]: [f64; 2]) -> Self {
        Self {
            gear,
            zero,
            offset: 0.0,
            estimate: None,
            gains: [kp, kd],
            torque: 0.0,
        }
    }

    /// Gains at the joint.
    pub(super) fn set_gains(&mut self, gains: [f64; 2]) {
        self.gains = gains;
    }

    pub(super) fn gear(&self) -> f64 {
        self.gear
    }

    /// Position in turns and velocity in turns per second, as the drive sees them; not numbers before the first sample.
    pub(super) fn estimates(&self) -> [f64; 2] {
        self.estimate.unwrap_or([f64::NAN; 2])
    }

    /// Estimates after a sample of the encoder: a loop that follows the counts.
    pub(super) fn sense(&mut self, angle: f64, period_s: f64) {
        let counted = self.gear * (angle - self.zero) / TAU + self.offset;
        let [position, velocity] = self.estimate.unwrap_or([counted, 0.0]);
        let ahead = position + period_s * velocity;
        let error = counted - ahead;
        // Critically damped; a period longer than its time constant takes the count as it is.
        let quick = (2.0 * ENCODER_BANDWIDTH * period_s).min(1.0);
        let slow = 0.25 * quick * quick / period_s;
        self.estimate = Some([ahead + quick * error, velocity + slow * error]);
    }

    /// Closes the loop on `target`.
    pub(super) fn follow(&mut self, target: &RotorTarget) -> f64 {
        let per_turn = TAU / self.gear;
        let [position, velocity] = self.estimates();
        let [kp, kd] = self.gains;
        let reference = Reference {
            // Only the difference counts, which may be more than a turn.
            angle: (target.position - position) * per_turn,
            rate: target.velocity * per_turn,
            acceleration: 0.0,
            torque: target.torque * self.gear,
        };
        let mut inner = Loop::<f64>::build(&LoopParameters {
            kp_nm_rad: kp,
            kd_nm_s_rad: kd,
            ki_nm_rad_s: 0.0,
            feed_forward: true,
            // Its current loop is no part of the model.
            torque_max_nm: f64::MAX,
            period_s: 0.0,
        });
        self.torque = inner.torque(&reference, 0.0, velocity * per_turn).torque;
        self.torque
    }

    /// Lets the motor go.
    pub(super) fn release(&mut self) -> f64 {
        self.torque = 0.0;
        0.0
    }
}

/// Frames that wait for the bus. Of a message that waits already, the newer takes its place.
#[derive(Clone, Debug, Default)]
pub(super) struct Outbox<const LONGEST: usize>(VecDeque<BusFrame<LONGEST>>);

impl<const LONGEST: usize> Outbox<LONGEST> {
    pub(super) fn put(&mut self, id: u32, data: &[u8]) {
        let Some(frame) = BusFrame::from(id, data) else {
            return;
        };
        match self.0.iter_mut().find(|other| other.rank() == frame.rank()) {
            Some(place) => *place = frame,
            None => self.0.push_back(frame),
        }
    }

    /// The next to go out.
    pub(super) fn first(&self) -> Option<&BusFrame<LONGEST>> {
        self.0.front()
    }

    pub(super) fn pop(&mut self) {
        self.0.pop_front();
    }

    pub(super) fn clear(&mut self) {
        self.0.clear();
    }
}
