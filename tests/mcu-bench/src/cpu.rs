//! The processor: the instructions by Unicorn, exceptions and time here.
//!
//! Unicorn executes Thumb-2 with the FPU, and takes no interrupt of a Cortex-M by itself. So exceptions are entered and left here
//! as the ARMv7-M reference manual says (B1.5): the frame on the stack, with the registers of the FPU where the context has any,
//! and a return by a jump to EXC_RETURN, on which Unicorn stops. A frame of the FPU is filled at once: a lazy one looks the same to
//! a program.
//!
//! Time goes on by blocks, sequences without a jump: each instruction counts [`CYCLES_PER_INSTRUCTION`], and an access
//! to a register comes at the end of its block. An interrupt that is due within a block has its time: what is left of the block
//! is executed before its handler, and takes its time after it. Only after a block that uses a register
//! the handler waits for its end.

use crate::chip::{Chip, Crystal, HARD_FAULT, ResetCause};
use crate::time::Time;
use crate::trace::Trace;
use anyhow::{Result, anyhow, bail, ensure};
use object::Endianness;
use object::elf::PT_LOAD;
use object::read::elf::{ElfFile32, ProgramHeader};
use std::fs;
use std::path::Path;
use unicorn_engine::{ArmCpuModel, HookType, Mode, Prot, RegisterARM, Unicorn};

/// Mean cycles of an instruction from flash; `docs/cycles.md` has from 1.4 in fixed point to 2.0 in f32.
pub(crate) const CYCLES_PER_INSTRUCTION: u64 = 2;

/// Cycles from an exception until its handler begins, and from its return on (Cortex-M4 technical reference manual, 3.9).
const ENTRY_CYCLES: u64 = 12;
/// More of them with the registers of the FPU.
const FPU_CYCLES: u64 = 17;

const FLASH: u64 = 0x0800_0000;
const FLASH_BYTES: u64 = 1024 * 1024;
const RAM: u64 = 0x2000_0000;
const RAM_BYTES: u64 = 128 * 1024;

/// Regions of registers: peripherals, their bits one by one, system, debug.
const REGISTERS: [(u64, u64); 4] = [
    (0x4000_0000, 0x8_0000),
    (0x4200_0000, 0x100_0000),
    (0xE000_E000, 0x1000),
    (0xE004_2000, 0x1000),
];

/// No address: the emulator runs until it is stopped.
const NEVER: u64 = u64::MAX;

/// Number that Unicorn gives a jump to EXC_RETURN.
const EXCEPTION_EXIT: u32 = 8;

/// Fault of the bus with a known address.
const PRECISE_BUS_FAULT: u32 = 1 << 9 | 1 << 15;
const FORCED: u32 = 1 << 30;

/// State of the processor that hooks see.
pub(crate) struct World {
    pub(crate) chip: Chip,
    /// Instructions of the block at a place in flash, and its bytes.
    blocks: Vec<(u16, u16)>,
    flash: Vec<u8>,
    /// The block that begins next is executed whatever is pending, or nothing would go on.
    must_go_on: bool,
    /// Begin of the block that was executed last.
    block_begin: Time,
    /// The block has used a register.
    accessed: bool,
    returns: bool,
    unhandled: Option<u32>,
    bad_address: Option<u32>,
    /// Most instructions of a block so far.
    longest_block: u16,
    instructions: u64,
}

impl World {
    /// Returns the number of instructions of a block.
    fn count(&mut self, address: u64, bytes: u32) -> u16 {
        let at = address.wrapping_sub(FLASH) as usize;
        let place = self.blocks.get_mut(at / 2);
        if let Some((instructions, of)) = place
            && u32::from(*of) == bytes
        {
            return *instructions;
        }
        let code = self.flash.get(at..at + bytes as usize).unwrap_or(&[]);
        let (mut next, mut count) = (0, 0);
        while let Some([low, high]) = code.get(next..next + 2) {
            let first = u16::from_le_bytes([*low, *high]) >> 11;
            next += if first >= 0b11101 { 4 } else { 2 };
            count += 1;
        }
        if let Some(place) = self.blocks.get_mut(at / 2) {
            *place = (count, bytes as u16);
        }
        self.longest_block = self.longest_block.max(count);
        count
    }
}

/// Handlers that the processor has begun and ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Handled {
    pub(crate) exception: u16,
    pub(crate) begin: Time,
    pub(crate) end: Time,
}

