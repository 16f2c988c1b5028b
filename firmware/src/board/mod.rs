//! The board, chosen by the target: pins, clocks, interrupts, priorities. Each has its
//! `#[rtic::app]` and gives the rest of the program
//! - `outputs_off`: every output off at once, from anywhere,
//! - `reset`: starts the board anew,
//! - `fault_status`: what the processor says of a fault,
//! - `RAM`: its addresses, the stack at their beginning,
//! - `CORE_HZ`: its clock.

#[cfg(board = "rp2040")]
mod rp2040;
#[cfg(board = "stm32f405")]
mod stm32f405;

#[cfg(board = "rp2040")]
use rp2040 as chosen;
#[cfg(board = "stm32f405")]
use stm32f405 as chosen;

#[cfg(feature = "provoke")]
pub(crate) use chosen::CORE_HZ;
pub(crate) use chosen::{RAM, fault_status, outputs_off, reset};
