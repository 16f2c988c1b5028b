//! `trirrr bridge`: the line of a board behind a TCP port.

mod args;

pub use args::BridgeArgs;

use crate::failure::CliError;
use crate::serve::{FrameKind, Hub, Standing, read_key};
use crate::terminal::print_line;
use std::collections::VecDeque;
use std::io;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use trirrr_line::{Frames, Link, OpenError, RawMessage, SharedKey, open_link};
use trirrr_protocol::message::{Command, Message, Request};

/// Time from one look at both sides to the next, while nothing comes.
const LOOK: Duration = Duration::from_micros(500);

/// Time from one attempt to open the board's line to the next.
const ATTEMPTS_EVERY: Duration = Duration::from_millis(500);

/// Silence after which a client gives way to another: a client asks for the status ten times a second.
const SILENCE: Duration = Duration::from_secs(2);

/// Longest wait for the answer to a request of a client that is not known. Until then its next request waits.
const ANSWER: Duration = Duration::from_secs(1);

/// Bytes taken from the board's line at a time.
const CHUNK: usize = 4096;

/// First bytes of a message from the machine.
const REPLY: u8 = 0;
const EVENT: u8 = 1;

/// Carries frames until `stop` is raised, which is the good end.
///
/// # Errors
/// Refused: an address or a key file. Failed: the board's line, or an address that cannot be listened at.
pub fn command(args: &BridgeArgs, stop: &AtomicBool) -> Result<(), CliError> {
    let far_key = args.far_key.as_deref().map(read_key).transpose()?;
    let far = FarLine {
        args,
        key: far_key,
        frames: Frames::default(),
        link: None,
    };
    let doors = args.listen.open()?;
    let address = doors.address();
    let lines = doors.lines().to_vec();
    let mut bridge = Bridge {
        far,
        hub: Hub::new(doors, SILENCE),
        clients: 0,
        requests: VecDeque::new(),
        open: None,
        frame: Vec::new(),
        start: Instant::now(),
    };
    // Without the board there is nothing to carry yet: most likely a name is wrong.
    let opened = bridge.far.open();
    opened.map_err(|error| CliError::Failed(error.to_string()))?;
    print_line(&format!("tcp:{address} carries {}", args.port));
    lines.iter().for_each(|line| print_line(line));
    bridge.run(stop)?;
    let clients = bridge.hub.clients();
    print_line(&format!("ended by Ctrl-C; {clients} clients"));
    Ok(())
}

/// Line of the board.
struct FarLine<'a> {
    args: &'a BridgeArgs,
    key: Option<SharedKey>,
    frames: Frames,
    /// None while it is lost.
    link: Option<Box<dyn Link>>,
}

impl FarLine<'_> {
    fn open(&mut self) -> Result<(), OpenError> {
        // The port is given back first: it opens once only.
        self.link = None;
        let link = open_link(&self.args.port, self.args.baud, self.key.as_ref())?;
        self.frames = Frames::default();
        self.link = Some(link);
        Ok(())
    }

    /// Takes the messages that have come.
    fn receive(&mut self) -> io::Result<Vec<RawMessage>> {
        let link = self.link.as_mut().ok_or(io::ErrorKind::NotConnected)?;
        let mut bytes = [0; CHUNK];
        let length = link.receive(&mut bytes, Duration::ZERO)?;
        let mut messages = Vec::new();
        let take = |message| messages.push(message);
        self.frames.receive(&bytes[..length], take);
        Ok(messages)
    }

    fn send(&mut self, frame: &[u8]) -> io::Result<()> {
        let link = self.link.as_mut().ok_or(io::ErrorKind::NotConnected)?;
        link.send(frame)
    }
}

/// Bridge under way.
struct Bridge<'a> {
    far: FarLine<'a>,
    hub: Hub,
    /// Number of clients when the requests below came.
    clients: u64,
    /// Requests of the client that are not sent.
    requests: VecDeque<RawMessage>,
    /// Number and time of the request of a client that is not known yet. One at a time: else it could try many numbers before the
    /// first refusal is back.
    open: Option<(u32, Instant)>,
    frame: Vec<u8>,
    start: Instant,
}

