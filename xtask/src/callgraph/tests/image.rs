//! Tests of what is said of a whole image.

use super::{BX_LR, F, FOREVER, G, H, NOP, POP_R4_PC, PUSH_R4_LR, SUB_SP_8, call, code, program};
use crate::callgraph::program::{Function, Program};
use crate::callgraph::{Image, Stack, check};
use std::collections::BTreeMap;

/// A board: a start, a tick, a panic, a fault that starts the stack anew, a default handler; `tick`: what
/// the tick's code is.
fn board(tick: &[u16]) -> Program {
    const RESET: u32 = 0x0800_1000;
    const DEFAULT: u32 = 0x0800_1100;
    const FAULT: u32 = 0x0800_1200;
    // The start calls the panic, as something always does.
    let reset = [&[SUB_SP_8][..], &call(RESET + 2, G)].concat();
    // ldr r1, [pc, #4]; mov sp, r1; push {r4, lr}; b .; the stack's top
    let fault = [0x4901, 0x468d, PUSH_R4_LR, FOREVER, 0x0400, 0x2000];
    let mut program = program(&[
        code(RESET, "Reset", &reset),
        code(F, "SysTick", tick),
        code(G, "core::panicking::panic_fmt", &[FOREVER]),
        code(DEFAULT, "DefaultHandler", &[FOREVER]),
        (FAULT, "HardFault", &fault, 4),
    ]);
    let thumb = |entry: u32| entry + 1;
    program.vectors = vec![0; 16];
    program.vectors[1] = thumb(RESET);
    program.vectors[2] = thumb(DEFAULT);
    program.vectors[3] = thumb(FAULT);
    program.vectors[14] = thumb(DEFAULT);
    program.vectors[15] = thumb(F);
    program
}

#[test]
fn every_handler_comes_on_top_of_the_others_once() {
    let mut program = board(&[PUSH_R4_LR, POP_R4_PC]);
    let stack = |program: &Program| Image::new(program)?.stack();
    // Start 8; tick 8, default 0, fault: nothing of the stack there was; three frames of 36.
    let most = 8 + 8 + 3 * 36;
    let expected = Stack { most, room: 1024 };
    assert_eq!(stack(&program).expect("room"), expected);
    program.has_floats = true;
    let most = 8 + 8 + 3 * 108;
    assert_eq!(stack(&program).expect("room").most, most);
    program.stack = Some(0x2000_0400 - most..0x2000_0400);
    assert!(stack(&program).is_ok());
    program.stack = Some(0x2000_0404 - most..0x2000_0400);
    let said = stack(&program).expect_err("no room").to_string();
    assert!(
        said.contains("takes 340 bytes at most and has 336"),
        "{said}"
    );
    assert!(
        said.contains("SysTick: 8 bytes\n       8  SysTick\n"),
        "{said}"
    );
}

#[test]
fn only_a_last_handler_starts_the_stack_anew() {
    // ldr r1, [pc, #0]; mov sp, r1; bx lr; nop; the stack's top
    let tick = [0x4901, 0x468d, BX_LR, NOP, 0x0400, 0x2000];
    let mut program = board(&tick);
    program.marks.insert(F + 8, false);
    let said = Image::new(&program).err().expect("refused").to_string();
    assert_eq!(
        said,
        "SysTick starts the stack anew, and is no last handler"
    );
}

#[test]
fn a_panic_below_a_handler_is_named_with_the_way_to_it() {
    let refusal = |tick: &[u16]| -> Option<String> {
        let mut program = board(tick);
        let h = [&[PUSH_R4_LR][..], &call(H + 2, G)].concat();
        program.functions.insert(
            H,
            Function {
                end: H + 6,
                names: vec!["h".into()],
            },
        );
        program
            .marks
            .extend(BTreeMap::from([(H, true), (H + 6, false)]));
        let bytes = h.iter().flat_map(|word| word.to_le_bytes()).collect();
        program.constants.push((H, bytes));
        let checked = Image::new(&program).expect("understood").check_panics();
        checked.err().map(|error| error.to_string())
    };
    assert_eq!(refusal(&[PUSH_R4_LR, POP_R4_PC]), None);
    let calls = [&[PUSH_R4_LR][..], &call(F + 2, H), &[POP_R4_PC]].concat();
    assert_eq!(
        refusal(&calls).expect("a panic"),
        "a handler may panic: SysTick > h > core::panicking::panic_fmt"
    );
    // udf, behind a condition
    assert_eq!(
        refusal(&[0xb100, 0xdefe, BX_LR]).expect("a trap"),
        "a handler may panic: SysTick"
    );
}

#[test]
fn a_check_that_could_find_nothing_is_an_error() {
    let said = |program: &Program| {
        let checked = Image::new(program).expect("understood").check_panics();
        checked.expect_err("refused").to_string()
    };
    let mut nameless = board(&[BX_LR]);
    nameless.functions.get_mut(&G).expect("the panic").names = vec!["abort".into()];
    assert!(said(&nameless).contains("no function has the name of a panic"));
    let mut tickless = board(&[BX_LR]);
    tickless.vectors[15] = tickless.vectors[2];
    assert!(said(&tickless).contains("the tick is not in the vector table"));
}

#[test]
fn this_very_program_is_no_image() {
    let program = std::env::current_exe().expect("a path");
    let said = format!("{:#}", check(&program).expect_err("refused"));
    assert!(
        said.ends_with("not a 32-bit ELF file: Unsupported ELF header"),
        "{said}"
    );
}
