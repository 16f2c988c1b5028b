//! Program of an STM32: line and log on the ports of the board file, the tick on SysTick.
//!
//! | priority | interrupt | task |
//! |---|---|---|
//! | above all | NMI | the crystal has stopped: outputs off, start anew; in images with drives or a tool |
//! | above all | PVD | the supply sags: the same, in images of an STM32F405 |
//! | above all | NMI | a double word of the flash is lost; in images of an STM32G474 that are replaced over the line |
//! | highest | that of the CAN controller | a frame from a drive into its queue, in images for drives on the bus; not a task |
//! | 4 | TIM7 | a slot of the step pulses, in images for steppers; a sample of the loops, in images for amplifiers |
//! | 3 | LINE, that of the DMA of the line's receiver | a round of its ring is full |
//! | 2 | SysTick | the tick |
//! | 1 | USB | packets in both directions, in images with the line over USB in place of a port |
//! | none | | the background |

#[rtic::app(device = crate::board::device, peripherals = true)]
mod app {
    use crate::board::{FIRMWARE, Pins};
    use crate::clock::{FAST, SLOW};
    #[cfg(any(drive = "odrive", drive = "mit", drive = "moteus"))]
    use crate::drives::Inbox;
    use crate::drives::{self, DriveTimer};
    use crate::inputs::{self, BoardInputs};
    #[cfg(not(usb))]
    use crate::line::{LineReceiver, LineTransmitter};
    use crate::outputs::{self, BoardOutputs};
    use crate::parts::{self, Watchdog};
    use crate::serial::{self, LogTransmitter};
    #[cfg(usb)]
    use crate::usb::{self, PacketMemory, PacketReceiver, PacketTransmitter as LineTransmitter};
    #[cfg(any(drive = "odrive", drive = "mit", drive = "moteus"))]
    use heapless::spsc::Queue;
    use trirrr_app::{Background, Channels, Tick, TickClock, period};
    use trirrr_protocol::message::{Board, Clock};

    // RTIC names the types of all resources, of those too that an image does not have.
    #[cfg(not(usb))]
    type PacketReceiver = ();

    /// What the background receives from.
    #[cfg(usb)]
    type LineReceiver = heapless::spsc::Consumer<'static, u8>;

    #[shared]
    struct Shared {}

    #[local]
    struct Local {
        #[cfg(usb)]
        packets: PacketReceiver,
        tick: Tick<BoardInputs, BoardOutputs>,
        timer: DriveTimer,
        background: Background<LineTransmitter, LogTransmitter, LineReceiver>,
        watchdog: Watchdog,
    }

    #[init(local = [
        channels: Channels = Channels::new(),
        #[cfg(usb)]
        memory: PacketMemory = PacketMemory::new(),
        #[cfg(any(drive = "odrive", drive = "mit", drive = "moteus"))]
        inbox: Inbox = Queue::new(),
    ])]
    fn init(context: init::Context) -> (Shared, Local) {
        let init::LocalResources {
            channels,
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
        let (packets, receiver, line) =
            usb::start(memory, (pins.usb_minus, pins.usb_plus), &clocks);

        let board = Board {
            timer_hz: clocks.core,
            clock,
            start: chip.start,
        };
        let (foreground, background) = trirrr_app::build(channels, board, FIRMWARE);
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
        let (drives, timer) = drives::build(parts, &mut rcc);
        #[cfg(not(tool = "none"))]
        let tool = {
            let parts = crate::tool::ToolParts {
                tool: pins.tool,
                enable: pins.tool_enable,
                counter: chip.tool,
                clocks,
            };
            crate::tool::build(parts, &mut rcc)
        };
        let outputs = outputs::build(
            drives,
            #[cfg(not(tool = "none"))]
            tool,
            pins.outputs,
        );
        let inputs = inputs::build(pins.inputs);
        let watchdog = chip.watchdog.start();
        let clock = TickClock::start(context.core.SYST, period);
        let local = Local {
            #[cfg(usb)]
            packets,
            tick: Tick::new(foreground, &board, inputs, outputs, clock),
            timer,
            background: Background::new(background, receiver, line, log),
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

    /// Counts a round of the line's ring. Above the tick: two rounds must not become one while a tick lasts.
    #[cfg(not(usb))]
    #[task(binds = LINE, priority = 3)]
    fn round(_: round::Context) {
        crate::line::count_round();
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
            #[cfg(usb)]
            trirrr_app::usb::resume(crate::board::device::interrupt::USB);
            #[cfg(any(drive = "odrive", drive = "mit", drive = "moteus"))]
            drives::report();
        })
    }
}
