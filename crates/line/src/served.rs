//! TCP from the end of a machine: a port that waits for clients, and links that never wait.

use crate::SharedKey;
use crate::closed;
use crate::refusal::{KeyRefusal, OtherClient};
use crate::seal::{PLAIN, Seal, WITH_KEY};
use crate::tcp::{is_closed, is_for_want_of_time, taken};
use std::io::{self, Read, Write};
use std::net::{Shutdown, SocketAddr, TcpListener, TcpStream};

/// TCP port that waits for clients, with a key or without.
#[derive(Debug)]
pub struct Listener {
    listener: TcpListener,
    address: SocketAddr,
    key: Option<SharedKey>,
}

impl Listener {
    /// Listens at `HOST:PORT`. Port 0 takes a free one.
    ///
    /// # Errors
    /// The address does not belong to this computer, or is taken.
    pub fn bind(address: &str) -> io::Result<Self> {
        let listener = TcpListener::bind(address)?;
        listener.set_nonblocking(true)?;
        let address = listener.local_addr()?;
        Ok(Self {
            listener,
            address,
            key: None,
        })
    }

    /// Expects `key` from every client, where there is one.
    pub fn with_key(self, key: Option<SharedKey>) -> Self {
        Self { key, ..self }
    }

    /// Returns the address of the port.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// Returns a client that has come, if any.
    ///
    /// # Errors
    /// The port is lost. A client that has left again is no error.
    pub fn accept(&self) -> io::Result<Option<(ServedLink, SocketAddr)>> {
        match self.listener.accept() {
            Ok((stream, from)) => {
                let link = ServedLink::new(stream, self.key.as_ref());
                Ok(link.ok().map(|link| (link, from)))
            }
            Err(error) if is_for_want_of_time(&error) => Ok(None),
            Err(error) if error.kind() == io::ErrorKind::ConnectionAborted => Ok(None),
            Err(error) => Err(error),
        }
    }
}

/// Protection of a link.
enum Guard {
    /// None. A client that begins with a key is told so. The number of bytes of such a beginning that have come.
    Plain {
        matched: Option<usize>,
    },
    Sealed(Box<Seal>),
}

/// Link of a machine to a client that has connected. No call waits.
pub struct ServedLink {
    stream: TcpStream,
    guard: Guard,
}

impl ServedLink {
    fn new(stream: TcpStream, key: Option<&SharedKey>) -> io::Result<Self> {
        // Frames are short and each is waited for.
        stream.set_nodelay(true)?;
        stream.set_nonblocking(true)?;
        let guard = match key {
            Some(key) => Guard::Sealed(Box::new(Seal::of_machine(key)?)),
            None => Guard::Plain { matched: Some(0) },
        };
        Ok(Self { stream, guard })
    }

    /// Goes on with the handshake, if there is one. Returns true once the client has shown that it has the key.
    ///
    /// # Errors
    /// The client is gone, or has another key, or none.
    pub fn is_through(&mut self) -> io::Result<bool> {
        let Guard::Sealed(seal) = &mut self.guard else {
            return Ok(true);
        };
        if !seal.is_open() {
            read(&mut self.stream, seal)?;
            let greeted = seal.greet();
            write(&mut self.stream, seal)?;
            greeted.map_err(refused)?;
            // The record behind the handshake, which is empty.
            seal.open(&mut [])?;
        }
        Ok(seal.is_open())
    }

    /// Tells a client that has shown no key that one is expected. A client that does not read learns less.
    pub fn ask_for_key(&mut self) {
        if let Guard::Sealed(seal) = &self.guard
            && !seal.is_open()
        {
            let _ = self.stream.write(KeyRefusal::Needed.record());
        }
    }

    /// Tells a client that another one has the machine, and ends the link. A client that does not read learns less.
    pub fn turn_away(mut self) {
        // What has come and is not read would take the words with it.
        let mut bytes = [0; PLAIN];
        while self.receive_now(&mut bytes).is_ok_and(|length| length > 0) {}
        let _ = self.send_now(OtherClient::WORDS);
        let _ = self.flush_now();
        let _ = self.stream.shutdown(Shutdown::Write);
    }

    /// Reads the bytes that have come. Returns 0 if none have come.
    ///
    /// # Errors
    /// The link is lost; [`io::ErrorKind::UnexpectedEof`] if the far end closed the link.
    pub fn receive_now(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        match &mut self.guard {
            Guard::Plain { matched } => {
                let length = taken(self.stream.read(buffer))?;
                if begins_with_key(matched, &buffer[..length]) {
                    // A client that does not take it learns less.
                    let _ = self.stream.write(KeyRefusal::Unknown.record());
                    let reason = "it uses a key, and this port has none";
                    return Err(io::Error::new(io::ErrorKind::PermissionDenied, reason));
                }
                Ok(length)
            }
            Guard::Sealed(seal) => {
                let length = seal.open(buffer)?;
                if length > 0 {
                    return Ok(length);
                }
                read(&mut self.stream, seal)?;
                seal.open(buffer)
            }
        }
    }

