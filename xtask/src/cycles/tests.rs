//! Short sequences, their cycles counted by hand from the manuals' tables. Encodings are LLVM's.

use super::boards::BOARDS;
use super::flash::{CacheSize, Flash, FlashState, UNCACHED};
use super::model::{Classes, Code, Processor};
use super::operation::{Kind, Operation};
use super::timing::{CORTEX_M0, CORTEX_M0_PLUS, CORTEX_M3, CORTEX_M4, Timing};
use super::trace::Executed;
use crate::callgraph::program::Program;

const VADD_S0: &[u16] = &[0xee30, 0x0a81]; // vadd.f32 s0, s1, s2
const VMUL_S0_S0: &[u16] = &[0xee60, 0x1a00]; // vmul.f32 s3, s0, s0
const VMUL_OTHER: &[u16] = &[0xee22, 0x2a83]; // vmul.f32 s4, s5, s6
const VDIV_S0: &[u16] = &[0xee80, 0x0a81]; // vdiv.f32 s0, s1, s2
const VNEG_S0: &[u16] = &[0xeef1, 0x1a40]; // vneg.f32 s3, s0
const VSTR_S0: &[u16] = &[0xed80, 0x0a01]; // vstr s0, [r0, #4]
const VLDR_S0: &[u16] = &[0xed90, 0x0a01]; // vldr s0, [r0, #4]
const ADDS_R0: &[u16] = &[0x3001]; // adds r0, #1
const ADDS_R1: &[u16] = &[0x3104]; // adds r1, #4
const LDR_R0_R1: &[u16] = &[0x6808]; // ldr r0, [r1]
const LDR_R2_R3: &[u16] = &[0x681a]; // ldr r2, [r3]
const LDR_R2_R0: &[u16] = &[0x6802]; // ldr r2, [r0]
const STR_INDEXED: &[u16] = &[0x5098]; // str r0, [r3, r2]
const STR_OFFSET: &[u16] = &[0x6058]; // str r0, [r3, #4]
const LDR_LITERAL: &[u16] = &[0x4801]; // ldr r0, [pc, #4]
const POP_PC: &[u16] = &[0xbd90]; // pop {r4, r7, pc}
const BX_LR: &[u16] = &[0x4770]; // bx lr
const BEQ: &[u16] = &[0xd000]; // beq, 4 bytes ahead
const NOP: &[u16] = &[0xbf00];

/// A program of these instructions, from address 0, and its execution from the first to the last.
fn program(instructions: &[&[u16]]) -> (Program, Vec<Executed>) {
    let (mut bytes, mut executed) = (Vec::new(), Vec::new());
    for words in instructions {
        let mut this = Executed::default();
        this.registers[15] = bytes.len() as u32;
        executed.push(this);
        bytes.extend(words.iter().flat_map(|word| word.to_le_bytes()));
    }
    let program = Program {
        constants: vec![(0, bytes)],
        ..Program::default()
    };
    (program, executed)
}

fn classes(timing: Timing, flash: Option<Flash>, instructions: &[&[u16]]) -> Classes {
    let (program, executed) = program(instructions);
    run(
        Processor::new(timing, flash.map(FlashState::new)),
        &program,
        &executed,
    )
}

fn run(mut processor: Processor, program: &Program, executed: &[Executed]) -> Classes {
    let operations = Code::new(program).operations(executed);
    processor.run(executed, &operations.expect("known instructions"))
}

fn cycles(timing: Timing, instructions: &[&[u16]]) -> u64 {
    classes(timing, None, instructions).total()
}

/// Cycles on a Cortex-M4 before the return, which takes 1 + 2.
fn body(instructions: &[&[u16]]) -> u64 {
    cycles(CORTEX_M4, &[instructions, &[BX_LR]].concat()) - 3
}

