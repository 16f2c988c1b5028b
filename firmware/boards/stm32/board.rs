//! Pins of the board as types. The build script writes them from the board file that `BOARD` or the scene names.
#![allow(unsafe_code)]
// The names of all pins; the functions take those of their scene.
#![allow(dead_code, unused_imports)]

use crate::parts::Ports;
use crate::pins::{AnyInput, AnyOutput, Inverted, PortInput, PortOutput};
use trirrr_app::pins::NoPin;

/// Names the interrupt of the line's DMA `LINE`, and that of USB `USB`: a task is bound to an interrupt by its name alone. Both have to be
/// interrupts of the chip, whichever task the image has.
macro_rules! line_interrupt {
    ($interrupt:ident, $usb:ident) => {
        /// The device as RTIC sees it.
        pub(crate) mod device {
            pub(crate) use crate::parts::device::*;

            /// The interrupts of the tasks.
            pub(crate) mod interrupt {
                pub(crate) use crate::parts::device::Interrupt::{$interrupt as LINE, $usb as USB};
                pub(crate) use crate::parts::device::SLOTS as TIM7;
            }
        }

        #[cfg(not(usb))]
        entry!($interrupt, LINE);
        #[cfg(usb)]
        entry!($usb, USB);
    };
}

/// Makes the entry of the vector table for a task that has another name.
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
pub(crate) use entry;

include!(concat!(env!("OUT_DIR"), "/board.rs"));
