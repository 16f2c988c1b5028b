//! Tests of the decoder: encodings as an assembler gives them (LLVM's), against what the instructions do.

use super::instruction::{Flow, Instruction, Registers, Stack, Value};
use super::thumb::decode;

const ADDRESS: u32 = 0x100;

fn of(words: &[u16]) -> Instruction {
    let instruction = decode(ADDRESS, words[0], words.get(1).copied());
    let instruction = instruction.unwrap_or_else(|| panic!("{words:04x?}"));
    assert_eq!(instruction.length as usize, 2 * words.len(), "{words:04x?}");
    instruction
}

#[test]
fn what_becomes_of_the_stack() {
    for (words, stack) in [
        (&[0xb590][..], Stack::Takes(12)),        // push {r4, r7, lr}
        (&[0xe92d, 0x0f00], Stack::Takes(16)),    // push.w {r8, r9, r10, r11}
        (&[0xf84d, 0xbd04], Stack::Takes(4)),     // str r11, [sp, #-4]!
        (&[0xf85d, 0xbb04], Stack::Takes(-4)),    // ldr r11, [sp], #4
        (&[0xed2d, 0x8b10], Stack::Takes(64)),    // vpush {d8-d15}
        (&[0xecbd, 0x8b02], Stack::Takes(-8)),    // vpop {d8}
        (&[0xb082], Stack::Takes(8)),             // sub sp, #8
        (&[0xf5ad, 0x7d16], Stack::Takes(600)),   // sub.w sp, sp, #600
        (&[0xf2ad, 0x4d04], Stack::Takes(1028)),  // subw sp, sp, #1028
        (&[0xb004], Stack::Takes(-16)),           // add sp, #16
        (&[0xf50d, 0x6d80], Stack::Takes(-1024)), // add.w sp, sp, #1024
        (&[0xf20d, 0x4d04], Stack::Takes(-1028)), // addw sp, sp, #1028
        (&[0xe96d, 0x0104], Stack::Takes(16)),    // strd r0, r1, [sp, #-16]!
        (&[0xe8fd, 0x0104], Stack::Takes(-16)),   // ldrd r0, r1, [sp], #16
        (&[0xbc90], Stack::Takes(-8)),            // pop {r4, r7}
        (&[0xbd90], Stack::Takes(-12)),           // pop {r4, r7, pc}
        (&[0xe8bd, 0x8030], Stack::Takes(-12)),   // pop.w {r4, r5, pc}
        (&[0xf85d, 0xfb08], Stack::Takes(-8)),    // ldr pc, [sp], #8
        (&[0x46b5], Stack::Becomes(6, 0)),        // mov sp, r6
        (&[0x44b5], Stack::Adds(6)),              // add sp, r6
        (&[0xf8dd, 0x4008], Stack::Same),         // ldr.w r4, [sp, #8]
        (&[0xed9d, 0x0a01], Stack::Same),         // vldr s0, [sp, #4]
        (&[0xecb0, 0x0a02], Stack::Same),         // vldmia r0!, {s0, s1}
        (&[0xf380, 0x8811], Stack::Same),         // msr basepri, r0
        (&[0xaf03], Stack::Same),                 // add r7, sp, #12
    ] {
        assert_eq!(of(words).stack, stack, "{words:04x?}");
    }
}