/// The board: a processor with a chip around it, and an image in its flash.
pub(crate) struct Board {
    uc: Unicorn<'static, World>,
    /// The processor has stopped for good, after a fault in the handler of faults.
    pub(crate) locked_up: bool,
    /// The clock of the core stands: its crystal died under the PLL.
    pub(crate) clock_stands: bool,
    /// Code does not go on: it is hung on purpose.
    pub(crate) hung: Option<Hang>,
    /// Handlers of the tick and of the slots, by their beginning.
    pub(crate) handled: Vec<Handled>,
    /// Handlers that are under way, with the time that the block before them still takes,
    begun: Vec<(u16, Time, Time)>,
    /// and those that a reset has cut off.
    cut_off: Vec<(u16, Time)>,
    /// Resets with their times.
    pub(crate) resets: Vec<(Time, ResetCause)>,
}

/// Part of the program that hangs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Hang {
    /// Handlers of the tick do not end.
    Tick,
    /// The background does not go on; interrupts do.
    Background,
}

fn failed(error: unicorn_engine::uc_error) -> anyhow::Error {
    anyhow!("the CPU emulator: {error:?}")
}

impl Board {
    /// Puts the image of `file` into the flash of a board and switches it on.
    pub(crate) fn switch_on(file: &Path, crystal: Crystal, oscillator_hz: u64) -> Result<Self> {
        let world = World {
            chip: Chip::new(crystal, oscillator_hz),
            blocks: vec![(0, 0); FLASH_BYTES as usize / 2],
            flash: load(file)?,
            must_go_on: true,
            block_begin: 0,
            accessed: false,
            returns: false,
            unhandled: None,
            bad_address: None,
            longest_block: 0,
            instructions: 0,
        };
        let mut uc = Unicorn::new_with_data(unicorn_engine::Arch::ARM, Mode::MCLASS, world)
            .map_err(failed)?;
        uc.ctl_set_cpu_model(ArmCpuModel::CORTEX_M4 as i32)
            .map_err(failed)?;
        set_up(&mut uc).map_err(failed)?;
        let mut board = Self {
            uc,
            locked_up: false,
            clock_stands: false,
            hung: None,
            handled: Vec::new(),
            begun: Vec::new(),
            cut_off: Vec::new(),
            resets: Vec::new(),
        };
        // RAM after power-on is noise, from a generator with a fixed seed.
        let mut state = 0x9E37_79B9_u32;
        let noise: Vec<u8> = (0..RAM_BYTES)
            .map(|_| {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                (state >> 24) as u8
            })
            .collect();
        board.uc.mem_write(RAM, &noise).map_err(failed)?;
        board.reset(ResetCause::Power)?;
        Ok(board)
    }

    pub(crate) fn chip(&mut self) -> &mut Chip {
        &mut self.uc.get_data_mut().chip
    }

    /// Returns the edges of the pins.
    pub(crate) fn trace(&self) -> &Trace {
        &self.uc.get_data().chip.trace
    }

    pub(crate) fn core_period(&self) -> Time {
        self.uc.get_data().chip.core_period()
    }

    /// Returns the time at which the handler of `exception` began last.
    pub(crate) fn last_begin(&self, exception: u16) -> Option<Time> {
        let handled = self
            .handled
            .iter()
            .map(|handled| (handled.exception, handled.begin));
        let cut_off = self.cut_off.iter().copied();
        let of = handled.chain(cut_off).filter(|(of, _)| *of == exception);
        of.map(|(_, begin)| begin).max()
    }

    /// Sends the program to an address.
    pub(crate) fn jump(&mut self, address: u32) -> Result<()> {
        self.put(RegisterARM::PC, address | 1)
    }

    pub(crate) fn now(&self) -> Time {
        self.uc.get_data().chip.now
    }

    /// Returns the instructions executed so far, and those of the longest block.
    pub(crate) fn work(&self) -> (u64, u16) {
        let world = self.uc.get_data();
        (world.instructions, world.longest_block)
    }

    /// Resets the chip and starts the program.
    pub(crate) fn reset(&mut self, cause: ResetCause) -> Result<()> {
        let chip = self.chip();
        chip.reset(cause);
        chip.interrupts.set_vectors(FLASH as u32);
        self.resets.push((self.now(), cause));
        let cut = self
            .begun
            .drain(..)
            .map(|(exception, begin, _)| (exception, begin));
        self.cut_off.extend(cut);
        self.locked_up = false;
        self.clock_stands = false;
        let (stack, entry) = (self.word(FLASH)?, self.word(FLASH + 4)?);
        for register in [
            RegisterARM::PRIMASK,
            RegisterARM::BASEPRI,
            RegisterARM::FAULTMASK,
            RegisterARM::CONTROL,
            RegisterARM::FPSCR,
        ] {
            self.put(register, 0)?;
        }
        self.set_status(1 << 24)?;
        self.put(RegisterARM::SP, stack)?;
        self.put(RegisterARM::LR, u32::MAX)?;
        self.put(RegisterARM::PC, entry)
    }

