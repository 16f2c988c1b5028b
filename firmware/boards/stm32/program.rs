//! Program of an STM32: line and log on the ports of the board file, the tick on SysTick.
//!
//! | priority | interrupt | task |
//! |---|---|---|
//! | above all | NMI, PVD | the crystal has stopped, the supply sags: outputs off, start anew; in images of an STM32F405 with drives or a tool |
//! | highest | that of the CAN controller | a frame from a drive into its queue, in images for drives on the bus; not a task |
//! | 4 | TIM7 | a slot of the step pulses, in images for steppers; a sample of the loops, in images for amplifiers |
//! | 3 | LINE, that of the line's port | a byte from the line into its queue |
//! | 2 | SysTick | the tick |
//! | 1 | USB | packets in both directions, in images with the line over USB in place of a port |
//! | none | | the background |

#[rtic::app(device = crate::board::device, peripherals = true)]
mod app {
    use crate::board::{FIRMWARE, Pins};
    use crate::clock::{FAST, SLOW};
    #[cfg(brake)]
    use crate::drives::Drives;
    #[cfg(not(brake))]
    use crate::drives::Drives as HeldDrives;
    #[cfg(any(drive = "odrive", drive = "mit", drive = "moteus"))]
    use crate::drives::Inbox;
    use crate::drives::{self, DriveTimer};
    #[cfg(interlocks)]
    use crate::interlocks::{self, GuardedSwitches as Switches};
    use crate::parts::{self, Watchdog};
    use crate::serial::{self, LogTransmitter};
    #[cfg(not(usb))]
    use crate::serial::{LineReceiver, LineTransmitter};
    use crate::switches;
    #[cfg(not(interlocks))]
    use crate::switches::Switches;
    #[cfg(usb)]
    use crate::usb::{
        self, PacketMemory, PacketReceiver as LineReceiver, PacketTransmitter as LineTransmitter,
    };
    #[cfg(not(usb))]
    use embedded_hal_nb::serial::Read;
    // RTIC names the types of all resources.
    use heapless::spsc::Producer;
    #[cfg(any(not(usb), drive = "odrive", drive = "mit", drive = "moteus"))]
    use heapless::spsc::Queue;
    #[cfg(not(usb))]
    use trirrr_app::RECEIVED;
    use trirrr_app::{Background, Channels, Tick, TickClock, period};
    use trirrr_protocol::message::{Board, Clock};

    #[cfg(brake)]
    type HeldDrives =
        trirrr_app::outputs::Braked<Drives, <crate::board::Brake as crate::pins::BoardPin>::Output>;

    #[cfg(all(tool = "none", not(lamp)))]
    type Outputs = HeldDrives;
    #[cfg(all(not(tool = "none"), not(lamp)))]
    type Outputs = trirrr_app::outputs::Tooled<HeldDrives, crate::tool::ToolPin>;
    #[cfg(all(tool = "none", lamp))]
    type Outputs =
        trirrr_app::WithLamp<HeldDrives, <crate::board::Lamp as crate::pins::BoardPin>::Output>;
    #[cfg(all(not(tool = "none"), lamp))]
    type Outputs = trirrr_app::WithLamp<
        trirrr_app::outputs::Tooled<HeldDrives, crate::tool::ToolPin>,
        <crate::board::Lamp as crate::pins::BoardPin>::Output,
    >;

    #[shared]
    struct Shared {}

    #[local]
    struct Local {
        #[cfg(not(usb))]
        receiver: LineReceiver,
        #[cfg(usb)]
        packets: LineReceiver,
        #[cfg(not(usb))]
        received: Producer<'static, u8>,
        tick: Tick<Switches, Outputs>,
        timer: DriveTimer,
        background: Background<LineTransmitter, LogTransmitter>,
        watchdog: Watchdog,
    }

