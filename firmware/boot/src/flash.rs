//! Flash memory of a microcontroller.

/// Flash whose words are programmed once after an erasure. Addresses are those of the processor, multiples of 4.
pub trait Flash {
    /// Returns the word at `address`; of erased flash all ones.
    fn word(&self, address: u32) -> u32;

    /// Erases sector number `sector`.
    ///
    /// # Errors
    /// The flash reports an error, or does not end.
    fn erase(&mut self, sector: u8) -> Result<(), FlashError>;

    /// Programs the word at `address`.
    ///
    /// # Errors
    /// The flash reports an error, or the word is another afterwards.
    fn program(&mut self, address: u32, word: u32) -> Result<(), FlashError>;
}

/// An erasure or a word that failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FlashError {
    /// Address of the word, or number of the sector.
    pub place: u32,
    /// Status of the flash, as the chip has it.
    pub status: u32,
}
