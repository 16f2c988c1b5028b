//! Cycles of a sequence of executed instructions, by class.

use super::flash::FlashState;
use super::operation::{Kind, Operation};
use super::timing::{FLOAT_DIVIDE, Timing};
use super::trace::Executed;
use crate::callgraph::program::Program;
use anyhow::{Context, Result};
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::ops::AddAssign;

/// First address that is not in the memory of code.
const CODE_END: u32 = 0x2000_0000;

/// Classes that cycles are counted in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Classes {
    /// Sums, products, comparisons and conversions of the FPU, and its moves.
    pub(super) float: u64,
    /// Divisions and square roots.
    pub(super) divide: u64,
    /// Products of integers.
    pub(super) multiply: u64,
    pub(super) integer: u64,
    /// Single loads.
    pub(super) load: u64,
    /// Single stores.
    pub(super) store: u64,
    /// Loads and stores of several words.
    pub(super) multiple: u64,
    /// Branches, `it`, and the refills of the pipeline.
    pub(super) branch: u64,
    /// Cycles in which a result is waited for.
    pub(super) stall: u64,
    /// Cycles in which the flash is waited for.
    pub(super) flash: u64,
}

impl Classes {
    pub(super) fn total(&self) -> u64 {
        self.float
            + self.divide
            + self.multiply
            + self.integer
            + self.load
            + self.store
            + self.multiple
            + self.branch
            + self.stall
            + self.flash
    }

    /// The class of an operation's own cycles.
    fn of(&mut self, kind: Kind) -> &mut u64 {
        match kind {
            Kind::Integer | Kind::Special => &mut self.integer,
            Kind::Multiply | Kind::MultiplyAdd | Kind::LongMultiply | Kind::LongMultiplyAdd => {
                &mut self.multiply
            }
            Kind::Divide | Kind::FloatDivide => &mut self.divide,
            Kind::Load | Kind::FloatLoad(_) => &mut self.load,
            Kind::Store(_) | Kind::FloatStore(_) => &mut self.store,
            Kind::LoadMany(_)
            | Kind::StoreMany(_)
            | Kind::FloatLoadMany(_)
            | Kind::FloatStoreMany(_) => &mut self.multiple,
            Kind::Branch
            | Kind::Call
            | Kind::CallRegister
            | Kind::JumpRegister
            | Kind::TableBranch
            | Kind::If => &mut self.branch,
            Kind::Float | Kind::FloatMove(_) | Kind::FloatMultiplyAdd => &mut self.float,
        }
    }
}

impl AddAssign for Classes {
    fn add_assign(&mut self, other: Self) {
        self.float += other.float;
        self.divide += other.divide;
        self.multiply += other.multiply;
        self.integer += other.integer;
        self.load += other.load;
        self.store += other.store;
        self.multiple += other.multiple;
        self.branch += other.branch;
        self.stall += other.stall;
        self.flash += other.flash;
    }
}

/// A processor that executes what was traced.
pub(super) struct Processor {
    timing: Timing,
    /// None: code and constants are in a memory without wait states.
    flash: Option<FlashState>,
    now: u64,
    /// Cycle from which the divider of the FPU is free.
    divider_free: u64,
    previous: Option<Operation>,
}

impl Processor {
    pub(super) fn new(timing: Timing, flash: Option<FlashState>) -> Self {
        Self {
            timing,
            flash,
            now: 0,
            divider_free: 0,
            previous: None,
        }
    }

    /// Forgets what the caches hold.
    pub(super) fn empty_caches(&mut self) {
        if let Some(flash) = &mut self.flash {
            flash.empty();
        }
    }

    /// Cycles of a call, from its first instruction to the end of its last.
    pub(super) fn run(&mut self, executed: &[Executed], operations: &[Operation]) -> Classes {
        let mut classes = Classes::default();
        for (nth, (this, operation)) in executed.iter().zip(operations).enumerate() {
            let behind = this.address() + operation.instruction.length;
            // The last one returns.
            let next = executed.get(nth + 1);
            let leaves = next.is_none_or(|next| next.address() != behind);
            classes += self.step(this, *operation, leaves);
        }
        // What the divider still has to do belongs to this call.
        let rest = self.divider_free.saturating_sub(self.now);
        classes.divide += rest;
        self.now += rest;
        self.previous = None;
        classes
    }