#[test]
fn a_result_of_the_fpu_that_the_next_instruction_uses_costs_a_cycle() {
    // 1 + (1) + 1
    assert_eq!(body(&[VADD_S0, VMUL_S0_S0]), 3);
    // 1 + 1 + 1
    assert_eq!(body(&[VADD_S0, VMUL_OTHER, VMUL_S0_S0]), 3);
    // A store uses it, too: 1 + (1) + 2. A move is no arithmetic: 1 + 1.
    assert_eq!(body(&[VADD_S0, VSTR_S0]), 4);
    assert_eq!(body(&[VNEG_S0, VSTR_S0]), 3);
    // A load waits for nothing: 1 + 2.
    assert_eq!(body(&[VADD_S0, VLDR_S0]), 3);
    assert_eq!(classes(CORTEX_M4, None, &[VADD_S0, VSTR_S0]).stall, 1);
}

#[test]
fn integers_go_on_beside_the_divider() {
    // The return goes on beside it, too.
    assert_eq!(cycles(CORTEX_M4, &[VDIV_S0, BX_LR]), 14);
    // 14, 1 for the result, 1
    assert_eq!(body(&[VDIV_S0, VMUL_S0_S0]), 16);
    // 1 + 3 of integers, 10 to wait, 1; the result is not of the instruction before.
    assert_eq!(body(&[VDIV_S0, ADDS_R0, ADDS_R0, ADDS_R0, VMUL_S0_S0]), 15);
    // The unit is one: another division waits for the first.
    assert_eq!(cycles(CORTEX_M4, &[VDIV_S0, VDIV_S0, BX_LR]), 28);
    let divide = classes(CORTEX_M4, None, &[VDIV_S0, ADDS_R0, VMUL_OTHER, BX_LR]);
    assert_eq!((divide.divide, divide.integer, divide.float), (13, 1, 1));
}

#[test]
fn operations_take_what_the_tables_say() {
    let vmla: &[u16] = &[0xee00, 0x0a81]; // vmla.f32 s0, s1, s2
    let vldm: &[u16] = &[0xec90, 0x0a04]; // vldmia r0, {s0-s3}
    let vpush: &[u16] = &[0xed2d, 0x8b04]; // vpush {d8, d9}
    let vmov_pair: &[u16] = &[0xec41, 0x0a12]; // vmov s4, s5, r0, r1
    let ldrd: &[u16] = &[0xe9d2, 0x0102]; // ldrd r0, r1, [r2, #8]
    let push: &[u16] = &[0xb5f0]; // push {r4-r7, lr}
    let ldm: &[u16] = &[0xe890, 0x0106]; // ldm.w r0, {r1, r2, r8}
    for (words, expected) in [
        (vmla, 3),
        (VLDR_S0, 2),
        (vldm, 1 + 4),
        (vpush, 1 + 4),
        (vmov_pair, 2),
        (ldrd, 1 + 2),
        (push, 1 + 5),
        (ldm, 1 + 3),
        (STR_OFFSET, 1),
        (STR_INDEXED, 2),
        (NOP, 1),
    ] {
        assert_eq!(body(&[words]), expected, "{words:04x?}");
    }
    let smull: &[u16] = &[0xfb82, 0x0103];
    let smlal: &[u16] = &[0xfbc2, 0x0103];
    let mla: &[u16] = &[0xfb01, 0x3002];
    let muls: &[u16] = &[0x4348];
    let udiv: &[u16] = &[0xfbb1, 0xf0f2];
    for (words, on_m4, on_m3) in [
        (smull, 1, 5),
        (smlal, 1, 7),
        (mla, 1, 2),
        (muls, 1, 1),
        (udiv, 12, 12),
    ] {
        let on = |timing| cycles(timing, &[words, BX_LR]) - 3;
        assert_eq!(
            (on(CORTEX_M4), on(CORTEX_M3)),
            (on_m4, on_m3),
            "{words:04x?}"
        );
    }
}

