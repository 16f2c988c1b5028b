//! The board, chosen by the target: pins, clocks, interrupts, priorities. Each has its
//! `#[rtic::app]` and gives the rest of the program
//! - `outputs_off`: every output off at once, from anywhere,
//! - `fault_status`: what the processor says of a fault,
//! - `RAM`: its addresses, the stack at their beginning,
//! - `CORE_HZ`: its clock.

#[cfg(all(target_arch = "arm", target_abi = "eabihf"))]
mod stm32f405;
#[cfg(all(target_arch = "arm", target_abi = "eabihf"))]
#[cfg(feature = "provoke")]
pub(crate) use stm32f405::CORE_HZ;
#[cfg(all(target_arch = "arm", target_abi = "eabihf"))]
pub(crate) use stm32f405::{RAM, fault_status, outputs_off};
