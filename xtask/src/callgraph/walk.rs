//! A function, walked from its entry along every way through it: how deep the stack gets, and which
//! functions it calls at which depth.

use super::condition::Condition;
use super::instruction::{Flow, LR, Value};
use super::program::Program;
use super::state::{Facts, Known};
use anyhow::{Context, Result, bail, ensure};
use std::collections::{BTreeMap, BTreeSet};

/// A call, or a jump to another function.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Call {
    /// The callee's entry.
    pub(super) to: u32,
    /// Bytes that the stack has grown by until there.
    pub(super) depth: i32,
}

/// Effects of a function: its use of the stack, its calls and its ends.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Body {
    /// Bytes of stack that it takes itself.
    pub(super) depth: i32,
    pub(super) calls: BTreeSet<Call>,
    pub(super) returns: bool,
    /// It ends in a fault on purpose, somewhere.
    pub(super) traps: bool,
    /// It puts the stack at its very top, before it takes any.
    pub(super) restarts: bool,
}

/// An instruction, and what it is under.
type Node = (u32, Condition);

/// Walks through the function at `entry`; `returning`: the functions that return, as far as is known.
///
/// # Errors
/// An instruction, a jump, or what becomes of the stack, that is not understood; with its place.
pub(super) fn walk(program: &Program, returning: &BTreeSet<u32>, entry: u32) -> Result<Body> {
    let mut walk = Walk::new(program, returning, entry);
    walk.all(Facts::entry())?;
    if let Some(exit) = walk.exit {
        ensure!(
            exit.depth == 0,
            "{} returns with the stack {} bytes deep",
            program.place(entry),
            exit.depth
        );
        walk.body.returns = true;
    }
    Ok(walk.body)
}

struct Walk<'a> {
    program: &'a Program,
    returning: &'a BTreeSet<u32>,
    entry: u32,
    body: Body,
    /// State known where the function returns.
    exit: Option<Facts>,
}

impl<'a> Walk<'a> {
    fn new(program: &'a Program, returning: &'a BTreeSet<u32>, entry: u32) -> Self {
        Self {
            program,
            returning,
            entry,
            body: Body::default(),
            exit: None,
        }
    }

    /// Every way, until nothing new becomes known; then each instruction once more, for what it says of the
    /// function.
    fn all(&mut self, state: Facts) -> Result<()> {
        let begin = (self.entry, Condition::NONE);
        let mut known = BTreeMap::from([(begin, state)]);
        let mut open = vec![begin];
        while let Some(node) = open.pop() {
            let mut scratch = Self::new(self.program, self.returning, self.entry);
            for (next, state) in scratch.step(node, &known[&node])? {
                let is_new = match known.get_mut(&next) {
                    Some(before) => before
                        .meet(&state)
                        .with_context(|| self.program.place(next.0))?,
                    None => known.insert(next, state).is_none(),
                };
                if is_new {
                    open.push(next);
                }
            }
        }
        for (node, state) in &known {
            self.step(*node, state)?;
        }
        Ok(())
    }

    /// Returns the nodes behind an instruction in this function, with the state known at each.
    fn step(&mut self, node: Node, state: &Facts) -> Result<Vec<(Node, Facts)>> {
        self.execute(node, state.clone())
            .with_context(|| self.program.place(node.0))
    }

    fn execute(&mut self, node: Node, mut state: Facts) -> Result<Vec<(Node, Facts)>> {
        let (address, condition) = node;
        let instruction = self.program.instruction(address)?;
        let next = address + instruction.length;
        if condition.skips() {
            return Ok(vec![((next, condition.rest()), state)]);
        }
        self.body.restarts |= state.apply(&instruction, self.program)?;
        self.body.depth = self.body.depth.max(state.depth);
        let to = match instruction.flow {
            Flow::Next => {
                let conditions = condition.after(instruction.compares);
                return Ok(behind(next, &conditions, &state));
            }
            Flow::If {
                condition: on,
                count,
                then,
            } => return Ok(behind(next, &condition.of(on, count, then), &state)),
            // Cores without a far branch call what is far away in the same function.
            Flow::Call(to) if to != self.entry && self.is_inside(to) => {
                state = state.after_call();
                vec![to]
            }
            Flow::Call(to) => return self.call(to, next, state),
            Flow::CallRegister(register) => match state.get(register) {
                Known::Constant(to) => return self.call(to & !1, next, state),
                Known::OneOf(constants) => {
                    let mut behind = Vec::new();
                    for to in constants.iter() {
                        behind.extend(self.call(to & !1, next, state.clone())?);
                    }
                    return Ok(behind);
                }
                _ => bail!("it calls what r{register} holds, and nothing here tells what that is"),
            },
            Flow::Branch(to) => vec![to],
            Flow::BranchIf(to) => vec![to, next],
            Flow::JumpRegister(LR) | Flow::Return => {
                self.leave(state)?;
                return Ok(Vec::new());
            }
            Flow::JumpRegister(register) => match state.get(register) {
                Known::Constant(to) => vec![to & !1],
                Known::Entry(table, 4) => self.table(table, 4, |word| word & !1)?,
                _ => bail!("it jumps to where r{register} says, and nothing here tells where"),
            },
            Flow::Table(size) => self.table(next, size, |distance| next + 2 * distance)?,
            Flow::TableAt(register, size) => match state.get(register) {
                Known::Constant(table) => {
                    self.table(table, size, |distance| next + 2 * distance)?
                }
                _ => bail!("its table is where r{register} says, and nothing here tells where"),
            },
            Flow::Ahead(register) => match state.get(register) {
                Known::TwiceEntry(table, size) => {
                    self.table(table, size, |distance| address + 4 + 2 * distance)?
                }
                _ => bail!("it jumps ahead by r{register}, and nothing here tells how far"),
            },
            Flow::Trap => {
                self.body.traps = true;
                return Ok(Vec::new());
            }
        };
        self.jump(&to, &state)
    }

