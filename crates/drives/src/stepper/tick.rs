//! The half in the tick: from angles to positions.

use super::line::Line;
use crate::Failure;
use crate::command::count::Countable;
use crate::command::stepper::{StepMotor, StepsPerTurn, TooManySteps};
use trirrr_protocol::message::DriveFault;
use trirrr_service::Output;

/// Three steppers, as the tick sees them.
#[derive(Debug)]
pub struct Steppers<'l, N: Countable> {
    motors: [StepMotor<N>; 3],
    line: &'l Line,
}

impl<'l, N: Countable> Steppers<'l, N> {
    /// Motors that stand at the joint angles `angles` and take up to `most` microsteps in a tick.
    pub fn new(
        per_turn: [StepsPerTurn; 3],
        most: [u32; 3],
        angles: [N::Angle; 3],
        line: &'l Line,
    ) -> Self {
        let motor = |index: usize| StepMotor::new(per_turn[index], most[index], angles[index]);
        Self {
            motors: [motor(0), motor(1), motor(2)],
            line,
        }
    }

    /// Has the motors where this tick wants them by the next. Off where the output is.
    ///
    /// # Errors
    /// [`DriveFault::StepRate`]: a motor would have to step faster than its driver can. None of the
    /// three moves.
    #[inline(always)]
    pub fn apply(&mut self, output: &Output<N>) -> Result<(), Failure<N>> {
        if !output.enabled {
            self.line.off();
            return Ok(());
        }
        let before = self.angles();
        for (index, (motor, to)) in self.motors.iter_mut().zip(&output.motors).enumerate() {
            if let Err(refused) = motor.move_to(to.angle) {
                return Err(self.take_back(before, index as u8, refused));
            }
        }
        self.line
            .give(self.motors.each_ref().map(|motor| motor.position()));
        Ok(())
    }

    /// None of the motors has moved.
    #[cold]
    fn take_back(&mut self, before: [N::Angle; 3], drive: u8, refused: TooManySteps) -> Failure<N> {
        for (motor, angle) in self.motors.iter_mut().zip(before) {
            // As many steps as there, or none.
            let _ = motor.move_to(angle);
        }
        Failure {
            value: N::ratio(refused.steps.unsigned_abs(), refused.most.max(1)),
            limit: N::ONE,
            ..Failure::of(DriveFault::StepRate, Some(drive))
        }
    }

    /// Drives off.
    pub fn off(&mut self) {
        self.line.off();
    }

    /// The joint angles that the motors were last moved to. After a failure the motors are here, and
    /// not where the tick wanted them.
    pub fn angles(&self) -> [N::Angle; 3] {
        self.motors.each_ref().map(|motor| motor.angle())
    }

    /// The motors stand where they are, and their joint angles turn out to be by so much more than they
    /// were thought to be: no step is taken for it.
    pub fn shift(&mut self, by: [N::Angle; 3]) {
        for (motor, by) in self.motors.iter_mut().zip(by) {
            motor.stands_at(motor.angle() + by);
        }
    }
}