    fn step(&mut self, executed: &Executed, operation: Operation, leaves: bool) -> Classes {
        let mut classes = Classes::default();
        let start = self.now;
        if let Some(flash) = &mut self.flash {
            let length = operation.instruction.length;
            classes.flash += flash.fetch(executed.address(), length, start);
        }
        if !executed.is_executed() {
            // An instruction whose condition does not hold.
            classes.integer += 1;
            self.previous = None;
            self.now += classes.total();
            return classes;
        }
        self.wait(&operation, &mut classes);
        let previous = self.previous.replace(operation);
        let kind = operation.kind;
        let own = match kind {
            // Integer operations go on beside the divider; the next of the FPU waits.
            Kind::FloatDivide => {
                self.divider_free = start + classes.total() + FLOAT_DIVIDE;
                1
            }
            _ => self.timing.cycles(kind) - self.overlap(previous.as_ref(), &operation),
        };
        *classes.of(kind) += own;
        if leaves {
            classes.branch += self.timing.refill(kind);
        }
        let access = operation.access.filter(|access| access.is_load);
        if let (Some(flash), Some(access)) = (&mut self.flash, access) {
            let address = access.address(&executed.registers);
            if address < CODE_END {
                let now = start + classes.total();
                classes.flash += flash.load(address, access.bytes, now);
            }
        }
        self.now += classes.total();
        classes
    }

    /// Adds the cycles that `operation` waits for the divider and for a result of the one before.
    fn wait(&self, operation: &Operation, classes: &mut Classes) {
        if operation.is_float() {
            let from = self.now + classes.total();
            classes.divide += self.divider_free.saturating_sub(from);
        }
        let Some(previous) = &self.previous else {
            return;
        };
        let is_arithmetic = matches!(
            previous.kind,
            Kind::Float | Kind::FloatMultiplyAdd | Kind::FloatDivide
        );
        if is_arithmetic && previous.float_writes & operation.float_reads != 0 {
            classes.stall += 1;
        }
        let is_result = matches!(
            previous.kind,
            Kind::Integer
                | Kind::Multiply
                | Kind::MultiplyAdd
                | Kind::LongMultiply
                | Kind::LongMultiplyAdd
                | Kind::Divide
        );
        if self.timing.overlaps_accesses && is_result && is_address(previous, operation) {
            classes.stall += 1;
        }
    }

    /// Cycles that a load or store spares because it follows a load.
    fn overlap(&self, previous: Option<&Operation>, operation: &Operation) -> u64 {
        let Some(previous) = previous else {
            return 0;
        };
        let follows = self.timing.overlaps_accesses
            && previous.kind == Kind::Load
            && matches!(operation.kind, Kind::Load | Kind::Store(false))
            && !is_address(previous, operation);
        u64::from(follows)
    }
}

/// Returns true if `operation` has a register in its address that `previous` has written.
fn is_address(previous: &Operation, operation: &Operation) -> bool {
    let written = previous.instruction.writes;
    let is_used = |access: super::operation::Access| {
        (0..13).any(|register| written.contains(register) && access.uses(register))
    };
    operation.access.is_some_and(is_used)
}

/// Decoded instructions of an image.
pub(super) struct Code<'a> {
    program: &'a Program,
    decoded: HashMap<u32, Operation>,
}

impl<'a> Code<'a> {
    pub(super) fn new(program: &'a Program) -> Self {
        Self {
            program,
            decoded: HashMap::new(),
        }
    }

    /// The instructions that were executed.
    pub(super) fn operations(&mut self, executed: &[Executed]) -> Result<Vec<Operation>> {
        let operations = executed.iter().map(|this| self.operation(this.address()));
        operations.collect()
    }

    fn operation(&mut self, address: u32) -> Result<Operation> {
        if let Some(operation) = self.decoded.get(&address) {
            return Ok(*operation);
        }
        let place = || self.program.place(address);
        let first = self.program.halfword(address).with_context(place)?;
        let second = self.program.halfword(address.wrapping_add(2));
        let operation = Operation::decode(address, first, second)
            .with_context(|| format!("{}: {first:04x} {second:04x?} has no timing", place()))?;
        self.decoded.insert(address, operation);
        Ok(operation)
    }
}