    #[init(local = [
        channels: Channels = Channels::new(),
        #[cfg(not(usb))]
        bytes: Queue<u8, RECEIVED> = Queue::new(),
        #[cfg(usb)]
        memory: PacketMemory = PacketMemory::new(),
        #[cfg(any(drive = "odrive", drive = "mit", drive = "moteus"))]
        inbox: Inbox = Queue::new(),
    ])]
    fn init(context: init::Context) -> (Shared, Local) {
        let init::LocalResources {
            channels,
            #[cfg(not(usb))]
            bytes,
            #[cfg(usb)]
            memory,
            #[cfg(any(drive = "odrive", drive = "mit", drive = "moteus"))]
            inbox,
            ..
        } = context.local;
        let chip = parts::start(context.device);
        let (clock, clocks, mut rcc) = (chip.clock, chip.clocks, chip.rcc);
        let period = match clock {
            Clock::Slow => const { period(SLOW.core) },
            _ => const { period(FAST.core) },
        };
        let pins = Pins::take(chip.ports, &mut rcc);
        #[cfg(not(usb))]
        let (line, receiver, log) = serial::start(
            (pins.line, pins.line_transmit, pins.line_receive),
            (pins.log, pins.log_transmit),
            &clocks,
            &mut rcc,
        );
        #[cfg(usb)]
        let log = serial::start_log((pins.log, pins.log_transmit), &clocks, &mut rcc);
        #[cfg(usb)]
        let (receiver, bytes, line) = usb::start(memory, (pins.usb_minus, pins.usb_plus), &clocks);

        let board = Board {
            timer_hz: clocks.core,
            clock,
            start: chip.start,
        };
        let (foreground, background) = trirrr_app::build(channels, board, &FIRMWARE);
        let parts = drives::DriveParts {
            pins: pins.drives,
            peripherals: chip.drives,
            clocks,
            #[cfg(feedback)]
            clock,
            #[cfg(any(drive = "odrive", drive = "mit", drive = "moteus"))]
            inbox,
            angles: foreground.output().motors.map(|motor| motor.angle),
        };
        let (outputs, timer) = drives::build(parts, &mut rcc);
        #[cfg(brake)]
        let outputs = trirrr_app::outputs::Braked::new(
            outputs,
            crate::pins::BoardPin::output(pins.brake, false),
        );
        #[cfg(not(tool = "none"))]
        let outputs = {
            let parts = crate::tool::ToolParts {
                tool: pins.tool,
                enable: pins.tool_enable,
                counter: chip.tool,
                clocks,
            };
            let tool = crate::tool::build(parts, &mut rcc);
            trirrr_app::outputs::Tooled::new(outputs, tool)
        };
        #[cfg(lamp)]
        let outputs = {
            let pin = crate::pins::BoardPin::output(pins.lamp, false);
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
        let watchdog = chip.watchdog.start();
        #[cfg(not(usb))]
        let (received, bytes) = bytes.split();
        let clock = TickClock::start(context.core.SYST, period);
        let local = Local {
            #[cfg(not(usb))]
            receiver,
            #[cfg(usb)]
            packets: receiver,
            #[cfg(not(usb))]
            received,
            tick: Tick::new(foreground, &board, inputs, outputs, clock),
            timer,
            background: Background::new(background, bytes, line, log),
            watchdog,
        };
        (Shared {}, local)
    }

    /// A slot of the steppers, or a sample of the loops. Above all else: the time of a pulse is its value, and so is that of
    /// a rate.
    #[cfg(any(drive = "stepper", drive = "bldc"))]
    #[task(binds = TIM7, priority = 4, local = [timer])]
    fn slot(context: slot::Context) {
        context.local.timer.run();
    }

    /// Moves a byte from the line into its queue. Above the tick: the receiver holds one byte, and at
    /// 921,600 baud the next comes 1,822 cycles later, less than a tick may take.
    #[cfg(not(usb))]
    #[task(binds = LINE, priority = 3, local = [receiver, received])]
    fn line(context: line::Context) {
        // A damaged byte, or one without room, damages its frame, which the host repeats.
        if let Ok(byte) = context.local.receiver.read() {
            let _ = context.local.received.enqueue(byte);
        }
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
        context.local.background.run(|| {
            watchdog.feed();
            #[cfg(usb)]
            trirrr_app::usb::resume(crate::board::device::interrupt::USB);
            #[cfg(any(drive = "odrive", drive = "mit", drive = "moteus"))]
            drives::report();
        })
    }
}