#[test]
fn where_it_goes_on() {
    let depends = |condition, count, then| Flow::If {
        condition,
        count,
        then,
    };
    for (words, flow) in [
        (&[0xe7fe][..], Flow::Branch(0x100)),        // b to itself
        (&[0xe7ff], Flow::Branch(0x102)),            // b to the next
        (&[0xd0fc], Flow::BranchIf(0xfc)),           // beq, 4 bytes back
        (&[0xf43f, 0xaffb], Flow::BranchIf(0xfa)),   // beq.w, 6 bytes back
        (&[0xf041, 0x8763], Flow::BranchIf(0x1fca)), // bne.w, 7878 bytes ahead of pc
        (&[0xf7ff, 0xbff9], Flow::Branch(0xf6)),     // b.w, 10 bytes back
        (&[0xf001, 0xbf77], Flow::Branch(0x1ff2)),   // b.w, 7918 bytes ahead of pc
        (&[0xf7ff, 0xfff5], Flow::Call(0xee)),       // bl, 18 bytes back
        (&[0xf001, 0xff73], Flow::Call(0x1fea)),     // bl, 7910 bytes ahead of pc
        (&[0xb100], Flow::BranchIf(0x104)),          // cbz r0
        (&[0xb94f], Flow::BranchIf(0x116)),          // cbnz r7, 18 bytes ahead of pc
        (&[0x4770], Flow::JumpRegister(14)),         // bx lr
        (&[0x4718], Flow::JumpRegister(3)),          // bx r3
        (&[0x4697], Flow::JumpRegister(2)),          // mov pc, r2
        (&[0x47d0], Flow::CallRegister(10)),         // blx r10
        (&[0x4487], Flow::Ahead(0)),                 // add pc, r0
        (&[0xe8df, 0xf005], Flow::Table(1)),         // tbb [pc, r5]
        (&[0xe8df, 0xf015], Flow::Table(2)),         // tbh [pc, r5, lsl #1]
        (&[0xe8d2, 0xf001], Flow::TableAt(2, 1)),    // tbb [r2, r1]
        (&[0xe8d2, 0xf011], Flow::TableAt(2, 2)),    // tbh [r2, r1, lsl #1]
        (&[0xbd90], Flow::Return),                   // pop {r4, r7, pc}
        (&[0xe8bd, 0x8030], Flow::Return),           // pop.w {r4, r5, pc}
        (&[0xf85d, 0xfb08], Flow::Return),           // ldr pc, [sp], #8
        (&[0xdefe], Flow::Trap),                     // udf #254
        (&[0xf7f0, 0xa000], Flow::Trap),             // udf.w #0
        (&[0xbe00], Flow::Trap),                     // bkpt #0
        (&[0xbf04], depends(0, 2, 0b11)),            // itt eq
        (&[0xbf14], depends(1, 2, 0b01)),            // ite ne
        (&[0xbf83], depends(8, 4, 0b0111)),          // ittte hi
        (&[0xbf51], depends(5, 4, 0b0001)),          // iteee pl
        (&[0xbfb8], depends(11, 1, 0b1)),            // it lt
        (&[0xbf00], Flow::Next),                     // nop
        (&[0xf3af, 0x8000], Flow::Next),             // nop.w
        (&[0xf3bf, 0x8f5f], Flow::Next),             // dmb sy
        (&[0xb672], Flow::Next),                     // cpsid i
        (&[0xf891, 0xf008], Flow::Next),             // pld [r1, #8]
    ] {
        assert_eq!(of(words).flow, flow, "{words:04x?}");
    }
}

