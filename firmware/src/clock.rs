//! The tick: SysTick counts, the application waits.

use core::sync::atomic::{AtomicU32, Ordering};
use cortex_m::peripheral::{SYST, syst::SystClkSource};

/// The internal oscillator, which runs the core after reset, Hz.
const CORE_CLOCK_HZ: f64 = 16e6;

/// SysTick counts 24 bits.
const MODULUS: u32 = 1 << 24;

/// Ticks since [`Clock::start`]. Only the handler writes.
static TICKS: AtomicU32 = AtomicU32::new(0);

/// Ticks at the scene's rate.
pub(crate) struct Clock {
    /// The last tick that [`Clock::wait`] returned for.
    served: u32,
}

impl Clock {
    /// Starts SysTick, one tick from now.
    pub(crate) fn start(mut systick: SYST, rate_hz: f64) -> Self {
        let cycles = (CORE_CLOCK_HZ / rate_hz + 0.5) as u32;
        defmt::assert!(
            0 < cycles && cycles <= MODULUS,
            "the rate does not fit SysTick"
        );
        systick.set_clock_source(SystClkSource::Core);
        systick.set_reload(cycles - 1);
        systick.clear_current();
        systick.enable_interrupt();
        systick.enable_counter();
        Self { served: 0 }
    }

    /// Sleeps until the next tick. Returns how many ticks went by without being waited for: 0
    /// unless the application was late.
    pub(crate) fn wait(&mut self) -> u32 {
        loop {
            let passed = TICKS.load(Ordering::Relaxed).wrapping_sub(self.served);
            if passed > 0 {
                self.served = self.served.wrapping_add(passed);
                return passed - 1;
            }
            // An interrupt between the check and this costs one period at most when SysTick is
            // the only one, so sleep only with interrupts held: a pending one still wakes.
            cortex_m::interrupt::free(|_| {
                if TICKS.load(Ordering::Relaxed) == self.served {
                    cortex_m::asm::wfi();
                }
            });
        }
    }
}

#[cortex_m_rt::exception]
fn SysTick() {
    // A load and a store, not a read-modify-write: nobody else writes.
    TICKS.store(
        TICKS.load(Ordering::Relaxed).wrapping_add(1),
        Ordering::Relaxed,
    );
}
