//! Code that the images of all boards share at their pins: inputs, and outputs beside the drives. Pins come as tuples, those of a function that the
//! scene does not name as `()`.
#![cfg(target_os = "none")]
#![no_std]

mod inputs;
mod outputs;
pub mod tool;
mod wiring;

pub use inputs::{BuiltInputs, InputGroup, InputPins, SwitchPins};
pub use outputs::{Brake, Lamp, OutputGroup, OutputPins, OutputsBeside, Spare};
pub use wiring::BoardPin;

/// Makes the entry of the vector table for a task that has another name.
#[macro_export]
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
