//! RP2040: line and log on the ports of the board file, the tick on SysTick. Core 1 stays in the boot ROM.
//!
//! | priority | interrupt | task |
//! |---|---|---|
//! | 4 | PWM_IRQ_WRAP | a slot of the step pulses, in images for steppers |
//! | 3 | LINE, that of the line's port | bytes from the line into their queue |
//! | 2 | SysTick | the tick |
//! | none | | the background |
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod board;
#[cfg(target_os = "none")]
mod chip;
#[cfg(target_os = "none")]
mod clock;
#[cfg(all(target_os = "none", digital))]
#[path = "../../digital.rs"]
mod digital;
#[cfg(target_os = "none")]
mod drives;
#[cfg(all(target_os = "none", interlocks))]
mod interlocks;
#[cfg(target_os = "none")]
mod pins;
#[cfg(target_os = "none")]
mod start;
#[cfg(target_os = "none")]
mod switches;
#[cfg(all(target_os = "none", not(tool = "none")))]
mod tool;

#[cfg(target_os = "none")]
#[rtic::app(device = crate::board::device, peripherals = true)]
mod app {
    use super::board::{
        CRYSTAL_MHZ, FIRMWARE, LinePort, LineReceive, LineTransmit, LogPort, LogTransmit, Pins,
    };
    use super::clock::{self, CORE_HZ};
    #[cfg(brake)]
    use super::drives::Drives;
    #[cfg(not(brake))]
    use super::drives::Drives as HeldDrives;
    use super::drives::{self, DriveTimer};
    #[cfg(interlocks)]
    use super::interlocks::{self, GuardedSwitches as Switches};
    use super::pins::Ports;
    use super::start;
    use super::switches;
    #[cfg(not(interlocks))]
    use super::switches::Switches;
    use embedded_hal_nb::serial::Read;
    use heapless::spsc::{Producer, Queue};
    use rp2040_hal::fugit::{ExtU32, RateExtU32};
    use rp2040_hal::gpio::{self, AnyPin, FunctionUart, Pin, PullNone, PullUp};
    use rp2040_hal::pwm::Slices;
    use rp2040_hal::typelevel::{OptionTNone, OptionTSome};
    use rp2040_hal::uart::{
        self, DataBits, FifoWatermark, Reader, StopBits, UartConfig, UartPeripheral, Writer,
    };
    use rp2040_hal::{Sio, Watchdog};
    use trirrr_app::{BAUD, LOG_BAUD, RECEIVED, WATCHDOG_MS};
    use trirrr_app::{Background, Channels, Tick, TickClock, period};
    use trirrr_protocol::message::{Board, Clock};

    type Transmit<P> = Pin<<P as AnyPin>::Id, FunctionUart, PullNone>;
    type LinePins = (
        Transmit<LineTransmit>,
        Pin<<LineReceive as AnyPin>::Id, FunctionUart, PullUp>,
    );
    type LogPins =
        uart::Pins<OptionTSome<Transmit<LogTransmit>>, OptionTNone, OptionTNone, OptionTNone>;

    /// Capacity of the receiver, bytes.
    const FIFO: usize = 32;

    #[cfg(brake)]
    type HeldDrives =
        trirrr_app::outputs::Braked<Drives, <super::board::Brake as super::pins::BoardPin>::Output>;

    #[cfg(all(tool = "none", not(lamp)))]
    type Outputs = HeldDrives;
    #[cfg(all(not(tool = "none"), not(lamp)))]
    type Outputs = trirrr_app::outputs::Tooled<HeldDrives, super::tool::ToolPin>;
    #[cfg(all(tool = "none", lamp))]
    type Outputs =
        trirrr_app::WithLamp<HeldDrives, <super::board::Lamp as super::pins::BoardPin>::Output>;
    #[cfg(all(not(tool = "none"), lamp))]
    type Outputs = trirrr_app::WithLamp<
        trirrr_app::outputs::Tooled<HeldDrives, super::tool::ToolPin>,
        <super::board::Lamp as super::pins::BoardPin>::Output,
    >;

    #[cfg(not(digital))]
    type ChipOutputs = Outputs;
    #[cfg(digital)]
    type ChipOutputs = super::digital::SwitchedOutputs<Outputs>;

    #[cfg(not(digital))]
    type ChipInputs = Switches;
    #[cfg(digital)]
    type ChipInputs = super::digital::SensedInputs<Switches>;

    #[shared]
    struct Shared {}

    #[local]
    struct Local {
        receiver: Reader<LinePort, LinePins>,
        received: Producer<'static, u8>,
        tick: Tick<ChipInputs, ChipOutputs>,
        slot: DriveTimer,
        background: Background<Writer<LinePort, LinePins>, Writer<LogPort, LogPins>>,
        watchdog: Watchdog,
    }