    /// Lets the board run until `end`.
    pub(crate) fn run(&mut self, end: Time) -> Result<()> {
        while self.now() < end {
            self.chip().advance();
            let chip = self.chip();
            if chip.watchdog.bite().is_some_and(|bite| bite <= chip.now) {
                self.reset(ResetCause::Watchdog)?;
                continue;
            }
            if std::mem::take(&mut chip.asks_for_reset) {
                self.reset(ResetCause::Software)?;
                continue;
            }
            if self.locked_up || self.clock_stands {
                // Nothing runs but the watchdog.
                let chip = self.chip();
                let bite = chip.watchdog.bite().unwrap_or(end);
                chip.now = bite.min(end).max(chip.now);
                continue;
            }
            self.take_interrupt()?;
            let stop = self.chip().next_event().unwrap_or(end).min(end);
            if self.is_hung() {
                let chip = self.chip();
                chip.now = stop.max(chip.now);
                continue;
            }
            self.execute(stop)?;
        }
        let chip = self.chip();
        chip.advance();
        Ok(())
    }

    /// Returns true if the code that would run now is hung on purpose.
    fn is_hung(&mut self) -> bool {
        let handled = self.chip().interrupts.handled();
        match self.hung {
            Some(Hang::Tick) => handled == crate::chip::SYS_TICK,
            Some(Hang::Background) => handled == 0,
            None => false,
        }
    }

    /// Enters the exception that is due, if the masks let it.
    fn take_interrupt(&mut self) -> Result<()> {
        let Some(exception) = self.chip().interrupts.due() else {
            return Ok(());
        };
        let base = self.get(RegisterARM::BASEPRI)?;
        let masked = self.get(RegisterARM::PRIMASK)? & 1 != 0
            || !self.chip().interrupts.passes(exception, base);
        match masked {
            true => Ok(()),
            false => self.enter(exception),
        }
    }

    /// Executes blocks until `stop`, or until something has to be looked at.
    fn execute(&mut self, stop: Time) -> Result<()> {
        let world = self.uc.get_data_mut();
        world.chip.stop_at = stop;
        world.must_go_on = true;
        let pc = u64::from(self.get(RegisterARM::PC)? | 1);
        let result = self.uc.emu_start(pc, NEVER, 0, 0);
        let world = self.uc.get_data_mut();
        if let Some(exception) = world.unhandled.take() {
            bail!(
                "exception {exception} of the CPU emulator at {:#010x}",
                self.get(RegisterARM::PC)?
            );
        }
        if std::mem::take(&mut world.returns) {
            return self.leave();
        }
        if result.is_err() {
            let address = self.uc.get_data_mut().bad_address.take();
            return self.fault(address);
        }
        Ok(())
    }

    /// Enters the handler of faults, for an access to `address`.
    fn fault(&mut self, address: Option<u32>) -> Result<()> {
        let interrupts = &mut self.chip().interrupts;
        if interrupts.is_in_hard_fault() {
            self.locked_up = true;
            return Ok(());
        }
        interrupts.hard_fault_status |= FORCED;
        if let Some(address) = address {
            interrupts.fault_status |= PRECISE_BUS_FAULT;
            interrupts.fault_address = address;
        }
        self.enter(HARD_FAULT)
    }

    /// Goes back to the time at which an interrupt was due within the last block. Returns what the block still takes.
    fn rewind(&mut self) -> Time {
        let World {
            chip,
            block_begin,
            accessed,
            ..
        } = self.uc.get_data_mut();
        let due = chip.stop_at.max(*block_begin);
        if *accessed || due >= chip.now {
            return 0;
        }
        let rest = chip.now - due;
        chip.now = due;
        rest
    }

