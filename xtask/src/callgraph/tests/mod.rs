//! Tests of the walk and the graph, on small programs.

mod image;

use super::program::{Function, Program};
use super::walk::{Body, Call, walk};
use super::*;

const F: u32 = 0x0800_0100;
const G: u32 = 0x0800_0200;
const H: u32 = 0x0800_0300;

/// Functions of 256 bytes at most, each at its address; data from `data` halfwords on.
fn program(functions: &[(u32, &str, &[u16], usize)]) -> Program {
    let mut program = Program {
        stack: Some(0x2000_0000..0x2000_0400),
        ..Program::default()
    };
    for (start, name, words, data) in functions {
        let bytes = words.iter().flat_map(|word| word.to_le_bytes()).collect();
        program.constants.push((*start, bytes));
        program.marks.insert(*start, true);
        program.marks.insert(start + 2 * *data as u32, false);
        let function = Function {
            end: start + 2 * words.len() as u32,
            names: vec![(*name).to_owned()],
        };
        program.functions.insert(*start, function);
    }
    program
}

/// Code without data behind it.
fn code<'a>(start: u32, name: &'a str, words: &'a [u16]) -> (u32, &'a str, &'a [u16], usize) {
    (start, name, words, words.len())
}

/// `bl`, or `b.w` where it does not come back.
fn far(from: u32, to: u32, links: bool) -> [u16; 2] {
    let offset = to.wrapping_sub(from + 4);
    let sign = offset >> 31;
    let (j1, j2) = (!(offset >> 23 ^ sign) & 1, !(offset >> 22 ^ sign) & 1);
    let first = 0xf000 | sign << 10 | offset >> 12 & 0x3ff;
    let second = 0x9000 | u32::from(links) << 14 | j1 << 13 | j2 << 11 | offset >> 1 & 0x7ff;
    [first as u16, second as u16]
}

fn call(from: u32, to: u32) -> [u16; 2] {
    far(from, to, true)
}

fn body(program: &Program, entry: u32) -> Body {
    let entries = BTreeSet::from([entry]);
    Graph::from(program, &entries).expect("understood").bodies[&entry].clone()
}

fn refusal(program: &Program, entry: u32) -> String {
    let refused = Graph::from(program, &BTreeSet::from([entry]));
    format!("{:#}", refused.expect_err("refused"))
}

const BX_LR: u16 = 0x4770;
const PUSH_R4_LR: u16 = 0xb510;
const POP_R4_PC: u16 = 0xbd10;
const SUB_SP_8: u16 = 0xb082;
const ADD_SP_8: u16 = 0xb002;
const NOP: u16 = 0xbf00;
const FOREVER: u16 = 0xe7fe;

#[test]
fn a_call_adds_what_the_callee_takes() {
    let [high, low] = call(F + 4, G);
    let f = [PUSH_R4_LR, SUB_SP_8, high, low, ADD_SP_8, POP_R4_PC];
    let program = program(&[code(F, "f", &f), code(G, "g", &[PUSH_R4_LR, POP_R4_PC])]);
    let graph = Graph::from(&program, &BTreeSet::from([F])).expect("understood");
    assert_eq!(graph.depth(F), 24);
    assert_eq!(graph.deepest(F), [(F, 16), (G, 8)]);
    let expected = Body {
        depth: 16,
        calls: BTreeSet::from([Call { to: G, depth: 16 }]),
        returns: true,
        ..Body::default()
    };
    assert_eq!(graph.bodies[&F], expected);
}

#[test]
fn a_tail_call_takes_nothing_but_what_the_callee_takes() {
    // push {r4, lr}; ldmia.w sp!, {r4, lr}; b.w g
    let f = [&[PUSH_R4_LR, 0xe8bd, 0x4010][..], &far(F + 6, G, false)].concat();
    let program = program(&[code(F, "f", &f), code(G, "g", &[PUSH_R4_LR, POP_R4_PC])]);
    assert_eq!(
        body(&program, F).calls,
        BTreeSet::from([Call { to: G, depth: 0 }])
    );
    assert!(body(&program, F).returns);
}

