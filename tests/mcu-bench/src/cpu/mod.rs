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

mod exceptions;
mod flash;
mod world;

pub(crate) use flash::{address_of, load};

use crate::chip::{Chip, Crystal, Kind, NMI, RAM, RAM_BYTES, ResetCause};
use crate::time::Time;
use crate::trace::Trace;
use anyhow::{Result, anyhow, bail};
use std::collections::BTreeSet;
use std::path::Path;
use unicorn_engine::{ArmCpuModel, Mode, RegisterARM, Unicorn};
use world::{Masks, World};

/// Mean cycles of an instruction from flash; `docs/cycles.md` has from 1.4 in fixed point to 2.0 in f32.
pub(crate) const CYCLES_PER_INSTRUCTION: u64 = 2;

const FLASH: u64 = 0x0800_0000;
const FLASH_BYTES: u64 = 1024 * 1024;

/// Word with which the start of the program (cortex-m-rt) paints the stack.
const PAINT: [u8; 4] = [0xCC; 4];

/// No address: the emulator runs until it is stopped.
const NEVER: u64 = u64::MAX;

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
    /// A debugger holds the core.
    pub(crate) halted: bool,
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
    /// Double words of the flash that are or were lost.
    watched: BTreeSet<u32>,
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
    /// Puts the images of `files` into the flash of a board and switches it on.
    pub(crate) fn switch_on(
        kind: Kind,
        files: &[&Path],
        crystal: Crystal,
        oscillator_hz: u64,
    ) -> Result<Self> {
        let world = World {
            chip: Chip::new(kind, crystal, oscillator_hz),
            blocks: vec![(0, 0); FLASH_BYTES as usize / 2],
            flash: flash::load(files)?,
            must_go_on: true,
            block_begin: 0,
            accessed: false,
            returns: false,
            unhandled: None,
            bad_address: None,
            longest_block: 0,
            instructions: 0,
            masks: None,
        };
        let mut uc = Unicorn::new_with_data(unicorn_engine::Arch::ARM, Mode::MCLASS, world)
            .map_err(failed)?;
        uc.ctl_set_cpu_model(ArmCpuModel::CORTEX_M4 as i32)
            .map_err(failed)?;
        world::set_up(&mut uc).map_err(failed)?;
        let mut board = Self {
            uc,
            locked_up: false,
            halted: false,
            hung: None,
            handled: Vec::new(),
            begun: Vec::new(),
            cut_off: Vec::new(),
            resets: Vec::new(),
            watched: BTreeSet::new(),
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

    /// Inverts a bit of the flash, as a cell that is worn out does. A flash with check bits would correct it, so there it is one of several.
    pub(crate) fn damage(&mut self, address: u32) -> Result<()> {
        self.chip().flash.lose(address);
        self.watch_lost()?;
        let at = (u64::from(address) - FLASH) as usize;
        let byte = &mut self.uc.get_data_mut().flash[at];
        *byte ^= 1;
        let byte = *byte;
        self.uc.mem_write(address.into(), &[byte]).map_err(failed)
    }

    /// Lets the flash tell of double words that are lost.
    fn watch_lost(&mut self) -> Result<()> {
        let lost: Vec<u32> = self.chip().flash.lost().iter().copied().collect();
        for address in lost {
            if self.watched.insert(address) {
                world::watch_lost(&mut self.uc, address).map_err(failed)?;
            }
        }
        Ok(())
    }

    /// Returns bytes of the flash.
    pub(crate) fn flash(&self, start: u32, bytes: usize) -> &[u8] {
        let at = (u64::from(start) - FLASH) as usize;
        &self.uc.get_data().flash[at..at + bytes]
    }

    pub(crate) fn now(&self) -> Time {
        self.uc.get_data().chip.now
    }

    /// Returns the instructions executed so far, and those of the longest block.
    pub(crate) fn work(&self) -> (u64, u16) {
        let world = self.uc.get_data();
        (world.instructions, world.longest_block)
    }

    /// Returns the bytes at the end of the stack, which is the beginning of the RAM, that have kept their paint since the last start.
    pub(crate) fn painted_stack(&self) -> Result<usize> {
        let mut memory = vec![0; RAM_BYTES as usize];
        self.uc.mem_read(RAM, &mut memory).map_err(failed)?;
        let words = memory.chunks(4);
        Ok(4 * words.take_while(|word| *word == PAINT).count())
    }

    /// Measures from now on for how long all interrupts are masked.
    pub(crate) fn watch_masks(&mut self) {
        self.uc.get_data_mut().masks = Some(Masks::default());
    }

    /// Returns the longest time for which all interrupts were masked while that was measured.
    pub(crate) fn longest_mask(&self) -> Time {
        let masks = &self.uc.get_data().masks;
        masks.map_or(0, |masks| masks.longest)
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
        self.halted = false;
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
            let watches = !self.halted || self.chip().watchdog_bites_at_halt();
            let chip = self.chip();
            if watches && chip.watchdog.bite().is_some_and(|bite| bite <= chip.now) {
                self.reset(ResetCause::Watchdog)?;
                continue;
            }
            if std::mem::take(&mut chip.flash.loses_power) {
                world::put_changed(&mut self.uc);
                self.watch_lost()?;
                self.reset(ResetCause::Power)?;
                continue;
            }
            let chip = self.chip();
            if std::mem::take(&mut chip.asks_for_reset) {
                self.reset(ResetCause::Software)?;
                continue;
            }
            if self.locked_up || self.halted {
                // No code runs; the watchdog does.
                let chip = self.chip();
                let bite = chip.watchdog.bite().filter(|_| watches).unwrap_or(end);
                chip.now = bite.min(end).max(chip.now);
                continue;
            }
            let is_masked = self.take_interrupt()?;
            let stop = self.chip().next_event().unwrap_or(end).min(end);
            if self.is_hung() {
                let chip = self.chip();
                chip.now = stop.max(chip.now);
                continue;
            }
            match is_masked {
                // Block by block: the interrupt comes behind the one that lifts the mask.
                true => {
                    let now = self.now();
                    self.execute(now)?;
                    self.uc.get_data_mut().accessed = true;
                }
                false => self.execute(stop)?,
            }
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

    /// Enters the exception that is due, if the masks let it. Returns true if they do not.
    fn take_interrupt(&mut self) -> Result<bool> {
        let Some(exception) = self.chip().interrupts.due() else {
            return Ok(false);
        };
        let base = self.get(RegisterARM::BASEPRI)?;
        let masked = exception != NMI
            && (self.get(RegisterARM::PRIMASK)? & 1 != 0
                || !self.chip().interrupts.passes(exception, base));
        if !masked {
            self.enter(exception)?;
        }
        Ok(masked)
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
