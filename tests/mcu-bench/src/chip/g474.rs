//! STM32G474: its registers by those of the STM32F405, where both have the same, and what is different.
//!
//! Timers 2 and 7, the watchdog and the core are at the same addresses. Ports have the same registers at other addresses. Clocks and serial
//! ports have others with the same meaning: these are translated. Both have a controller for CAN at the same place, of another kind.

use super::PORTS;
use super::clock::ClockControl;
use super::map::{Place, SERIALS};
use super::serial::Serial;
use crate::time::Time;
use std::collections::BTreeMap;

const RCC: u32 = 0x4002_1000;
/// Resets of the ports.
pub(super) const RESET_OF_PORTS: u32 = RCC + 0x2C;

/// Registers that hold what is written and do nothing that the bench shows: address and bytes.
const HELD: [(u32, u32); 5] = [
    // RCC: resets and clocks of peripherals, and sources of clocks.
    (RCC + 0x28, 0x6C),
    // PWR: the boost of the core.
    (0x4000_7000, 0x84),
    // DBGMCU: what stands still under a debugger.
    (0xE004_2004, 12),
    // FPU: lazy stacking.
    (0xE000_EF34, 12),
    // DWT and DCB.
    (0xE000_EDF0, 16),
];

/// Modes of the pins of a port in a reset: analogue, but for the debug port.
pub(super) fn reset_modes(port: char) -> u32 {
    match port {
        'A' => 0xABFF_FFFF,
        'B' => 0xFFFF_FEBF,
        _ => 0xFFFF_FFFF,
    }
}

/// Returns the place of an address; none if it is that of an STM32F405.
pub(super) fn place(address: u32) -> Option<Place> {
    let within = |start: u32, bytes: u32| {
        (start..start + bytes)
            .contains(&address)
            .then(|| address - start)
    };
    if HELD
        .iter()
        .any(|(start, bytes)| within(*start, *bytes).is_some())
    {
        return Some(Place::Held);
    }
    if let Some(offset) = within(0x4002_2000, 0x24) {
        return Some(Place::Flash(offset));
    }
    if let Some(offset) = within(RCC, 0x98) {
        return Some(Place::OtherClock(offset));
    }
    if let Some(offset) = within(0x4800_0000, 0x400 * PORTS.len() as u32) {
        return Some(Place::Port((offset / 0x400) as usize, offset % 0x400));
    }
    for (index, (start, _)) in SERIALS.iter().enumerate() {
        if let Some(offset) = within(*start, 0x400) {
            return Some(Place::OtherSerial(index, offset));
        }
    }
    // DMA1, and the multiplexer behind both controllers.
    if let Some(offset) =
        within(0x4002_0000, 0x400).or(within(0x4002_0800, 0x100).map(|at| at + 0x800))
    {
        return Some(Place::Channel(offset));
    }
    if let Some(offset) = within(0x4000_6400, 0x400) {
        return Some(Place::Can(offset));
    }
    if let Some(offset) = within(0x4000_A400, 0x350) {
        return Some(Place::MessageRam(offset));
    }
    // TIM2, TIM7, watchdog, core.
    let same = [
        (0x4000_0000, 0x400),
        (0x4000_1400, 0x400),
        (0x4000_3000, 0x400),
        (0xE000_E000, 0x1000),
    ];
    let is_same = same
        .iter()
        .any(|(start, bytes)| within(*start, *bytes).is_some());
    (!is_same).then_some(Place::Unknown)
}

/// Flags of resets: power-on and brown-out have one, bit 27.
fn cause(of_f405: u32) -> u32 {
    let low = u32::from(of_f405 & (1 << 25 | 1 << 27) != 0);
    of_f405 & !(0xFFFF | 1 << 25 | 1 << 27) | low << 27
}

/// Reads a register of the clocks.
pub(super) fn read_clock(
    clock: &ClockControl,
    held: &BTreeMap<u32, u32>,
    offset: u32,
    now: Time,
) -> Option<u32> {
    let written = |offset: u32| held.get(&(RCC + offset)).copied();
    match offset {
        0x00 => clock.read(0x00, now),
        // From the internal oscillator after a reset.
        0x08 => {
            let written = written(0x08).unwrap_or(1);
            Some(written & !0xC | (written & 3) << 2)
        }
        0x0C => Some(written(0x0C).unwrap_or(0x1000)),
        0x1C => Some(u32::from(clock.has_told()) << 8),
        0x94 => clock.read(0x74, now).map(cause),
        _ => None,
    }
}

