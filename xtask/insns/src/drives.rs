//! The drives of the scene on pins, PWM outputs and a bus that are words in memory: what a tick does
//! about them, without a board.

use crate::scene::Scalar;
use core::convert::Infallible;
use core::sync::atomic::{AtomicU32, Ordering};
use embedded_hal::digital::OutputPin;
use trirrr_core::number::Arithmetic;
#[cfg(any(drive = "none", drive = "moteus"))]
use {trirrr_drives::Failure, trirrr_service::Output};

type Angle = <Scalar as Arithmetic>::Angle;

/// Stand-in for a register. The compiler keeps the writes to it although nobody reads it.
#[used]
static REGISTER: AtomicU32 = AtomicU32::new(0);

/// An output pin.
#[derive(Debug)]
pub struct Pin;

impl embedded_hal::digital::ErrorType for Pin {
    type Error = Infallible;
}

impl OutputPin for Pin {
    #[inline(always)]
    fn set_low(&mut self) -> Result<(), Infallible> {
        REGISTER.store(1 << 16, Ordering::Relaxed);
        Ok(())
    }

    #[inline(always)]
    fn set_high(&mut self) -> Result<(), Infallible> {
        REGISTER.store(1, Ordering::Relaxed);
        Ok(())
    }
}

#[cfg(any(drive = "none", drive = "moteus"))]
mod none {
    use super::{Angle, Failure, Output, Scalar};

    /// No drives.
    pub struct NoDrives;

    /// None.
    pub fn build(_: [Angle; 3]) -> NoDrives {
        NoDrives
    }

    impl NoDrives {
        /// Nothing.
        #[inline(always)]
        pub fn apply(&mut self, _: &Output<Scalar>) -> Result<(), Failure<Scalar>> {
            Ok(())
        }

        /// Nothing either.
        #[cfg(homing)]
        #[inline(always)]
        pub fn shift(&mut self, _: [Angle; 3]) {}
    }
}

#[cfg(drive = "stepper")]
mod stepper {
    use super::{Angle, Pin, Scalar};
    use crate::scene::drive::{MOST_PER_TICK, PER_TURN};
    use trirrr_drives::stepper::{Line, Slots, Steppers};

    #[used]
    static LINE: Line = Line::new();

    /// Steppers.
    pub type StepperDrives = Steppers<'static, Scalar>;

    /// Slots that are called between ticks.
    pub type SceneSlots = Slots<'static, Pin, Pin, Pin>;

    /// Motors that stand at `angles`.
    pub fn build(angles: [Angle; 3]) -> StepperDrives {
        Steppers::new(PER_TURN, MOST_PER_TICK, angles, &LINE)
    }

    /// One slot.
    #[inline(never)]
    pub fn slot(slots: &mut SceneSlots) {
        let Ok(()) = slots.slot();
    }
}

#[cfg(drive = "bldc")]
mod bldc {
    use super::{Angle, Infallible, Ordering, Pin, REGISTER, Scalar};
    use crate::scene::drive::{MOTORS, REVERSED};
    use embedded_hal::pwm::{ErrorType, SetDutyCycle};
    use trirrr_drives::bldc::{Bldc, BldcMotor, Bldcs};
    use trirrr_drives::{Active, Enable};

    /// A PWM output of 4,200 counts.
    pub struct Pwm;

    impl ErrorType for Pwm {
        type Error = Infallible;
    }

    impl SetDutyCycle for Pwm {
        fn max_duty_cycle(&self) -> u16 {
            4200
        }

        #[inline(always)]
        fn set_duty_cycle(&mut self, duty: u16) -> Result<(), Infallible> {
            REGISTER.store(duty.into(), Ordering::Relaxed);
            Ok(())
        }
    }

    /// Brushless motors.
    pub type BldcDrives = Bldcs<BldcMotor<Scalar, Pwm, Pin>, Pin>;

    /// Motors that are off.
    pub fn build(_: [Angle; 3]) -> BldcDrives {
        let [a, b, c] = const { MOTORS }.each_ref().map(Bldc::<Scalar>::build);
        let [r1, r2, r3] = REVERSED;
        let motors = [
            BldcMotor::new(a, Pwm, Pin, r1),
            BldcMotor::new(b, Pwm, Pin, r2),
            BldcMotor::new(c, Pwm, Pin, r3),
        ];
        let Ok(enable) = Enable::new(Pin, Active::High);
        Bldcs::new(motors, enable)
    }
}

#[cfg(drive = "odrive")]
mod odrive {
    use super::{Angle, Infallible, Ordering, REGISTER, Scalar};
    use crate::scene::drive::{NODES, RATE_RAD_S, ROTORS, TORQUE_NM};
    use embedded_can::nb::Can;
    use embedded_can::{Frame, Id};
    use trirrr_drives::can::{Bus, CanDrives, ClassicFrame, Odrive, RotorScale};

    /// A controller whose mailboxes are always empty, with nothing received.
    pub struct Mailboxes;

    impl Can for Mailboxes {
        type Frame = ClassicFrame;
        type Error = Infallible;

        #[inline(always)]
        fn transmit(
            &mut self,
            frame: &ClassicFrame,
        ) -> nb::Result<Option<ClassicFrame>, Infallible> {
            let id = match frame.id() {
                Id::Standard(id) => id.as_raw().into(),
                Id::Extended(id) => id.as_raw(),
            };
            let [low, high] = frame.words();
            for word in [frame.dlc() as u32, low, high, id] {
                REGISTER.store(word, Ordering::Relaxed);
            }
            Ok(None)
        }

        #[inline(always)]
        fn receive(&mut self) -> nb::Result<ClassicFrame, Infallible> {
            Err(nb::Error::WouldBlock)
        }
    }

    impl Bus for Mailboxes {
        fn abort(&mut self) {}
    }

    /// Drives on the bus.
    pub type OdriveDrives = CanDrives<Scalar, Odrive, Mailboxes>;

    /// Drives whose joints stand at `angles`.
    pub fn build(angles: [Angle; 3]) -> OdriveDrives {
        let scales = ROTORS.map(|(gear, reversed, zero)| {
            RotorScale::new(gear, reversed, zero, RATE_RAD_S, TORQUE_NM)
        });
        CanDrives::new(Odrive, Mailboxes, NODES, scales, angles)
    }
}

#[cfg(drive = "bldc")]
pub use bldc::{BldcDrives as Drives, build};
#[cfg(any(drive = "none", drive = "moteus"))]
pub use none::{NoDrives as Drives, build};
#[cfg(drive = "odrive")]
pub use odrive::{OdriveDrives as Drives, build};
#[cfg(drive = "stepper")]
pub use stepper::{SceneSlots, StepperDrives as Drives, build, slot};