#[test]
fn what_a_register_gets() {
    for (words, register, value) in [
        (&[0xf642, 0x52f8][..], 2, Value::Constant(0x2df8)), // movw r2, #0x2df8
        (&[0xf6c0, 0x0201], 2, Value::Upper(0x801)),         // movt r2, #0x801
        (&[0xf44f, 0x0200], 2, Value::Constant(0x80_0000)),  // mov.w r2, #0x800000
        (&[0xf04f, 0x12ff], 2, Value::Constant(0xff_00ff)),  // mov.w r2, #0xff00ff
        (&[0xf04f, 0x32ab], 2, Value::Constant(0xabab_abab)), // mov.w r2, #0xabababab
        (&[0x22c0], 2, Value::Constant(192)),                // movs r2, #192
        (&[0x000a], 2, Value::Of(1, 0)),                     // movs r2, r1
        (&[0xea4f, 0x000a], 0, Value::Of(10, 0)),            // mov.w r0, r10
        (&[0x466f], 7, Value::Of(13, 0)),                    // mov r7, sp
        (&[0xaf03], 7, Value::Of(13, 12)),                   // add r7, sp, #12
        (&[0xf50d, 0x7780], 7, Value::Of(13, 256)),          // add.w r7, sp, #256
        (&[0x1dc8], 0, Value::Of(1, 7)),                     // adds r0, r1, #7
        (&[0x1ffe], 6, Value::Of(7, -7)),                    // subs r6, r7, #7
        (&[0x30c8], 0, Value::Of(0, 200)),                   // adds r0, #200
        (&[0x3e05], 6, Value::Of(6, -5)),                    // subs r6, #5
        (&[0xf101, 0x4000], 0, Value::Of(1, i32::MIN)),      // add.w r0, r1, #0x80000000
        (&[0x4478], 0, Value::From(0x104)),                  // add r0, pc
        (&[0x4448], 0, Value::Other),                        // add r0, r9
        (&[0x0040], 0, Value::Double(0)),                    // lsls r0, r0, #1
        (&[0x0080], 0, Value::Other),                        // lsls r0, r0, #2
        (&[0x4806], 0, Value::Literal(0x11c)),               // ldr r0, [pc, #24]
        (&[0xf8df, 0x0018], 0, Value::Literal(0x11c)),       // ldr.w r0, [pc, #24]
        (&[0xf85f, 0x9028], 9, Value::Literal(0xdc)),        // ldr.w r9, [pc, #-40]
        (&[0xa104], 1, Value::Constant(0x114)),              // adr r1, #16
        (&[0xf2af, 0x0130], 1, Value::Constant(0xd4)),       // adr.w r1, #-48
        (&[0xf60f, 0x61cc], 1, Value::Constant(0xfd0)),      // adr.w r1, #3788
        (&[0x6fcb], 3, Value::Load(1, 124, 4)),              // ldr r3, [r1, #124]
        (&[0x790b], 3, Value::Load(1, 4, 1)),                // ldrb r3, [r1, #4]
        (&[0x888b], 3, Value::Load(1, 4, 2)),                // ldrh r3, [r1, #4]
        (&[0xf8da, 0xc0b0], 12, Value::Load(10, 176, 4)),    // ldr.w r12, [r10, #176]
        (&[0xf85a, 0x4c04], 4, Value::Load(10, -4, 4)),      // ldr r4, [r10, #-4]
        (&[0xf85a, 0x4023], 4, Value::Other),                // ldr.w r4, [r10, r3, lsl #2]
        (&[0xf89a, 0x4005], 4, Value::Other),                // ldrb.w r4, [r10, #5]
        (&[0x580b], 3, Value::Element(1, 0, 4)),             // ldr r3, [r1, r0]
        (&[0x5c0b], 3, Value::Element(1, 0, 1)),             // ldrb r3, [r1, r0]
        (&[0x5a0b], 3, Value::Element(1, 0, 2)),             // ldrh r3, [r1, r0]
        (&[0x5e0b], 3, Value::Other),                        // ldrsh r3, [r1, r0]
        (&[0xf3ef, 0x8008], 0, Value::Other),                // mrs r0, msp
    ] {
        let instruction = of(words);
        assert_eq!(instruction.writes, Registers::one(register), "{words:04x?}");
        assert_eq!(instruction.value, value, "{words:04x?}");
    }
}

