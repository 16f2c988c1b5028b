//! A board's half of three drives, a bus, and a hand that enables them as a service does.

use std::f64::consts::TAU;
use std::sync::{Arc, Mutex, MutexGuard};
use trirrr_core::tick::Motor;
use trirrr_drives::can::{
    Absolute, Answer, CanDrives, Mit, MitRanges, Moteus, Protocol, Resolution, RotorScale,
    frames_per_tick,
};
use trirrr_plant::bus::{DriveModel, Endpoint, Medium, MitModel, MoteusModel, OdriveModel, Servo};
use trirrr_protocol::message::{DriveFault, DriveReading, DriveState};
use trirrr_service::{Output, Power};

pub(crate) const GEAR: f64 = 8.0;
pub(crate) const START: [f64; 3] = [2.9, -0.4, -3.0];
pub(crate) const TICK_RATE_HZ: f64 = 500.0;
const SAMPLES: u32 = 2;
const BIT_RATE_HZ: u32 = 1_000_000;
/// As the service would have it, and the watchdogs of the drives.
pub(crate) const TIMEOUT_TICKS: u16 = 50;
const WATCHDOG_S: f64 = TIMEOUT_TICKS as f64 / TICK_RATE_HZ;

pub(crate) const ODRIVE_HZ: f64 = 1050.0;

const fn mit(answer: Answer) -> Mit {
    Mit {
        ranges: MitRanges {
            // Wide enough for a rotor that has counted from anywhere.
            position: 200.0,
            velocity: 200.0,
            torque: 10.0,
            kp: 500.0,
            kd: 5.0,
        },
        kp: 4.0,
        kd: 0.03,
        answer,
        host_id: 0,
    }
}

pub(crate) const DAMIAO: Mit = mit(Answer::Damiao);
pub(crate) const T_MOTOR: Mit = mit(Answer::TMotor);
pub(crate) const ROBSTRIDE: Mit = mit(Answer::RobStride);
pub(crate) const MOTEUS: Moteus = Moteus {
    resolution: Resolution::Float,
};

/// Servo of a drive, which has counted from anywhere.
fn servo(leg: usize) -> Servo {
    let mut servo = Servo::new(GEAR, 0.3, [256.0, 2.0]);
    servo.offset = [3.0, -2.0, 4.0][leg];
    servo
}

pub(crate) fn odrive(leg: usize) -> Box<dyn DriveModel<8> + Send> {
    Box::new(OdriveModel::new(
        leg as u8 + 1,
        servo(leg),
        ODRIVE_HZ,
        WATCHDOG_S,
    ))
}

pub(crate) fn moteus(leg: usize) -> Box<dyn DriveModel<64> + Send> {
    Box::new(MoteusModel::new(leg as u8 + 1, servo(leg), WATCHDOG_S))
}

pub(crate) fn actuator(mit: Mit) -> impl Fn(usize) -> Box<dyn DriveModel<8> + Send> {
    move |leg| Box::new(MitModel::new(leg as u8 + 1, servo(leg), mit, WATCHDOG_S))
}

/// Failure that ends a run: of the bus, or of a drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Ended {
    Bus(DriveFault),
    Drive(usize, DriveReading<f64>),
}

pub(crate) struct Bench<P, const LONGEST: usize>
where
    P: Protocol,
{
    board: CanDrives<f64, P, Endpoint<LONGEST>>,
    medium: Arc<Mutex<Medium<LONGEST>>>,
    /// Joints, rad: they stand.
    pub(crate) joints: [f64; 3],
    motors: [Motor<f64>; 3],
    pub(crate) readings: [DriveReading<f64>; 3],
    pub(crate) power: Power,
    pub(crate) ticks: u32,
}

impl<P: Protocol, const LONGEST: usize> Bench<P, LONGEST> {
    pub(crate) fn new(
        protocol: P,
        model: impl Fn(usize) -> Box<dyn DriveModel<LONGEST> + Send>,
    ) -> Self {
        // The job starts a little beside where the joints are.
        Self::near(protocol, model, START, START.map(|angle| angle + 0.1))
    }

