//! A line that can be cut: TCP in, TCP or a serial port out.

use std::io::{Read, Write};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::thread;

/// Forwards what comes at the port that it returns to `board` (`tcp:HOST:PORT`). The first
/// connection is cut when it has carried `cut` bytes from the board; later ones are not.
pub(crate) fn cut_once(board: &str, cut: usize) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = format!("tcp:{}", listener.local_addr().unwrap());
    let board = board.strip_prefix("tcp:").unwrap().to_string();
    thread::spawn(move || {
        let mut limit = cut;
        for client in listener.incoming() {
            let client = client.unwrap();
            let board = TcpStream::connect(&board).unwrap();
            let (from_client, to_board) = (client.try_clone().unwrap(), board.try_clone().unwrap());
            let there = thread::spawn(move || forward(from_client, to_board, usize::MAX));
            forward(
                board.try_clone().unwrap(),
                client.try_clone().unwrap(),
                limit,
            );
            for end in [&client, &board] {
                // The other side may have closed it.
                let _ = end.shutdown(Shutdown::Both);
            }
            there.join().unwrap();
            limit = usize::MAX;
        }
    });
    address
}

/// Up to `limit` bytes, or until one side is gone.
fn forward(mut from: TcpStream, mut to: TcpStream, limit: usize) {
    let mut left = limit;
    let mut bytes = [0; 4096];
    while left > 0 {
        let wanted = left.min(bytes.len());
        let Ok(length) = from.read(&mut bytes[..wanted]) else {
            return;
        };
        if length == 0 || to.write_all(&bytes[..length]).is_err() {
            return;
        }
        left -= length;
    }
}

/// A serial port whose far end is `board`: its name. It is there until the board is gone.
#[cfg(unix)]
pub(crate) fn serial(board: &str) -> String {
    use serialport::SerialPort;
    use std::time::Duration;
    let (mut near, far) = serialport::TTYPort::pair().unwrap();
    let name = far.name().unwrap();
    let board = TcpStream::connect(board.strip_prefix("tcp:").unwrap()).unwrap();
    near.set_timeout(Duration::from_secs(600)).unwrap();
    let (mut to_port, mut from_board) =
        (near.try_clone_native().unwrap(), board.try_clone().unwrap());
    let mut to_board = board;
    thread::spawn(move || std::io::copy(&mut from_board, &mut to_port));
    thread::spawn(move || {
        // The far end is kept open: without it, the port would be closed before it is opened.
        let _far = far;
        let mut bytes = [0; 4096];
        while let Ok(length @ 1..) = near.read(&mut bytes) {
            if to_board.write_all(&bytes[..length]).is_err() {
                return;
            }
        }
    });
    name
}
