//! Reports and samples that the tick sends of itself.

use super::super::handoff::{TickReport, count};
use super::{Foreground, ForegroundEnds};
use crate::digital::DigitalPlayer;
use crate::feature::Feature;
use crate::feedback::DriveWatch;
use crate::interlock::ProbeLatch;
use crate::number::ServiceNumber;
use crate::scene::{QuinticsOf, Scene};
use crate::splice::SplicePlayer;
use trirrr_core::setpoint::Setpoint;
use trirrr_protocol::message::Telemetry;

impl<'q, N: ServiceNumber, S: Scene<N = N>> Foreground<'_, S, ForegroundEnds<'q, S>> {
    /// Reports what changed; where there is no room, later.
    #[inline]
    pub(super) fn report(&mut self) {
        if !self.unreported || !self.ends.reports.has_room() {
            return;
        }
        let (features, at) = (&self.features, self.travel.position.tick);
        let report = TickReport {
            orders: self.orders_taken,
            generation: self.job.generation,
            state: self.state,
            acting: self.acting,
            begun: self.job.begun,
            done: self.job.done,
            passed: self.travel.passed.room,
            interrupted: self.job.interrupted,
            pose: self.pose,
            angles: self.output.motors.each_ref().map(|motor| motor.angle),
            splice: QuinticsOf::<S>::map(&features.splices, |all: &SplicePlayer<'_, _, _>| {
                all.report(at)
            }),
            feedback: S::Feedback::map(&features.feedback, |watch: &DriveWatch<'_, N>| {
                watch.report()
            }),
            interlocks: S::Interlocks::of(|| features.input_states()),
            probe: S::Probe::map(&features.probe, |probe: &ProbeLatch<N>| *probe),
            digital: S::Digital::map(&features.digital, |player: &DigitalPlayer<'_>| {
                player.states()
            }),
        };
        self.unreported = !self.ends.reports.send(report);
    }

    /// Every so many ticks a sample; where there is no room, one is lost and counted.
    #[inline]
    pub(super) fn sample(&mut self, setpoint: &Setpoint<N>) {
        if self.sampling.every == 0 {
            return;
        }
        if self.sampling.countdown > 0 {
            self.sampling.countdown -= 1;
            return;
        }
        self.sampling.countdown = self.sampling.every - 1;
        let motors = &self.output.motors;
        let sample = Telemetry {
            tick: self.clock,
            state: self.state,
            acting: self.acting,
            number: self.number_under_way(),
            at: self.travel.position.tick,
            part: self.travel.position.part,
            lost: self
                .ends
                .shared
                .lost
                .load(core::sync::atomic::Ordering::Relaxed),
            fields: self.sampling.fields,
            setpoint: *setpoint,
            angles: motors.each_ref().map(|motor| motor.angle),
            rates: motors.each_ref().map(|motor| motor.rate),
            accelerations: motors.each_ref().map(|motor| motor.acceleration),
            torques: motors.each_ref().map(|motor| motor.torque),
            tool: self.output.tool,
            duration: self.sampling.duration,
        };
        if !self.ends.samples.send(sample) {
            count(&self.ends.shared.lost);
        }
    }
}
