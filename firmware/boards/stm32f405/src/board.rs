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
            pub(crate) use stm32f4xx_hal::pac::*;

            /// The interrupts of the tasks.
            pub(crate) mod interrupt {
                pub(crate) use stm32f4xx_hal::pac::Interrupt::{TIM7, $interrupt as LINE};
            }
        }

        /// Entry of the vector table.
        #[unsafe(no_mangle)]
        unsafe extern "C" fn $interrupt() {
            unsafe extern "Rust" {
                fn LINE();
            }
            // SAFETY: the task, as RTIC has exported it; the processor calls it here, and nothing else does.
            unsafe { LINE() }
        }
    };
}

include!(concat!(env!("OUT_DIR"), "/board.rs"));