#[test]
fn which_registers_change() {
    for (words, registers) in [
        (&[0xbc90][..], &[4, 7][..]),        // pop {r4, r7}
        (&[0xe8bd, 0x8030], &[4, 5]),        // pop.w {r4, r5, pc}
        (&[0xe92d, 0x0f00], &[]),            // push.w {r8, r9, r10, r11}
        (&[0xe8fd, 0x0104], &[0, 1]),        // ldrd r0, r1, [sp], #16
        (&[0xe9d6, 0x4502], &[4, 5]),        // ldrd r4, r5, [r6, #8]
        (&[0xf85a, 0x4b04], &[4, 10]),       // ldr r4, [r10], #4
        (&[0xf85a, 0x4f04], &[4, 10]),       // ldr r4, [r10, #4]!
        (&[0xf84a, 0x4f04], &[10]),          // str r4, [r10, #4]!
        (&[0xf88a, 0x4005], &[]),            // strb.w r4, [r10, #5]
        (&[0x67cb], &[]),                    // str r3, [r1, #124]
        (&[0xc90c], &[1, 2, 3]),             // ldm r1!, {r2, r3}
        (&[0xe894, 0x000e], &[1, 2, 3]),     // ldm.w r4, {r1, r2, r3}
        (&[0xe934, 0x4006], &[1, 2, 4, 14]), // ldmdb r4!, {r1, r2, lr}
        (&[0xc10c], &[1]),                   // stm r1!, {r2, r3}
        (&[0xe8a4, 0x0006], &[4]),           // stm.w r4!, {r1, r2}
        (&[0xfba3, 0x1204], &[1, 2]),        // umull r1, r2, r3, r4
        (&[0xfbb2, 0xf1f3], &[1]),           // udiv r1, r2, r3
        (&[0xfb02, 0xf103], &[1]),           // mul r1, r2, r3
        (&[0x4351], &[1]),                   // muls r1, r2, r1
        (&[0xe843, 0x2100], &[1]),           // strex r1, r2, [r3]
        (&[0xe853, 0x1f00], &[1]),           // ldrex r1, [r3]
        (&[0xe8c3, 0x2f41], &[1]),           // strexb r1, r2, [r3]
        (&[0xb2d1], &[1]),                   // uxtb r1, r2
        (&[0xfa0f, 0xf982], &[9]),           // sxth.w r9, r2
        (&[0xba11], &[1]),                   // rev r1, r2
        (&[0xfab2, 0xf182], &[1]),           // clz r1, r2
        (&[0xf3c2, 0x01c3], &[1]),           // ubfx r1, r2, #3, #4
        (&[0xee10, 0x1a10], &[1]),           // vmov r1, s0
        (&[0xec52, 0x1b10], &[1, 2]),        // vmov r1, r2, d0
        (&[0xee00, 0x1a10], &[]),            // vmov s0, r1
        (&[0xecb0, 0x0a02], &[0]),           // vldmia r0!, {s0, s1}
        (&[0xec80, 0x0a02], &[]),            // vstmia r0, {s0, s1}
        (&[0xee30, 0x0a81], &[]),            // vadd.f32 s0, s1, s2
        (&[0xeeb1, 0x0ae0], &[]),            // vsqrt.f32 s0, s1
    ] {
        let expected = registers
            .iter()
            .fold(Registers::NONE, |all, one| all.with(*one));
        assert_eq!(of(words).writes, expected, "{words:04x?}");
    }
}

#[test]
fn what_changes_the_flags_where_it_depends_on_them() {
    for (words, compares) in [
        (&[0x2907][..], true),      // cmp r1, #7
        (&[0x4549], true),          // cmp r1, r9
        (&[0xebb1, 0x0f02], true),  // cmp.w r1, r2
        (&[0xf011, 0x0f0e], true),  // tst.w r1, #14
        (&[0xebb2, 0x0103], true),  // subs.w r1, r2, r3
        (&[0xfa12, 0xf103], true),  // lsls.w r1, r2, r3
        (&[0xeef1, 0xfa10], true),  // vmrs APSR_nzcv, fpscr
        (&[0x2001], false),         // mov r0, #1, under a condition
        (&[0xea4f, 0x000a], false), // mov.w r0, r10
        (&[0xfa0f, 0xf982], false), // sxth.w r9, r2
    ] {
        assert_eq!(of(words).compares, compares, "{words:04x?}");
    }
}

#[test]
fn what_no_program_here_has_is_refused() {
    for words in [
        [0xf380, 0x8808], // msr msp, r0
        [0xdf00, 0xbf00], // svc #0
        [0xf000, 0xe800], // blx to ARM code
        [0xef00, 0x0d40], // vadd.f32 q0, q0, q0: of other cores
        [0xf8dd, 0xd008], // ldr.w sp, [sp, #8]
        [0xf8d1, 0xf008], // ldr.w pc, [r1, #8]
        [0xf081, 0x0d08], // eor sp, r1, #8
    ] {
        assert_eq!(
            decode(ADDRESS, words[0], Some(words[1])),
            None,
            "{words:04x?}"
        );
    }
    // The second half is missing.
    assert_eq!(decode(ADDRESS, 0xf7ff, None), None);
}
