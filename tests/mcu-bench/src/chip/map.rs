//! Addresses of the peripherals.

use super::{Kind, PORTS, g474, usb};

/// Interrupt of TIM7: the slots of the steppers.
pub(crate) const TIM7: u16 = 55;

/// Timers: number, address, interrupt, on APB2, with 32 bits.
pub(super) const TIMERS: [(u8, u32, u16, bool, bool); 6] = [
    (1, 0x4001_0000, 25, true, false),
    (2, 0x4000_0000, 28, false, true),
    (3, 0x4000_0400, 29, false, false),
    (4, 0x4000_0800, 30, false, false),
    (5, 0x4000_0C00, 50, false, true),
    (7, 0x4000_1400, TIM7, false, false),
];

/// Serial ports: address, interrupt. USART2 is the line, USART3 the log.
pub(super) const SERIALS: [(u32, u16); 2] = [(0x4000_4400, 38), (0x4000_4800, 39)];

/// Registers that hold what is written and do nothing that the bench shows: address and bytes.
const HELD: [(u32, u32); 4] = [
    // RCC: resets and clocks of peripherals, and in standby.
    (0x4002_3810, 0x60),
    // DBGMCU: what stands still under a debugger.
    (0xE004_2004, 12),
    // FPU: lazy stacking.
    (0xE000_EF34, 12),
    // DWT and DCB.
    (0xE000_EDF0, 16),
];

/// DBGMCU_IDCODE.
const IDENTITY: u32 = 0xE004_2000;

/// Peripheral that has one place, at an offset.
type PlaceAt = fn(u32) -> Place;

/// Peripheral, and the offset in it.
pub(super) enum Place {
    Clock(u32),
    Core(u32),
    Port(usize, u32),
    Timer(usize, u32),
    Serial(usize, u32),
    Watchdog(u32),
    Capture(u32),
    Can(u32),
    MessageRam(u32),
    OtherClock(u32),
    OtherSerial(usize, u32),
    Stream(u32),
    Channel(u32),
    Supply(u32),
    Lines(u32),
    Flash(u32),
    Usb(u32),
    Packets(u32),
    Trimming(u32),
    Number(u32),
    Identity,
    Held,
    Unknown,
}

/// Returns the place of an address.
pub(super) fn place(kind: Kind, address: u32) -> Place {
    let within = |start: u32, bytes: u32| {
        (start..start + bytes)
            .contains(&address)
            .then(|| address - start)
    };
    if let Some(place) = usb::place(kind, address) {
        return place;
    }
    if kind == Kind::Stm32g474
        && let Some(place) = g474::place(address)
    {
        return place;
    }
    if let Some(offset) = within(0x4002_3800, 0x0C).or(within(0x4002_3874, 4).map(|_| 0x74)) {
        return Place::Clock(offset);
    }
    if let Some(offset) = within(0x4002_3C00, 0x18) {
        return Place::Flash(offset);
    }
    if HELD
        .iter()
        .any(|(start, bytes)| within(*start, *bytes).is_some())
    {
        return Place::Held;
    }
    if let Some(offset) = within(0x4002_0000, 0x400 * PORTS.len() as u32) {
        return Place::Port((offset / 0x400) as usize, offset % 0x400);
    }
    for (index, (_, start, ..)) in TIMERS.iter().enumerate() {
        if let Some(offset) = within(*start, 0x400) {
            return Place::Timer(index, offset);
        }
    }
    for (index, (start, _)) in SERIALS.iter().enumerate() {
        if let Some(offset) = within(*start, 0x400) {
            return Place::Serial(index, offset);
        }
    }
    if let Some(offset) = within(0x4002_6000, 0x800) {
        return Place::Stream(offset);
    }
    let others: [(u32, PlaceAt); 4] = [
        (0x4000_6400, Place::Can),
        (0x4001_4800, Place::Capture),
        (0x4000_7000, Place::Supply),
        (0x4001_3C00, Place::Lines),
    ];
    for (start, place) in others {
        if let Some(offset) = within(start, 0x400) {
            return place(offset);
        }
    }
    match (within(0x4000_3000, 0x400), within(0xE000_E000, 0x1000)) {
        (Some(offset), _) => Place::Watchdog(offset),
        (_, Some(offset)) => Place::Core(offset),
        _ if address == IDENTITY => Place::Identity,
        _ => Place::Unknown,
    }
}

/// Returns the register and the bit of an address that stands for a single bit.
pub(super) fn single_bit(address: u32) -> Option<(u32, u32)> {
    let offset = address
        .checked_sub(0x4200_0000)
        .filter(|offset| *offset < 0x200_0000)?;
    // 32 bytes for each byte, four for each bit.
    let (byte, bit) = (offset / 32, offset / 4 % 8);
    Some((0x4000_0000 + (byte & !3), (byte & 3) * 8 + bit))
}
