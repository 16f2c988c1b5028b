//! A fuzzer's bytes as numbers; behind their end there is nothing more to do.

/// Bytes that are used up from the front.
pub(super) struct Bytes<'a>(&'a [u8]);

impl<'a> Bytes<'a> {
    pub(super) fn new(data: &'a [u8]) -> Self {
        Self(data)
    }

    pub(super) fn byte(&mut self) -> Option<u8> {
        let (first, rest) = self.0.split_first()?;
        self.0 = rest;
        Some(*first)
    }

    /// As many as a byte says, or as there are.
    pub(super) fn some(&mut self) -> Option<&'a [u8]> {
        let count = usize::from(self.byte()?).min(self.0.len());
        let (taken, rest) = self.0.split_at(count);
        self.0 = rest;
        Some(taken)
    }

    pub(super) fn u16(&mut self) -> Option<u16> {
        Some(u16::from_le_bytes([self.byte()?, self.byte()?]))
    }

    /// A number of either sign below `size`, or one of those that are none or too large.
    pub(super) fn number(&mut self, size: f64) -> Option<f64> {
        const ODD: [f64; 6] = [
            f64::NAN,
            f64::INFINITY,
            f64::NEG_INFINITY,
            f64::MAX,
            f64::MIN_POSITIVE,
            -0.0,
        ];
        let bits = self.u16()?;
        Some(match ODD.get(usize::from(u16::MAX - bits)) {
            Some(odd) => *odd,
            None => f64::from(bits as i16) / 32768.0 * size,
        })
    }
}
