//! Exceptions: entry, return, faults.

use super::{Board, Handled, World, failed};
use crate::chip::HARD_FAULT;
use crate::time::Time;
use anyhow::{Result, ensure};
use unicorn_engine::RegisterARM;

/// Cycles from an exception until its handler begins, and from its return on (Cortex-M4 technical reference manual, 3.9).
const ENTRY_CYCLES: u64 = 12;
/// More of them with the registers of the FPU.
const FPU_CYCLES: u64 = 17;

/// Fault of the bus with a known address.
const PRECISE_BUS_FAULT: u32 = 1 << 9 | 1 << 15;
const FORCED: u32 = 1 << 30;

impl Board {
    /// Enters the handler of faults, for an access to `address`.
    pub(super) fn fault(&mut self, address: Option<u32>) -> Result<()> {
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
    pub(super) fn enter(&mut self, exception: u16) -> Result<()> {
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
    pub(super) fn leave(&mut self) -> Result<()> {
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
}
