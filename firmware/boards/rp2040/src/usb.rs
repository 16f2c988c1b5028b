//! The line over the USB controller.

use crate::board::device::interrupt::USB as USB_INTERRUPT;
use heapless::spsc::Consumer;
use rp2040_hal::clocks::UsbClock;
use rp2040_hal::pac::{Interrupt, RESETS, USBCTRL_DPRAM, USBCTRL_REGS};
use rp2040_hal::usb::UsbBus;
use trirrr_app::usb::{UsbLine, UsbMemory, UsbTransmitter};
use usb_device::bus::UsbBusAllocator;

/// Memory of the line.
pub(crate) type PlugMemory = UsbMemory<UsbBus>;

/// The line in its interrupt.
pub(crate) type PlugReceiver = UsbLine<UsbBus, Interrupt>;

/// Transmitter of the line.
pub(crate) type PlugTransmitter = UsbTransmitter<Interrupt>;

/// Starts the controller.
pub(crate) fn start(
    memory: &'static mut PlugMemory,
    (registers, packets): (USBCTRL_REGS, USBCTRL_DPRAM),
    resets: &mut RESETS,
    clock: UsbClock,
) -> (PlugReceiver, Consumer<'static, u8>, PlugTransmitter) {
    // The chip has no pin that tells the voltage of the plug: it takes it for there.
    let bus = UsbBus::new(registers, packets, clock, true, resets);
    // Nor has it a number of its own.
    let Ok(started) = memory.start(UsbBusAllocator::new(bus), None, USB_INTERRUPT) else {
        panic!("the device does not take its texts");
    };
    (started.line, started.bytes, started.transmitter)
}
