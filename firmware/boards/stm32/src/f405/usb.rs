//! The line over the OTG controller at full speed.
#![allow(unsafe_code)]

pub(crate) use self::{
    PacketBytes as LineReceiver, PacketMemory as LineMemory, PacketTransmitter as LineTransmitter,
};
use crate::board::LinePins;
use crate::board::device::interrupt::USB as USB_INTERRUPT;
use crate::clock::{Clocks, FAST};
use heapless::spsc::Consumer;
use stm32_metapac::{Interrupt, RCC, UID, USB_OTG_FS};
use synopsys_usb_otg::{UsbBus, UsbPeripheral};
use trirrr_app::usb::{UsbLine, UsbMemory, UsbTransmitter};

/// Alternate function of both pins (data sheet DS8626, table 9).
const FUNCTION: u8 = 10;

/// Words for packets of the host: of control and of data, 64 bytes each.
const PACKETS: usize = 32;

/// Memory of the line.
pub(crate) struct PacketMemory {
    line: UsbMemory<UsbBus<OtgFs>>,
    packets: [u32; PACKETS],
}

impl PacketMemory {
    pub(crate) const fn new() -> Self {
        Self {
            line: UsbMemory::new(),
            packets: [0; PACKETS],
        }
    }
}

/// The line in its interrupt.
pub(crate) type PacketReceiver = UsbLine<UsbBus<OtgFs>, Interrupt>;

/// Transmitter of the line.
pub(crate) type PacketTransmitter = UsbTransmitter<Interrupt>;

/// Source of the background's bytes.
pub(crate) type PacketBytes = Consumer<'static, u8>;

/// The controller.
pub(crate) struct OtgFs;

// SAFETY: the registers are those of the controller (RM0090, chapter 34), and nothing else in the image has them.
unsafe impl UsbPeripheral for OtgFs {
    const REGISTERS: *const () = USB_OTG_FS.as_ptr().cast_const();
    const HIGH_SPEED: bool = false;
    const FIFO_DEPTH_WORDS: usize = 320;
    const ENDPOINT_COUNT: usize = 4;

    fn enable() {
        RCC.ahb2enr().modify(|w| w.set_usb_otg_fsen(true));
        RCC.ahb2rstr().modify(|w| w.set_usb_otg_fsrst(true));
        RCC.ahb2rstr().modify(|w| w.set_usb_otg_fsrst(false));
    }

    fn ahb_frequency_hz(&self) -> u32 {
        FAST.core
    }
}

/// Starts the controller at its pins.
pub(crate) fn start(
    memory: &'static mut PacketMemory,
    pins: LinePins,
    clocks: &Clocks,
) -> (PacketReceiver, PacketBytes, PacketTransmitter) {
    if clocks.core != FAST.core {
        // The PLL makes the 48 MHz, too. So the board starts anew until the PLL does.
        panic!("USB has no clock");
    }
    let _ = (
        pins.usb_minus.into_alternate::<FUNCTION>().very_fast(),
        pins.usb_plus.into_alternate::<FUNCTION>().very_fast(),
    );
    let bus = UsbBus::new(OtgFs, &mut memory.packets);
    let number = [0, 1, 2].map(|word| UID.uid(word).read());
    let Ok(started) = memory.line.start(bus, Some(number), USB_INTERRUPT) else {
        panic!("the device does not take its texts");
    };
    (started.line, started.bytes, started.transmitter)
}

/// Goes on after a queue that had no room.
pub(crate) fn resume() {
    trirrr_app::usb::resume(USB_INTERRUPT);
}