impl Bridge<'_> {
    fn run(&mut self, stop: &AtomicBool) -> Result<(), CliError> {
        while !stop.load(Ordering::Relaxed) {
            let carried = self.listen().and_then(|heard| Ok(self.ask()? || heard));
            match carried {
                Ok(true) => {}
                Ok(false) => std::thread::sleep(LOOK),
                Err(error) => self.reopen(&error, stop)?,
            }
            self.serve()?;
        }
        Ok(())
    }

    /// Lets clients in, sends what waits, and prints what has happened.
    fn serve(&mut self) -> Result<(), CliError> {
        let accepted = self.hub.accept();
        accepted.map_err(|error| CliError::Failed(format!("the listener failed: {error}")))?;
        self.hub.flush();
        for note in self.hub.take_notes() {
            self.note(&note);
        }
        if self.clients != self.hub.clients() || !self.hub.has_client() {
            // What the one before has asked is not asked for the next.
            self.clients = self.hub.clients();
            self.requests.clear();
            self.open = None;
        }
        Ok(())
    }

    /// Passes on what the board says. Returns true if it has said something.
    fn listen(&mut self) -> io::Result<bool> {
        let messages = self.far.receive()?;
        for message in &messages {
            self.pass(message);
        }
        Ok(!messages.is_empty())
    }

    fn pass(&mut self, message: &RawMessage) {
        self.frame.clear();
        Frames::append(message, &mut self.frame);
        // What a bridge has to know has the same bytes in every number type.
        let read = || message.read::<Message<f64>>();
        match message.bytes() {
            [REPLY, rest @ ..] => {
                let standing = match read() {
                    Some(Message::Reply { reply, .. }) => Standing::of(&reply),
                    _ => Standing::Known,
                };
                let number = number(rest);
                let is_its_own = self.open.is_some_and(|(open, _)| number == Some(open));
                if is_its_own || self.hub.knows_client() {
                    self.open = None;
                    self.hub.judge(standing, &self.frame);
                } else {
                    // A late answer to the client before.
                    self.hub.put(&self.frame, FrameKind::Other);
                }
            }
            [EVENT, ..] => {
                let kind = read().map_or(FrameKind::Other, |message| FrameKind::of(&message));
                self.hub.put(&self.frame, kind);
            }
            _ => self.hub.put(&self.frame, FrameKind::Sample),
        }
    }

    /// Passes on what the client asks. Returns true if it has asked something.
    fn ask(&mut self) -> io::Result<bool> {
        if self.requests.is_empty() {
            self.requests.extend(self.hub.requests::<RawMessage>());
        }
        let mut asked = false;
        while let Some(request) = self.requests.front() {
            let waits = |&(_, since): &(u32, Instant)| since.elapsed() < ANSWER;
            if !self.hub.knows_client() && self.open.as_ref().is_some_and(waits) {
                break;
            }
            let is_hello = request
                .read::<Request<f64>>()
                .is_some_and(|request| matches!(request.command, Command::Hello(_)));
            if !self.hub.takes(is_hello) {
                self.requests.clear();
                break;
            }
            self.open = number(request.bytes()).map(|number| (number, Instant::now()));
            self.frame.clear();
            Frames::append(request, &mut self.frame);
            self.requests.pop_front();
            self.far.send(&self.frame)?;
            asked = true;
        }
        Ok(asked)
    }

    /// Tells the client that the board is gone, by closing its link, and opens the board's line anew.
    fn reopen(&mut self, why: &io::Error, stop: &AtomicBool) -> Result<(), CliError> {
        let port = &self.far.args.port;
        self.note(&format!("{port}: the line to the board is lost: {why}"));
        self.far.link = None;
        while !stop.load(Ordering::Relaxed) {
            self.hub.cut("the line to the board is lost");
            match self.far.open() {
                Ok(()) => {
                    self.note(&format!("{}: the line is open again", self.far.args.port));
                    return Ok(());
                }
                Err(error) if error.may_pass() => std::thread::sleep(ATTEMPTS_EVERY),
                Err(error) => return Err(CliError::Failed(error.to_string())),
            }
            // Those who have come meanwhile are told, too.
            self.serve()?;
        }
        Ok(())
    }

    fn note(&self, text: &str) {
        let t = self.start.elapsed().as_secs_f64();
        print_line(&format!("{t:>10.3} s  {text}"));
    }
}

/// Number of a request or of the one that is answered: a varint.
fn number(bytes: &[u8]) -> Option<u32> {
    let mut number = 0_u64;
    for (place, byte) in bytes.iter().take(5).enumerate() {
        number |= u64::from(byte & 0x7f) << (7 * place);
        if byte & 0x80 == 0 {
            return u32::try_from(number).ok();
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use trirrr_protocol::message::Reply;

    #[test]
    fn the_number_of_a_request_and_of_its_answer_are_read() {
        for sequence in [0, 127, 128, 300, u32::MAX] {
            let command = Command::<f32>::Status;
            let request = RawMessage::of(&Request { sequence, command }).unwrap();
            assert_eq!(number(request.bytes()), Some(sequence));
            let reply = Reply::<f32>::Done;
            let answer = RawMessage::of(&Message::Reply { sequence, reply }).unwrap();
            assert_eq!(answer.bytes()[0], REPLY);
            assert_eq!(number(&answer.bytes()[1..]), Some(sequence));
        }
        assert_eq!(number(&[0xff; 5]), None);
        assert_eq!(number(&[0x80]), None);
    }
}
