//! Reports and samples that the tick sends of itself.

use super::super::digital::DigitalKind;
use super::super::feedback::Feedback;
use super::super::handoff::{TickReport, count};
use super::super::interlock::InterlockKind;
use super::super::scene::Scene;
use super::super::splice::{SpliceChannels, SplicesOf};
use super::Foreground;
use crate::number::ServiceNumber;
use trirrr_core::setpoint::Setpoint;
use trirrr_protocol::message::Telemetry;

impl<N: ServiceNumber, S: Scene<N = N>> Foreground<'_, S> {
    /// Reports what changed; where there is no room, later.
    #[inline]
    pub(super) fn report(&mut self) {
        if !self.unreported || !self.reports.has_room() {
            return;
        }
        let report = TickReport {
            orders: self.orders_taken,
            generation: self.generation,
            state: self.state,
            acting: self.acting,
            begun: self.begun,
            done: self.done,
            passed: self.passed.room,
            interrupted: self.interrupted,
            pose: self.pose,
            angles: self.output.motors.each_ref().map(|motor| motor.angle),
            splice: <SplicesOf<S>>::report(&self.splices, self.position.tick),
            feedback: <S::Feedback as Feedback<N>>::report(&self.feedback),
            interlocks: self.interlocks.report(),
            digital: <S::Digital as DigitalKind>::report(&self.digital),
        };
        self.unreported = !self.reports.send(report);
    }

    /// Every so many ticks a sample; where there is no room, one is lost and counted.
    #[inline]
    pub(super) fn sample(&mut self, setpoint: &Setpoint<N>) {
        if self.every == 0 {
            return;
        }
        if self.countdown > 0 {
            self.countdown -= 1;
            return;
        }
        self.countdown = self.every - 1;
        let motors = &self.output.motors;
        let sample = Telemetry {
            tick: self.clock,
            state: self.state,
            acting: self.acting,
            number: self.number_under_way(),
            at: self.position.tick,
            part: self.position.part,
            lost: self.shared.lost.load(core::sync::atomic::Ordering::Relaxed),
            fields: self.fields,
            setpoint: *setpoint,
            angles: motors.each_ref().map(|motor| motor.angle),
            rates: motors.each_ref().map(|motor| motor.rate),
            accelerations: motors.each_ref().map(|motor| motor.acceleration),
            torques: motors.each_ref().map(|motor| motor.torque),
            tool: self.output.tool,
            duration: self.duration,
        };
        if !self.samples.send(sample) {
            count(&self.shared.lost);
        }
    }
}
