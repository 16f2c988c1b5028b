//! An image as a program: its functions, its constants, where code ends and data begins.

use super::instruction::Instruction;
use super::thumb;
use crate::elf::Elf;
use anyhow::{Context, Result, ensure};
use object::elf::{EF_ARM_ABI_FLOAT_HARD, SHF_ALLOC, SHF_EXECINSTR, SHF_WRITE};
use object::read::elf::{FileHeader, SectionHeader};
use object::{Endianness, Object, ObjectSection, ObjectSymbol, SymbolKind};
use std::collections::BTreeMap;
use std::ops::Range;

/// Name prefix that the compiler's outliner gives to pieces that it finds in several functions.
const OUTLINED: &str = "OUTLINED_FUNCTION_";

/// Code from its entry to where the next begins.
#[derive(Clone, Debug)]
pub(crate) struct Function {
    pub(crate) end: u32,
    /// As in the source; functions that are the same may share their code.
    pub(crate) names: Vec<String>,
}

impl Function {
    /// A piece of other functions, which keeps to no calling convention.
    pub(crate) fn is_outlined(&self) -> bool {
        self.names.iter().any(|name| name.starts_with(OUTLINED))
    }
}

/// A program for a Cortex-M.
#[derive(Clone, Debug, Default)]
pub(crate) struct Program {
    /// By address.
    pub(crate) functions: BTreeMap<u32, Function>,
    /// Data that does not change: addresses and bytes.
    pub(crate) constants: Vec<(u32, Vec<u8>)>,
    /// Addresses where code begins (true) and where data between it begins (false).
    pub(crate) marks: BTreeMap<u32, bool>,
    /// The entries of the vector table, from the first stack pointer on.
    pub(crate) vectors: Vec<u32>,
    /// Address range in which the stack must stay, if the linker script gives one.
    pub(crate) stack: Option<Range<u32>>,
    /// It passes floats in the registers of a floating-point unit.
    pub(crate) has_floats: bool,
}

impl Program {
    pub(crate) fn read(elf: &Elf) -> Result<Self> {
        let flags = elf.elf_header().e_flags(Endianness::Little);
        let mut program = Self {
            has_floats: flags.0 & EF_ARM_ABI_FLOAT_HARD != 0,
            ..Self::default()
        };
        let mut code = Vec::new();
        for section in elf.sections() {
            let flags = section.elf_section_header().sh_flags(Endianness::Little);
            let start = u32::try_from(section.address())?;
            if flags.contains(SHF_ALLOC) && !flags.contains(SHF_WRITE) && section.size() > 0 {
                program.constants.push((start, section.data()?.to_vec()));
            }
            if flags.contains(SHF_EXECINSTR) && section.size() > 0 {
                code.push(start..start + u32::try_from(section.size())?);
            }
            if section.name() == Ok(".vector_table") {
                let words = section.data()?.as_chunks::<4>().0;
                program.vectors = words.iter().map(|word| u32::from_le_bytes(*word)).collect();
            }
        }
        let (mut bottom, mut top) = (None, None);
        for symbol in elf.symbols() {
            let (name, address) = (symbol.name()?, u32::try_from(symbol.address())?);
            let is_code = code.iter().any(|range| range.contains(&(address & !1)));
            match (name.get(..2), symbol.kind()) {
                (Some("$t" | "$a"), _) => _ = program.marks.insert(address, true),
                (Some("$d"), _) => _ = program.marks.insert(address, false),
                (_, SymbolKind::Text) if is_code => {
                    let name = format!("{:#}", rustc_demangle::demangle(name));
                    let end = (address & !1) + u32::try_from(symbol.size())?;
                    program.add(address & !1, end, name);
                }
                _ => {}
            }
            match name {
                "_stack_start" => top = Some(address),
                "_stack_end" => bottom = Some(address),
                _ => {}
            }
        }
        program.stack = bottom.zip(top).map(|(bottom, top)| bottom..top);
        // Those written in assembly may have no size: they end where the next begins.
        let starts: Vec<u32> = program.functions.keys().copied().collect();
        for (nth, (start, function)) in program.functions.iter_mut().enumerate() {
            let section = code.iter().find(|range| range.contains(start));
            let last = section.map_or(*start, |range| range.end);
            let next = starts.get(nth + 1).map_or(last, |next| last.min(*next));
            if function.end == *start {
                function.end = next;
            }
            ensure!(
                function.end <= next,
                "{} overlaps another",
                function.names[0]
            );
        }
        Ok(program)
    }

