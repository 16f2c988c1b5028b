//! Proofs from the code of an image: how deep its stack gets at most, and that no interrupt panics.
//!
//! Read is the very ELF that is flashed. Each function is walked along every way through it, with
//! what is known of its registers: what constants they hold, and what places on the stack. So a call by way of
//! a register is a call like another where the compiler has put an address there (for size it does that
//! often), and where it is not, or where an instruction, a jump or a change of the stack pointer
//! is not understood, it is an error that names the place. The same goes for recursion. Nothing is skipped, and
//! nothing taken for granted but three things: the symbols say where functions begin and end, and where data
//! lies between code; functions keep to the calling convention (pieces that the compiler has outlined do
//! not, and are walked as a part of each caller); the flash keeps what was written to it.
//!
//! **Stack.** Most is taken where a program is at its deepest, an interrupt comes, at its deepest the next one,
//! and so on: each handler of the vector table once, whatever its priority, for none interrupts itself. With
//! each comes the frame that the processor saves, the floating-point registers included where there are
//! any. A handler that ends the program for good, by starting at the stack's top again, counts as its frame.
//! An exception with no handler of its own ends in the default one, that of a hard fault; it counts once.
//!
//! **Panics.** From no handler of an interrupt or exception can a function of `core::panicking` be
//! reached, nor the panic handler, nor an instruction that faults on purpose.
//!
//! Why not from the debug information: what it says of frames ends at the frame pointer, and the compiler keeps
//! one. Why no disassembler: that of yaxpeax-arm knows no floating-point instruction, which every
//! function here may have; what has to be known of each is where it goes, what it does to the stack and which
//! registers it changes, and that is three small files.

mod condition;
#[cfg(test)]
mod encodings;
pub(crate) mod fields;
mod graph;
pub(crate) mod instruction;
mod memory;
pub(crate) mod program;
mod state;
#[cfg(test)]
mod tests;
pub(crate) mod thumb;
mod walk;
mod wide;

use crate::elf::{Elf, with_elf};
use anyhow::{Context, Result, bail, ensure};
use graph::{Graph, names};
use program::Program;
use std::collections::BTreeSet;
use std::fmt::Write;
use std::ops::Range;
use std::path::{Path, PathBuf};

#[derive(clap::Args)]
pub(crate) struct StackArgs {
    /// An image, such as target/thumbv7em-none-eabihf/device/trirrr-firmware
    image: PathBuf,
}

/// An image's stack, bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Stack {
    /// Most that it takes.
    pub(crate) most: u32,
    /// Room that it has.
    pub(crate) room: u32,
}

/// Parts of the names of functions that panic. All of them end in the handler, which is the second.
const PANICS: [&str; 2] = ["core::panicking::", "rust_begin_unwind"];

/// Entries of the vector table: the program's start, and the tick.
const RESET: usize = 1;
const TICK: usize = 15;

/// Bytes that a processor saves for a handler: eight words, and one to align them; with floating point
/// eighteen more (ARMv7-M Architecture Reference Manual, B1.5.7).
const FRAME: i32 = 4 * (8 + 1);
const FLOATS: i32 = 4 * 18;

/// The stack of the image in `file`.
///
/// # Errors
/// Code that is not understood; recursion; less room than the stack takes; a way from an interrupt to a panic.
pub(crate) fn check(file: &Path) -> Result<Stack> {
    with_elf(file, check_elf)
}

/// The same of an image that is read already.
pub(crate) fn check_elf(elf: &Elf) -> Result<Stack> {
    let program = Program::read(elf)?;
    let image = Image::new(&program)?;
    image.check_panics()?;
    image.stack()
}

/// Returns the addresses of the stack of the image in `file`.
pub(crate) fn place(file: &Path) -> Result<Range<u32>> {
    with_elf(file, |elf| Program::read(elf)?.stack())
}

