//! Memories, registers and hooks of the CPU emulator.

use super::{CYCLES_PER_INSTRUCTION, FLASH, FLASH_BYTES};
use crate::chip::{Chip, RAM, RAM_BYTES, Stored};
use crate::time::Time;
use unicorn_engine::{HookType, Prot, RegisterARM, Unicorn};

/// Regions of registers: peripherals, their bits one by one, system, debug, and constants of the chip.
const REGISTERS: [(u64, u64); 7] = [
    (0x4000_0000, 0x8_0000),
    (0x4200_0000, 0x100_0000),
    // Ports of an STM32G474.
    (0x4800_0000, 0x2000),
    // USB of an STM32F405.
    (0x5000_0000, 0x2_0000),
    // Number of the chip.
    (0x1FFF_7000, 0x1000),
    (0xE000_E000, 0x1000),
    (0xE004_2000, 0x1000),
];

/// Number that Unicorn gives a jump to EXC_RETURN.
const EXCEPTION_EXIT: u32 = 8;

/// State of the processor that hooks see.
pub(crate) struct World {
    pub(crate) chip: Chip,
    /// Instructions of the block at a place in flash, and its bytes.
    pub(super) blocks: Vec<(u16, u16)>,
    pub(super) flash: Vec<u8>,
    /// The block that begins next is executed whatever is pending, or nothing would go on.
    pub(super) must_go_on: bool,
    /// Begin of the block that was executed last.
    pub(super) block_begin: Time,
    /// The block has used a register.
    pub(super) accessed: bool,
    pub(super) returns: bool,
    pub(super) unhandled: Option<u32>,
    pub(super) bad_address: Option<u32>,
    /// Most instructions of a block so far.
    pub(super) longest_block: u16,
    pub(super) instructions: u64,
    /// Times for which the program masks all interrupts, if somebody asks.
    pub(super) masks: Option<Masks>,
}

/// Longest time for which all interrupts were masked, to a block.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Masks {
    since: Option<Time>,
    pub(super) longest: Time,
}

impl Masks {
    /// A block begins, with interrupts masked or not.
    fn see(&mut self, now: Time, masked: bool) {
        match (masked, self.since) {
            (true, None) => self.since = Some(now),
            (false, Some(since)) => {
                self.longest = self.longest.max(now - since);
                self.since = None;
            }
            _ => {}
        }
    }
}

impl World {
    /// Forgets the blocks that begin in these bytes of the flash.
    fn forget_blocks(&mut self, at: usize, bytes: usize) {
        if let Some(blocks) = self.blocks.get_mut(at / 2..(at + bytes) / 2) {
            blocks.fill((0, 0));
        }
    }

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

/// Puts content of the flash that has changed into the memory.
pub(super) fn put_changed(uc: &mut Unicorn<'_, World>) {
    for (start, bytes) in std::mem::take(&mut uc.get_data_mut().chip.changed) {
        let world = uc.get_data_mut();
        let at = (u64::from(start) - FLASH) as usize;
        world.flash[at..at + bytes.len()].copy_from_slice(&bytes);
        world.forget_blocks(at, bytes.len());
        // The region is mapped. Code that was translated from it is none any more.
        let _ = uc.mem_write(start.into(), &bytes);
        let _ = uc.ctl_remove_cache(start.into(), u64::from(start) + bytes.len() as u64);
    }
}

/// Takes a store of the program to the flash, whose memory takes none by itself.
fn store(uc: &mut Unicorn<'_, World>, address: u64, size: usize, value: u32) {
    let world = uc.get_data_mut();
    let at = (address - FLASH) as usize;
    let before = world.flash.get(at / 8 * 8..).and_then(<[u8]>::first_chunk);
    let Some(before) = before.copied() else {
        return;
    };
    let chip = &mut world.chip;
    let (now, executes_at) = (chip.now, chip.executes_at);
    let stored = chip
        .flash
        .store(address as u32, value, size, before, now, executes_at);
    match stored {
        Stored::Nothing => {}
        Stored::Content { content, time } => {
            chip.now += time;
            chip.changed.push(content);
        }
        Stored::Wrong => {
            let text = format!("store of {value:#010x} to the flash at {address:#010x}");
            chip.unknown.insert(text);
        }
    }
    // A loss of power is looked at.
    if chip.flash.loses_power {
        chip.stop_at = chip.now;
    }
    put_changed(uc);
}

/// Lets the flash tell that the double word at `address` is lost, whenever the program reads it.
pub(super) fn watch_lost(
    uc: &mut Unicorn<'static, World>,
    address: u32,
) -> Result<(), unicorn_engine::uc_error> {
    let (first, last) = (address.into(), u64::from(address) + 7);
    uc.add_mem_hook(HookType::MEM_READ, first, last, |uc, _, address, _, _| {
        let chip = &mut uc.get_data_mut().chip;
        if chip.flash.is_told_lost(address as u32) {
            chip.interrupts.fail();
            chip.stop_at = chip.now;
        }
        true
    })?;
    Ok(())
}

/// Maps memories and registers, and sets the hooks.
#[allow(unsafe_code)]
pub(super) fn set_up(uc: &mut Unicorn<'static, World>) -> Result<(), unicorn_engine::uc_error> {
    // A store to it is not permitted, which the hook below sees: one for all stores would slow down each access to the RAM, too.
    uc.mem_map(FLASH, FLASH_BYTES, Prot::READ | Prot::EXEC)?;
    let ram = uc.get_data().chip.dma.memory.pointer();
    // SAFETY: the chip keeps its memory, which never moves, as long as the emulator has the chip.
    unsafe { uc.mem_map_ptr(RAM, RAM_BYTES, Prot::READ | Prot::WRITE, ram)? };
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
                    put_changed(uc);
                },
            ),
        )?;
    }
    uc.add_mem_hook(
        HookType::MEM_WRITE_PROT,
        FLASH,
        FLASH + FLASH_BYTES - 1,
        |uc, _, address, size, value| {
            store(uc, address, size, value as u32);
            true
        },
    )?;
    uc.add_block_hook(1, 0, |uc, address, bytes| {
        let world = uc.get_data_mut();
        let must = std::mem::take(&mut world.must_go_on);
        if !must && world.chip.now >= world.chip.stop_at {
            // An emulator that cannot be stopped goes on, and is looked at after the next block.
            let _ = uc.emu_stop();
            return;
        }
        if world.masks.is_some() {
            let masked = uc.reg_read(RegisterARM::PRIMASK).unwrap_or(0) & 1 != 0;
            let World { chip, masks, .. } = uc.get_data_mut();
            if let Some(masks) = masks {
                masks.see(chip.now, masked);
            }
        }
        let world = uc.get_data_mut();
        let count = u64::from(world.count(address, bytes));
        world.instructions += count;
        world.block_begin = world.chip.now;
        world.chip.executes_at = address as u32;
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
