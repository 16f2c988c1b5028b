//! The board, chosen by the target: pins, clocks, interrupts, priorities.

#[cfg(all(target_arch = "arm", target_abi = "eabihf"))]
mod stm32f405;
