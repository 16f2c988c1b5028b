//! Control transfers of a host, and those by which it takes a serial port into use.

use crate::chip::UsbPacket;

/// Packet of endpoint 0, bytes.
const PACKET: usize = 64;

/// Address that the host gives.
pub(super) const ADDRESS: u8 = 7;

/// Stage of a transfer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Stage {
    SetUp,
    /// Data from the device, or to it.
    FromDevice,
    ToDevice,
    /// Empty packet at the end, against the direction of the data.
    StatusFromDevice,
    StatusToDevice,
}

/// Control transfer under way.
#[derive(Clone, Debug)]
pub(super) struct ControlTransfer {
    pub(super) request: [u8; 8],
    data: Vec<u8>,
    pub(super) stage: Stage,
    is_odd: bool,
    /// Data that has come.
    pub(super) received: Vec<u8>,
}

impl ControlTransfer {
    pub(super) fn new(request: [u8; 8], data: &[u8]) -> Self {
        Self {
            request,
            data: data.to_vec(),
            stage: Stage::SetUp,
            is_odd: true,
            received: Vec::new(),
        }
    }

    /// Bytes that the device is asked for, or gets.
    fn length(&self) -> usize {
        usize::from(self.request[6]) | usize::from(self.request[7]) << 8
    }

    /// Returns the packet for the device, of a stage that has one.
    pub(super) fn packet(&self) -> UsbPacket {
        let bytes = match self.stage {
            Stage::ToDevice => self.data.clone(),
            _ => Vec::new(),
        };
        UsbPacket {
            bytes,
            odd: self.is_odd,
        }
    }

    /// The device has taken a packet. Returns true if the transfer is over.
    pub(super) fn went(&mut self) -> bool {
        self.stage = match self.stage {
            Stage::SetUp if self.request[0] & 0x80 != 0 => Stage::FromDevice,
            Stage::SetUp if self.length() > 0 => Stage::ToDevice,
            Stage::SetUp | Stage::ToDevice => Stage::StatusFromDevice,
            _ => return true,
        };
        false
    }

    /// The device has given a packet. Returns true if the transfer is over, and an error if the packet is not the one that is due.
    pub(super) fn came(&mut self, packet: &UsbPacket) -> Result<bool, String> {
        if packet.odd != self.is_odd {
            return Err(format!(
                "a packet of {:?} has the wrong toggle",
                self.request
            ));
        }
        if self.stage == Stage::StatusFromDevice {
            return match packet.bytes.len() {
                0 => Ok(true),
                bytes => Err(format!("{bytes} bytes as the status of {:?}", self.request)),
            };
        }
        self.received.extend(&packet.bytes);
        self.is_odd = !self.is_odd;
        if packet.bytes.len() < PACKET || self.received.len() >= self.length() {
            self.stage = Stage::StatusToDevice;
            self.is_odd = true;
        }
        Ok(false)
    }
}

/// What a host finds out about the device.
#[derive(Clone, Debug, Default)]
pub(crate) struct Found {
    pub(crate) vendor: u16,
    pub(crate) product: u16,
    /// Manufacturer, product, serial number.
    pub(crate) texts: Vec<String>,
    texts_at: Vec<u8>,
    configuration: Vec<u8>,
    /// Endpoints of the data: to the device, from it.
    pub(super) endpoints: Option<(u8, u8)>,
}

/// Request for `length` bytes of a descriptor.
fn descriptor(kind: u8, index: u8, language: u16, length: u16) -> [u8; 8] {
    let ([low, high], [few, many]) = (language.to_le_bytes(), length.to_le_bytes());
    [0x80, 6, index, kind, low, high, few, many]
}

/// Step after which the host resets the bus once more, and that which sets the address.
pub(super) const RESET_AFTER: usize = 0;
pub(super) const ADDRESS_STEP: usize = 1;

