//! Half in the tick: from angles to positions.

use super::line::Line;
use super::motor::{MotorPlace, StepMotor, StepsPerTurn, TooManySteps};
use crate::Failure;
use crate::count::Countable;
use trirrr_protocol::message::DriveFault;
use trirrr_service::Output;

/// Three steppers, as the tick sees them.
#[derive(Debug)]
pub struct Steppers<'l, N: Countable> {
    motors: [StepMotor<N>; 3],
    line: &'l Line,
}

impl<'l, N: Countable> Steppers<'l, N> {
    /// Motors at the joint angles `angles` that take up to `most` microsteps in a tick.
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

    /// Sends the motors to the angles of this tick, to arrive by the next. Switches the drives off unless the
    /// output is enabled.
    ///
    /// # Errors
    /// [`DriveFault::StepRate`]: a motor would have to step faster than its driver can. None of the
    /// three moves.
    #[inline(always)]
    pub fn apply(&mut self, output: &Output<N>) -> Result<(), Failure<N>> {
        if !output.is_on() {
            self.line.off();
            return Ok(());
        }
        let before = self.motors.each_ref().map(|motor| motor.stands());
        for (index, (motor, to)) in self.motors.iter_mut().zip(&output.motors).enumerate() {
            if let Err(refused) = motor.move_to(to.angle) {
                return Err(self.take_back(before, index as u8, refused));
            }
        }
        self.line
            .give(self.motors.each_ref().map(|motor| motor.place()));
        Ok(())
    }

    /// Returns all motors to where they stood before.
    #[cold]
    fn take_back(
        &mut self,
        before: [MotorPlace<N>; 3],
        drive: u8,
        refused: TooManySteps,
    ) -> Failure<N> {
        for (motor, stood) in self.motors.iter_mut().zip(before) {
            motor.return_to(stood);
        }
        Failure {
            value: N::ratio(refused.steps.unsigned_abs(), refused.most.max(1)),
            limit: N::ONE,
            ..Failure::of(DriveFault::StepRate, Some(drive))
        }
    }

    /// Switches the drives off.
    pub fn off(&mut self) {
        self.line.off();
    }

    /// Joint angles that the motors were last moved to. After a failure the motors stand here, not at the
    /// angles of the tick.
    pub fn angles(&self) -> [N::Angle; 3] {
        self.motors.each_ref().map(|motor| motor.angle())
    }

    /// Follows a new zero of the joint angles: all are greater `by` so much. No step is taken.
    pub fn shift(&mut self, by: [N::Angle; 3]) {
        for (motor, by) in self.motors.iter_mut().zip(by) {
            motor.set_angle(motor.angle() + by);
        }
    }
}
