//! Critical sections of the driver of USB. Step pulses do not wait for them.
#![allow(unsafe_code)]

use cortex_m::asm::{dsb, isb};
use cortex_m::peripheral::NVIC;
use critical_section::{Impl, RawRestoreState};
use rp2040_hal::pac::Interrupt;

/// Masks all interrupts but the slots. The tick, which is no interrupt of the chip, goes on, too.
struct BelowSlots;

critical_section::set_impl!(BelowSlots);

// SAFETY: sections exclude each other, as the start and the task of USB alone have any: the start runs before all tasks, and the task does
// not preempt itself. Slots and tick, which a section lets pass, have none, and share nothing with the driver of USB.
unsafe impl Impl for BelowSlots {
    unsafe fn acquire() -> RawRestoreState {
        // SAFETY: ones mask interrupts, zeros change nothing. No other task masks one that it could mask here.
        let enabled = unsafe {
            let enabled = (*NVIC::PTR).iser[0].read();
            (*NVIC::PTR).icer[0].write(!(1 << Interrupt::PWM_IRQ_WRAP as u32));
            enabled
        };
        // From the next instruction on.
        dsb();
        isb();
        enabled
    }

    unsafe fn release(enabled: RawRestoreState) {
        // All of the section lies before this.
        dsb();
        // SAFETY: ones let interrupts through, those that were before the section.
        unsafe { (*NVIC::PTR).iser[0].write(enabled) };
    }
}
