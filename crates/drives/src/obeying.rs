//! Drives without a bus: they do what they are told, at once and exactly. For emulated boards and for hosts.

use trirrr_core::number::Number;
use trirrr_protocol::message::{DriveReading, DriveState};
use trirrr_service::Output;

/// Three drives that obey.
#[derive(Clone, Debug)]
pub struct ObeyingDrives<N: Number> {
    angles: [N::Angle; 3],
    /// Rate and torque of each joint.
    motion: [[N; 2]; 3],
    is_on: bool,
}

impl<N: Number> ObeyingDrives<N> {
    /// Drives that are off, with their joints at `angles`.
    pub fn new(angles: [N::Angle; 3]) -> Self {
        Self {
            angles,
            motion: [[N::ZERO; 2]; 3],
            is_on: false,
        }
    }

    /// Returns what the drives tell.
    pub fn measure(&self) -> [DriveReading<N>; 3] {
        let state = match self.is_on {
            true => DriveState::On,
            false => DriveState::Off,
        };
        let mut readings = self.angles.map(|angle| DriveReading {
            state,
            age: 0,
            state_age: 0,
            ..DriveReading::unheard(angle)
        });
        for (reading, [rate, torque]) in readings.iter_mut().zip(self.motion) {
            reading.rate = rate;
            reading.torque = torque;
        }
        readings
    }

    /// Carries out the output of a tick.
    pub fn apply(&mut self, output: &Output<N>) {
        self.is_on = output.is_on();
        self.motion = [[N::ZERO; 2]; 3];
        if self.is_on {
            let motors = output.motors.each_ref();
            self.angles = motors.map(|motor| motor.angle);
            self.motion = motors.map(|motor| [motor.rate, motor.torque]);
        }
    }

    /// Follows a new zero of the joint angles.
    pub fn shift(&mut self, by: [N::Angle; 3]) {
        for (angle, by) in self.angles.iter_mut().zip(by) {
            *angle = *angle + by;
        }
    }
}
