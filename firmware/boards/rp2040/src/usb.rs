//! The line over the USB controller.
//!
//! # Erratum RP2040-E15
//! Certain errors on the bus during a transfer to the host hang the controller until it is reset. It then hears no frame any more, of which a
//! host begins one each millisecond. So a device that is configured, whose bus does not rest, and that hears no frame from one feeding of
//! the watchdog to the next, is reset and takes its pull-up from the bus: the host enumerates it anew, as after a cable that was pulled.
#![allow(unsafe_code)]

pub(crate) use self::{
    NoBytes as ByteReceiver, PlugMemory as LineMemory, PlugReceiver as PacketReceiver,
    PlugTransmitter as LineTransmitter,
};
use crate::board::device::interrupt::USB as USB_INTERRUPT;
use crate::board::{LinePins, LinePort};
use crate::clock::{CORE_HZ, PortRates, within};
use core::sync::atomic::{AtomicBool, Ordering};
use cortex_m::peripheral::NVIC;
use heapless::spsc::Consumer;
use rp2040_hal::clocks::{Clock, UsbClock};
use rp2040_hal::pac::{Interrupt, RESETS, USBCTRL_REGS};
use rp2040_hal::pll::PhaseLockedLoop;
use rp2040_hal::pll::common_configs::PLL_USB_48MHZ;
use rp2040_hal::usb::UsbBus;
use trirrr_app::usb::{UsbLine, UsbMemory, UsbTransmitter};
use usb_device::bus::UsbBusAllocator;

/// Memory of the line.
pub(crate) type PlugMemory = UsbMemory<UsbBus>;

/// The line in its interrupt.
pub(crate) struct PlugReceiver {
    line: UsbLine<UsbBus, Interrupt>,
    /// Number of the frame at the last look.
    frame: u16,
}

/// Transmitter of the line.
pub(crate) type PlugTransmitter = UsbTransmitter<Interrupt>;

/// Part of the line in the interrupt of a port: none.
pub(crate) type NoBytes = ();

/// Starts the controller.
pub(crate) fn start(
    memory: &'static mut PlugMemory,
    ((registers, packets), _): (LinePort, LinePins),
    resets: &mut RESETS,
    clocks: PortRates,
) -> (
    (NoBytes, PlugReceiver),
    Consumer<'static, u8>,
    PlugTransmitter,
) {
    let Some(clock) = start_clock(clocks, resets) else {
        panic!("the PLL of USB does not start");
    };
    // The chip has no pin that tells the voltage of the plug: it takes it for there.
    let bus = UsbBus::new(registers, packets, clock, true, resets);
    // Nor has it a number of its own.
    let Ok(started) = memory.start(UsbBusAllocator::new(bus), None, USB_INTERRUPT) else {
        panic!("the device does not take its texts");
    };
    let receiver = PlugReceiver {
        line: started.line,
        frame: 0,
    };
    (((), receiver), started.bytes, started.transmitter)
}

/// Starts the PLL and the clock of USB. Returns `None` if it does not lock.
fn start_clock(clocks: PortRates, resets: &mut RESETS) -> Option<UsbClock> {
    let (mut clock, pll, crystal) = clocks.usb;
    let pll = PhaseLockedLoop::new(pll, crystal, PLL_USB_48MHZ).ok()?;
    let pll = pll.initialize(resets);
    let locked = within(|| pll.await_lock())?;
    let pll = pll.get_locked(locked);
    clock
        .configure_clock(&pll, pll.operating_frequency())
        .ok()?;
    Some(clock)
}

/// A look at the number of the frame is due.
static LOOKS: AtomicBool = AtomicBool::new(false);

/// Goes on after a queue that had no room. `looks` lets the interrupt look whether the controller hangs: some frames after the last look.
pub(crate) fn resume(looks: bool) {
    trirrr_app::usb::resume(USB_INTERRUPT);
    if looks {
        LOOKS.store(true, Ordering::Relaxed);
        NVIC::pend(USB_INTERRUPT);
    }
}

impl PlugReceiver {
    /// Handles an event of the controller.
    pub(crate) fn run(&mut self) {
        self.line.run();
        if LOOKS.load(Ordering::Relaxed) {
            LOOKS.store(false, Ordering::Relaxed);
            self.look();
        }
    }

    fn look(&mut self) {
        // SAFETY: the interrupt alone uses the controller, and not now.
        let registers = unsafe { USBCTRL_REGS::steal() };
        let frame = registers.sof_rd().read().count().bits();
        if frame == self.frame && self.line.is_configured() {
            restart(&registers);
        }
        self.frame = frame;
    }
}

/// Resets the controller, with the settings that it has. The host sees it go and come; its reset of the bus does the rest.
#[cold]
fn restart(registers: &USBCTRL_REGS) {
    /// USBCTRL in RESETS.
    const USB: u32 = 1 << 24;
    /// Time without the pull-up: a hub sees a device go after 2.5 us.
    const GONE: u32 = CORE_HZ / 10_000;
    const READS: u32 = 1000;
    let (phy, power) = (registers.usb_muxing().read(), registers.usb_pwr().read());
    let (mode, events) = (registers.main_ctrl().read(), registers.inte().read());
    let bus = registers.sie_ctrl().read();
    // SAFETY: aliases of the register that set and clear bits; that of USB is this task's. Values that the registers had.
    unsafe {
        let resets = RESETS::steal();
        let at = resets.reset().as_ptr();
        at.byte_add(0x2000).write_volatile(USB);
        cortex_m::asm::delay(GONE);
        at.byte_add(0x3000).write_volatile(USB);
        let _ = (0..READS).any(|_| resets.reset_done().read().bits() & USB != 0);
        registers.usb_muxing().write(|w| w.bits(phy.bits()));
        registers.usb_pwr().write(|w| w.bits(power.bits()));
        registers.main_ctrl().write(|w| w.bits(mode.bits()));
        registers.inte().write(|w| w.bits(events.bits()));
        registers.sie_ctrl().write(|w| w.bits(bus.bits()));
    }
}
