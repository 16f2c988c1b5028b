//! Reads from an ELF file the memory that an image takes, and checks whether it can boot.

use anyhow::{Context, Result, bail, ensure};
use crc::{CRC_32_MPEG_2, Crc};
use object::elf::{PT_LOAD, SHF_ALLOC, SHF_WRITE, SHT_NOBITS};
use object::read::elf::{ElfFile32, ProgramHeader, SectionHeader};
use object::{Endianness, Object, ObjectSection};
use std::fs;
use std::ops::Range;
use std::path::Path;

/// Memory that an image takes, bytes. The stack is not part of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Footprint {
    /// Code, constants and the initial values of variables.
    pub(crate) flash: u64,
    /// Variables, and code that runs from RAM.
    pub(crate) ram: u64,
}

pub(crate) type Elf<'data> = ElfFile32<'data, Endianness>;

/// Returns what `read` makes of the image in `file`; an error names the file.
pub(crate) fn with_elf<T>(file: &Path, read: impl FnOnce(&Elf) -> Result<T>) -> Result<T> {
    let parsed = || {
        let data = fs::read(file)?;
        read(&Elf::parse(&*data).context("not a 32-bit ELF file")?)
    };
    parsed().with_context(|| file.display().to_string())
}

/// Addresses at which a Cortex-M has its RAM.
const SRAM: Range<u64> = 0x2000_0000..0x4000_0000;

/// The footprint of an image.
pub(crate) fn footprint(elf: &Elf) -> Footprint {
    let mut footprint = Footprint { flash: 0, ram: 0 };
    for section in elf.sections() {
        let header = section.elf_section_header();
        let flags = header.sh_flags(Endianness::Little);
        if !flags.contains(SHF_ALLOC) {
            continue;
        }
        if header.sh_type(Endianness::Little) != SHT_NOBITS {
            footprint.flash += section.size();
        }
        // Code that is copied to RAM takes both.
        if flags.contains(SHF_WRITE) || SRAM.contains(&section.address()) {
            footprint.ram += section.size();
        }
    }
    footprint
}

/// Memory that a Cortex-M needs to start.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Memory {
    /// Address at which the processor looks for the vector table.
    pub(crate) vectors: u64,
    /// Start and length of the flash.
    pub(crate) flash: (u64, u64),
    /// Start and length of the RAM.
    pub(crate) ram: (u64, u64),
}

/// Checks that a Cortex-M with this memory starts the image: a vector table where it looks for it,
/// the first stack pointer in RAM, the reset handler in flash and Thumb code, and everything to be
/// loaded within flash. A table behind the flash's start is found by a second stage, which lies there.
pub(crate) fn check_boot(elf: &Elf, memory: Memory) -> Result<()> {
    if memory.vectors != memory.flash.0 {
        let stage = elf.section_by_name(".boot2").context("no second stage")?;
        check_stage(stage.address(), stage.data()?, memory.flash.0)?;
    }
    let table = elf.section_by_name(".vector_table");
    let table = table.context("no vector table")?;
    check_vectors(table.address(), table.data()?, memory)?;
    let variables = elf.sections().filter(|section| {
        let (ram, length) = memory.ram;
        section.size() > 0 && (ram..ram + length).contains(&section.address())
    });
    let lowest = variables.map(|section| section.address()).min();
    check_stack(word(table.data()?, 0), lowest)?;
    for segment in elf.elf_program_headers() {
        let endian = Endianness::Little;
        if segment.p_type(endian) == PT_LOAD {
            let (start, length) = (segment.p_paddr(endian), segment.p_filesz(endian));
            check_load(start.into(), length.into(), memory)?;
        }
    }
    Ok(())
}

fn check_vectors(address: u64, table: &[u8], memory: Memory) -> Result<()> {
    let (flash, flash_length) = memory.flash;
    let (ram, ram_length) = memory.ram;
    ensure!(
        address == memory.vectors,
        "the vector table is at {address:#010x}, the processor looks at {:#010x}",
        memory.vectors
    );
    let (Some(stack), Some(reset)) = (word(table, 0), word(table, 1)) else {
        bail!("the vector table has {} bytes", table.len())
    };
    // A full descending stack may start just beyond the end.
    ensure!(
        stack > ram && stack <= ram + ram_length && stack % 8 == 0,
        "the stack starts at {stack:#010x}, RAM is {ram:#010x} to {:#010x}",
        ram + ram_length
    );
    ensure!(
        reset % 2 == 1 && (flash..flash + flash_length).contains(&reset),
        "the reset handler is {reset:#010x}, which is no Thumb code in flash"
    );
    Ok(())
}

/// A stack below everything else in RAM runs out of the RAM and not into the variables.
fn check_stack(stack: Option<u64>, variables: Option<u64>) -> Result<()> {
    if let (Some(stack), Some(variables)) = (stack, variables) {
        ensure!(
            stack <= variables,
            "the stack starts at {stack:#010x}, above variables at {variables:#010x}: it would run \
             into them"
        );
    }
    Ok(())
}

