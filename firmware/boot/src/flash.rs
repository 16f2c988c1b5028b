//! Flash memory of a microcontroller.

use core::fmt::Debug;

/// Cells that a flash programs at a time.
pub trait FlashUnit: Copy + Debug + PartialEq {
    /// Content as bytes.
    type Bytes: AsRef<[u8]>;

    /// Number of bytes.
    const BYTES: u32 = size_of::<Self>() as u32;
    /// Content after an erasure.
    const ERASED: Self;
    /// Content that may be programmed over any other.
    const CLEARED: Self;

    /// Returns the content with these bytes, the first ones of an erased unit.
    fn of_bytes(bytes: &[u8]) -> Self;

    /// Returns the bytes of the content.
    fn bytes(self) -> Self::Bytes;
}

macro_rules! flash_unit {
    ($word:ty) => {
        impl FlashUnit for $word {
            type Bytes = [u8; size_of::<Self>()];

            const ERASED: Self = Self::MAX;
            const CLEARED: Self = 0;

            fn of_bytes(bytes: &[u8]) -> Self {
                let mut unit = [0xFF; size_of::<Self>()];
                for (to, from) in unit.iter_mut().zip(bytes) {
                    *to = *from;
                }
                Self::from_le_bytes(unit)
            }

            fn bytes(self) -> Self::Bytes {
                self.to_le_bytes()
            }
        }
    };
}

// The STM32F405 programs words, the STM32G474 double words.
flash_unit!(u32);
flash_unit!(u64);

/// Flash whose units are programmed once after an erasure. Addresses are those of the processor, multiples of a unit's bytes.
pub trait Flash {
    /// Cells that are programmed at a time.
    type Unit: FlashUnit;

    /// Returns the unit at `address`; of erased flash all ones. `None` where the check bits of the flash say that its content is lost, as of
    /// a unit whose programming was cut off.
    fn unit(&self, address: u32) -> Option<Self::Unit>;

    /// Erases sector number `sector`.
    ///
    /// # Errors
    /// The flash reports an error, or does not end.
    fn erase(&mut self, sector: u8) -> Result<(), FlashError>;

    /// Programs the unit at `address`, which is erased, or takes [`FlashUnit::CLEARED`].
    ///
    /// # Errors
    /// The flash reports an error.
    fn program(&mut self, address: u32, unit: Self::Unit) -> Result<(), FlashError>;
}

/// An erasure or a unit that failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FlashError {
    /// Address of the unit, or number of the sector.
    pub place: u32,
    /// Status of the flash, as the chip has it; 0 where it reports no error and the content is another; [`Self::LOW_SUPPLY`].
    pub status: u32,
}

impl FlashError {
    /// Status of an operation that was not begun, for the supply of the chip is too low for it. No flash has this bit.
    pub const LOW_SUPPLY: u32 = 1 << 31;
}

/// Reads bytes from `address` on. `None` where the content of one is lost.
pub(crate) fn read_bytes<F: Flash>(flash: &F, address: u32, bytes: &mut [u8]) -> Option<()> {
    let parts = bytes.chunks_mut(F::Unit::BYTES as usize);
    for (part, at) in parts.zip((address..).step_by(F::Unit::BYTES as usize)) {
        let unit = flash.unit(at)?.bytes();
        for (to, from) in part.iter_mut().zip(unit.as_ref()) {
            *to = *from;
        }
    }
    Some(())
}

/// Programs bytes from `address` on, and compares. What is erased needs no programming.
///
/// # Errors
/// The flash reports an error, or has another content afterwards.
pub(crate) fn program_bytes<F: Flash>(
    flash: &mut F,
    address: u32,
    bytes: &[u8],
) -> Result<(), FlashError> {
    let parts = bytes.chunks(F::Unit::BYTES as usize);
    for (part, at) in parts.zip((address..).step_by(F::Unit::BYTES as usize)) {
        program_unit(flash, at, F::Unit::of_bytes(part))?;
    }
    Ok(())
}

/// Programs a unit, unless it stays erased, and compares.
///
/// # Errors
/// As [`program_bytes`].
pub(crate) fn program_unit<F: Flash>(
    flash: &mut F,
    address: u32,
    unit: F::Unit,
) -> Result<(), FlashError> {
    if unit != F::Unit::ERASED {
        flash.program(address, unit)?;
    }
    match flash.unit(address) == Some(unit) {
        true => Ok(()),
        false => Err(FlashError {
            place: address,
            status: 0,
        }),
    }
}
