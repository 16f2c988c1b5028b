//! STM32F405: the line on USART2 (PA2 TX, PA3 RX), the tick on SysTick.

use defmt_rtt as _;
use panic_probe as _;

#[rtic::app(device = stm32f4xx_hal::pac, peripherals = true)]
mod app {
    use crate::background::Background;
    use crate::line::RECEIVED;
    use crate::outputs::{NoOutputs, Outputs};
    use crate::scene::TICK_RATE_HZ;
    use crate::station::{self, Channels, Foreground};
    use cortex_m::peripheral::syst::SystClkSource;
    use embedded_hal_nb::serial::Read;
    use heapless::spsc::{Producer, Queue};
    use stm32f4xx_hal::pac::USART2;
    use stm32f4xx_hal::prelude::*;
    use stm32f4xx_hal::rcc::Config;
    use stm32f4xx_hal::serial::{self, Rx, RxListen, Serial, Tx};

    #[shared]
    struct Shared {}

    #[local]
    struct Local {
        receiver: Rx<USART2>,
        received: Producer<'static, u8>,
        foreground: Foreground,
        outputs: NoOutputs,
        background: Background<Tx<USART2>>,
    }

    #[init(local = [channels: Channels = Channels::new(), bytes: Queue<u8, RECEIVED> = Queue::new()])]
    fn init(context: init::Context) -> (Shared, Local) {
        let init::LocalResources {
            channels, bytes, ..
        } = context.local;
        let device = context.device;
        let core_hz = match device.DBGMCU.idcode().read().bits() {
            0 => 168_000_000.0,
            _ => 16_000_000.0,
        };
        let mut rcc = device.RCC.freeze(Config::hsi());
        let pins = device.GPIOA.split(&mut rcc);
        let settings = serial::Config::default().baudrate(115_200.bps());
        let serial = Serial::new(device.USART2, (pins.pa2, pins.pa3), settings, &mut rcc);
        let (transmitter, mut receiver) = defmt::unwrap!(serial.ok()).split();
        receiver.listen();
        let (received, out) = bytes.split();

        let (foreground, background) = defmt::unwrap!(station::build(channels).ok());
        let mut systick = context.core.SYST;
        systick.set_clock_source(SystClkSource::Core);
        systick.set_reload((core_hz / TICK_RATE_HZ + 0.5) as u32 - 1);
        systick.clear_current();
        systick.enable_interrupt();
        systick.enable_counter();
        let local = Local {
            receiver,
            received,
            foreground,
            outputs: NoOutputs,
            background: Background::new(background, out, transmitter),
        };
        (Shared {}, local)
    }

    /// Above the tick: the receiver holds one byte and no more.
    #[task(binds = USART2, priority = 3, local = [receiver, received])]
    fn line(context: line::Context) {
        // A byte that is damaged or finds no room damages its frame, which the host repeats.
        if let Ok(byte) = context.local.receiver.read() {
            let _ = context.local.received.enqueue(byte);
        }
    }

    #[task(binds = SysTick, priority = 2, local = [foreground, outputs])]
    fn tick(context: tick::Context) {
        let output = context.local.foreground.tick();
        context.local.outputs.apply(output);
    }

    #[idle(local = [background])]
    fn idle(context: idle::Context) -> ! {
        loop {
            while context.local.background.step() {}
        }
    }
}
