//! RP2040: line and log on the ports of the board file, the tick on SysTick. Core 1 stays in the boot ROM.
//!
//! | priority | interrupt | task |
//! |---|---|---|
//! | 4 | PWM_IRQ_WRAP | a slot of the step pulses, in images for steppers |
//! | 3 | LINE, that of the line's port | bytes from the line into their queue |
//! | 2 | SysTick | the tick |
//! | 1 | USB | packets in both directions, in images with the line over USB in place of a port |
//! | none | | the background |

#[rtic::app(device = crate::board::device, peripherals = true)]
mod app {
    use crate::board::{self, FIRMWARE, InputPins, OutputPins, Pins, ToolPart};
    use crate::clock::{self, CORE_HZ};
    use crate::drives::{self, DriveTimer, Drives};
    use crate::line::{self, ByteReceiver, LineMemory, LineTransmitter, PacketReceiver};
    use crate::log::{self, LogTransmitter};
    use crate::pins::Ports;
    use crate::start;
    use rp2040_hal::fugit::ExtU32;
    use rp2040_hal::gpio;
    use rp2040_hal::pwm::Slices;
    use rp2040_hal::{Sio, Watchdog};
    use trirrr_app::outputs::WithParts;
    use trirrr_app::{Background, Channels, Tick, TickClock, WATCHDOG_MS, period};
    use trirrr_boards::{BuiltInputs, OutputsBeside};
    use trirrr_protocol::message::{Board, Clock};

    type BoardInputs = <InputPins as BuiltInputs>::Inputs;
    type BoardOutputs = WithParts<Drives, <OutputPins as OutputsBeside>::Parts<ToolPart>>;

    #[shared]
    struct Shared {}

    #[local]
    struct Local {
        bytes: ByteReceiver,
        packets: PacketReceiver,
        tick: Tick<BoardInputs, BoardOutputs>,
        slot: DriveTimer,
        background: Background<LineTransmitter, LogTransmitter>,
        watchdog: Watchdog,
    }

    #[init(local = [
        channels: Channels = Channels::new(),
        memory: LineMemory = LineMemory::new(),
    ])]
    fn init(context: init::Context) -> (Shared, Local) {
        let init::LocalResources {
            channels, memory, ..
        } = context.local;
        let device = context.device;
        let start = start::cause(&device.WATCHDOG, &device.VREG_AND_CHIP_RESET);
        let mut resets = device.RESETS;
        let mut watchdog = Watchdog::new(device.WATCHDOG);
        let plls = (device.PLL_SYS, device.PLL_USB);
        let Some(clocks) = clock::start(device.XOSC, device.CLOCKS, plls, &mut resets) else {
            // The ring oscillator is too slow and too inexact for a line. So the board starts anew until the
            // crystal does.
            panic!("the crystal or the PLL does not start");
        };
        watchdog.enable_tick_generation(clocks.ring_mhz);

        let sio = Sio::new(device.SIO);
        let pins = gpio::Pins::new(
            device.IO_BANK0,
            device.PADS_BANK0,
            sio.gpio_bank0,
            &mut resets,
        );
        let slices = Slices::new(device.PWM, &mut resets);
        let ports = Ports {
            uart0: device.UART0,
            uart1: device.UART1,
            usb: (device.USBCTRL_REGS, device.USBCTRL_DPRAM),
        };
        let pins = Pins::take(pins, slices, ports);
        #[allow(clippy::let_unit_value)] // where there is none
        let log = log::start_log(pins.log_transmit, pins.log, &mut resets, &clocks);
        let port = (pins.line_port, pins.line);
        let ((bytes, packets), received, transmitter) =
            line::start(memory, port, &mut resets, clocks);

        let board = Board {
            timer_hz: CORE_HZ,
            clock: Clock::Crystal,
            start,
        };
        let (foreground, background) = trirrr_app::build(channels, board, FIRMWARE);
        let parts = drives::DriveParts {
            pins: pins.drives,
            slots: pins.slots,
            angles: foreground.output().motors.map(|motor| motor.angle),
        };
        let (drives, slot) = drives::build(parts);
        let tool = board::tool::build((pins.tool, pins.tool_slice));
        let outputs = WithParts {
            drives,
            parts: pins.outputs.build(tool),
        };
        let inputs = pins.inputs.build();
        watchdog.start(WATCHDOG_MS.millis());
        let clock = TickClock::start(context.core.SYST, const { period(CORE_HZ) });
        let local = Local {
            bytes,
            packets,
            tick: Tick::new(foreground, &board, inputs, outputs, clock),
            slot,
            background: Background::new(background, received, transmitter, log),
            watchdog,
        };
        (Shared {}, local)
    }

    /// One slot of the steppers. Above all else: the time of a pulse is its value.
    #[cfg(drive = "stepper")]
    #[task(binds = PWM_IRQ_WRAP, priority = 4, local = [slot])]
    fn slot(context: slot::Context) {
        context.local.slot.run();
    }

    /// Moves bytes from the line into their queue. Above the tick: the receiver interrupts with four bytes, or
    /// when no more come, and has room for 28 more.
    #[cfg(not(any(usb, autonomous)))]
    #[task(binds = LINE, priority = 3, local = [bytes])]
    fn bytes(context: bytes::Context) {
        context.local.bytes.run();
    }

    /// Handles an event of USB. Below the tick: the controller makes the host wait.
    #[cfg(usb)]
    #[task(binds = USB, priority = 1, local = [packets])]
    fn packets(context: packets::Context) {
        context.local.packets.run();
    }

    #[task(binds = SysTick, priority = 2, local = [tick])]
    fn tick(context: tick::Context) {
        context.local.tick.run();
    }

    #[idle(local = [background, watchdog])]
    fn idle(context: idle::Context) -> ! {
        let watchdog = context.local.watchdog;
        context.local.background.run(|feeds| {
            if feeds {
                watchdog.feed();
            }
            line::resume(feeds);
        })
    }
}