/// `cargo xtask stack`: the ways on which the stack gets deepest.
pub(crate) fn run(arguments: &StackArgs) -> Result<()> {
    let program = with_elf(&arguments.image, Program::read)?;
    let image = Image::new(&program)?;
    print!("{}", image.ways());
    let Stack { most, room } = image.stack()?;
    println!("all together, each with its frame: {most} of {room} bytes");
    image.check_panics()
}

/// An image, walked through from its vector table.
struct Image<'a> {
    program: &'a Program,
    graph: Graph,
    reset: u32,
    /// Other entries of the table, each once.
    handlers: BTreeSet<u32>,
}

impl<'a> Image<'a> {
    fn new(program: &'a Program) -> Result<Self> {
        let handlers = program
            .vectors
            .iter()
            .skip(RESET + 1)
            .map(|vector| vector & !1);
        let handlers: BTreeSet<u32> = handlers.filter(|handler| *handler != 0).collect();
        let reset = program.vectors.get(RESET).context("no reset handler")? & !1;
        let mut entries = handlers.clone();
        entries.insert(reset);
        let graph = Graph::from(program, &entries)?;
        // A stack that starts anew is the last: nothing comes back to what it was.
        let restarts = graph.bodies.iter().find(|(function, body)| {
            body.restarts && (body.returns || !handlers.contains(function))
        });
        if let Some((function, _)) = restarts {
            bail!(
                "{} starts the stack anew, and is no last handler",
                program.place(*function)
            );
        }
        Ok(Self {
            program,
            graph,
            reset,
            handlers,
        })
    }

    fn stack(&self) -> Result<Stack> {
        let frame = match self.program.has_floats {
            true => FRAME + FLOATS,
            false => FRAME,
        };
        let mut most = self.graph.depth(self.reset);
        let mut anew = 0;
        for handler in &self.handlers {
            let depth = self.graph.depth(*handler);
            most += frame;
            match self.graph.bodies[handler].restarts {
                true => anew = anew.max(depth),
                false => most += depth,
            }
        }
        let place = self.program.stack()?;
        let stack = Stack {
            most: u32::try_from(most.max(anew))?,
            room: place.end - place.start,
        };
        ensure!(
            stack.most <= stack.room,
            "the stack takes {} bytes at most and has {}:\n{}",
            stack.most,
            stack.room,
            self.ways()
        );
        Ok(stack)
    }

    /// The way on which each handler is at its deepest, in words.
    fn ways(&self) -> String {
        let mut text = String::new();
        for entry in [&self.reset].into_iter().chain(&self.handlers) {
            let _ = writeln!(
                text,
                "{}: {} bytes",
                self.program.place(*entry),
                self.graph.depth(*entry)
            );
            for (function, bytes) in self.graph.deepest(*entry) {
                let _ = writeln!(text, "{bytes:>8}  {}", self.program.place(function));
            }
        }
        text
    }

    /// Checks that no handler can panic.
    fn check_panics(&self) -> Result<()> {
        // Identical functions may be one: then it has the names of all.
        let is_named = |function: u32, name: &str| {
            let function = self.program.functions.get(&function);
            let mut names = function.into_iter().flat_map(|function| &function.names);
            names.any(|of_function| of_function.contains(name))
        };
        let is_panic = |function: u32| PANICS.iter().any(|name| is_named(function, name));
        // Without one, or without a tick, there would be nothing to find. An image without a host has no place that may panic.
        let functions = self.graph.bodies.keys();
        let is_alone = functions
            .clone()
            .any(|function| is_named(*function, "::own_job::"));
        ensure!(
            is_alone || functions.clone().any(|function| is_panic(*function)),
            "no function has the name of a panic: {}",
            PANICS.join(", ")
        );
        let tick = self.program.vectors.get(TICK);
        ensure!(
            tick.is_some_and(|tick| is_named(tick & !1, "SysTick")),
            "the tick is not in the vector table"
        );
        for handler in &self.handlers {
            let panics = |function, body: &walk::Body| body.traps || is_panic(function);
            if let Some(way) = self.graph.way(*handler, panics) {
                bail!("a handler may panic: {}", names(self.program, &way));
            }
        }
        Ok(())
    }
}
