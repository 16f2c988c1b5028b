//! Drivers by the registers of `stm32-metapac`, which has one set of names for all STM32s.

#[cfg(not(usb))]
pub(crate) mod dma;
pub(crate) mod drives;
pub(crate) mod gpio;
pub(crate) mod serial;
pub(crate) mod timers;
pub(crate) mod watchdog;

/// The device as RTIC sees it.
pub(crate) mod device {
    pub(crate) use stm32_metapac::{Interrupt, NVIC_PRIO_BITS};

    /// Registers are constants: there is nothing to hand out.
    pub(crate) struct Peripherals;

    impl Peripherals {
        /// # Safety
        /// None: there is nothing to share.
        #[allow(unsafe_code)]
        pub(crate) unsafe fn steal() -> Self {
            Self
        }
    }
}
