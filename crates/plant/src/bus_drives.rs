//! Drives on a simulated bus, commanded by the code that an image holds.

use crate::bus::{DriveModel, Endpoint, Medium, MitModel, MoteusModel, OdriveModel, Servo};
use crate::bus_settings::{absolute, mit_of, watch};
use crate::control::{Commands, Measured};
use crate::drives::{SimulatedDrives, reference, standing};
use crate::motor::wrapped;
use crate::refusal::Refusal;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use trirrr_core::number::Number;
use trirrr_core::units::Units;
use trirrr_drives::Failure;
use trirrr_drives::can::{
    CanDrives, Moteus, Odrive, Protocol, Resolution, RotorScale, frames_per_tick,
};
use trirrr_drives::count::Countable;
use trirrr_drives::joint::Reference;
use trirrr_protocol::message::{DriveReading, DriveState};
use trirrr_scene::{Can, CanProtocol, Drive, Knows, Scene};
use trirrr_service::{Output, Power};

/// Three drives on a bus, and the board's half of them.
pub(crate) struct SimulatedBus<N: Countable, P: Protocol, const LONGEST: usize> {
    board: CanDrives<N, P, Endpoint<LONGEST>>,
    medium: Arc<Mutex<Medium<LONGEST>>>,
    /// Joints with everything that they have turned, rad.
    angles: [f64; 3],
    /// Longest age of a reading, ticks.
    oldest: u16,
    /// A service watches the drives in this tick.
    is_watched: bool,
    units: Units,
    references: [Reference<f64>; 3],
    /// Time from one sample to the next, s.
    period_s: f64,
    per_tick: u32,
    samples: u64,
}

/// Builds the drives of `scene` with `per_tick` samples in each tick, for ticks in `units`; none if they are not on a
/// bus. The joints stand at `start`, held by their brakes until all drives are on.
///
/// # Errors
/// [`Refusal::Scene`]: no controller. [`Refusal::Drive`]: a drive does not go on.
pub(crate) fn build<'l, N: Countable>(
    scene: &Scene,
    per_tick: u32,
    units: Units,
    start: [f64; 3],
) -> Result<Option<Box<dyn SimulatedDrives<N> + 'l>>, Refusal> {
    let Some(drives) = &scene.drives else {
        return Ok(None);
    };
    let cans = drives.each_ref().map(|drive| drive.can());
    let [Some(first), Some(second), Some(third)] = cans else {
        return Ok(None);
    };
    let cans = [first, second, third];
    let bus = Parts {
        scene,
        cans: &cans,
        per_tick,
        units,
        start,
    };
    let Some(models) = models(scene)? else {
        return Ok(None);
    };
    Ok(Some(match (first.protocol, models) {
        (CanProtocol::Mit(mit), BusModels::Classic(models)) => bus.join(mit_of(&mit), models)?,
        (_, BusModels::Classic(models)) => bus.join(Odrive, models)?,
        (_, BusModels::Flexible(models)) => {
            let moteus = Moteus {
                resolution: Resolution::Float,
            };
            bus.join(moteus, models)?
        }
    }))
}

/// Drives of a bus as state machines, by the frames of their protocol.
pub enum BusModels {
    /// Classic CAN.
    Classic([Box<dyn DriveModel<8> + Send>; 3]),
    /// CAN FD.
    Flexible([Box<dyn DriveModel<64> + Send>; 3]),
}

