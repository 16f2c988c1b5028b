//! STM32F405: the line on USART2 (PA2 TX, PA3 RX), the log on USART3 (PB10 TX), the tick on
//! SysTick.

mod clock;
mod dividers;
mod drives;
mod pins;
mod registers;
mod start;
mod switches;

pub(crate) use registers::{RAM, fault_status, outputs_off, reset};

/// The clock of the core, Hz, where the PLL starts.
#[cfg(feature = "provoke")]
pub(crate) const CORE_HZ: u32 = clock::FAST.core;

#[rtic::app(device = stm32f4xx_hal::pac, peripherals = true)]
mod app {
    use super::clock::{self, FAST, SLOW};
    use super::dividers::set_bauds;
    use super::drives::{self, Drives, Slot};
    use super::start;
    use super::switches::{self, Switches};
    use crate::background::Background;
    use crate::pulse::{PATIENCE_MS, Pulse};
    use crate::systick::{TickClock, period};
    use crate::tick::Tick;
    use embedded_hal_nb::serial::Read;
    use heapless::spsc::{Producer, Queue};
    use stm32f4xx_hal::pac::{USART2, USART3};
    use stm32f4xx_hal::prelude::*;
    use stm32f4xx_hal::serial::{self, Rx, RxListen, Serial, Tx};
    use stm32f4xx_hal::watchdog::IndependentWatchdog;
    use trirrr_protocol::message::{Board, Clock};
    use trirrr_station::{self as station, Channels};
    use trirrr_station::{BAUD, LOG_BAUD, RECEIVED};

    #[shared]
    struct Shared {}

    #[local]
    struct Local {
        receiver: Rx<USART2>,
        received: Producer<'static, u8>,
        clock: TickClock,
        tick: Tick<Switches, Drives>,
        slot: Slot,
        background: Background<Tx<USART2>, Tx<USART3>>,
        watchdog: IndependentWatchdog,
        pulse: Pulse,
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
        let start = start::cause(&device.RCC);
        #[cfg(feature = "provoke")]
        crate::provoke::arm(&start);
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
        let (received, out) = bytes.split();
        let (mut foreground, background) = station::build(channels, board, out);
        crate::tick::heed(&board.start, &mut foreground);
        let parts = drives::Parts {
            pb8: b.pb8,
            pb9: b.pb9,
            pb12: b.pb12,
            port_c: device.GPIOC,
            tim3: device.TIM3,
            tim7: device.TIM7,
            can1: device.CAN1,
            clocks,
            is_emulated: clock == Clock::Emulated,
            angles: foreground.output().motors.map(|motor| motor.angle),
        };
        let (outputs, slot) = drives::build(parts, &mut rcc);
        let inputs = switches::build(b.pb13, b.pb14, b.pb15);
        let mut watchdog = IndependentWatchdog::new(device.IWDG);
        watchdog.stop_on_debug(&device.DBGMCU, true);
        watchdog.start(PATIENCE_MS.millis());
        let local = Local {
            receiver,
            received,
            clock: TickClock::start(context.core.SYST, period),
            tick: Tick::new(foreground, inputs, outputs),
            slot,
            background: Background::new(background, line, log),
            watchdog,
            pulse: Pulse::default(),
        };
        (Shared {}, local)
    }

    /// A slot of the steppers: a pulse's time is its value.
    #[cfg(drive = "stepper")]
    #[task(binds = TIM7, priority = 4, local = [slot])]
    fn slot(context: slot::Context) {
        context.local.slot.run();
    }

    /// A byte from the line into its queue: but for the slots nothing else is above the tick. The
    /// receiver holds one byte and no more, and at 921,600 baud the next one is there 1,822 cycles
    /// later, which is less than a tick may take.
    #[task(binds = USART2, priority = 3, local = [receiver, received])]
    fn line(context: line::Context) {
        // A byte that is damaged or finds no room damages its frame, which the host repeats.
        if let Ok(byte) = context.local.receiver.read() {
            let _ = context.local.received.enqueue(byte);
        }
    }

    #[task(binds = SysTick, priority = 2, local = [tick, clock])]
    fn tick(context: tick::Context) {
        let tick::LocalResources { tick, clock, .. } = context.local;
        tick.run();
        tick.took(clock.elapsed(), clock.period());
    }

    #[idle(local = [background, watchdog, pulse])]
    fn idle(context: idle::Context) -> ! {
        let idle::LocalResources {
            background,
            watchdog,
            pulse,
            ..
        } = context.local;
        loop {
            if pulse.beats() {
                watchdog.feed();
            }
            // It never sleeps: from sleep a tick starts late, a debugger loses the core, and in an
            // emulator time jumps with the host's.
            background.step();
        }
    }
}