impl Found {
    /// Returns a step of the enumeration, in the order of Linux; none behind the last one, which opens the port.
    pub(super) fn step(&self, step: usize) -> Option<ControlTransfer> {
        let of = |request| Some(ControlTransfer::new(request, &[]));
        match step {
            0 => of(descriptor(1, 0, 0, 64)),
            ADDRESS_STEP => of([0, 5, ADDRESS, 0, 0, 0, 0, 0]),
            2 => of(descriptor(1, 0, 0, 18)),
            3 => of(descriptor(2, 0, 0, 9)),
            4 => {
                let length = self
                    .configuration
                    .get(2..4)
                    .and_then(|bytes| bytes.first_chunk());
                of(descriptor(
                    2,
                    0,
                    0,
                    length.map_or(9, |bytes| u16::from_le_bytes(*bytes)),
                ))
            }
            5..=7 => {
                let at = self.texts_at.get(step - 5).copied().unwrap_or(0);
                // The languages, where there is no text.
                let language = if at == 0 { 0 } else { 0x0409 };
                of(descriptor(3, at, language, 255))
            }
            8 => {
                let value = self.configuration.get(5).copied().unwrap_or(0);
                of([0, 9, value, 0, 0, 0, 0, 0])
            }
            // 115,200 baud, 8 bits: a host sets a rate, and the board takes none.
            9 => Some(ControlTransfer::new(
                [0x21, 0x20, 0, 0, 0, 0, 7, 0],
                &[0x00, 0xC2, 0x01, 0x00, 0, 0, 8],
            )),
            10 => Some(line_state(true)),
            _ => None,
        }
    }

    /// Takes the answer to a step.
    pub(super) fn learn(&mut self, step: usize, answer: &[u8]) {
        let word = |at: usize| {
            let bytes = answer.get(at..at + 2).and_then(|bytes| bytes.first_chunk());
            bytes.map_or(0, |bytes| u16::from_le_bytes(*bytes))
        };
        match step {
            2 => {
                (self.vendor, self.product) = (word(8), word(10));
                self.texts_at = answer.get(14..17).unwrap_or_default().to_vec();
            }
            3 => self.configuration = answer.to_vec(),
            4 => {
                self.configuration = answer.to_vec();
                self.endpoints = data_endpoints(answer);
            }
            5..=7 => {
                let (units, _) = answer.get(2..).unwrap_or_default().as_chunks::<2>();
                let text = units.iter().map(|unit| u16::from_le_bytes(*unit));
                self.texts
                    .push(String::from_utf16_lossy(&text.collect::<Vec<u16>>()));
            }
            _ => {}
        }
    }
}

/// Request that tells the device of a program that opens or closes the port: data terminal ready, request to send.
pub(super) fn line_state(is_open: bool) -> ControlTransfer {
    let value = if is_open { 3 } else { 0 };
    ControlTransfer::new([0x21, 0x22, value, 0, 0, 0, 0, 0], &[])
}

/// Numbers of the endpoints with the bytes of the port, to the device and from it.
fn data_endpoints(configuration: &[u8]) -> Option<(u8, u8)> {
    let (mut to, mut from, mut is_data) = (None, None, false);
    let mut rest = configuration;
    while let [length, kind, third, ..] = rest {
        match kind {
            4 => is_data = rest.get(5) == Some(&10),
            5 if is_data && third & 0x80 != 0 => from = Some(third & 15),
            5 if is_data => to = Some(*third),
            _ => {}
        }
        rest = rest.get(usize::from(*length).max(1)..).unwrap_or_default();
    }
    to.zip(from)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_transfer_from_the_device_ends_with_a_short_packet_and_a_status() {
        let mut transfer = ControlTransfer::new(descriptor(2, 0, 0, 255), &[]);
        assert!(!transfer.went());
        let packet = |bytes: usize, odd| UsbPacket {
            bytes: vec![0; bytes],
            odd,
        };
        assert_eq!(transfer.came(&packet(64, true)), Ok(false));
        assert!(transfer.came(&packet(3, true)).is_err());
        assert_eq!(transfer.came(&packet(3, false)), Ok(false));
        assert_eq!(transfer.stage, Stage::StatusToDevice);
        assert_eq!((transfer.received.len(), transfer.went()), (67, true));
    }

    #[test]
    fn data_endpoints_are_those_of_the_data_interface() {
        let configuration = [
            9, 4, 0, 0, 1, 2, 2, 0, 0, 7, 5, 0x81, 3, 8, 0, 255, 9, 4, 1, 0, 2, 10, 0, 0, 0, 7, 5,
            0x82, 2, 64, 0, 0, 7, 5, 0x01, 2, 64, 0, 0,
        ];
        assert_eq!(data_endpoints(&configuration), Some((1, 2)));
    }
}
