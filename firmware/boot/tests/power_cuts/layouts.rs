//! Layouts of the chips: slots that do not overlap, and linker scripts that agree with them.

use std::path::Path;
use trirrr_boot::{Layout, Slot};

/// Chip, its layout, and the ends of its flash.
const CHIPS: [(&str, Layout, u32); 2] = [
    ("stm32f405", Layout::STM32F405, 0x0810_0000),
    ("stm32g474", Layout::STM32G474, 0x0808_0000),
];

fn slots(layout: &Layout) -> Vec<Slot> {
    let programs = [layout.journal, layout.program, layout.new, layout.old];
    programs.into_iter().chain(layout.scenes).collect()
}

/// Origin and length of the memory `name` in a `regions.x`.
fn region(text: &str, name: &str) -> (u32, u32) {
    let line = text.lines().find_map(|line| {
        let (of, rest) = line.split_once(" : ORIGIN = ")?;
        (of.trim() == name).then_some(rest)
    });
    let (origin, length) = line
        .and_then(|line| line.split_once(", LENGTH = "))
        .unwrap_or_else(|| panic!("{name} in {text}"));
    let origin = origin.strip_prefix("0x").expect("a hexadecimal address");
    let kib = length.strip_suffix('K').expect("a length in KiB");
    let kib: u32 = kib.parse().expect("a number");
    (
        u32::from_str_radix(origin, 16).expect("an address"),
        kib * 1024,
    )
}

fn read(file: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(file);
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

#[test]
fn a_program_behind_the_boot_loader_has_the_slot_of_the_layout() {
    for (chip, layout, _) in CHIPS {
        let text = read(&format!("../boards/stm32/{chip}/updated/regions.x"));
        let slot = layout.program;
        assert_eq!(region(&text, "FLASH"), (slot.start, slot.bytes()), "{chip}");
        // The same RAM as without a boot loader.
        let alone = read(&format!("../boards/stm32/{chip}/regions.x"));
        let ram = |text: &str| {
            let ((start, stack), (above, rest)) = (region(text, "STACK"), region(text, "RAM"));
            assert_eq!(start + stack, above, "{chip}");
            (start, stack + rest)
        };
        assert_eq!(ram(&text), ram(&alone), "{chip}");
    }
}

#[test]
fn slots_lie_behind_the_boot_loader_and_do_not_overlap() {
    let loader = region(&read("regions.x"), "FLASH");
    for (chip, layout, end) in CHIPS {
        let mut slots = slots(&layout);
        slots.sort_by_key(|slot| slot.start);
        let mut free = loader.0 + loader.1;
        let mut sector = 0;
        for slot in slots {
            assert!(slot.start >= free, "{chip}: {slot:?}");
            assert!(slot.first_sector > sector, "{chip}: {slot:?}");
            free = slot.start + slot.bytes();
            sector = slot.first_sector + (slot.sectors - 1);
        }
        assert!(free <= end, "{chip}: {free:#x}");
        let programs = [layout.program, layout.new, layout.old].map(|slot| slot.bytes());
        assert!(programs.iter().all(|bytes| *bytes == programs[0]), "{chip}");
        // Erased with the first byte that comes.
        assert!(layout.scenes.iter().all(|slot| slot.sectors == 1), "{chip}");
    }
}

/// The program writes while it runs: nothing of that is in its bank.
#[test]
fn a_program_of_the_stm32g474_writes_in_the_other_bank() {
    const SECOND: u32 = 0x0804_0000;
    let layout = Layout::STM32G474;
    assert!(layout.program.start + layout.program.bytes() <= SECOND);
    for slot in [layout.journal, layout.new].iter().chain(&layout.scenes) {
        assert!(slot.start >= SECOND, "{slot:?}");
        // Numbers of pages count on from the first bank.
        let page = (slot.start - 0x0800_0000) / slot.sector_bytes;
        assert_eq!(page, slot.first_sector.into());
    }
}
