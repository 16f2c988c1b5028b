//! Update of an image over the line, and the way back: the logic of the boot loader and of the program that receives.
//!
//! The flash has three slots and a journal ([`Layout`]). The program runs from the first slot. It writes a new image into the second
//! ([`Receiver`]), compares its checksum, and asks for it in the journal. At the next start the boot loader ([`boot`])
//! copies the program into the third slot and the new image into the first, and starts it on trial. The new program
//! [confirms](confirm) itself. Where it has not, the next start copies the old one back. Two smaller slots [keep](kept) a scene that has come
//! over the line for the program; the boot loader does not look at them.
//!
//! # Power cuts
//! Each step of the boot loader copies from a slot that it does not write, and is repeated from its beginning until the journal has
//! its end. Records of the journal have checksums: one that was cut counts as none. `tests/power_cuts` cuts the power at
//! each erasure and each unit. A unit whose content the flash itself finds lost counts as none, too ([`Flash::unit`]), and one that looks erased
//! and takes no content is passed over.
//!
//! # embassy-boot
//! The kept library for this is not used, for three reasons. It swaps two slots and counts pages in a sector which each change of
//! state erases: an erasure that is cut may lose the count and keep the state, which mixes both images. Here nothing is
//! erased while it counts. It confirms by an erasure, which stops a program on a chip with one bank for up to
//! 0.5 s; here by 16 bytes. And it brings twenty crates for what these files do.
#![cfg_attr(not(test), no_std)]

mod boot;
mod flash;
mod journal;
mod kept;
mod layout;
mod receive;
#[cfg(all(target_os = "none", target_arch = "arm"))]
mod registers;
#[cfg(all(target_os = "none", target_arch = "arm"))]
pub mod start;
#[cfg(all(target_os = "none", target_arch = "arm"))]
pub mod stm32f405;
#[cfg(all(target_os = "none", target_arch = "arm"))]
pub mod stm32g474;
#[cfg(all(target_os = "none", target_arch = "arm"))]
pub mod watchdog;

pub use boot::{Started, boot};
pub use flash::{Flash, FlashError, FlashUnit};
pub use journal::{JournalError, Stage, WholeImage, confirm, is_blank, request, stage};
pub use kept::{Kept, keep, kept, read, spare};
pub use layout::{Layout, Slot};
pub use receive::{ReceiveError, Receiver};

use crc::{CRC_32_ISO_HDLC, Crc};

/// That of the line, too.
static CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);

/// CRC-32/ISO-HDLC of the bytes whose checksum is `before`, and of `bytes` behind them; that of no bytes is 0.
pub fn checksum_behind(before: u32, bytes: &[u8]) -> u32 {
    // What a checksum starts from is neither inverted nor reflected.
    let mut digest = CRC.digest_with_initial((!before).reverse_bits());
    digest.update(bytes);
    digest.finalize()
}

/// Defines the program of a boot loader: the module of its chip, its [`Layout`], and Cargo's alias that builds it. All failures start it anew.
#[macro_export]
macro_rules! loader {
    ($chip:ident, $layout:ident, $command:literal) => {
        #[cfg(target_os = "none")]
        #[allow(unsafe_code)]
        mod loader {
            use cortex_m::peripheral::SCB;
            use $crate::$chip::ChipFlash;

            #[cortex_m_rt::entry]
            fn main() -> ! {
                // SAFETY: the only one, and the boot loader lies in front of all slots. It has come from a reset.
                unsafe { $crate::start::start(ChipFlash::take(), &$crate::Layout::$layout) }
            }

            #[cortex_m_rt::exception]
            unsafe fn HardFault(_: &cortex_m_rt::ExceptionFrame) -> ! {
                SCB::sys_reset()
            }

            #[cortex_m_rt::exception]
            unsafe fn DefaultHandler(_: i16) -> ! {
                SCB::sys_reset()
            }

            #[panic_handler]
            fn panic(_: &core::panic::PanicInfo) -> ! {
                SCB::sys_reset()
            }
        }

        #[cfg(not(target_os = "none"))]
        fn main() {
            eprintln!(concat!(
                "the boot loader is for a board: build it with `",
                $command,
                "`"
            ));
            std::process::exit(2);
        }
    };
}
