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
    use crate::scene::drive::{MOTORS, PER_TICK, UNITS};
    use embedded_hal::pwm::{ErrorType, SetDutyCycle};
    use trirrr_drives::bldc::{Bldcs, LoopLine, Loops};
    use trirrr_drives::{Active, Enable, Failure};
    use trirrr_service::Output;

    #[used]
    static LINE: LoopLine = LoopLine::new();

    /// A PWM output of 16,800 counts.
    pub struct Pwm;

    impl ErrorType for Pwm {
        type Error = Infallible;
    }

    impl SetDutyCycle for Pwm {
        fn max_duty_cycle(&self) -> u16 {
            16_800
        }

        #[inline(always)]
        fn set_duty_cycle(&mut self, duty: u16) -> Result<(), Infallible> {
            REGISTER.store(duty.into(), Ordering::Relaxed);
            Ok(())
        }
    }

    /// Loops that are called between ticks.
    pub type SceneSlots = Loops<&'static LoopLine, Pwm, Pin>;

    /// Amplifiers and encoders, with their loops.
    pub struct LoopedDrives {
        tick: Bldcs<&'static LoopLine>,
        loops: SceneSlots,
    }

    /// Motors that are off, with their joints at `angles`.
    pub fn build(angles: [Angle; 3]) -> LoopedDrives {
        let Ok(enable) = Enable::new(Pin, Active::High);
        LoopedDrives {
            tick: Bldcs::new::<Scalar>(&LINE, UNITS, angles),
            loops: Loops::new(&LINE, &MOTORS, [Pwm, Pwm, Pwm], enable, PER_TICK),
        }
    }

    /// One sample of the loops.
    #[inline(never)]
    pub fn slot(loops: &mut SceneSlots) {
        let counter = REGISTER.load(Ordering::Relaxed) as u16;
        loops.sample([counter; 3], [counter == u16::MAX; 3]);
    }

    impl LoopedDrives {
        /// Work of a tick for the drives, and one sample of the loops.
        #[inline(always)]
        pub fn apply(&mut self, output: &Output<Scalar>) -> Result<(), Failure<Scalar>> {
            for reading in self.tick.measure::<Scalar>() {
                REGISTER.store(reading.error, Ordering::Relaxed);
            }
            self.tick.apply(output);
            slot(&mut self.loops);
            Ok(())
        }

        /// Follows a new zero of the joint angles.
        #[cfg(homing)]
        #[inline(always)]
        pub fn shift(&mut self, by: [Angle; 3]) {
            self.tick.shift::<Scalar>(by);
        }
    }
}

#[cfg(any(drive = "odrive", drive = "mit"))]
mod can {
    use super::{Angle, Infallible, Ordering, REGISTER, Scalar};
    use crate::scene::drive::{HEARD, NODES, PROTOCOL, Protocol, ROTORS};
    use embedded_can::nb::Can;
    use embedded_can::{Frame, Id, StandardId};
    use trirrr_drives::Failure;
    use trirrr_drives::can::{Absolute, Bus, CanDrives, ClassicFrame};
    use trirrr_protocol::message::DriveReading;
    use trirrr_service::Output;

    /// A drive that obeys: it is on when it is told, and where it is told.
    #[derive(Clone, Copy)]
    struct Obeying {
        /// State of its axis, as heartbeats tell it.
        state: u8,
        /// Position and velocity of the rotor as its estimates tell them,
        estimates: [u8; 8],
        /// and its torque.
        torques: [u8; 8],
    }

    /// A controller whose mailboxes are always empty. In each tick it has received an estimate and a torque of each drive, and
    /// now and then a heartbeat in the place of the torque.
    struct Mailboxes {
        drives: [Obeying; 3],
        /// Frames received in this tick.
        received: usize,
        ticks: u8,
    }

    impl Mailboxes {
        /// Controller of drives that are off.
        fn new() -> Self {
            let drive = Obeying {
                state: 1,
                estimates: [0; 8],
                torques: [0; 8],
            };
            Self {
                drives: [drive; 3],
                received: 0,
                ticks: 0,
            }
        }

        /// Lets an ODrive obey a frame. Drives of other kinds say nothing.
        #[inline(always)]
        fn obey(&mut self, id: u32, [low, high]: [u32; 2]) {
            if !cfg!(drive = "odrive") {
                return;
            }
            for (node, drive) in NODES.iter().zip(&mut self.drives) {
                if id >> 5 != u32::from(*node) {
                    continue;
                }
                match id & 0x1F {
                    0x07 => drive.state = low as u8,
                    0x0C => {
                        // Velocity and torque in thousandths.
                        let part = |bits: u32| f32::from(bits as u16 as i16) * 1e-3;
                        let words = |one: u32, two: f32| {
                            (u64::from(one) | u64::from(two.to_bits()) << 32).to_le_bytes()
                        };
                        drive.estimates = words(low, part(high));
                        drive.torques = words(0, part(high >> 16));
                    }
                    _ => {}
                }
            }
        }
    }

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
            self.obey(id, [low, high]);
            Ok(None)
        }

        #[inline(always)]
        fn receive(&mut self) -> nb::Result<ClassicFrame, Infallible> {
            let place = self.received / 2;
            let drive = self.drives.get(place).filter(|_| cfg!(drive = "odrive"));
            let (Some(node), Some(drive)) = (NODES.get(place), drive) else {
                self.received = 0;
                self.ticks = self.ticks.wrapping_add(1);
                return Err(nb::Error::WouldBlock);
            };
            let (command, data) = match (self.received % 2, self.ticks % 8) {
                (0, _) => (0x09, drive.estimates),
                (_, 0) => (0x01, [0, 0, 0, 0, drive.state, 0, 0, 0]),
                _ => (0x1C, drive.torques),
            };
            self.received += 1;
            let id = StandardId::new(u16::from(*node) << 5 | command).unwrap_or(StandardId::ZERO);
            Ok(ClassicFrame::of(id.into(), 8, data))
        }
    }

    impl Bus for Mailboxes {
        fn abort(&mut self) {}
    }

    /// Drives on the bus.
    pub struct HeardDrives(CanDrives<Scalar, Protocol, Mailboxes>);

    /// Drives whose joints stand at `angles`, wherever their encoders began.
    pub fn build(angles: [Angle; 3]) -> HeardDrives {
        let scales = ROTORS.map(|scale| scale.knows(Absolute::Nothing));
        HeardDrives(CanDrives::new(
            PROTOCOL,
            Mailboxes::new(),
            NODES,
            scales,
            angles,
            HEARD,
        ))
    }

    impl HeardDrives {
        /// Hears the drives, before the tick.
        #[inline(always)]
        pub fn measure(&mut self) -> [DriveReading<Scalar>; 3] {
            self.0.measure()
        }

        /// Work of a tick for the drives: commands them.
        #[inline(always)]
        pub fn apply(&mut self, output: &Output<Scalar>) -> Result<(), Failure<Scalar>> {
            self.0.apply(output)
        }

        /// Follows a new zero of the joint angles.
        #[cfg(homing)]
        #[inline(always)]
        pub fn shift(&mut self, by: [Angle; 3]) {
            self.0.shift(by);
        }
    }
}

#[cfg(drive = "bldc")]
pub use bldc::{LoopedDrives as Drives, SceneSlots, build, slot};
#[cfg(any(drive = "odrive", drive = "mit"))]
pub use can::{HeardDrives as Drives, build};
#[cfg(any(drive = "none", drive = "moteus"))]
pub use none::{NoDrives as Drives, build};
#[cfg(drive = "stepper")]
pub use stepper::{SceneSlots, StepperDrives as Drives, build, slot};