    fn is_inside(&self, address: u32) -> bool {
        let function = self.program.functions.get(&self.entry);
        function.is_some_and(|function| (self.entry..function.end).contains(&address))
    }

    /// Returns the addresses of the constants that the function loads.
    fn literals(&self) -> BTreeSet<u32> {
        let function = self.program.functions.get(&self.entry);
        let end = function.map_or(self.entry, |function| function.end);
        let mut literals = BTreeSet::new();
        let mut at = self.entry;
        while at < end {
            let instruction = match self.program.is_code(at) {
                true => self.program.instruction(at).ok(),
                false => None,
            };
            if let Some(Value::Literal(address)) = instruction.as_ref().map(|each| each.value) {
                literals.insert(address);
            }
            at += instruction.map_or(2, |each| each.length);
        }
        literals
    }

    /// Returns the targets of a table. It ends where code begins or a constant of the function, or where an entry leads to no code of
    /// this function. Entries read beyond its end make more ways, not less.
    fn table(&self, table: u32, size: u32, target: impl Fn(u32) -> u32) -> Result<Vec<u32>> {
        let literals = self.literals();
        let targets: Vec<u32> = (0..)
            .map(|nth| table + size * nth)
            .take_while(|at| !self.program.is_code(*at) && !literals.contains(&(at & !3)))
            .map_while(|at| match size {
                1 => self.program.byte(at),
                2 => self.program.halfword(at).map(u32::from),
                _ => self.program.word(at),
            })
            .map(target)
            .take_while(|to| self.is_inside(*to) && self.program.begins_instruction(*to))
            .collect();
        ensure!(!targets.is_empty(), "the table at {table:#010x} is empty");
        Ok(targets)
    }

    /// A call of `to`; what comes behind it, if it returns.
    fn call(&mut self, to: u32, next: u32, state: Facts) -> Result<Vec<(Node, Facts)>> {
        let after = match self.is_outlined(to)? {
            true => self.piece(to, state)?,
            false => {
                self.body.calls.insert(Call {
                    to,
                    depth: state.depth,
                });
                self.returning
                    .contains(&to)
                    .then_some(state)
                    .map(Facts::after_call)
            }
        };
        // Nothing depends on a condition any more: a call is the last in its block.
        Ok(after.map_or(Vec::new(), |state| vec![((next, Condition::NONE), state)]))
    }

    /// Jumps to where `targets` says, in this function or to others, which then return for it.
    fn jump(&mut self, targets: &[u32], state: &Facts) -> Result<Vec<(Node, Facts)>> {
        let mut inside = Vec::new();
        for to in targets {
            if self.is_inside(*to) {
                inside.push(((*to, Condition::NONE), state.clone()));
            } else if self.is_outlined(*to)? {
                if let Some(exit) = self.piece(*to, state.clone())? {
                    self.leave(exit)?;
                }
            } else {
                self.body.calls.insert(Call {
                    to: *to,
                    depth: state.depth,
                });
                if self.returning.contains(to) {
                    self.leave(state.clone())?;
                }
            }
        }
        Ok(inside)
    }

    /// It returns from here.
    fn leave(&mut self, state: Facts) -> Result<()> {
        match &mut self.exit {
            Some(exit) => _ = exit.meet(&state)?,
            None => self.exit = Some(state),
        }
        Ok(())
    }

    /// Returns true if `entry` begins a piece of several functions that the compiler has put elsewhere.
    /// Such a piece keeps to no calling convention, so the walk takes it as a part of each.
    fn is_outlined(&self, entry: u32) -> Result<bool> {
        let function = self.program.functions.get(&entry).with_context(|| {
            format!(
                "it goes to {}, where no function begins",
                self.program.place(entry)
            )
        })?;
        Ok(function.is_outlined())
    }

    /// Walks through such a piece; what is known where it returns, if it does.
    fn piece(&mut self, entry: u32, state: Facts) -> Result<Option<Facts>> {
        let mut piece = Self::new(self.program, self.returning, entry);
        piece.all(state)?;
        let Body {
            depth,
            calls,
            traps,
            restarts,
            returns: _,
        } = piece.body;
        self.body.depth = self.body.depth.max(depth);
        self.body.calls.extend(calls);
        self.body.traps |= traps;
        self.body.restarts |= restarts;
        Ok(piece.exit)
    }
}

/// Behind an instruction, under each of these.
fn behind(next: u32, conditions: &[Condition], state: &Facts) -> Vec<(Node, Facts)> {
    conditions
        .iter()
        .map(|condition| ((next, *condition), state.clone()))
        .collect()
}