/// Builds the models of the drives of `scene`; none if they are not on a bus.
///
/// # Errors
/// [`Refusal::Scene`]: no controller.
pub fn models(scene: &Scene) -> Result<Option<BusModels>, Refusal> {
    let Some(drives) = &scene.drives else {
        return Ok(None);
    };
    let cans = drives.each_ref().map(|drive| drive.can());
    let [Some(first), Some(second), Some(third)] = cans else {
        return Ok(None);
    };
    let cans = [first, second, third];
    let controller = scene.controller.ok_or_else(|| Refusal::Scene {
        key: "controller".into(),
        reason: "missing: drives on a bus close their loops with its gains".into(),
    })?;
    let servo = |leg: usize| {
        let Drive {
            gear_ratio,
            reversed,
            ..
        } = drives[leg];
        let gear = if reversed { -gear_ratio } else { gear_ratio };
        let gains = [controller.kp_nm_rad[leg], controller.kd_nm_s_rad[leg]];
        let mut servo = Servo::new(gear, cans[leg].zero_rad, gains);
        // What a drive does not know is anywhere.
        servo.offset = match cans[leg].knows {
            Knows::Joint => 0.0,
            Knows::Rotor => [3.0, -2.0, 7.0][leg],
            Knows::Nothing => [3.25, -2.5, 7.125][leg],
        };
        servo
    };
    let node = |leg: usize| cans[leg].node_id as u8;
    let watchdog_s = watch(scene).timeout_s;
    Ok(Some(match first.protocol {
        CanProtocol::Odrive => BusModels::Classic([0, 1, 2].map(|leg| {
            let rate = cans[leg].messages_hz;
            let model = OdriveModel::new(node(leg), servo(leg), rate, watchdog_s);
            Box::new(model) as Box<dyn DriveModel<8> + Send>
        })),
        CanProtocol::Mit(mit) => BusModels::Classic([0, 1, 2].map(|leg| {
            let model = MitModel::new(node(leg), servo(leg), mit_of(&mit), watchdog_s);
            Box::new(model) as Box<dyn DriveModel<8> + Send>
        })),
        CanProtocol::Moteus => BusModels::Flexible([0, 1, 2].map(|leg| {
            let model = MoteusModel::new(node(leg), servo(leg), watchdog_s);
            Box::new(model) as Box<dyn DriveModel<64> + Send>
        })),
    }))
}

/// Parts from which a bus of any protocol is built.
struct Parts<'a> {
    scene: &'a Scene,
    cans: &'a [Can; 3],
    per_tick: u32,
    units: Units,
    start: [f64; 3],
}

impl Parts<'_> {
    /// Joins the drives of `models` with a board that talks `protocol`, and switches them on.
    fn join<'l, N: Countable, P: Protocol + Send + 'l, const LONGEST: usize>(
        &self,
        protocol: P,
        models: [Box<dyn DriveModel<LONGEST> + Send>; 3],
    ) -> Result<Box<dyn SimulatedDrives<N> + 'l>, Refusal> {
        let Self {
            scene,
            cans,
            per_tick,
            units,
            start,
        } = *self;
        let [first, ..] = cans;
        let rate_hz = scene.tick_rate_hz;
        let medium = Medium::new(first.bit_rate_hz, models);
        let medium = Arc::new(Mutex::new(medium));
        let scale = |leg: usize| {
            let drive = scene.drives.as_ref().map(|drives| drives[leg]);
            let (gear, reversed) =
                drive.map_or((1.0, false), |drive| (drive.gear_ratio, drive.reversed));
            RotorScale::new(
                gear,
                reversed,
                cans[leg].zero_rad,
                units.rate_rad_s(),
                units.torque_nm(),
            )
            .knows(absolute(cans[leg].knows))
            .positions_within(cans[leg].positions_within_ticks(rate_hz))
        };
        let board = CanDrives::<N, P, _>::new(
            protocol,
            Endpoint::new(Arc::clone(&medium)),
            cans.map(|can| can.node_id as u8),
            [scale(0), scale(1), scale(2)],
            start.map(N::angle_from_f64),
            frames_per_tick(first.bit_rate_hz, rate_hz),
        );
        let mut drives = SimulatedBus {
            board,
            medium,
            angles: start,
            is_watched: false,
            oldest: (watch(scene).timeout_s * rate_hz).ceil() as u16,
            units,
            references: start.map(Reference::standing),
            period_s: scene.period_s() / f64::from(per_tick),
            per_tick,
            samples: 0,
        };
        drives.enable((watch(scene).enable_time_max_s * rate_hz) as u32)?;
        Ok(Box::new(drives))
    }
}

