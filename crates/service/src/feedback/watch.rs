//! The tick's part of feedback: what the drives told, and whether it is well.

use super::FeedbackReport;
use super::Readings;
use super::parameters::WatchLimits;
use crate::guard::LimitBreach;
use crate::number::ServiceNumber;
use crate::queue::Sender;
use trirrr_core::number::Number;
use trirrr_core::setpoint::shorter_way;
use trirrr_core::tick::Motor;
use trirrr_protocol::message::{
    DriveFault, DriveReading, DriveSample, DriveState, FaultCode, NotEnabled,
};

/// Ticks for which commanded angles are kept, to compare an older reading with.
const KEPT: usize = 16;

/// DriveWatch over the drives, tick by tick. Without limits the drives tell nothing.
pub(crate) struct DriveWatch<'q, N: ServiceNumber> {
    limits: Option<WatchLimits<N>>,
    readings: Option<Readings<N>>,
    /// Angles commanded in the last ticks, a ring with its newest place.
    commanded: [[N::Angle; 3]; KEPT],
    newest: usize,
    /// Ticks in a row for which each joint was too far from its command.
    beyond: [u16; 3],
    /// Ticks since the machine was asked to be enabled.
    since: u16,
    restarts: [Restart; 3],
    report: FeedbackReport<N>,
    samples: Sender<'q, DriveSample<N>>,
    every: u16,
    countdown: u16,
}

/// Knowledge of a drive's restart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Restart {
    /// There was none, or a host has acknowledged it.
    None,
    /// No host was told yet.
    Untold,
    /// A host was told why the machine was not enabled.
    Told,
}

/// Progress of a machine that is being enabled.
pub(crate) enum EnableProgress<N: Number> {
    /// Not yet.
    Waiting,
    /// All drives are ready, their joints at these angles; or all are on.
    Done([N::Angle; 3]),
    /// It is given up.
    Refused,
}

impl<'q, N: ServiceNumber> DriveWatch<'q, N> {
    pub(super) fn new(limits: Option<WatchLimits<N>>, samples: Sender<'q, DriveSample<N>>) -> Self {
        Self {
            limits,
            readings: None,
            commanded: [[N::angle(N::ZERO); 3]; KEPT],
            newest: 0,
            beyond: [0; 3],
            since: 0,
            restarts: [Restart::None; 3],
            report: FeedbackReport {
                asked: 0,
                refused: None,
            },
            samples,
            every: 0,
            countdown: 0,
        }
    }

    /// Returns true if the drives tell anything.
    pub(crate) fn measures(&self) -> bool {
        self.limits.is_some()
    }

    /// Returns the readings of this tick, or the last ones.
    #[inline(always)]
    pub(crate) fn readings(&self) -> Option<&Readings<N>> {
        self.readings.as_ref()
    }

    pub(crate) fn hear(&mut self, readings: Readings<N>) {
        let before = self.readings.map(|each| each.map(|drive| drive.restarts));
        let pairs = readings.iter().zip(before.unwrap_or([0; 3]));
        for (restart, (reading, before)) in self.restarts.iter_mut().zip(pairs) {
            if reading.restarts != before {
                *restart = Restart::Untold;
            }
        }
        self.readings = Some(readings);
    }

    /// A host acknowledges the restarts that it was told. With `all` those count, too, that no host was told: the joints are going
    /// to be searched.
    pub(crate) fn acknowledge(&mut self, all: bool) {
        for restart in &mut self.restarts {
            if all || *restart == Restart::Told {
                *restart = Restart::None;
            }
        }
    }

    /// Refuses a machine with drives that have restarted. Returns true if there is one.
    fn refuse_restarts(&mut self, readings: &Readings<N>) -> bool {
        if self.restarts == [Restart::None; 3] {
            return false;
        }
        let mut angles = [None; 3];
        for ((restart, angle), reading) in self.restarts.iter_mut().zip(&mut angles).zip(readings) {
            if *restart != Restart::None {
                *restart = Restart::Told;
                *angle = Some(reading.angle);
            }
        }
        self.report.refused = Some(NotEnabled::Restarted { angles });
        true
    }

    pub(crate) fn report(&self) -> FeedbackReport<N> {
        self.report
    }

    /// Begins to enable the machine.
    pub(crate) fn begin(&mut self) {
        self.since = 0;
        self.report.refused = None;
    }

    /// Asks the background for the pose.
    pub(crate) fn ask_for_pose(&mut self) {
        self.report.asked = self.report.asked.wrapping_add(1);
    }

    /// A tick in which every drive has to come to `wanted`, [`DriveState::Off`] or [`DriveState::On`].
    pub(crate) fn wait_for(&mut self, wanted: DriveState) -> EnableProgress<N> {
        let (Some(limits), Some(readings)) = (&self.limits, self.readings) else {
            return EnableProgress::Waiting;
        };
        self.since = self.since.saturating_add(1);
        let is_late = self.since >= limits.enable_ticks;
        let mut waits = false;
        for (motor, reading) in (0..).zip(&readings) {
            let known = limits.knows(reading);
            let is_there = known == wanted && reading.error == 0;
            let fails = matches!(known, DriveState::Fault | DriveState::Uncalibrated);
            if !is_there && (fails || reading.error != 0 || is_late) {
                self.report.refused = Some(NotEnabled::Drive {
                    motor,
                    state: known,
                    error: reading.error,
                });
                return EnableProgress::Refused;
            }
            waits |= !is_there;
        }
        // Drives that are on stop at once; those that come back one by one are named together.
        if (wanted == DriveState::On || !waits) && self.refuse_restarts(&readings) {
            return EnableProgress::Refused;
        }
        match waits {
            true => EnableProgress::Waiting,
            false => EnableProgress::Done(readings.each_ref().map(|reading| reading.angle)),
        }
    }

