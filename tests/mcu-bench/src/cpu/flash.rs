//! Content of the flash, from an ELF file.

use super::{FLASH, FLASH_BYTES};
use anyhow::{Result, anyhow, bail};
use object::Endianness;
use object::elf::PT_LOAD;
use object::read::elf::{ElfFile32, ProgramHeader};
use object::{Object, ObjectSymbol};
use std::fs;
use std::path::Path;

/// Returns the address of the variable whose name has `part` in it, mangled.
pub(crate) fn address_of(file: &Path, part: &str) -> Result<u32> {
    let data = fs::read(file).map_err(|error| anyhow!("{}: {error}", file.display()))?;
    let elf = ElfFile32::<Endianness>::parse(&*data)
        .map_err(|error| anyhow!("{}: not a 32-bit ELF file: {error}", file.display()))?;
    let symbol = elf
        .symbols()
        .find(|symbol| symbol.name().is_ok_and(|name| name.contains(part)));
    let symbol = symbol.ok_or_else(|| anyhow!("{}: no symbol {part}", file.display()))?;
    Ok(symbol.address() as u32)
}

/// Returns the content of the flash with the images of `files` in it.
pub(crate) fn load(files: &[&Path]) -> Result<Vec<u8>> {
    // Erased flash is all ones.
    let mut flash = vec![0xFF; FLASH_BYTES as usize];
    for file in files {
        put(&mut flash, file)?;
    }
    Ok(flash)
}

/// Puts the image of `file` into the flash.
fn put(flash: &mut [u8], file: &Path) -> Result<()> {
    let data = fs::read(file).map_err(|error| anyhow!("{}: {error}", file.display()))?;
    let elf = ElfFile32::<Endianness>::parse(&*data)
        .map_err(|error| anyhow!("{}: not a 32-bit ELF file: {error}", file.display()))?;
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
    Ok(())
}