#[test]
fn a_branch_that_is_taken_fills_the_pipeline_again() {
    // beq to 4, taken: the instruction at 2 is not executed. 1 + 2, 1 + 2.
    let (program, mut executed) = program(&[BEQ, NOP, BX_LR]);
    executed.remove(1);
    let taken = run(Processor::new(CORTEX_M4, None), &program, &executed);
    assert_eq!((taken.total(), taken.branch), (6, 6));
    // Not taken: 1, 1, 1 + 2.
    assert_eq!(cycles(CORTEX_M4, &[BEQ, NOP, BX_LR]), 5);
    // A return by the stack: 1 + 3 + 2.
    assert_eq!(cycles(CORTEX_M4, &[POP_PC]), 6);
}

#[test]
fn cores_without_caches_have_their_own_refills() {
    // On M0 bx 3 and pop 4 + N, on M0+ 2 and 3 + N.
    assert_eq!(
        (cycles(CORTEX_M0, &[BX_LR]), cycles(CORTEX_M0, &[POP_PC])),
        (3, 7)
    );
    let on_plus = |words| cycles(CORTEX_M0_PLUS, &[words]);
    assert_eq!((on_plus(BX_LR), on_plus(POP_PC)), (2, 6));
    // bl: 4 and 3.
    let call: &[u16] = &[0xf000, 0xf800];
    assert_eq!(cycles(CORTEX_M0, &[call]), 4);
    assert_eq!(cycles(CORTEX_M0_PLUS, &[call]), 3);
    // Loads do not overlap there: 2 + 2 + 3, and a store takes 2.
    assert_eq!(cycles(CORTEX_M0, &[LDR_R0_R1, LDR_R2_R3, BX_LR]), 7);
    assert_eq!(cycles(CORTEX_M0, &[STR_OFFSET, BX_LR]), 5);
}

#[test]
fn neighbouring_loads_overlap_and_addresses_wait() {
    // The examples of DDI 0337I, 3.3.2: three cycles each.
    assert_eq!(body(&[LDR_R0_R1, LDR_R2_R3]), 3);
    assert_eq!(body(&[LDR_R0_R1, STR_INDEXED]), 3);
    // The second needs the result of the first as its address: 2 + 2.
    assert_eq!(body(&[LDR_R0_R1, LDR_R2_R0]), 4);
    // The address is a sum of the instruction before: 1 + (1) + 2.
    assert_eq!(body(&[ADDS_R1, LDR_R0_R1]), 4);
    assert_eq!(body(&[ADDS_R0, LDR_R0_R1]), 3);
}

#[test]
fn an_instruction_whose_condition_does_not_hold_takes_one_cycle() {
    let it: &[u16] = &[0xbf08]; // it eq
    let (program, mut executed) = program(&[it, LDR_R0_R1, BX_LR]);
    // In the block: condition eq, mask 1000. It does not hold.
    executed[1].status = 0b10 << 10;
    let cycles =
        |executed: &[Executed]| run(Processor::new(CORTEX_M4, None), &program, executed).total();
    // 1 + 1 + 3
    assert_eq!(cycles(&executed), 5);
    // Z: 1 + 2 + 3
    executed[1].status |= 1 << 30;
    assert_eq!(cycles(&executed), 6);
}

/// As the F405's, without caches.
const FIVE: Flash = Flash {
    wait_states: 5,
    line: 16,
    prefetches: true,
    instructions: UNCACHED,
    constants: Some(UNCACHED),
};

#[test]
fn the_line_ahead_comes_while_a_line_is_executed() {
    // Line 0 is there after 6 cycles: 5 waits. Line 1 is read from then on, and is there after 12. Eight
    // instructions of one cycle take from 5 to 13: no wait.
    let nops = [NOP; 16];
    assert_eq!(classes(CORTEX_M4, Some(FIVE), &nops[..9]).flash, 5);
    // Line 2, read from 13 to 19, is wanted at 21.
    assert_eq!(
        classes(CORTEX_M4, Some(FIVE), &[&nops[..], &[NOP]].concat()).flash,
        5
    );
    // Four instructions of 32 bits take from 5 to 9, and a fetch takes one cycle itself: 12 - (9 + 1) waits.
    let wide = [VMUL_OTHER; 5];
    assert_eq!(classes(CORTEX_M4, Some(FIVE), &wide).flash, 5 + 2);
    // Without prefetch each line has its waits.
    let without = Flash {
        prefetches: false,
        ..FIVE
    };
    assert_eq!(classes(CORTEX_M4, Some(without), &wide).flash, 5 + 5);
}