#[test]
fn a_call_by_register_is_followed_where_the_register_is_known() {
    // push; ldr r3, [pc, #4]; blx r3; pop; the address of g
    let f = [PUSH_R4_LR, 0x4b01, 0x4798, POP_R4_PC, 0x0201, 0x0800];
    let known = program(&[(F, "f", &f, 4), code(G, "g", &[BX_LR])]);
    assert_eq!(
        body(&known, F).calls,
        BTreeSet::from([Call { to: G, depth: 8 }])
    );
    let unknown = program(&[code(F, "f", &[PUSH_R4_LR, 0x4798, POP_R4_PC])]);
    assert_eq!(
        refusal(&unknown, F),
        "f+0x2 (0x08000102): it calls what r3 holds, and nothing here tells what that is"
    );
    // What a callee may change is not known behind the call: r3 again.
    let [high, low] = call(F + 4, G);
    let f = [
        PUSH_R4_LR, 0x4b01, high, low, 0x4798, POP_R4_PC, 0x0201, 0x0800,
    ];
    let lost = program(&[(F, "f", &f, 6), code(G, "g", &[BX_LR])]);
    assert!(
        refusal(&lost, F).starts_with("f+0x8"),
        "{}",
        refusal(&lost, F)
    );
}

#[test]
fn a_call_by_register_is_followed_to_both_where_two_ways_join() {
    // push; ldr r3, [pc, #8]; beq; ldr r3, [pc, #8]; blx r3; pop; the addresses of g and h
    let f = [
        PUSH_R4_LR, 0x4b02, 0xd000, 0x4b02, 0x4798, POP_R4_PC, 0x0201, 0x0800, 0x0301, 0x0800,
    ];
    let both = program(&[
        (F, "f", &f, 6),
        code(G, "g", &[BX_LR]),
        code(H, "h", &[BX_LR]),
    ]);
    let calls = [G, H].map(|to| Call { to, depth: 8 });
    assert_eq!(body(&both, F).calls, BTreeSet::from(calls));
}

#[test]
fn what_lies_behind_a_call_that_never_returns_is_not_walked() {
    let [high, low] = call(F + 2, G);
    // 0xffff is no instruction.
    let f = [PUSH_R4_LR, high, low, 0xffff, 0xffff];
    let dead_end = program(&[code(F, "f", &f), code(G, "g", &[FOREVER])]);
    assert!(!body(&dead_end, F).returns);
    let goes_on = program(&[code(F, "f", &f), code(G, "g", &[BX_LR])]);
    assert!(refusal(&goes_on, F).contains("f+0x6 (0x08000106): ffff ffff is not understood"));
}

#[test]
fn every_way_of_a_table_is_walked() {
    // tbb [pc, r0]; .byte 1, 3; bx lr; nop; push; pop
    let f = [0xe8df, 0xf000, 0x0301, BX_LR, NOP, PUSH_R4_LR, POP_R4_PC];
    let mut table = program(&[code(F, "f", &f)]);
    table.marks.insert(F + 4, false);
    table.marks.insert(F + 6, true);
    assert_eq!(body(&table, F).depth, 8);
    // Without the second entry nothing is pushed.
    table.constants[0].1[5] = 1;
    assert_eq!(body(&table, F).depth, 0);
    // A table that leads nowhere.
    table.constants[0].1[4..6].fill(0xff);
    assert!(refusal(&table, F).contains("is empty"));
}

#[test]
fn the_tables_of_small_cores_are_walked() {
    // add r0, pc; ldrb r0, [r0, #4]; lsls r0, r0, #1; add pc, r0; .byte 0, 1; bx lr; push; pop
    let f = [
        0x4478, 0x7900, 0x0040, 0x4487, 0x0100, BX_LR, PUSH_R4_LR, POP_R4_PC,
    ];
    let mut table = program(&[code(F, "f", &f)]);
    table.marks.insert(F + 8, false);
    table.marks.insert(F + 10, true);
    assert_eq!(body(&table, F).depth, 8);
    // adr r1, #4; ldr r0, [r1, r0]; mov pc, r0; nop; two addresses; bx lr; push; pop
    let f = [
        0xa101, 0x5808, 0x4687, NOP, 0x0111, 0x0800, 0x0113, 0x0800, BX_LR, PUSH_R4_LR, POP_R4_PC,
    ];
    let mut table = program(&[code(F, "f", &f)]);
    table.marks.insert(F + 8, false);
    table.marks.insert(F + 16, true);
    assert_eq!(body(&table, F).depth, 8);
}

