//! RAM, which the processor and the DMA share.
#![allow(unsafe_code)]

use std::cell::UnsafeCell;
use std::ffi::c_void;

/// Address and size.
pub(crate) const RAM: u64 = 0x2000_0000;
pub(crate) const RAM_BYTES: u64 = 128 * 1024;

const PAGE: usize = 4096;

/// Aligned as the CPU emulator maps it.
#[repr(C, align(4096))]
struct Page(UnsafeCell<[u8; PAGE]>);

/// Content of the RAM.
pub(crate) struct Memory(Box<[Page]>);

impl Memory {
    pub(crate) fn new() -> Self {
        let pages = RAM_BYTES as usize / PAGE;
        let page = |_| Page(UnsafeCell::new([0; PAGE]));
        Self((0..pages).map(page).collect())
    }

    /// Returns the place of the RAM in the memory of the bench, for the CPU emulator.
    pub(crate) fn pointer(&self) -> *mut c_void {
        self.0.as_ptr().cast_mut().cast()
    }

    /// Returns the place of a byte; none if there is no RAM at `address`.
    fn place(&self, address: u32) -> Option<*mut u8> {
        let offset = u64::from(address).checked_sub(RAM)? as usize;
        let page = self.0.get(offset / PAGE)?;
        Some(page.0.get().cast::<u8>().wrapping_add(offset % PAGE))
    }

    /// Reads a byte. Returns `None` if there is no RAM at `address`.
    pub(crate) fn read(&self, address: u32) -> Option<u8> {
        // SAFETY: within the page, and the emulator, which has the same pointer, does not run now.
        self.place(address)
            .map(|place| unsafe { place.read_volatile() })
    }

    /// Writes a byte. Returns `None` if there is no RAM at `address`.
    pub(crate) fn write(&mut self, address: u32, byte: u8) -> Option<()> {
        // SAFETY: as in `read`.
        self.place(address)
            .map(|place| unsafe { place.write_volatile(byte) })
    }
}
