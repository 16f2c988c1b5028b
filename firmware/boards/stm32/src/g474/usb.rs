//! The line over the USB device at full speed.
#![allow(unsafe_code)]

pub(crate) use self::{
    PacketBytes as LineReceiver, PacketMemory as LineMemory, PacketTransmitter as LineTransmitter,
};
use crate::board::LinePins;
use crate::board::device::interrupt::USB as USB_INTERRUPT;
use crate::clock::{Clocks, FAST, becomes};
use heapless::spsc::Consumer;
use stm32_metapac::crs::vals::Syncsrc;
use stm32_metapac::rcc::vals::Clk48sel;
use stm32_metapac::{CRS, Interrupt, RCC, UID, USB, USBRAM};
use stm32_usbd::{MemoryAccess, UsbBus, UsbPeripheral};
use trirrr_app::usb::{UsbLine, UsbMemory, UsbTransmitter};

/// Memory of the line.
pub(crate) type PacketMemory = UsbMemory<UsbBus<UsbDevice>>;

/// The line in its interrupt.
pub(crate) type PacketReceiver = UsbLine<UsbBus<UsbDevice>, Interrupt>;

/// Transmitter of the line.
pub(crate) type PacketTransmitter = UsbTransmitter<Interrupt>;

/// The controller.
pub(crate) struct UsbDevice;

// SAFETY: the registers and the memory are those of the controller (RM0440, chapter 45), and nothing else in the image has them.
unsafe impl UsbPeripheral for UsbDevice {
    const REGISTERS: *const () = USB.as_ptr().cast_const();
    const DP_PULL_UP_FEATURE: bool = true;
    const EP_MEMORY: *const () = USBRAM.as_ptr().cast_const();
    const EP_MEMORY_SIZE: usize = 1024;
    const EP_MEMORY_ACCESS: MemoryAccess = MemoryAccess::Word16x2;

    fn enable() {
        RCC.apb1enr1().modify(|w| w.set_usben(true));
        RCC.apb1rstr1().modify(|w| w.set_usbrst(true));
        RCC.apb1rstr1().modify(|w| w.set_usbrst(false));
    }

    /// A microsecond (data sheet DS12288, characteristics of USB), at the fastest clock.
    fn startup_delay() {
        cortex_m::asm::delay(FAST.core / 1_000_000);
    }
}

/// Source of the background's bytes.
pub(crate) type PacketBytes = Consumer<'static, u8>;

/// Starts the controller. Its pins are connected as it is switched on.
pub(crate) fn start(
    memory: &'static mut PacketMemory,
    _: LinePins,
    _: &Clocks,
) -> (PacketReceiver, PacketBytes, PacketTransmitter) {
    // An oscillator for USB alone, which follows the frames of the host: no crystal is needed.
    RCC.crrcr().modify(|w| w.set_hsi48on(true));
    if !becomes(|| RCC.crrcr().read().hsi48rdy()) {
        panic!("USB has no clock");
    }
    RCC.ccipr().modify(|w| w.set_clk48sel(Clk48sel::HSI48));
    RCC.apb1enr1().modify(|w| w.set_crsen(true));
    CRS.cfgr().modify(|w| w.set_syncsrc(Syncsrc::USB));
    CRS.cr().modify(|w| {
        w.set_autotrimen(true);
        w.set_cen(true);
    });
    let bus = UsbBus::new(UsbDevice);
    let number = [0, 1, 2].map(|word| UID.uid(word).read());
    let Ok(started) = memory.start(bus, Some(number), USB_INTERRUPT) else {
        panic!("the device does not take its texts");
    };
    (started.line, started.bytes, started.transmitter)
}

/// Goes on after a queue that had no room.
pub(crate) fn resume() {
    trirrr_app::usb::resume(USB_INTERRUPT);
}
