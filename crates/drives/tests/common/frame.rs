//! A frame of any length.

use embedded_can::{ExtendedId, Frame, Id, StandardId};

/// A frame that holds up to `LONGEST` bytes: 8 in classic CAN, 64 in CAN FD.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sent<const LONGEST: usize> {
    id: Id,
    data: Vec<u8>,
    /// Bytes that a remote frame asks for.
    asked: Option<usize>,
}

impl<const LONGEST: usize> Frame for Sent<LONGEST> {
    fn new(id: impl Into<Id>, data: &[u8]) -> Option<Self> {
        (data.len() <= LONGEST).then(|| Self {
            id: id.into(),
            data: data.into(),
            asked: None,
        })
    }

    fn new_remote(id: impl Into<Id>, length: usize) -> Option<Self> {
        (length <= 8).then(|| Self {
            id: id.into(),
            data: vec![],
            asked: Some(length),
        })
    }

    fn is_extended(&self) -> bool {
        matches!(self.id, Id::Extended(_))
    }

    fn is_remote_frame(&self) -> bool {
        self.asked.is_some()
    }

    fn id(&self) -> Id {
        self.id
    }

    fn dlc(&self) -> usize {
        self.asked.unwrap_or(self.data.len())
    }

    fn data(&self) -> &[u8] {
        &self.data
    }
}

impl<const LONGEST: usize> Sent<LONGEST> {
    /// Identifier and bytes in hexadecimal, as candump and cansend have them.
    pub fn text(&self) -> String {
        let id = match self.id {
            Id::Standard(id) => format!("{:03x}", id.as_raw()),
            Id::Extended(id) => format!("{:08x}", id.as_raw()),
        };
        if let Some(asked) = self.asked {
            return format!("{id}#R{asked}");
        }
        let bytes: String = self.data.iter().map(|byte| format!("{byte:02x}")).collect();
        format!("{id}#{bytes}")
    }

    /// Data frame of a text as [`text`](Self::text) has it.
    pub fn of_text(text: &str) -> Self {
        let (id, data) = text.split_once('#').unwrap();
        let raw = u32::from_str_radix(id, 16).unwrap();
        let id = match id.len() {
            3 => Id::Standard(StandardId::new(raw as u16).unwrap()),
            _ => Id::Extended(ExtendedId::new(raw).unwrap()),
        };
        let byte = |at: usize| u8::from_str_radix(&data[2 * at..2 * at + 2], 16).unwrap();
        let data: Vec<u8> = (0..data.len() / 2).map(byte).collect();
        Self::new(id, &data).unwrap()
    }
}