    /// Checks that the joints still stand where the `motors` are commanded to be: otherwise the machine is not enabled.
    pub(crate) fn stands_at(&mut self, motors: &[Motor<N>; 3]) -> bool {
        let (Some(limits), Some(readings)) = (&self.limits, self.readings) else {
            return false;
        };
        for (index, (reading, motor)) in (0..).zip(readings.iter().zip(motors)) {
            let value = shorter_way::<N>(reading.angle - motor.angle);
            if !(value.abs() <= limits.still) {
                self.report.refused = Some(NotEnabled::Moves {
                    motor: index,
                    value,
                    limit: limits.still,
                });
                return false;
            }
        }
        !self.refuse_restarts(&readings)
    }

    /// Watches drives that are on, before the next command; `motors` were commanded last. With `follows` the joints have to be where
    /// they were commanded.
    #[inline]
    pub(crate) fn check(
        &mut self,
        motors: &[Motor<N>; 3],
        follows: bool,
    ) -> Result<(), LimitBreach<N>> {
        let (Some(limits), Some(readings)) = (&self.limits, &self.readings) else {
            return Ok(());
        };
        self.newest = (self.newest + 1) % KEPT;
        if let Some(newest) = self.commanded.get_mut(self.newest) {
            *newest = motors.each_ref().map(|motor| motor.angle);
        }
        for (index, (reading, motor)) in readings.iter().zip(motors).enumerate() {
            let breach = |code, value, limit| LimitBreach {
                code,
                index: Some(index as u8),
                value,
                limit,
            };
            let fault = match limits.knows(reading) {
                DriveState::Silent => Some((DriveFault::Silent, limits.silence(reading))),
                _ if self.restarts.get(index) != Some(&Restart::None) => {
                    Some((DriveFault::Restarted, N::ZERO))
                }
                _ if reading.error != 0 => Some((DriveFault::Reported, N::ratio(reading.error, 1))),
                DriveState::Fault => Some((DriveFault::Reported, N::ZERO)),
                DriveState::On => None,
                DriveState::Off | DriveState::Preparing | DriveState::Uncalibrated => {
                    Some((DriveFault::NotOn, N::ZERO))
                }
            };
            if let Some((what, value)) = fault {
                return Err(breach(FaultCode::Drive(what), value, N::ONE));
            }
            let Some(beyond) = self.beyond.get_mut(index) else {
                continue;
            };
            let age = usize::from(reading.age);
            if !follows {
                *beyond = 0;
                continue;
            }
            // An older reading says nothing of these commands.
            let Some(place) = (age < KEPT).then(|| (self.newest + KEPT - age) % KEPT) else {
                continue;
            };
            let commanded = self.commanded.get(place).and_then(|each| each.get(index));
            let error = commanded.map_or(N::ZERO, |angle| shorter_way::<N>(reading.angle - *angle));
            let limit = match motor.rate == N::ZERO {
                true => limits.standing,
                false => limits.moving,
            };
            *beyond = match error.abs() <= limit {
                true => 0,
                false => beyond.saturating_add(1),
            };
            if *beyond >= limits.window_ticks {
                return Err(breach(FaultCode::FollowingError, error, limit));
            }
        }
        Ok(())
    }

    /// Forgets what was commanded: the drives hold at `motors` from now on.
    pub(crate) fn forget(&mut self, motors: &[Motor<N>; 3]) {
        let angles = motors.each_ref().map(|motor| motor.angle);
        self.commanded = [angles; KEPT];
        self.beyond = [0; 3];
    }

    /// Sends a sample of the drives every so many ticks from now on.
    pub(crate) fn sample_every(&mut self, every: u16) {
        self.every = every;
        self.countdown = 0;
    }

    /// Sends a sample of the drives if it is time. A sample without room is lost: the next one tells more.
    #[inline]
    pub(crate) fn sample(&mut self, tick: u32) {
        if self.every == 0 {
            return;
        }
        if self.countdown > 0 {
            self.countdown -= 1;
            return;
        }
        self.countdown = self.every - 1;
        if let Some(drives) = self.readings {
            self.samples.send(DriveSample { tick, drives });
        }
    }
}

impl<N: Number> WatchLimits<N> {
    /// State of a drive, silent if it is too long ago that it told its state or its angle.
    fn knows(&self, reading: &DriveReading<N>) -> DriveState {
        match reading.age.max(reading.state_age) > self.timeout_ticks {
            true => DriveState::Silent,
            false => reading.state,
        }
    }

    /// Time for which a drive was silent, over the timeout; at most 2.
    fn silence(&self, reading: &DriveReading<N>) -> N {
        let age = u32::from(reading.age.max(reading.state_age));
        let timeout = u32::from(self.timeout_ticks.max(1));
        N::ratio(age.min(2 * timeout), timeout)
    }
}
