//! Accesses to registers and to the flash, and what the controllers of both chips' flashes have in common.
#![allow(unsafe_code)]

use crate::FlashError;

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

/// An operation is under way.
const BUSY: u32 = 1 << 16;
/// The control register takes nothing more until the keys come again.
const LOCK: u32 = 1 << 31;

/// An erasure starts.
const START: u32 = 1 << 16;

/// Registers of a flash's controller, by their addresses.
pub(crate) struct Controller {
    pub(crate) keys: u32,
    pub(crate) status: u32,
    pub(crate) control: u32,
    /// Flags of the status that are cleared before an operation: with one of them nothing begins.
    pub(crate) flags: u32,
    /// Those of them that tell an error.
    pub(crate) errors: u32,
}

impl Controller {
    /// Unlocks the controller for an operation that `control` names.
    pub(crate) fn begin(&self, control: u32) {
        write(self.keys, 0x4567_0123);
        write(self.keys, 0xCDEF_89AB);
        write(self.status, self.flags);
        write(self.control, control);
    }

    /// Erases what `control` names; `place` is for the error.
    pub(crate) fn erase(&self, control: u32, place: u32) -> Result<(), FlashError> {
        self.begin(control);
        write(self.control, control | START);
        self.end(place)
    }

    /// Waits for the end of an operation, and locks the controller again.
    pub(crate) fn end(&self, place: u32) -> Result<(), FlashError> {
        let ended = (0..READS).any(|_| read(self.status) & BUSY == 0);
        let status = read(self.status);
        write(self.control, LOCK);
        match ended && status & self.errors == 0 {
            true => Ok(()),
            false => Err(FlashError { place, status }),
        }
    }
}