    /// Enters an exception: the frame on the stack, the vector in the program counter.
    fn enter(&mut self, exception: u16) -> Result<()> {
        let rest = self.rewind();
        let status = self.get(RegisterARM::XPSR)?;
        let has_fpu = self.get(RegisterARM::CONTROL)? & 4 != 0;
        let sp = self.get(RegisterARM::SP)?;
        let bytes = if has_fpu { 104 } else { 32 };
        let aligned = sp.wrapping_sub(bytes) & !7;
        // Bit 9 tells of a word that was left out.
        let moved = u32::from(sp & 4 != 0) << 9;
        let mut frame = Vec::with_capacity(26);
        for register in [
            RegisterARM::R0,
            RegisterARM::R1,
            RegisterARM::R2,
            RegisterARM::R3,
            RegisterARM::R12,
            RegisterARM::LR,
            RegisterARM::PC,
        ] {
            frame.push(self.get(register)?);
        }
        frame.push(status & !(1 << 9) | moved | 1 << 24);
        if has_fpu {
            for index in 0..8 {
                let pair = self
                    .uc
                    .reg_read(RegisterARM::D0 as i32 + index)
                    .map_err(failed)?;
                frame.extend([pair as u32, (pair >> 32) as u32]);
            }
            frame.extend([self.get(RegisterARM::FPSCR)?, 0]);
        }
        let content: Vec<u8> = frame.iter().flat_map(|word| word.to_le_bytes()).collect();
        // A stack that has left the RAM: the frame is lost, and the handler of faults runs all the same.
        let exception = match self.uc.mem_write(u64::from(aligned), &content) {
            Ok(()) => exception,
            Err(_) if self.chip().interrupts.is_in_hard_fault() => {
                self.locked_up = true;
                return Ok(());
            }
            Err(_) => HARD_FAULT,
        };
        let handled = self.chip().interrupts.handled();
        // To the handler or the thread, without or with registers of the FPU.
        let back = if handled == 0 {
            0xFFFF_FFF9
        } else {
            0xFFFF_FFF1_u32
        };
        self.put(RegisterARM::SP, aligned)?;
        self.put(RegisterARM::LR, back & !(u32::from(has_fpu) << 4))?;
        self.put(RegisterARM::CONTROL, 0)?;
        self.set_status(status & 0xF80F_0000 | 1 << 24 | u32::from(exception))?;
        let interrupts = &mut self.chip().interrupts;
        interrupts.enter(exception);
        let vector = interrupts.vector(exception);
        let handler = self.word(u64::from(vector))?;
        self.put(RegisterARM::PC, handler)?;
        self.pass(has_fpu);
        let now = self.now();
        self.begun.push((exception, now, rest));
        Ok(())
    }

    /// Returns from an exception: EXC_RETURN is in the program counter.
    fn leave(&mut self) -> Result<()> {
        let back = self.get(RegisterARM::PC)? | 1;
        let has_fpu = back & 1 << 4 == 0;
        let sp = self.get(RegisterARM::SP)?;
        let mut content = vec![0; if has_fpu { 104 } else { 32 }];
        self.uc
            .mem_read(u64::from(sp), &mut content)
            .map_err(failed)?;
        let word = |index: usize| {
            let at = 4 * index;
            u32::from_le_bytes([
                content[at],
                content[at + 1],
                content[at + 2],
                content[at + 3],
            ])
        };
        let status = word(7);
        let left = self.chip().interrupts.leave();
        ensure!(
            left.is_some(),
            "a return from an exception that was not entered"
        );
        let next = u32::from(self.chip().interrupts.handled());
        ensure!(
            status & 0x1FF == next,
            "a return to exception {}, and {next} was preempted",
            status & 0x1FF
        );
        self.set_status(status)?;
        self.put(RegisterARM::CONTROL, u32::from(has_fpu) << 2)?;
        for (index, register) in [
            RegisterARM::R0,
            RegisterARM::R1,
            RegisterARM::R2,
            RegisterARM::R3,
            RegisterARM::R12,
            RegisterARM::LR,
        ]
        .into_iter()
        .enumerate()
        {
            self.put(register, word(index))?;
        }
        if has_fpu {
            for index in 0..8 {
                let at = 8 + 2 * index;
                let pair = u64::from(word(at)) | u64::from(word(at + 1)) << 32;
                let register = RegisterARM::D0 as i32 + index as i32;
                self.uc.reg_write(register, pair).map_err(failed)?;
            }
            self.put(RegisterARM::FPSCR, word(24))?;
        }
        let moved = (status >> 9 & 1) * 4;
        self.put(RegisterARM::SP, sp + content.len() as u32 + moved)?;
        self.put(RegisterARM::PC, word(6) | 1)?;
        self.pass(has_fpu);
        let end = self.now();
        if let Some((exception, begin, rest)) = self.begun.pop() {
            self.handled.push(Handled {
                exception,
                begin,
                end,
            });
            let world = self.uc.get_data_mut();
            world.chip.now += rest;
            // The next interrupt comes between blocks.
            world.accessed = true;
        }
        Ok(())
    }

    /// Lets the time of an entry or a return pass.
    fn pass(&mut self, has_fpu: bool) {
        let chip = self.chip();
        let cycles = ENTRY_CYCLES + if has_fpu { FPU_CYCLES } else { 0 };
        chip.now += cycles * chip.core_period();
    }