    #[init(local = [
        channels: Channels = Channels::new(),
        bytes: Queue<u8, RECEIVED> = Queue::new(),
    ])]
    fn init(context: init::Context) -> (Shared, Local) {
        let init::LocalResources {
            channels, bytes, ..
        } = context.local;
        let device = context.device;
        let start = start::cause(&device.WATCHDOG, &device.VREG_AND_CHIP_RESET);
        let mut resets = device.RESETS;
        let mut watchdog = Watchdog::new(device.WATCHDOG);
        let Some(line_clock) =
            clock::start(device.XOSC, device.CLOCKS, device.PLL_SYS, &mut resets)
        else {
            // The ring oscillator is too slow and too inexact for a line. So the board starts anew until the
            // crystal does.
            panic!("the crystal or the PLL does not start");
        };
        watchdog.enable_tick_generation(CRYSTAL_MHZ);

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
        };
        let pins = Pins::take(pins, slices, ports);
        let settings = |baud: u32| UartConfig::new(baud.Hz(), DataBits::Eight, None, StopBits::One);
        let line_pins = (
            pins.line_transmit.reconfigure(),
            pins.line_receive.reconfigure(),
        );
        let line = UartPeripheral::new(pins.line, line_pins, &mut resets)
            .enable(settings(BAUD), line_clock);
        let log_pins = uart::Pins::default().tx(pins.log_transmit.reconfigure());
        let log = UartPeripheral::new(pins.log, log_pins, &mut resets)
            .enable(settings(LOG_BAUD), line_clock);
        let (Ok(mut line), Ok(log)) = (line, log) else {
            panic!("the clock does not divide into the baud rates");
        };
        line.set_rx_watermark(FifoWatermark::Bytes4);
        let (mut receiver, line) = line.split();
        receiver.enable_rx_interrupt();
        let (_, log) = log.split();

        let board = Board {
            timer_hz: CORE_HZ,
            clock: Clock::Crystal,
            start,
        };
        let (foreground, background) = trirrr_app::build(channels, board, &FIRMWARE);
        let parts = drives::DriveParts {
            pins: pins.drives,
            slots: pins.slots,
            angles: foreground.output().motors.map(|motor| motor.angle),
        };
        let (outputs, slot) = drives::build(parts);
        #[cfg(brake)]
        let outputs = {
            let pin = super::pins::BoardPin::output(pins.brake, false);
            trirrr_app::outputs::Braked::new(outputs, pin)
        };
        #[cfg(not(tool = "none"))]
        let outputs = {
            let parts = super::tool::ToolParts {
                tool: pins.tool,
                enable: pins.tool_enable,
                slice: pins.tool_slice,
            };
            trirrr_app::outputs::Tooled::new(outputs, super::tool::build(parts))
        };
        #[cfg(lamp)]
        let outputs = {
            let pin = super::pins::BoardPin::output(pins.lamp, false);
            trirrr_app::WithLamp::new(outputs, pin)
        };
        #[cfg(homing)]
        let inputs = switches::build(pins.homing_1, pins.homing_2, pins.homing_3);
        #[cfg(not(homing))]
        let inputs = switches::Switches;
        #[cfg(interlocks)]
        let inputs = interlocks::build(
            inputs,
            (pins.stop, pins.door, pins.probe),
            (pins.limit_1, pins.limit_2, pins.limit_3),
        );
        #[cfg(digital)]
        let outputs = super::digital::outputs(
            outputs,
            (
                pins.output_1,
                pins.output_2,
                pins.output_3,
                pins.output_4,
                pins.output_5,
                pins.output_6,
                pins.output_7,
                pins.output_8,
            ),
        );
        #[cfg(digital)]
        let inputs = super::digital::inputs(
            inputs,
            (
                pins.input_1,
                pins.input_2,
                pins.input_3,
                pins.input_4,
                pins.input_5,
                pins.input_6,
                pins.input_7,
                pins.input_8,
            ),
        );
        watchdog.start(WATCHDOG_MS.millis());
        let (received, bytes) = bytes.split();
        let clock = TickClock::start(context.core.SYST, const { period(CORE_HZ) });
        let local = Local {
            receiver,
            received,
            tick: Tick::new(foreground, &board, inputs, outputs, clock),
            slot,
            background: Background::new(background, bytes, line, log),
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
    #[task(binds = LINE, priority = 3, local = [receiver, received])]
    fn line(context: line::Context) {
        let line::LocalResources {
            receiver, received, ..
        } = context.local;
        // Bounded: bytes beyond the receiver's capacity come later.
        for _ in 0..FIFO {
            match receiver.read() {
                // A damaged byte, or one without room, damages its frame, which the host repeats.
                Ok(byte) => {
                    let _ = received.enqueue(byte);
                }
                Err(nb::Error::WouldBlock) => return,
                Err(nb::Error::Other(_)) => {}
            }
        }
    }

    #[task(binds = SysTick, priority = 2, local = [tick])]
    fn tick(context: tick::Context) {
        context.local.tick.run();
    }

    #[idle(local = [background, watchdog])]
    fn idle(context: idle::Context) -> ! {
        let watchdog = context.local.watchdog;
        context.local.background.run(|| watchdog.feed())
    }
}

#[cfg(not(target_os = "none"))]
fn main() {
    trirrr_app::refuse_host("cargo fw-rp2040")
}
