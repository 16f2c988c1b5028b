//! Fault status of a Cortex-M4.
#![allow(unsafe_code)]

/// CFSR, and the address of the fault, or 0.
pub(crate) fn fault_status() -> (u32, u32) {
    const CFSR: *const u32 = 0xE000_ED28 as *const u32;
    const MMFAR: *const u32 = 0xE000_ED34 as *const u32;
    const BFAR: *const u32 = 0xE000_ED38 as *const u32;
    // SAFETY: registers that every Cortex-M4 has; reading changes nothing.
    let (status, memory, bus) = unsafe {
        (
            CFSR.read_volatile(),
            MMFAR.read_volatile(),
            BFAR.read_volatile(),
        )
    };
    let address = match (status & 1 << 7 != 0, status & 1 << 15 != 0) {
        (true, _) => memory,
        (_, true) => bus,
        _ => 0,
    };
    (status, address)
}