    fn add(&mut self, start: u32, end: u32, name: String) {
        let function = self.functions.entry(start).or_insert(Function {
            end,
            names: Vec::new(),
        });
        function.end = function.end.max(end);
        function.names.push(name);
    }

    /// The address of the function called `name`.
    pub(crate) fn named(&self, name: &str) -> Option<u32> {
        let is_named = |function: &&Function| function.names.iter().any(|other| other == name);
        let mut functions = self.functions.iter();
        functions
            .find(|(_, function)| is_named(function))
            .map(|(address, _)| *address)
    }

    pub(crate) fn stack(&self) -> Result<Range<u32>> {
        let stack = self.stack.clone();
        stack.context("no _stack_start and _stack_end")
    }

    /// Returns the function at `address` and the offset in it, as text.
    pub(crate) fn place(&self, address: u32) -> String {
        match self.functions.range(..=address).next_back() {
            Some((start, function)) if *start == address => function.names[0].clone(),
            Some((start, function)) if address < function.end => {
                format!(
                    "{}+{:#x} ({address:#010x})",
                    function.names[0],
                    address - start
                )
            }
            _ => format!("{address:#010x}"),
        }
    }

    /// Returns true if there is code at `address`, and not data between it.
    pub(crate) fn is_code(&self, address: u32) -> bool {
        let mark = self.marks.range(..=address).next_back();
        mark.is_some_and(|(_, is_code)| *is_code)
    }

    /// Returns true if an instruction begins at `address`, counted from where the code around it begins.
    pub(crate) fn begins_instruction(&self, address: u32) -> bool {
        let Some((start, true)) = self.marks.range(..=address).next_back() else {
            return false;
        };
        let mut at = *start;
        while at < address {
            // Those of two halfwords begin with 0b11101, 0b11110 or 0b11111.
            let is_long = self.halfword(at).is_some_and(|word| word >> 11 >= 0b11101);
            at += if is_long { 4 } else { 2 };
        }
        at == address
    }

    /// The constant bytes from here on.
    fn bytes<const N: usize>(&self, address: u32) -> Option<[u8; N]> {
        self.constants.iter().find_map(|(start, bytes)| {
            let offset = address.checked_sub(*start)? as usize;
            bytes.get(offset..)?.first_chunk().copied()
        })
    }

    pub(crate) fn byte(&self, address: u32) -> Option<u32> {
        self.bytes(address).map(|[byte]| byte.into())
    }

    pub(crate) fn halfword(&self, address: u32) -> Option<u16> {
        self.bytes(address).map(u16::from_le_bytes)
    }

    pub(crate) fn word(&self, address: u32) -> Option<u32> {
        self.bytes(address).map(u32::from_le_bytes)
    }

    /// The instruction here.
    pub(crate) fn instruction(&self, address: u32) -> Result<Instruction> {
        let place = || self.place(address);
        ensure!(self.is_code(address), "{}: no code", place());
        let first = self.halfword(address).with_context(place)?;
        let second = self.halfword(address.wrapping_add(2));
        thumb::decode(address, first, second).with_context(|| match second {
            Some(second) => format!("{}: {first:04x} {second:04x} is not understood", place()),
            None => format!("{}: {first:04x} is not understood", place()),
        })
    }
}