/// Writes a register of the clocks.
pub(super) fn write_clock(clock: &mut ClockControl, offset: u32, value: u32, now: Time) -> bool {
    match offset {
        0x00 => clock.write(0x00, value, now),
        // The dividers of the buses are left at 1, and that of the core is 2 for some cycles.
        0x08 if value >> 8 & 0x3F == 0 => {
            let source = match value & 3 {
                3 => 2,
                2 => 1,
                _ => 0,
            };
            clock.write(0x08, source, now)
        }
        0x0C => {
            let divider = (value >> 4 & 15) + 1;
            // No output without its enable bit: a clock that stands.
            let factor = (value >> 8 & 0x7F) * (value >> 24 & 1);
            let by_crystal = u32::from(value & 3 == 3);
            let output = value >> 25 & 3;
            let of_f405 = divider | factor << 6 | output << 16 | by_crystal << 22;
            clock.write(0x04, of_f405, now)
        }
        0x20 => {
            if value >> 8 & 1 != 0 {
                clock.answer();
            }
            true
        }
        0x94 => clock.write(0x74, (value >> 23 & 1) << 24, now),
        _ => false,
    }
}

/// The bit that switches a port on, here and in an STM32F405.
const ON: (u32, u32) = (0, 13);

/// Reads a register of a serial port.
pub(super) fn read_serial(serial: &mut Serial, offset: u32, now: Time, bus: Time) -> Option<u32> {
    match offset {
        0x00 => {
            let control = serial.read(0x0C, now, bus)?;
            Some(control & !(1 << ON.1) | (control >> ON.1 & 1) << ON.0)
        }
        0x08 => serial.read(0x14, now, bus),
        0x0C => serial.read(0x08, now, bus),
        0x1C => serial.read(0x00, now, bus),
        0x24 => serial.read(0x04, now, bus),
        _ => None,
    }
}

/// Writes a register of a serial port.
pub(super) fn write_serial(
    serial: &mut Serial,
    offset: u32,
    value: u32,
    now: Time,
    bus: Time,
) -> bool {
    match offset {
        0x00 => {
            let control = value & !(1 << ON.0) | (value >> ON.0 & 1) << ON.1;
            serial.write(0x0C, control, now, bus)
        }
        0x08 => serial.write(0x14, value, now, bus),
        0x0C => serial.write(0x08, value, now, bus),
        // The overrun goes with the byte that is read next.
        0x20 => true,
        0x28 => serial.write(0x04, value, now, bus),
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chip::{Crystal, ResetCause};
    use crate::time::{MS, SECOND};

    #[test]
    fn a_crystal_of_24_mhz_makes_170() {
        let mut clock = ClockControl::new(Crystal::Runs { mhz: 24 });
        // HSE by 6, times 85, by 2.
        let settings = 3 | 5 << 4 | 85 << 8 | 1 << 24;
        for (offset, value) in [(0x00, 1 << 16), (0x0C, settings), (0x00, 1 << 24 | 1 << 16)] {
            assert!(write_clock(&mut clock, offset, value, 0));
        }
        let ready = read_clock(&clock, &BTreeMap::new(), 0x00, 10 * MS);
        assert_eq!(ready.map(|flags| flags >> 25 & 1), Some(1));
        assert!(write_clock(&mut clock, 0x08, 3, 0));
        assert_eq!(SECOND / clock.clocks().core, 170_000_000);
    }

    #[test]
    fn a_brown_out_looks_like_power_on() {
        let mut clock = ClockControl::new(Crystal::Missing);
        for (of, flags) in [
            (ResetCause::Power, 0b1100),
            (ResetCause::BrownOut, 0b1100),
            (ResetCause::Watchdog, 0b10_0100),
        ] {
            clock.reset(of);
            let read = read_clock(&clock, &BTreeMap::new(), 0x94, 0);
            assert_eq!(read.map(|word| word >> 24), Some(flags), "{of:?}");
            assert!(write_clock(&mut clock, 0x94, 1 << 23, 0));
        }
    }
}