impl<N: Countable, P: Protocol, const LONGEST: usize> SimulatedBus<N, P, LONGEST> {
    fn medium(&self) -> MutexGuard<'_, Medium<LONGEST>> {
        self.medium.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Lets the bus and the drives go on to the next sample, and takes it. Returns the torques.
    fn step(&mut self, measured: &[f64; 3]) -> [f64; 3] {
        let now_ns = (self.samples as f64 * self.period_s * 1e9).round() as u64;
        self.samples += 1;
        for (angle, now) in self.angles.iter_mut().zip(measured) {
            *angle += wrapped(now - *angle);
        }
        let (angles, period_s) = (self.angles, self.period_s);
        let mut medium = self.medium();
        medium.advance(now_ns);
        [0, 1, 2].map(|leg| medium.drive(leg).sample(angles[leg], period_s))
    }

    /// Checks the drives and switches them on as a service does, while brakes hold the machine.
    fn enable(&mut self, ticks: u32) -> Result<(), Refusal> {
        let start = self.angles;
        let mut power = Power::Check;
        let mut motors = start.map(|angle| standing::<N>(N::angle_from_f64(angle)));
        let mut readings = self.board.measure();
        for _ in 0..ticks {
            let output = Output {
                motors,
                tool: N::ZERO,
                power,
                brake_released: false,
            };
            self.board
                .apply(&output)
                .map_err(|failure| refused(&failure))?;
            for _ in 0..self.per_tick {
                self.step(&start);
            }
            readings = self.board.measure();
            let all = |state| readings.iter().all(|reading| reading.state == state);
            if power == Power::Check && all(DriveState::Off) {
                power = Power::On;
                motors = readings.map(|reading| standing(reading.angle));
            }
            if power == Power::On && all(DriveState::On) {
                return Ok(());
            }
        }
        self.judge(&readings)
    }

    /// Refuses drives that are not on, or have said nothing for too long.
    fn judge(&self, readings: &[DriveReading<N>; 3]) -> Result<(), Refusal> {
        for (motor, reading) in readings.iter().enumerate() {
            let DriveReading { state, error, .. } = *reading;
            let age = reading.age.max(reading.state_age);
            let reason = match state {
                DriveState::On if age <= self.oldest => continue,
                DriveState::On => format!("its drive has said nothing for {age} ticks"),
                _ => format!("its drive is not on: {state:?}, error 0x{error:x}"),
            };
            return Err(Refusal::Drive { motor, reason });
        }
        Ok(())
    }
}

fn refused<N: Number>(failure: &Failure<N>) -> Refusal {
    Refusal::Drive {
        motor: failure.drive.unwrap_or(0).into(),
        reason: format!("the bus fails: {:?}", failure.what),
    }
}

impl<N: Countable, P: Protocol + Send, const LONGEST: usize> SimulatedDrives<N>
    for SimulatedBus<N, P, LONGEST>
{
    fn measure(&mut self) -> Option<[DriveReading<N>; 3]> {
        self.is_watched = true;
        Some(self.board.measure())
    }

    fn tick(&mut self, output: &Output<N>) -> Result<(), Refusal> {
        if !std::mem::take(&mut self.is_watched) {
            let readings = self.board.measure();
            self.judge(&readings)?;
        }
        self.references = output
            .motors
            .each_ref()
            .map(|motor| reference(motor, &self.units));
        self.board
            .apply(output)
            .map_err(|failure| refused(&failure))
    }

    fn sample(&mut self, slot: u32, measured: &[Measured; 3]) -> Commands {
        let elapsed = f64::from(slot) * self.period_s;
        let held = self.step(&measured.map(|measured| measured.angle));
        Commands {
            held,
            angle: self
                .references
                .map(|reference| reference.after(elapsed).angle),
            limited: [None; 3],
        }
    }
}