#[test]
fn an_epilogue_in_two_blocks_of_one_condition_is_one() {
    // push; sub sp, #8; itt eq; nopeq; addeq sp, #8; it eq; popeq {r4, pc}; add sp, #8; pop
    let f = [
        PUSH_R4_LR, SUB_SP_8, 0xbf04, NOP, ADD_SP_8, 0xbf08, POP_R4_PC, ADD_SP_8, POP_R4_PC,
    ];
    assert!(body(&program(&[code(F, "f", &f)]), F).returns);
    // With a comparison between the two they are not of one condition any more.
    let mut other = f.to_vec();
    other.insert(5, 0x2907);
    let said = refusal(&program(&[code(F, "f", &other)]), F);
    assert!(said.contains("bytes deep on one way"), "{said}");
}

#[test]
fn an_outlined_piece_is_a_part_of_its_caller() {
    // f: push {r4, lr}; ldr r3, [pc, #4]; b.w piece. piece: blx r3; pop {r4, pc}
    let [high, low] = far(F + 4, H, false);
    let f = [PUSH_R4_LR, 0x4b01, high, low, 0x0201, 0x0800];
    let program = program(&[
        (F, "f", &f, 4),
        code(G, "g", &[BX_LR]),
        code(H, "OUTLINED_FUNCTION_7", &[0x4798, POP_R4_PC]),
    ]);
    let body = body(&program, F);
    assert!(body.returns);
    assert_eq!(body.calls, BTreeSet::from([Call { to: G, depth: 8 }]));
}

#[test]
fn what_the_stack_pointer_becomes_has_to_be_known() {
    // push {r4, r7, lr}; add r7, sp, #4; sub sp, #8; subs r6, r7, #4; mov sp, r6; pop {r4, r7, pc}
    let f = [0xb590, 0xaf01, SUB_SP_8, 0x1f3e, 0x46b5, 0xbd90];
    assert_eq!(body(&program(&[code(F, "f", &f)]), F).depth, 20);
    // ldr r6, [pc, #4]; add sp, r6; bl g; .word -1024
    let [high, low] = call(F + 4, G);
    let f = [0x4e01, 0x44b5, high, low, 0xfc00, 0xffff];
    let grown = program(&[(F, "f", &f, 4), code(G, "g", &[FOREVER])]);
    assert_eq!(body(&grown, F).depth, 1024);
    let unknown = program(&[code(F, "f", &[0x46b5, BX_LR])]);
    assert!(refusal(&unknown, F).contains("f: what becomes of the stack pointer"));
    let left = program(&[code(F, "f", &[SUB_SP_8, BX_LR])]);
    assert_eq!(refusal(&left, F), "f returns with the stack 8 bytes deep");
    // A loop that pushes.
    let grows = program(&[code(F, "f", &[SUB_SP_8, 0xe7fd])]);
    assert!(refusal(&grows, F).contains("deep on one way"));
}

#[test]
fn recursion_is_named_with_its_cycle() {
    let g = [&[PUSH_R4_LR][..], &call(G + 2, H), &[POP_R4_PC]].concat();
    let h = [&[PUSH_R4_LR][..], &call(H + 2, G), &[POP_R4_PC]].concat();
    let f = [&[PUSH_R4_LR][..], &call(F + 2, G), &[POP_R4_PC]].concat();
    let cycle = program(&[code(F, "f", &f), code(G, "g", &g), code(H, "h", &h)]);
    // No way out of it, either.
    assert_eq!(refusal(&cycle, F), "recursion: g > h > g");
    let itself = [&[PUSH_R4_LR][..], &call(F + 2, F), &[POP_R4_PC]].concat();
    assert_eq!(
        refusal(&program(&[code(F, "f", &itself)]), F),
        "recursion: f > f"
    );
}

#[test]
fn a_call_into_the_middle_of_a_function_is_refused() {
    let f = [&[PUSH_R4_LR][..], &call(F + 2, G + 2), &[POP_R4_PC]].concat();
    let program = program(&[code(F, "f", &f), code(G, "g", &[NOP, BX_LR])]);
    let said = refusal(&program, F);
    assert!(
        said.contains("it goes to g+0x2 (0x08000202), where no function begins"),
        "{said}"
    );
    assert!(walk(&program, &BTreeSet::new(), F).is_err());
}
