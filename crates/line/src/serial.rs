//! Serial ports.

use crate::{Link, WRITE_TIMEOUT, closed};
use serialport::SerialPort;
use std::io;
use std::time::Duration;

/// Open serial port, 8 data bits, no parity, 1 stop bit, no flow control.
pub(crate) struct SerialLink {
    port: Box<dyn SerialPort>,
}

/// Opens the port `path` for this process alone.
pub(crate) fn open(path: &str, baud: u32) -> serialport::Result<SerialLink> {
    // A board behind USB sends to a program that is ready, and no system but Linux says so unasked.
    let port = serialport::new(path, baud)
        .timeout(WRITE_TIMEOUT)
        .dtr_on_open(true)
        .open()?;
    // What arrived before is no answer to anything.
    port.clear(serialport::ClearBuffer::Input)?;
    Ok(SerialLink { port })
}

impl Link for SerialLink {
    fn receive(&mut self, buffer: &mut [u8], timeout: Duration) -> io::Result<usize> {
        self.port.set_timeout(timeout)?;
        match self.port.read(buffer) {
            Ok(0) => Err(closed()),
            Err(error) => match error.kind() {
                io::ErrorKind::TimedOut | io::ErrorKind::Interrupted => Ok(0),
                _ => Err(error),
            },
            read => read,
        }
    }

    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        // Not flushed: that would wait until the last bit has left the port.
        self.port.set_timeout(WRITE_TIMEOUT)?;
        self.port.write_all(bytes)
    }
}
