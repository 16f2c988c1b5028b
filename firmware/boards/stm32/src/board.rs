//! Pins of the board as types. The build script writes them from the board file that `BOARD` or the scene names.
#![allow(unsafe_code)]
// The names of all pins; the functions take those of their scene.
#![allow(dead_code, unused_imports)]

use crate::pins::{AnyInput, AnyOutput, Inverted, PortInput, PortOutput};
use trirrr_app::pins::NoPin;

/// Names the interrupt of the line's DMA `LINE`, and that of USB `USB`: a task is bound to an interrupt by its name alone. Both have to be
/// interrupts of the chip, whichever task the image has.
macro_rules! line_interrupt {
    ($interrupt:ident, $usb:ident) => {
        /// The device as RTIC sees it.
        pub(crate) mod device {
            pub(crate) use stm32_metapac::Interrupt;
            pub(crate) use stm32_metapac::NVIC_PRIO_BITS;

            /// The interrupts of the tasks.
            pub(crate) mod interrupt {
                pub(crate) use crate::chip::SLOTS as TIM7;
                pub(crate) use stm32_metapac::Interrupt::{$interrupt as LINE, $usb as USB};
            }
        }
    };
}

include!(concat!(env!("OUT_DIR"), "/board.rs"));