fn word(table: &[u8], index: usize) -> Option<u64> {
    let bytes = table.get(4 * index..4 * index + 4)?;
    Some(u32::from_le_bytes(bytes.try_into().ok()?).into())
}

/// Checks that the boot ROM of an RP2040 starts this second stage: 256 bytes at the start of the
/// flash, the last four of them the checksum of the others (RP2040 datasheet, 2.8.1.3.1).
fn check_stage(address: u64, stage: &[u8], flash: u64) -> Result<()> {
    ensure!(
        address == flash,
        "the second stage is at {address:#010x}, the boot ROM looks at {flash:#010x}"
    );
    let Some((code, [a, b, c, d])) = stage.split_last_chunk().filter(|_| stage.len() == 256) else {
        bail!("the second stage has {} bytes, not 256", stage.len())
    };
    let computed = Crc::<u32>::new(&CRC_32_MPEG_2).checksum(code);
    let stored = u32::from_le_bytes([*a, *b, *c, *d]);
    ensure!(
        computed == stored,
        "the second stage's checksum is {stored:#010x}, that of its code {computed:#010x}"
    );
    Ok(())
}

/// `length` bytes that are programmed to `start`.
fn check_load(start: u64, length: u64, memory: Memory) -> Result<()> {
    let (flash, flash_length) = memory.flash;
    ensure!(
        length == 0 || (start >= flash && start + length <= flash + flash_length),
        "{length} bytes are loaded to {start:#010x}, outside the flash"
    );
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::boards::FIRMWARE_MEMORY as MEMORY;

    fn vectors(address: u64, stack: u32, reset: u32) -> Result<()> {
        let table = [stack.to_le_bytes(), reset.to_le_bytes()].concat();
        check_vectors(address, &table, MEMORY)
    }

    #[test]
    fn a_good_vector_table_boots() {
        vectors(0x0800_0000, 0x2002_0000, 0x0800_0401).expect("as the firmware's");
    }

    #[test]
    fn a_bad_one_is_refused_with_the_reason() {
        for (address, stack, reset, reason) in [
            (0, 0x2002_0000, 0x0800_0401, "the vector table is at"),
            (0x0800_0000, 0x2002_0008, 0x0800_0401, "the stack starts at"),
            (0x0800_0000, 0x2000_0000, 0x0800_0401, "the stack starts at"),
            (0x0800_0000, 0x2001_0004, 0x0800_0401, "the stack starts at"),
            (0x0800_0000, 0x2002_0000, 0x0800_0400, "no Thumb code"),
            (0x0800_0000, 0x2002_0000, 0x0810_0001, "no Thumb code"),
        ] {
            let error = vectors(address, stack, reset).expect_err(reason);
            assert!(error.to_string().contains(reason), "{error}");
        }
        let error = check_vectors(0x0800_0000, &[0; 6], MEMORY).expect_err("too short");
        assert_eq!(error.to_string(), "the vector table has 6 bytes");
    }

    #[test]
    fn a_second_stage_has_its_place_its_length_and_its_checksum() {
        // CRC-32/MPEG-2 of 252 zeros, by polynomial division bit by bit.
        let remainder = (0..252 * 8).fold(u32::MAX, |rest, _| {
            (rest << 1) ^ (0x04c1_1db7 & (rest >> 31).wrapping_neg())
        });
        let mut stage = [0; 256];
        stage[252..].copy_from_slice(&remainder.to_le_bytes());
        let flash = 0x1000_0000;
        check_stage(flash, &stage, flash).expect("a good one");
        let refused = |address, stage: &[u8], reason: &str| {
            let error = check_stage(address, stage, flash).expect_err(reason);
            assert!(error.to_string().contains(reason), "{error}");
        };
        refused(flash + 256, &stage, "the boot ROM looks at");
        refused(flash, &stage[..252], "252 bytes, not 256");
        stage[17] ^= 1;
        refused(flash, &stage, "checksum");
    }

    #[test]
    fn a_stack_lies_below_the_variables() {
        assert!(check_stack(Some(0x2000_8000), Some(0x2000_8000)).is_ok());
        assert!(check_stack(Some(0x2002_0000), None).is_ok());
        let error = check_stack(Some(0x2002_0000), Some(0x2000_0000)).expect_err("above");
        assert!(error.to_string().contains("run into them"), "{error}");
    }

    #[test]
    fn what_is_programmed_must_be_flash() {
        assert!(check_load(0x0800_0000, 1024 * 1024, MEMORY).is_ok());
        assert!(check_load(0x0800_0000, 1024 * 1024 + 1, MEMORY).is_err());
        assert!(check_load(0x2000_0000, 4, MEMORY).is_err());
        // .bss has an address in RAM and nothing to program.
        assert!(check_load(0x2000_0000, 0, MEMORY).is_ok());
    }

    #[test]
    fn this_very_program_is_no_image() {
        let program = std::env::current_exe().expect("a path");
        assert!(with_elf(&program, |_| Ok(())).is_err());
    }
}
