//! Failures of the program: the outputs go off, the [cause] is kept, and the board starts anew.
//!
//! A board implements [`Chip`] and calls [`failure_handlers!`](crate::failure_handlers) once.
#![allow(unsafe_code)]

use crate::service::cause;
use core::ops::Range;
use core::panic::PanicInfo;
use trirrr_protocol::message::{NAME_CAPACITY, Registers, Start};

/// Operations of a microcontroller whose program has failed. Nothing else runs any more.
pub trait Chip {
    /// Addresses of the RAM. The stack lies at their beginning.
    const RAM: Range<usize>;

    /// Switches every output off.
    fn outputs_off();

    /// Starts the board anew.
    fn reset() -> !;

    /// Fault status and fault address of the processor, 0 if unknown.
    fn fault_status() -> (u32, u32);
}

/// Defines the panic handler and the entry of the hard fault for a [`Chip`].
#[macro_export]
macro_rules! failure_handlers {
    ($chip:ty) => {
        // A part of the panic's own function, from which the compiler sees that no text is needed. So the
        // image holds none of the core's texts for panics, nor any code to format them.
        #[panic_handler]
        #[inline(always)]
        #[expect(unused_attributes, reason = "rustc tells LLVM of it all the same")]
        fn panic(info: &core::panic::PanicInfo) -> ! {
            $crate::failure::panicked::<$chip>(info)
        }

        // The stack may be what has failed. So the entry uses none and starts the stack anew at its top. r0
        // is the old stack pointer: the processor has put its registers there, if it could. An interrupt or exception without a handler ends
        // here, too: the program does not know what it has to do.
        core::arch::global_asm!(
            ".section .HardFault.entry, \"ax\"",
            ".global HardFault",
            ".type HardFault, %function",
            ".global DefaultHandler",
            ".type DefaultHandler, %function",
            ".thumb_func",
            "DefaultHandler:",
            ".thumb_func",
            "HardFault:",
            "mrs r0, msp",
            "ldr r1, =_stack_start",
            "mov sp, r1",
            "bl {hard_fault}",
            hard_fault = sym $crate::failure::hard_fault::<$chip>,
        );
    };
}

/// Ends the program after a panic.
#[inline(always)]
pub fn panicked<C: Chip>(info: &PanicInfo) -> ! {
    let (path, line) = info.location().map_or(("", 0), |at| (at.file(), at.line()));
    // The end of a path tells more than its beginning.
    let mut file = [0; NAME_CAPACITY];
    let skipped = path.len().saturating_sub(file.len());
    for (byte, of_path) in file.iter_mut().zip(path.bytes().skip(skipped)) {
        *byte = of_path;
    }
    end::<C>(&Start::Panic { file, line })
}

/// Ends the program with a cause: outputs off, the cause kept, a start anew.
pub fn end<C: Chip>(start: &Start) -> ! {
    cortex_m::interrupt::disable();
    C::outputs_off();
    cause::keep(start);
    C::reset()
}

/// Words of the frame that the processor puts on the stack: r0 to r3, r12, lr, pc, xPSR.
const FRAME: usize = 8;

/// Ends the program after a hard fault.
///
/// # Safety
/// Only for the entry of the hard fault: `sp` is the stack pointer at the fault, and nothing else runs.
pub unsafe extern "C" fn hard_fault<C: Chip>(sp: usize) -> ! {
    let has_frame =
        C::RAM.contains(&sp) && C::RAM.contains(&(sp + 4 * FRAME - 1)) && sp.is_multiple_of(4);
    let word = |index: usize| match has_frame {
        // SAFETY: an aligned word of RAM; nothing else runs.
        true => unsafe { ((sp + 4 * index) as *const u32).read_volatile() },
        false => 0,
    };
    let (status, address) = C::fault_status();
    let registers = Registers {
        pc: word(6),
        lr: word(5),
        sp: sp as u32,
        status,
        address,
    };
    // The stack ends at the beginning of the RAM: a stack pointer below it has overflown.
    end::<C>(&match sp < C::RAM.start {
        true => Start::StackOverflow(registers),
        false => Start::HardFault(registers),
    })
}