    /// Sends as many of `bytes` as possible. Returns their number.
    ///
    /// # Errors
    /// As [`Self::receive_now`].
    pub fn send_now(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match &mut self.guard {
            Guard::Plain { .. } => written(self.stream.write(bytes)),
            Guard::Sealed(seal) => {
                // At most one record waits here, so that who does not read takes no memory.
                if !write(&mut self.stream, seal)? {
                    return Ok(0);
                }
                let length = seal.seal(bytes)?;
                write(&mut self.stream, seal)?;
                Ok(length)
            }
        }
    }

    /// Sends what is sealed and waits. Returns true if nothing is left of it.
    ///
    /// # Errors
    /// As [`Self::receive_now`].
    pub fn flush_now(&mut self) -> io::Result<bool> {
        match &mut self.guard {
            Guard::Plain { .. } => Ok(true),
            Guard::Sealed(seal) => write(&mut self.stream, seal),
        }
    }
}

/// Reads what has come, as far as there is room for it.
fn read(stream: &mut TcpStream, seal: &mut Seal) -> io::Result<()> {
    let mut bytes = [0; PLAIN];
    let room = seal.room().min(bytes.len());
    if room > 0 {
        let length = taken(stream.read(&mut bytes[..room]))?;
        seal.take(&bytes[..length]);
    }
    Ok(())
}

/// Sends what is sealed. Returns true if nothing is left of it.
fn write(stream: &mut TcpStream, seal: &mut Seal) -> io::Result<bool> {
    while !seal.outgoing().is_empty() {
        match written(stream.write(seal.outgoing()))? {
            0 => return Ok(false),
            length => seal.sent(length),
        }
    }
    Ok(true)
}

/// Converts the result of a write to that of [`ServedLink::send_now`].
fn written(written: io::Result<usize>) -> io::Result<usize> {
    match written {
        Err(error) if is_for_want_of_time(&error) => Ok(0),
        Err(error) if is_closed(&error) => Err(closed()),
        written => written,
    }
}

/// Returns true if the bytes since the beginning are those of a client with a key.
fn begins_with_key(matched: &mut Option<usize>, bytes: &[u8]) -> bool {
    let Some(before) = *matched else {
        return false;
    };
    let expected = &WITH_KEY[before..];
    let length = expected.len().min(bytes.len());
    let is_same = expected[..length] == bytes[..length];
    *matched = (is_same && length < expected.len()).then_some(before + length);
    is_same && length == expected.len()
}

