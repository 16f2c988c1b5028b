//! What happens when the program fails: the outputs go off, the cause is kept, the board starts
//! anew and [tells](cause) what it was.
#![allow(unsafe_code)]

use crate::board;
use core::panic::PanicInfo;
use trirrr_protocol::message::{NAME_CAPACITY, Registers, Start};
use trirrr_station::cause;

// As a part of the panic's own function, which is seen then to need no text: so the image holds none of
// the core's texts for panics, nor any code to format them. Only a function that others link to would lose
// by it.
#[panic_handler]
#[inline(always)]
#[expect(unused_attributes, reason = "rustc tells LLVM of it all the same")]
fn panic(info: &PanicInfo) -> ! {
    let (path, line) = info.location().map_or(("", 0), |at| (at.file(), at.line()));
    // The end of the path says more than its beginning.
    let mut file = [0; NAME_CAPACITY];
    let skipped = path.len().saturating_sub(file.len());
    for (byte, of_path) in file.iter_mut().zip(path.bytes().skip(skipped)) {
        *byte = of_path;
    }
    end(&Start::Panic { file, line })
}

fn end(start: &Start) -> ! {
    cortex_m::interrupt::disable();
    board::outputs_off();
    cause::keep(start);
    board::reset()
}

// The hard fault's entry. The stack may be what has failed: nothing is done on it, it starts anew
// at its top. r0 is where it was, with what the processor has put there, if it could.
core::arch::global_asm!(
    ".section .HardFault.entry, \"ax\"",
    ".global HardFault",
    ".type HardFault, %function",
    ".thumb_func",
    "HardFault:",
    "mrs r0, msp",
    "ldr r1, =_stack_start",
    "mov sp, r1",
    "bl {hard_fault}",
    hard_fault = sym hard_fault,
);

/// Words of the frame that the processor puts on the stack: r0 to r3, r12, lr, pc, xPSR.
const FRAME: usize = 8;

unsafe extern "C" fn hard_fault(sp: usize) -> ! {
    let has_frame = board::RAM.contains(&sp)
        && board::RAM.contains(&(sp + 4 * FRAME - 1))
        && sp.is_multiple_of(4);
    let word = |index: usize| match has_frame {
        // SAFETY: an aligned word of RAM; nothing else runs.
        true => unsafe { ((sp + 4 * index) as *const u32).read_volatile() },
        false => 0,
    };
    let (status, address) = board::fault_status();
    let registers = Registers {
        pc: word(6),
        lr: word(5),
        sp: sp as u32,
        status,
        address,
    };
    // The stack ends where the RAM begins: below it there is nothing to put a frame into.
    end(&match sp < board::RAM.start {
        true => Start::StackOverflow(registers),
        false => Start::HardFault(registers),
    })
}
