//! The line over the OTG controller at full speed.
#![allow(unsafe_code)]

use crate::board::device::interrupt::USB as USB_INTERRUPT;
use crate::board::{UsbMinus, UsbPlus};
use crate::clock::{Clocks, FAST};
use heapless::spsc::Consumer;
use stm32f4xx_hal::gpio::Speed;
use stm32f4xx_hal::pac::{Interrupt, OTG_FS_GLOBAL, RCC};
use synopsys_usb_otg::{UsbBus, UsbPeripheral};
use trirrr_app::usb::{UsbLine, UsbMemory, UsbTransmitter};

/// Alternate function of both pins (data sheet DS8626, table 9).
const FUNCTION: u8 = 10;

/// Words for packets of the host: of control and of data, 64 bytes each.
const PACKETS: usize = 32;

/// Number of the chip (RM0090, 39.1): three words.
const NUMBER: *const [u32; 3] = 0x1fff_7a10 as *const [u32; 3];

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

/// The controller.
pub(crate) struct OtgFs;

// SAFETY: the registers are those of the controller (RM0090, chapter 34), and nothing else in the image has them.
unsafe impl UsbPeripheral for OtgFs {
    const REGISTERS: *const () = OTG_FS_GLOBAL::ptr().cast();
    const HIGH_SPEED: bool = false;
    const FIFO_DEPTH_WORDS: usize = 320;
    const ENDPOINT_COUNT: usize = 4;

    fn enable() {
        // SAFETY: only bits of the controller are changed, before any task runs.
        let rcc = unsafe { RCC::steal() };
        rcc.ahb2enr().modify(|_, w| w.otgfsen().set_bit());
        rcc.ahb2rstr().modify(|_, w| w.otgfsrst().set_bit());
        rcc.ahb2rstr().modify(|_, w| w.otgfsrst().clear_bit());
    }

    fn ahb_frequency_hz(&self) -> u32 {
        FAST.core
    }
}

/// Starts the controller at its pins.
pub(crate) fn start(
    memory: &'static mut PacketMemory,
    pins: (UsbMinus, UsbPlus),
    clocks: &Clocks,
) -> (PacketReceiver, Consumer<'static, u8>, PacketTransmitter) {
    if clocks.core != FAST.core {
        // The PLL makes the 48 MHz, too. So the board starts anew until the PLL does.
        panic!("USB has no clock");
    }
    let _ = (
        pins.0.into_alternate::<FUNCTION>().speed(Speed::VeryHigh),
        pins.1.into_alternate::<FUNCTION>().speed(Speed::VeryHigh),
    );
    let bus = UsbBus::new(OtgFs, &mut memory.packets);
    // SAFETY: constants in the chip's own memory.
    let number = unsafe { NUMBER.read_volatile() };
    let Ok(started) = memory.line.start(bus, Some(number), USB_INTERRUPT) else {
        panic!("the device does not take its texts");
    };
    (started.line, started.bytes, started.transmitter)
}