    /// Drives of joints at `joints`, of which the board knows that they are within half a turn of the rotor from
    /// `near`.
    pub(crate) fn near(
        protocol: P,
        model: impl Fn(usize) -> Box<dyn DriveModel<LONGEST> + Send>,
        joints: [f64; 3],
        near: [f64; 3],
    ) -> Self {
        let medium = Medium::new(BIT_RATE_HZ, [model(0), model(1), model(2)]);
        let medium = Arc::new(Mutex::new(medium));
        let scale = RotorScale::new(GEAR, false, 0.3, 1.0, 1.0).knows(Absolute::Rotor);
        let board = CanDrives::new(
            protocol,
            Endpoint::new(Arc::clone(&medium)),
            [1, 2, 3],
            [scale; 3],
            near,
            frames_per_tick(BIT_RATE_HZ, TICK_RATE_HZ),
        );
        let motor = |angle| Motor {
            angle,
            rate: 0.0,
            acceleration: 0.0,
            torque: 0.0,
        };
        Self {
            board,
            medium,
            joints,
            motors: near.map(motor),
            readings: near.map(DriveReading::unheard),
            power: Power::Off,
            ticks: 0,
        }
    }

    pub(crate) fn medium(&self) -> MutexGuard<'_, Medium<LONGEST>> {
        self.medium.lock().unwrap()
    }

    /// One tick with the present power.
    pub(crate) fn tick(&mut self) -> Result<(), DriveFault> {
        self.readings = self.board.measure();
        let output = Output {
            motors: self.motors,
            tool: 0.0,
            power: self.power,
            brake_released: false,
        };
        self.tick_by(&output)
    }

    /// Readings up to now: one tick of the drives.
    pub(crate) fn measure(&mut self) -> [DriveReading<f64>; 3] {
        self.board.measure()
    }

    /// One tick with the output of a service, which has heard [`measure`](Self::measure).
    pub(crate) fn tick_by(&mut self, output: &Output<f64>) -> Result<(), DriveFault> {
        let applied = self.board.apply(output).map_err(|failure| failure.what);
        let period_s = 1.0 / (TICK_RATE_HZ * f64::from(SAMPLES));
        for sample in 1..=SAMPLES {
            let t = f64::from(self.ticks * SAMPLES + sample) * period_s;
            let mut medium = self.medium.lock().unwrap();
            medium.advance((t * 1e9).round() as u64);
            for (leg, angle) in self.joints.into_iter().enumerate() {
                medium.drive(leg).sample(angle, period_s);
            }
        }
        self.ticks += 1;
        applied
    }

    /// Takes the measured angles for the commanded ones.
    pub(crate) fn stand(&mut self) {
        for (motor, reading) in self.motors.iter_mut().zip(&self.readings) {
            motor.angle = reading.angle;
        }
    }

    fn all_are(&self, state: DriveState) -> bool {
        self.readings.iter().all(|reading| reading.state == state)
    }

    /// Checks the drives and switches them on, within this number of ticks.
    pub(crate) fn enable(&mut self, ticks: u32) -> Result<(), Ended> {
        self.power = Power::Check;
        for _ in 0..ticks {
            self.tick().map_err(Ended::Bus)?;
            match self.power {
                Power::Check if self.all_are(DriveState::Off) => {
                    self.stand();
                    self.power = Power::On;
                }
                Power::On if self.all_are(DriveState::On) => return Ok(()),
                _ => {}
            }
        }
        let good = match self.power {
            Power::Check => DriveState::Off,
            _ => DriveState::On,
        };
        let bad = self
            .readings
            .iter()
            .position(|reading| reading.state != good);
        let leg = bad.expect("one is not as the others");
        Err(Ended::Drive(leg, self.readings[leg]))
    }

    /// Lets drives that are on go on for this number of ticks, unless one fails.
    pub(crate) fn watch(&mut self, ticks: u32) -> Result<(), Ended> {
        for _ in 0..ticks {
            self.tick().map_err(Ended::Bus)?;
            for (leg, reading) in self.readings.iter().enumerate() {
                if reading.state != DriveState::On
                    || reading.age.max(reading.state_age) > TIMEOUT_TICKS
                {
                    return Err(Ended::Drive(leg, *reading));
                }
            }
        }
        Ok(())
    }

    /// Switches off, and lets everything come to rest.
    pub(crate) fn off(&mut self, ticks: u32) {
        self.power = Power::Off;
        for _ in 0..ticks {
            let _ = self.tick();
        }
    }

    /// Torques of the motors at the joints.
    pub(crate) fn torques(&self) -> [f64; 3] {
        let mut medium = self.medium();
        [0, 1, 2].map(|leg| medium.drive(leg).servo().torque)
    }

    /// Off, errors cleared, and on again.
    pub(crate) fn recover(&mut self) -> Result<(), Ended> {
        self.off(40);
        self.power = Power::Clear;
        let _ = self.tick();
        self.off(40);
        self.enable(200)
    }
}

/// An angle within half a turn of 0.
pub(crate) fn wrapped(angle: f64) -> f64 {
    angle - TAU * (angle / TAU).round()
}
