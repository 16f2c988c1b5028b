//! First lines of the log.

use crate::scene::{NAME, TICK_RATE_HZ};
use trirrr_protocol::message::{Board, Clock, Start};

/// Logs how the board has started.
pub(crate) fn log_start(board: &Board) {
    defmt::info!("scene {=str}, {=f64} ticks per second", NAME, TICK_RATE_HZ);
    match board.clock {
        Clock::Crystal | Clock::Emulated | Clock::Host => {}
        Clock::Internal => defmt::warn!("the crystal does not start: internal oscillator and PLL"),
        Clock::Slow => defmt::warn!("no crystal and no PLL: internal oscillator"),
        Clock::WrongCrystal => {
            defmt::error!("check crystal_mhz of the board file: the crystal is another")
        }
    }
    match &board.start {
        Start::Power | Start::Reset => {}
        Start::Watchdog => defmt::error!("started by the watchdog"),
        Start::Panic { file, line } => {
            defmt::error!(
                "started after a panic in {=[u8]:a}, line {=u32}",
                *file,
                line
            );
        }
        Start::HardFault(at) => {
            defmt::error!("started after a hard fault at {=u32:#x}", at.pc);
        }
        Start::StackOverflow(at) => {
            defmt::error!("started after a stack overflow at {=u32:#x}", at.pc);
        }
        Start::CrystalStopped => defmt::error!("started after the crystal stopped"),
        Start::LowSupply => defmt::error!("started after the supply sagged"),
    }
}
