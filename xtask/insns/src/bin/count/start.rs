//! From reset to `run`: a stack, on a Cortex-M4F its FPU, and nothing else (see `count.x`).
#![allow(unsafe_code)]

// The vector table: stack pointer, reset, and the other system exceptions, which all stop the
// emulator: without a handler QEMU reports a lock-up and ends with an error.
#[cfg(target_arch = "arm")]
core::arch::global_asm!(
    ".section .start, \"a\"",
    ".word _stack_top",
    ".word _start",
    ".fill 14, 4, 0",
);

#[cfg(target_arch = "arm")]
core::arch::global_asm!(
    ".section .text._start, \"ax\"",
    ".globl _start",
    ".type _start, %function",
    ".thumb_func",
    "_start:",
    "bl {fpu}",
    "bl {enter}",
    fpu = sym enable_fpu,
    enter = sym enter,
);

/// Full access to coprocessors 10 and 11, for without it the first floating-point instruction
/// faults. Apart from `enter`, so that none comes before.
#[cfg(target_arch = "arm")]
extern "C" fn enable_fpu() {
    #[cfg(target_abi = "eabihf")]
    {
        const CPACR: *mut u32 = 0xE000_ED88 as *mut u32;
        // SAFETY: CPACR is a register of every Cortex-M4F; this runs before anything else.
        unsafe { CPACR.write_volatile(CPACR.read_volatile() | 0xF << 20) };
        cortex_m::asm::dsb();
        cortex_m::asm::isb();
    }
}

#[cfg(target_arch = "riscv32")]
core::arch::global_asm!(
    ".section .start, \"ax\"",
    ".globl _start",
    "_start:",
    "la sp, _stack_top",
    "tail {enter}",
    enter = sym enter,
);

extern "C" fn enter() -> ! {
    super::run::run()
}
