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

#[rtic::app(device = crate::board::device, peripherals = false)]
mod app {
    use crate::board::{self, FIRMWARE, InputPins, OutputPins, Pins, ToolPart};
    use crate::clock::{FAST, SLOW};
    use crate::drives::{self, DriveParts, DriveTimer, Drives, Inbox};
    use crate::line::{self, LineMemory, LineReceiver, LineTransmitter, PacketReceiver};
    use crate::serial::{self, LogTransmitter};
    use crate::start;
    use crate::watchdog::Watchdog;
    use trirrr_app::outputs::WithParts;
    use trirrr_app::{Background, Channels, Tick, TickClock, period};
    use trirrr_boards::{BuiltInputs, OutputsBeside};
    use trirrr_protocol::message::{Board, Clock};

    type BoardInputs = <InputPins as BuiltInputs>::Inputs;
    type BoardOutputs = WithParts<Drives, <OutputPins as OutputsBeside>::Parts<ToolPart>>;

    #[shared]
    struct Shared {}

    #[local]
    struct Local {
        packets: PacketReceiver,
        tick: Tick<BoardInputs, BoardOutputs>,
        timer: DriveTimer,
        background: Background<LineTransmitter, LogTransmitter, LineReceiver>,
        watchdog: Watchdog,
    }

    #[init(local = [
        channels: Channels = Channels::new(),
        memory: LineMemory = LineMemory::new(),
        inbox: Inbox = drives::no_frames(),
    ])]
    fn init(context: init::Context) -> (Shared, Local) {
        let init::LocalResources {
            channels,
            memory,
            inbox,
            ..
        } = context.local;
        let (start, clock, clocks) = start::start();
        let period = match clock {
            Clock::Slow => const { period(SLOW.core) },
            _ => const { period(FAST.core) },
        };
        let pins = Pins::take();
        #[allow(clippy::let_unit_value)] // where there is none
        let log = serial::start_log(pins.log_transmit, &clocks);
        let (packets, receiver, line) = line::start(memory, pins.line, &clocks);

        let board = Board {
            timer_hz: clocks.core,
            clock,
            start,
        };
        let (foreground, background) = trirrr_app::build(channels, board, FIRMWARE);
        let (drives, timer) = drives::build(DriveParts {
            pins: pins.drives,
            clocks,
            clock,
            inbox,
            angles: foreground.output().motors.map(|motor| motor.angle),
        });
        let tool = board::tool::build((pins.tool, clocks));
        let outputs = WithParts {
            drives,
            parts: pins.outputs.build(tool),
        };
        let inputs = pins.inputs.build();
        let watchdog = Watchdog::start();
        let clock = TickClock::start(context.core.SYST, period);
        let local = Local {
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
    #[cfg(not(any(usb, autonomous)))]
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
            line::resume();
            drives::report();
        })
    }
}
