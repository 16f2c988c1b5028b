//! STM32F405: the line on USART2 (PA2 TX, PA3 RX), the log on USART3 (PB10 TX), the tick on SysTick.
//!
//! | priority | interrupt | task |
//! |---|---|---|
//! | highest | CAN1_RX0 | a frame from a drive into its queue, in images for drives on the bus; not a task |
//! | 4 | TIM7 | a slot of the step pulses, in images for steppers; a sample of the loops, in images for amplifiers |
//! | 3 | USART2 | a byte from the line into its queue |
//! | 2 | SysTick | the tick |
//! | none | | the background |
#![cfg_attr(target_os = "none", no_std, no_main)]

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
#[rtic::app(device = stm32f4xx_hal::pac, peripherals = true)]
mod app {
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
    use super::start;
    use super::switches;
    #[cfg(not(interlocks))]
    use super::switches::Switches;
    use embedded_hal_nb::serial::Read;
    use heapless::spsc::{Producer, Queue};
    use stm32f4xx_hal::pac::{USART2, USART3};
    use stm32f4xx_hal::prelude::*;
    use stm32f4xx_hal::serial::{self, Rx, RxListen, Serial, Tx};
    use stm32f4xx_hal::watchdog::IndependentWatchdog;
    use trirrr_app::{BAUD, LOG_BAUD, RECEIVED, WATCHDOG_MS};
    use trirrr_app::{Background, Channels, Tick, TickClock, period};
    use trirrr_protocol::message::{Board, Clock};

    #[cfg(brake)]
    type HeldDrives =
        trirrr_app::outputs::Braked<Drives, stm32f4xx_hal::gpio::PB0<stm32f4xx_hal::gpio::Output>>;

    #[cfg(tool = "none")]
    type Outputs = HeldDrives;
    #[cfg(not(tool = "none"))]
    type Outputs = trirrr_app::outputs::Tooled<HeldDrives, super::tool::ToolPin>;

    #[shared]
    struct Shared {}

    #[local]
    struct Local {
        receiver: Rx<USART2>,
        received: Producer<'static, u8>,
        tick: Tick<Switches, Outputs>,
        timer: DriveTimer,
        background: Background<Tx<USART2>, Tx<USART3>>,
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

        let (a, b) = (device.GPIOA.split(&mut rcc), device.GPIOB.split(&mut rcc));
        let settings = |baud: u32| serial::Config::default().baudrate(baud.bps());
        let line = Serial::new(device.USART2, (a.pa2, a.pa3), settings(BAUD), &mut rcc);
        let log = device.USART3.tx(b.pb10, settings(LOG_BAUD), &mut rcc);
        let (Ok(line), Ok(log)) = (line, log) else {
            panic!("the slowest clock does not divide into the baud rates");
        };
        set_bauds(clocks.apb1, BAUD, LOG_BAUD);
        let (line, mut receiver) = line.split();
        receiver.listen();

        let board = Board {
            timer_hz: clocks.core,
            clock,
            start,
        };
        let (foreground, background) = trirrr_app::build(channels, board);
        let parts = drives::DriveParts {
            pa0: a.pa0,
            pa1: a.pa1,
            pa8: a.pa8,
            pa9: a.pa9,
            pb6: b.pb6,
            pb7: b.pb7,
            pb8: b.pb8,
            pb9: b.pb9,
            pb12: b.pb12,
            port_c: device.GPIOC,
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
        let outputs = trirrr_app::outputs::Braked::new(outputs, b.pb0.into_push_pull_output());
        #[cfg(not(tool = "none"))]
        let outputs = {
            let parts = super::tool::ToolParts {
                pa4: a.pa4,
                pa5: a.pa5,
                tim2: device.TIM2,
                clocks,
            };
            let tool = super::tool::build(parts, &mut rcc);
            trirrr_app::outputs::Tooled::new(outputs, tool)
        };
        let inputs = switches::build(b.pb13, b.pb14, b.pb15);
        #[cfg(interlocks)]
        let inputs = interlocks::build(inputs, a.pa6, a.pa7);
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
    #[task(binds = USART2, priority = 3, local = [receiver, received])]
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
