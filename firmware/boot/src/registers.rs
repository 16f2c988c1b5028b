//! Accesses to registers and to the flash.
#![allow(unsafe_code)]

/// Reads of a status before the hardware counts as one that does not end. Each of them stands while a flash of one bank is busy.
pub(crate) const READS: u32 = 1 << 24;

pub(crate) fn read(register: u32) -> u32 {
    // SAFETY: an aligned word of the flash, of its registers or of the watchdog's, which the chip has; reading changes nothing.
    unsafe { (register as *const u32).read_volatile() }
}

pub(crate) fn write(register: u32, value: u32) {
    // SAFETY: a register of flash or watchdog, which nothing else in the program uses while the owner of a `ChipFlash` does,
    // or a word of a slot that holds no code that runs.
    unsafe { (register as *mut u32).write_volatile(value) }
}
