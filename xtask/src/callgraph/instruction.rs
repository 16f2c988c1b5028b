//! Effects of a Thumb instruction on the stack and on calls.

/// Numbers of core registers.
pub(crate) type Register = u8;
pub(crate) const SP: Register = 13;
pub(crate) const LR: Register = 14;
pub(crate) const PC: Register = 15;

/// Core registers: bit n is register n.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Registers(pub(super) u16);

impl Registers {
    pub(crate) const NONE: Self = Self(0);

    pub(crate) fn one(register: Register) -> Self {
        Self(1 << register)
    }

    pub(crate) fn contains(self, register: Register) -> bool {
        self.0 & (1 << register) != 0
    }

    pub(crate) fn with(self, register: Register) -> Self {
        Self(self.0 | 1 << register)
    }

    /// The lowest of them, if there are any.
    pub(crate) fn first(self) -> Register {
        self.0.trailing_zeros() as Register
    }

    /// Bytes of all of them on the stack.
    pub(crate) fn bytes(self) -> i32 {
        4 * self.0.count_ones() as i32
    }
}

/// Way in which the program goes on after an instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Flow {
    Next,
    Branch(u32),
    /// There or on.
    BranchIf(u32),
    Call(u32),
    CallRegister(Register),
    /// `bx lr` is a return.
    JumpRegister(Register),
    /// To the address that it loads from the stack.
    Return,
    /// `tbb` and `tbh`: ahead by twice an entry of the table behind it, whose entries have so many bytes.
    Table(u32),
    /// The same, of a table at the address that a register holds.
    TableAt(Register, u32),
    /// `add pc, r`: ahead by a register's value.
    Ahead(Register),
    /// The next instructions depend on a condition: so many, and which (bit n: the nth) are executed
    /// where it holds, the others where it does not.
    If {
        condition: u8,
        count: u8,
        then: u8,
    },
    /// It ends in a fault, on purpose.
    Trap,
}

/// Change of the stack pointer by an instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stack {
    Same,
    /// Bytes that are taken; negative: that are given back.
    Takes(i32),
    /// It becomes a register's value plus this.
    Becomes(Register, i32),
    /// A register's value is added to it.
    Adds(Register),
}

/// New value of a register, where that may be a constant or a place on the stack.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Value {
    /// Nothing that is followed.
    Other,
    Constant(u32),
    /// A register's value plus this.
    Of(Register, i32),
    /// The upper half, by `movt`.
    Upper(u16),
    /// This, plus what the register held.
    From(u32),
    /// Twice a register's value.
    Double(Register),
    /// The word at this address.
    Literal(u32),
    /// So many bytes at a register's value plus this.
    Load(Register, i32, u32),
    /// So many bytes at the sum of two registers' values.
    Element(Register, Register, u32),
}

/// An instruction, as far as it matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Instruction {
    /// Bytes: 2 or 4.
    pub(crate) length: u32,
    pub(crate) flow: Flow,
    pub(crate) stack: Stack,
    /// The registers that it changes, without sp and pc.
    pub(crate) writes: Registers,
    /// Value that the instruction gives to the one register that it writes.
    pub(crate) value: Value,
    /// True if the instruction depends on a condition and still changes the flags that conditions test.
    /// (Most instructions of 16 bits that depend on no condition change them, too.)
    pub(crate) compares: bool,
}

impl Instruction {
    /// One that is nothing but a change of these registers.
    pub(crate) fn writing(length: u32, writes: Registers) -> Self {
        Self {
            length,
            flow: Flow::Next,
            stack: Stack::Same,
            writes,
            value: Value::Other,
            compares: false,
        }
    }

    pub(crate) fn plain(length: u32) -> Self {
        Self::writing(length, Registers::NONE)
    }

    pub(crate) fn going(length: u32, flow: Flow) -> Self {
        Self {
            flow,
            ..Self::plain(length)
        }
    }

    pub(crate) fn comparing(length: u32) -> Self {
        Self {
            compares: true,
            ..Self::plain(length)
        }
    }

    pub(crate) fn taking(length: u32, bytes: i32) -> Self {
        Self {
            stack: Stack::Takes(bytes),
            ..Self::plain(length)
        }
    }

    pub(crate) fn giving(length: u32, register: Register, value: Value) -> Self {
        Self {
            value,
            ..Self::writing(length, Registers::one(register))
        }
    }
}
