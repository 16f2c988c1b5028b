//! The line of a board behind a WebSocket: bytes of binary messages, both ways.

use std::io;
use std::net::TcpStream;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use trirrr_line::{Address, Link, SharedKey, open_link};
use tungstenite::protocol::frame::coding::CloseCode;
use tungstenite::protocol::{CloseFrame, Role, WebSocketConfig};
use tungstenite::{Error, Message, WebSocket};

/// Longest wait for the board before the page is heard.
const LOOK: Duration = Duration::from_millis(2);

/// Longest wait for a page to agree that the WebSocket closes.
const FAREWELL: Duration = Duration::from_secs(1);

/// Bytes taken from the board's line at a time.
const CHUNK: usize = 4096;

/// Most bytes of a message of the page: a few requests.
const MESSAGE: usize = 1 << 16;

/// Most bytes that wait for a page that does not read: some seconds of samples.
const WAITING: usize = 1 << 20;

/// Most bytes of the reason for which a WebSocket is closed.
const REASON: usize = 123;

/// Line of a board, for one page at a time.
pub(super) struct BoardLine {
    pub(super) address: Address,
    pub(super) baud: u32,
    pub(super) key: Option<SharedKey>,
    /// A page has it.
    is_taken: AtomicBool,
}

/// Reason for which a page is cut off.
struct Cut {
    code: CloseCode,
    why: String,
}

impl BoardLine {
    pub(super) fn new(address: Address, baud: u32, key: Option<SharedKey>) -> Self {
        Self {
            address,
            baud,
            key,
            is_taken: AtomicBool::new(false),
        }
    }

    /// Carries bytes between `browser`, whose WebSocket is open, and the board, until either goes or `stop` is raised. The board's line is
    /// open for this time only. Returns the reason of the end; none where the page went.
    pub(super) fn carry(&self, browser: TcpStream, stop: &AtomicBool) -> Option<String> {
        let config = WebSocketConfig::default()
            .max_message_size(Some(MESSAGE))
            .max_frame_size(Some(MESSAGE))
            .max_write_buffer_size(WAITING);
        let mut page = WebSocket::from_raw_socket(browser, Role::Server, Some(config));
        let end = match self.is_taken.swap(true, Ordering::AcqRel) {
            true => Err(Cut {
                code: CloseCode::Policy,
                why: "another page has the board: disconnect it there".into(),
            }),
            false => {
                let end = self.carry_alone(&mut page, stop);
                self.is_taken.store(false, Ordering::Release);
                end
            }
        };
        let cut = end.err()?;
        close(&mut page, &cut);
        Some(cut.why)
    }

    fn carry_alone(&self, page: &mut WebSocket<TcpStream>, stop: &AtomicBool) -> Result<(), Cut> {
        let lost = |why: String| Cut {
            code: CloseCode::Error,
            why,
        };
        // Requests and answers are short, and each is waited for.
        let _ = page.get_ref().set_nodelay(true);
        let link = open_link(&self.address, self.baud, self.key.as_ref());
        let mut link = link.map_err(|error| lost(error.to_string()))?;
        page.get_ref()
            .set_nonblocking(true)
            .map_err(|error| lost(error.to_string()))?;
        let board = |error: io::Error| lost(format!("{}: {error}", self.address));
        while !stop.load(Ordering::Relaxed) {
            if !ask(page, link.as_mut(), &board)? {
                return Ok(());
            }
            let mut bytes = [0; CHUNK];
            let length = link.receive(&mut bytes, LOOK).map_err(board)?;
            let sent = match length {
                0 => page.flush(),
                length => page.send(Message::binary(bytes[..length].to_vec())),
            };
            match sent {
                Ok(()) => {}
                Err(Error::Io(error)) if error.kind() == io::ErrorKind::WouldBlock => {}
                // Whatever it is: this page takes nothing any more.
                Err(_) => return Ok(()),
            }
        }
        Err(Cut {
            code: CloseCode::Away,
            why: "trirrr ui has ended".into(),
        })
    }
}

/// Passes on what the page has sent. Returns false if the page is gone.
fn ask(
    page: &mut WebSocket<TcpStream>,
    link: &mut dyn Link,
    board: &impl Fn(io::Error) -> Cut,
) -> Result<bool, Cut> {
    loop {
        match page.read() {
            Ok(Message::Binary(bytes)) => link.send(&bytes).map_err(board)?,
            Ok(Message::Text(_)) => {
                return Err(Cut {
                    code: CloseCode::Unsupported,
                    why: "the board takes bytes, no text".into(),
                });
            }
            Ok(_) => {}
            Err(Error::Io(error)) if error.kind() == io::ErrorKind::WouldBlock => return Ok(true),
            Err(_) => return Ok(false),
        }
    }
}

/// Closes with a reason, and waits until the page has it.
fn close(page: &mut WebSocket<TcpStream>, cut: &Cut) {
    let mut end = cut.why.len().min(REASON);
    while !cut.why.is_char_boundary(end) {
        end -= 1;
    }
    let frame = CloseFrame {
        code: cut.code,
        reason: cut.why[..end].into(),
    };
    // A page that is gone is told nothing.
    let stream = page.get_ref();
    let _ = stream.set_nonblocking(false);
    let _ = stream.set_read_timeout(Some(FAREWELL));
    let _ = page.close(Some(frame));
    while page.read().is_ok() {}
}
