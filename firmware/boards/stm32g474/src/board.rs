//! Pins of the board as types. The build script writes them from the board file that `BOARD` or the scene names.
#![allow(unsafe_code)]
// The names of all pins; the functions take those of their scene.
#![allow(dead_code, unused_imports)]

use crate::parts::Ports;
use crate::pins::{AnyInput, AnyOutput, Inverted, PortInput, PortOutput};
use trirrr_app::pins::NoPin;

/// Names the interrupt of the line's port `LINE`: a task is bound to an interrupt by its name alone.
macro_rules! line_interrupt {
    ($interrupt:ident) => {
        /// The device as RTIC sees it.
        pub(crate) mod device {
            pub(crate) use stm32_metapac::NVIC_PRIO_BITS;

            /// Registers are constants: there is nothing to hand out.
            pub(crate) struct Peripherals;

            impl Peripherals {
                /// # Safety
                /// None: there is nothing to share.
                pub(crate) unsafe fn steal() -> Self {
                    Self
                }
            }

            /// The interrupts of the tasks.
            pub(crate) mod interrupt {
                pub(crate) use stm32_metapac::Interrupt::{TIM7_DAC as TIM7, $interrupt as LINE};
            }
        }

        entry!($interrupt, LINE);
    };
}

/// Entry of the vector table for a task that has another name.
macro_rules! entry {
    ($interrupt:ident, $task:ident) => {
        #[unsafe(no_mangle)]
        unsafe extern "C" fn $interrupt() {
            unsafe extern "Rust" {
                fn $task();
            }
            // SAFETY: the task, as RTIC has exported it; the processor calls it here, and nothing else does.
            unsafe { $task() }
        }
    };
}

#[cfg(drive = "stepper")]
entry!(TIM7_DAC, TIM7);

include!(concat!(env!("OUT_DIR"), "/board.rs"));