/// Says what the client did, where its own error says what the machine did.
fn refused(error: io::Error) -> io::Error {
    let reason = match KeyRefusal::of(&error) {
        Some(KeyRefusal::Other) => "it has another key",
        Some(KeyRefusal::Needed) => "it uses no key, and this port expects one",
        _ => return error,
    };
    io::Error::new(io::ErrorKind::PermissionDenied, reason)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Address, Link, OpenError, open, open_keyed, open_link};
    use std::thread;
    use std::time::Duration;

    /// Longer than anything takes; a test that waits for this has failed.
    const LIMIT: Duration = Duration::from_secs(60);

    fn accepted(listener: &Listener) -> ServedLink {
        loop {
            if let Some((link, _)) = listener.accept().unwrap() {
                return link;
            }
            thread::yield_now();
        }
    }

    fn received(link: &mut ServedLink) -> io::Result<Vec<u8>> {
        let mut buffer = [0; 16];
        loop {
            match link.receive_now(&mut buffer)? {
                0 => thread::yield_now(),
                length => return Ok(buffer[..length].to_vec()),
            }
        }
    }

    fn address(listener: &Listener) -> Address {
        format!("tcp:{}", listener.address()).parse().unwrap()
    }

    /// A client that connects in another thread, for the handshake needs both.
    fn opened(
        address: Address,
        key: SharedKey,
    ) -> thread::JoinHandle<Result<Box<dyn Link>, OpenError>> {
        thread::spawn(move || open_keyed(&address, 0, &key))
    }

    #[test]
    fn both_ends_see_the_other_go() {
        let key = SharedKey::random().unwrap();
        for key in [None, Some(key)] {
            let listener = Listener::bind("127.0.0.1:0").unwrap();
            let listener = listener.with_key(key.clone());
            assert!(listener.accept().unwrap().is_none());
            let client = match &key {
                Some(key) => opened(address(&listener), key.clone()),
                None => {
                    let address = address(&listener);
                    thread::spawn(move || open(&address, 0))
                }
            };
            let mut board = accepted(&listener);
            while !board.is_through().unwrap() {}
            let mut client = client.join().unwrap().unwrap();
            let mut buffer = [0; 16];
            assert_eq!(board.receive_now(&mut buffer).unwrap(), 0, "nothing yet");
            client.send(b"hello").unwrap();
            assert_eq!(received(&mut board).unwrap(), b"hello");
            assert_eq!(board.send_now(b"welcome").unwrap(), 7);
            let length = client.receive(&mut buffer, LIMIT).unwrap();
            assert_eq!(&buffer[..length], b"welcome");
            assert_eq!(client.receive(&mut buffer, Duration::ZERO).unwrap(), 0);
            drop(client);
            let gone = received(&mut board).unwrap_err();
            assert_eq!(gone.kind(), io::ErrorKind::UnexpectedEof);
        }
    }

    #[test]
    fn a_far_end_that_does_not_read_holds_nobody_up() {
        let key = SharedKey::random().unwrap();
        let listener = Listener::bind("127.0.0.1:0").unwrap();
        let listener = listener.with_key(Some(key.clone()));
        let client = opened(address(&listener), key);
        let mut board = accepted(&listener);
        while !board.is_through().unwrap() {}
        let client = client.join().unwrap().unwrap();
        // Far more than the system's buffers hold: at some point nothing more goes.
        let block = vec![0; 1 << 20];
        while board.send_now(&block).unwrap() > 0 {}
        assert!(!board.flush_now().unwrap());
        drop(client);
    }

    #[test]
    fn ends_whose_keys_differ_are_told_so() {
        let [one, two] = [0, 1].map(|_| SharedKey::random().unwrap());
        for (client, machine, refusal, noted) in [
            (Some(&one), Some(&two), KeyRefusal::Other, "another key"),
            (Some(&one), None, KeyRefusal::Unknown, "uses a key"),
            (None, Some(&two), KeyRefusal::Needed, "uses no key"),
        ] {
            let listener = Listener::bind("127.0.0.1:0").unwrap();
            let listener = listener.with_key(machine.cloned());
            let address = address(&listener);
            let key = client.cloned();
            let client = thread::spawn(move || match key {
                Some(key) => match open_keyed(&address, 0, &key) {
                    Ok(_) => panic!("{refusal:?}"),
                    Err(OpenError::Key { refusal, .. }) => refusal,
                    Err(error) => panic!("{error}"),
                },
                None => {
                    let mut link = open(&address, 0).unwrap();
                    link.send(&[2, 7, 11, 0]).unwrap();
                    let error = link.receive(&mut [0; 64], LIMIT).unwrap_err();
                    KeyRefusal::of(&error).unwrap()
                }
            });
            let mut board = accepted(&listener);
            let error = loop {
                let end = match board.is_through() {
                    Ok(true) => received(&mut board).map(|_| ()),
                    Ok(false) => continue,
                    Err(error) => Err(error),
                };
                break end.unwrap_err();
            };
            assert!(error.to_string().contains(noted), "{error}");
            drop(board);
            assert_eq!(client.join().unwrap(), refusal);
        }
    }

    #[test]
    fn a_client_that_is_turned_away_hears_why() {
        let key = SharedKey::random().unwrap();
        for key in [None, Some(key)] {
            let listener = Listener::bind("127.0.0.1:0").unwrap();
            let listener = listener.with_key(key.clone());
            let address = address(&listener);
            let client = thread::spawn(move || open_link(&address, 0, key.as_ref()).unwrap());
            let mut board = accepted(&listener);
            while !board.is_through().unwrap() {}
            let mut client = client.join().unwrap();
            client.send(b"hello").unwrap();
            board.turn_away();
            let why = loop {
                // Whatever it does first: the words are there when it has lost the line.
                let said = client.send(b"hello").err();
                let heard = client.receive(&mut [0; 64], Duration::from_millis(1)).err();
                if let Some(error) = said.or(heard) {
                    break error;
                }
            };
            assert!(super::OtherClient::is_in(&why), "{why}");
        }
    }

    #[test]
    fn a_far_end_that_closes_or_speaks_otherwise_is_named() {
        let key = SharedKey::random().unwrap();
        for (answer, expected) in [
            (
                &b""[..],
                "closed before it answered: it may have another client",
            ),
            (
                b"HTTP/1.1 400 Bad Request\r\n",
                "does not know how to use a key",
            ),
        ] {
            let listener = TcpListener::bind("127.0.0.1:0").unwrap();
            let address = format!("tcp:{}", listener.local_addr().unwrap());
            let client = opened(address.parse().unwrap(), key.clone());
            let (mut stream, _) = listener.accept().unwrap();
            stream.read_exact(&mut [0; 50]).unwrap();
            stream.write_all(answer).unwrap();
            drop(stream);
            let Err(error) = client.join().unwrap() else {
                panic!("opened");
            };
            assert!(error.to_string().contains(expected), "{error}");
            assert!(error.to_string().contains(&address), "{error}");
            assert_eq!(error.may_pass(), answer.is_empty());
        }
    }
}
