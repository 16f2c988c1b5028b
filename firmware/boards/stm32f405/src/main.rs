//! STM32F405: line and log on the ports of the board file, the tick on SysTick.
//!
//! | priority | interrupt | task |
//! |---|---|---|
//! | highest | CAN1_RX0 | a frame from a drive into its queue, in images for drives on the bus; not a task |
//! | 4 | TIM7 | a slot of the step pulses, in images for steppers; a sample of the loops, in images for amplifiers |
//! | 3 | LINE, that of the line's port | a byte from the line into its queue |
//! | 2 | SysTick | the tick |
//! | none | | the background |
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod board;
#[cfg(target_os = "none")]
mod chip;
#[cfg(target_os = "none")]
mod clock;
#[cfg(target_os = "none")]
mod dividers;
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
    use super::board::{FIRMWARE, LinePort, LogPort, Pins};
    use super::clock::{self, FAST, SLOW};
    use super::dividers::set_bauds;
    #[cfg(brake)]
    use super::drives::Drives;
    #[cfg(not(brake))]
    use super::drives::Drives as HeldDrives;
    #[cfg(any(drive = "odrive", drive = "mit"))]
    use super::drives::Inbox;
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
    use stm32f4xx_hal::prelude::*;
    use stm32f4xx_hal::serial::{self, Rx, RxListen, Serial, Tx};
    use stm32f4xx_hal::watchdog::IndependentWatchdog;
    use trirrr_app::{BAUD, LOG_BAUD, RECEIVED, WATCHDOG_MS};
    use trirrr_app::{Background, Channels, Tick, TickClock, period};
    use trirrr_protocol::message::{Board, Clock};

    #[cfg(brake)]
    type HeldDrives =
        trirrr_app::outputs::Braked<Drives, <super::board::Brake as super::pins::BoardPin>::Output>;

    #[cfg(tool = "none")]
    type Outputs = HeldDrives;
    #[cfg(not(tool = "none"))]
    type Outputs = trirrr_app::outputs::Tooled<HeldDrives, super::tool::ToolPin>;

    #[shared]
    struct Shared {}

    #[local]
    struct Local {
        receiver: Rx<LinePort>,
        received: Producer<'static, u8>,
        tick: Tick<Switches, Outputs>,
        timer: DriveTimer,
        background: Background<Tx<LinePort>, Tx<LogPort>>,
        watchdog: IndependentWatchdog,
    }

    #[init(local = [
        channels: Channels = Channels::new(),
        bytes: Queue<u8, RECEIVED> = Queue::new(),
        #[cfg(any(drive = "odrive", drive = "mit"))]
        inbox: Inbox = Queue::new(),
    ])]
    fn init(context: init::Context) -> (Shared, Local) {
        let init::LocalResources {
            channels,
            bytes,
            #[cfg(any(drive = "odrive", drive = "mit"))]
            inbox,
            ..
        } = context.local;
        let device = context.device;
        let start = start::cause(&device.RCC);
        let (clock, clocks) = clock::start(&device.RCC, &device.FLASH, &device.DBGMCU);
        let period = match clock {
            Clock::Slow => const { period(SLOW.core) },
            _ => const { period(FAST.core) },
        };
        let mut rcc = device.RCC.constrain();

        let ports = Ports {
            a: device.GPIOA,
            b: device.GPIOB,
            c: device.GPIOC,
            d: device.GPIOD,
            e: device.GPIOE,
            usart1: device.USART1,
            usart2: device.USART2,
            usart3: device.USART3,
            usart6: device.USART6,
        };
        let pins = Pins::take(ports, &mut rcc);
        let settings = |baud: u32| serial::Config::default().baudrate(baud.bps());
        // At rest the line is high: without an adapter at the pin noise would be bytes, and each of them an interrupt above the tick.
        let receive = pins.line_receive.into_pull_up_input();
        let line_pins = (pins.line_transmit, receive);
        let line = Serial::new(pins.line, line_pins, settings(BAUD), &mut rcc);
        let log = pins.log.tx(pins.log_transmit, settings(LOG_BAUD), &mut rcc);
        let (Ok(line), Ok(log)) = (line, log) else {
            panic!("the slowest clock does not divide into the baud rates");
        };
        set_bauds(&clocks, BAUD, LOG_BAUD);
        let (line, mut receiver) = line.split();
        receiver.listen();

        let board = Board {
            timer_hz: clocks.core,
            clock,
            start,
        };
        let (foreground, background) = trirrr_app::build(channels, board, FIRMWARE);
        let parts = drives::DriveParts {
            pins: pins.drives,
            tim1: device.TIM1,
            tim3: device.TIM3,
            tim4: device.TIM4,
            tim5: device.TIM5,
            tim7: device.TIM7,
            can1: device.CAN1,
            clocks,
            #[cfg(feedback)]
            clock,
            #[cfg(any(drive = "odrive", drive = "mit"))]
            inbox,
            angles: foreground.output().motors.map(|motor| motor.angle),
        };
        let (outputs, timer) = drives::build(parts, &mut rcc);
        #[cfg(brake)]
        let outputs = trirrr_app::outputs::Braked::new(
            outputs,
            super::pins::BoardPin::output(pins.brake, false),
        );
        #[cfg(not(tool = "none"))]
        let outputs = {
            let parts = super::tool::ToolParts {
                tool: pins.tool,
                enable: pins.tool_enable,
                tim2: device.TIM2,
                clocks,
            };
            let tool = super::tool::build(parts, &mut rcc);
            trirrr_app::outputs::Tooled::new(outputs, tool)
        };
        #[cfg(homing)]
        let inputs = switches::build(pins.homing_1, pins.homing_2, pins.homing_3);
        #[cfg(not(homing))]
        let inputs = switches::Switches;
        #[cfg(interlocks)]
        let inputs = interlocks::build(inputs, pins.stop, pins.door);
        let mut watchdog = IndependentWatchdog::new(device.IWDG);
        watchdog.stop_on_debug(&device.DBGMCU, true);
        watchdog.start(WATCHDOG_MS.millis());
        let (received, bytes) = bytes.split();
        let clock = TickClock::start(context.core.SYST, period);
        let local = Local {
            receiver,
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
    #[task(binds = LINE, priority = 3, local = [receiver, received])]
    fn line(context: line::Context) {
        // A damaged byte, or one without room, damages its frame, which the host repeats.
        if let Ok(byte) = context.local.receiver.read() {
            let _ = context.local.received.enqueue(byte);
        }
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
            #[cfg(any(drive = "odrive", drive = "mit"))]
            drives::report();
        })
    }
}

#[cfg(not(target_os = "none"))]
fn main() {
    trirrr_app::refuse_host("cargo fw")
}