#[test]
fn an_instruction_across_two_lines_needs_both() {
    // Seven instructions of 16 bits, then one of 32 at byte 14. Line 0: 5 waits, up to 6; line 1 from 6 to 12.
    // It is wanted at 5 + 7 = 12, with its own cycle: no wait.
    let mut across = vec![NOP; 7];
    across.push(VMUL_OTHER);
    assert_eq!(classes(CORTEX_M4, Some(FIVE), &across).flash, 5);
    // Behind a branch to byte 14 both are read: 5 waits up to 6 where the second read starts, wanted at 5 for
    // cycle 6, there at 12.
    let mut flash = FlashState::new(FIVE);
    assert_eq!(flash.fetch(14, 4, 0), 5 + 6);
}

#[test]
fn the_cache_keeps_lines_that_were_waited_for() {
    let cached = Flash {
        instructions: CacheSize { sets: 1, ways: 2 },
        prefetches: false,
        ..FIVE
    };
    let mut flash = FlashState::new(cached);
    let mut now = 0;
    let mut fetch = |line: u32| {
        now += 100;
        flash.fetch(16 * line, 2, now)
    };
    // Two lines, both kept.
    assert_eq!([0, 5, 0, 5].map(&mut fetch), [5, 5, 0, 0]);
    // A third takes the place of 0, which was used before 5.
    assert_eq!([9, 5, 0, 9].map(&mut fetch), [5, 0, 5, 5]);
}

#[test]
fn lines_that_were_read_ahead_are_not_kept() {
    let cached = Flash {
        instructions: CacheSize { sets: 1, ways: 64 },
        ..FIVE
    };
    let mut flash = FlashState::new(cached);
    // Line 0 is waited for, line 1 comes ahead and is entered without a wait.
    assert_eq!([flash.fetch(0, 2, 0), flash.fetch(16, 2, 50)], [5, 0]);
    // Again: 0 is kept. 1 is read ahead from 100 on, and is there at 106.
    assert_eq!(flash.fetch(0, 2, 100), 0);
    assert_eq!(flash.fetch(16, 2, 101), 106 - (101 + 1));
    // By a branch to it: line 2 is under way from 106 to 112, then line 1 is read, up to 118.
    assert_eq!(flash.fetch(64, 2, 130), 5);
    assert_eq!(flash.fetch(16, 2, 150), 5);
    assert_eq!(flash.fetch(64, 2, 170), 0);
    assert_eq!(flash.fetch(16, 2, 190), 0);
}

#[test]
fn constants_are_read_before_lines_ahead_and_kept() {
    let flash = Flash {
        constants: Some(CacheSize { sets: 1, ways: 8 }),
        ..FIVE
    };
    let mut state = FlashState::new(flash);
    // Line 0 up to 6, line 1 ahead up to 12: the constant waits for it, and is there at 18.
    assert_eq!(state.fetch(0, 2, 0), 5);
    assert_eq!(state.load(0x100, 4, 5), 18 - (5 + 1));
    assert_eq!(state.load(0x104, 4, 40), 0);
    // Only what lies in the memory of code: the registers are zero, so that `ldr r0, [pc, #4]` reads there.
    let literal = classes(CORTEX_M4, Some(flash), &[LDR_LITERAL, BX_LR]);
    // Line 0: 5. The constant at 8 is read behind line 1, from 12 to 18, wanted at 5 + 2 = 7.
    assert_eq!(literal.flash, 5 + 18 - (7 + 1));
}

#[test]
fn a_shared_cache_has_constants_and_instructions() {
    let shared = BOARDS.iter().find(|board| board.name == "RP2040");
    let mut state = FlashState::new(shared.expect("a board").flash);
    assert_eq!(state.fetch(0, 2, 0), 49);
    assert_eq!(state.load(4, 4, 100), 0);
    // 16 KiB of two ways: lines 8 KiB apart share a set of two.
    assert_eq!(state.load(0x2000, 4, 200), 49);
    assert_eq!(state.load(0x4000, 4, 300), 49);
    assert_eq!(state.load(0, 4, 400), 49);
}

