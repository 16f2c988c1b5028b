//! Failures outside of the program that end it: the crystal stops, the flash loses content.
#![allow(unsafe_code)]

/// The crystal has stopped, and the chip has put the core on the internal oscillator; or the flash tells that a double word is lost: one that a
/// cut of the power has left, or one of the program. Nothing masks this exception.
#[cortex_m_rt::exception]
unsafe fn NonMaskableInt() {
    #[cfg(outputs)]
    if stm32_metapac::RCC.cifr().read().cssf() {
        use trirrr_protocol::message::Start::CrystalStopped;
        trirrr_app::failure::end::<crate::failure::Stm32>(&CrystalStopped);
    }
    #[cfg(update)]
    if !trirrr_app::is_lost_expected() {
        panic!("the flash has lost a part of the program");
    }
}