    /// Sets the status register, with the exception in it.
    fn set_status(&mut self, status: u32) -> Result<()> {
        self.put(RegisterARM::XPSR_NZCVQG, status)?;
        // The emulator derives its mode from the exception when the flags are written in this way.
        self.put(RegisterARM::APSR_NZCV, status & 0xF000_0000)
    }

    fn get(&self, register: RegisterARM) -> Result<u32> {
        let value = self.uc.reg_read(register as i32).map_err(failed)?;
        Ok(value as u32)
    }

    fn put(&mut self, register: RegisterARM, value: u32) -> Result<()> {
        self.uc
            .reg_write(register as i32, value.into())
            .map_err(failed)
    }

    fn word(&self, address: u64) -> Result<u32> {
        let mut word = [0; 4];
        self.uc.mem_read(address, &mut word).map_err(failed)?;
        Ok(u32::from_le_bytes(word))
    }
}

/// Maps memories and registers, and sets the hooks.
fn set_up(uc: &mut Unicorn<'static, World>) -> Result<(), unicorn_engine::uc_error> {
    uc.mem_map(FLASH, FLASH_BYTES, Prot::READ | Prot::EXEC)?;
    uc.mem_map(RAM, RAM_BYTES, Prot::READ | Prot::WRITE)?;
    let flash = uc.get_data().flash.clone();
    uc.mem_write(FLASH, &flash)?;
    for (start, bytes) in REGISTERS {
        uc.mmio_map(
            start,
            bytes,
            Some(
                move |uc: &mut Unicorn<'_, World>, offset: u64, size: usize| {
                    let World { chip, accessed, .. } = uc.get_data_mut();
                    *accessed = true;
                    chip.read((start + offset) as u32, size).into()
                },
            ),
            Some(
                move |uc: &mut Unicorn<'_, World>, offset: u64, size: usize, value: u64| {
                    let World { chip, accessed, .. } = uc.get_data_mut();
                    *accessed = true;
                    chip.write((start + offset) as u32, size, value as u32);
                },
            ),
        )?;
    }
    uc.add_block_hook(1, 0, |uc, address, bytes| {
        let world = uc.get_data_mut();
        let must = std::mem::take(&mut world.must_go_on);
        if !must && world.chip.now >= world.chip.stop_at {
            // An emulator that cannot be stopped goes on, and is looked at after the next block.
            let _ = uc.emu_stop();
            return;
        }
        let count = u64::from(world.count(address, bytes));
        world.instructions += count;
        world.block_begin = world.chip.now;
        world.accessed = false;
        world.chip.now += count * CYCLES_PER_INSTRUCTION * world.chip.core_period();
    })?;
    uc.add_intr_hook(|uc, exception| {
        let world = uc.get_data_mut();
        match exception {
            EXCEPTION_EXIT => world.returns = true,
            _ => world.unhandled = Some(exception),
        }
        let _ = uc.emu_stop();
    })?;
    uc.add_mem_hook(
        HookType::MEM_UNMAPPED | HookType::MEM_PROT,
        1,
        0,
        |uc, _, address, _, _| {
            uc.get_data_mut().bad_address = Some(address as u32);
            false
        },
    )?;
    Ok(())
}

/// Returns the content of the flash with the image of `file` in it.
fn load(file: &Path) -> Result<Vec<u8>> {
    let data = fs::read(file).map_err(|error| anyhow!("{}: {error}", file.display()))?;
    let elf = ElfFile32::<Endianness>::parse(&*data)
        .map_err(|error| anyhow!("{}: not a 32-bit ELF file: {error}", file.display()))?;
    // Erased flash is all ones.
    let mut flash = vec![0xFF; FLASH_BYTES as usize];
    for header in elf.elf_program_headers() {
        let endian = Endianness::Little;
        if header.p_type(endian) != PT_LOAD {
            continue;
        }
        let (at, bytes) = (
            u64::from(header.p_paddr(endian)),
            u64::from(header.p_filesz(endian)),
        );
        if bytes == 0 {
            continue;
        }
        let content = header.data(endian, &*data);
        let content = content.map_err(|()| anyhow!("{}: a segment is cut off", file.display()))?;
        let place = at.checked_sub(FLASH).and_then(|start| {
            let start = start as usize;
            flash.get_mut(start..start + content.len())
        });
        let Some(place) = place else {
            bail!(
                "{}: a segment at {at:#010x} is not in the flash",
                file.display()
            );
        };
        place.copy_from_slice(content);
    }
    Ok(flash)
}