#[test]
fn accesses_are_where_the_registers_say() {
    let mut registers = [0; 16];
    registers[1] = 0x100;
    registers[2] = 3;
    registers[15] = 0x1002;
    let address = |words: &[u16]| {
        let operation = Operation::decode(0x1002, words[0], words.get(1).copied());
        let access = operation.expect("known").access.expect("an access");
        (access.address(&registers), access.bytes, access.is_load)
    };
    // ldr.w r0, [r1, r2, lsl #2]
    assert_eq!(address(&[0xf851, 0x0022]), (0x10c, 4, true));
    // ldr r0, [r1], #4: before the sum.
    assert_eq!(address(&[0xf851, 0x0b04]), (0x100, 4, true));
    // ldr r0, [pc, #4]: the pc is 4 ahead, and aligned.
    assert_eq!(address(LDR_LITERAL), (0x1004 + 4, 4, true));
    // ldrd r0, r1, [r2, #8]
    assert_eq!(address(&[0xe9d2, 0x0102]), (3 + 8, 8, true));
    // vldmia r1, {s0-s3}
    assert_eq!(address(&[0xec91, 0x0a04]), (0x100, 16, true));
    // strb r0, [r1, r2]
    assert_eq!(address(&[0x5488]), (0x103, 1, false));
}

#[test]
fn registers_of_the_fpu_are_those_of_the_operands() {
    let of = |words: &[u16]| {
        let operation = Operation::decode(0, words[0], Some(words[1])).expect("known");
        (
            operation.kind,
            operation.float_reads,
            operation.float_writes,
        )
    };
    let s = |registers: &[u32]| registers.iter().fold(0, |all, one| all | 1 << one);
    assert_eq!(of(VADD_S0), (Kind::Float, s(&[1, 2]), s(&[0])));
    assert_eq!(of(VMUL_S0_S0), (Kind::Float, s(&[0]), s(&[3])));
    // vmla.f32 s0, s1, s2 reads its sum, too.
    let vmla = of(&[0xee00, 0x0a81]);
    assert_eq!(vmla, (Kind::FloatMultiplyAdd, s(&[0, 1, 2]), s(&[0])));
    // vsqrt.f32 s0, s1
    assert_eq!(of(&[0xeeb1, 0x0ae0]), (Kind::FloatDivide, s(&[1]), s(&[0])));
    // vcmp.f32 s0, #0
    assert_eq!(of(&[0xeeb5, 0x0a40]), (Kind::Float, s(&[0]), 0));
    // vmrs APSR_nzcv, fpscr; vmov r1, s0; vmov s0, r1; vmov.f32 s1, #1.0
    assert_eq!(of(&[0xeef1, 0xfa10]), (Kind::FloatMove(1), 0, 0));
    assert_eq!(of(&[0xee10, 0x1a10]), (Kind::FloatMove(1), s(&[0]), 0));
    assert_eq!(of(&[0xee00, 0x1a10]), (Kind::FloatMove(1), 0, s(&[0])));
    assert_eq!(of(&[0xeef7, 0x0a00]), (Kind::FloatMove(1), 0, s(&[1])));
    // vcvt.f32.u32 s0, s1
    assert_eq!(of(&[0xeeb8, 0x0a60]), (Kind::Float, s(&[1]), s(&[0])));
    // vpop {d8, d9}; vmov s4, s5, r0, r1
    let pop = of(&[0xecbd, 0x8b04]);
    assert_eq!(pop, (Kind::FloatLoadMany(4), 0, s(&[16, 17, 18, 19])));
    assert_eq!(of(&[0xec41, 0x0a12]), (Kind::FloatMove(2), 0, s(&[4, 5])));
    // vadd.f64 d0, d1, d2: the unit has none.
    assert!(Operation::decode(0, 0xee31, Some(0x0b02)).is_none());
}
