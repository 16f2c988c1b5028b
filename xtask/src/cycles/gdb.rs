//! Client of the emulator's debugger stub: breakpoints, one register, commands of the monitor.

use anyhow::{Context, Result, bail, ensure};
use std::io::{Read, Write};
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::process::Child;
use std::thread;
use std::time::{Duration, Instant};

/// Longest time that the emulator may take to open its socket, or to answer.
const PATIENCE: Duration = Duration::from_secs(60);

/// Numbers of the link register and the program counter.
const LINK: usize = 14;
const COUNTER: usize = 15;

pub(super) struct Debugger {
    stream: UnixStream,
    received: Vec<u8>,
}

impl Debugger {
    /// Connects to the emulator, which has just been started.
    pub(super) fn connect(socket: &Path, emulator: &mut Child) -> Result<Self> {
        let start = Instant::now();
        let stream = loop {
            match UnixStream::connect(socket) {
                Ok(stream) => break stream,
                Err(error) if start.elapsed() > PATIENCE => {
                    return Err(error).context("the emulator opens no socket");
                }
                Err(_) => thread::sleep(Duration::from_millis(5)),
            }
            ensure!(
                emulator.try_wait()?.is_none(),
                "the emulator does not start"
            );
        };
        stream.set_read_timeout(Some(PATIENCE))?;
        Ok(Self {
            stream,
            received: Vec::new(),
        })
    }

    /// Sets a breakpoint, or takes it away.
    fn set_breakpoint(&mut self, address: u32, is_set: bool) -> Result<()> {
        let command = if is_set { 'Z' } else { 'z' };
        let answer = self.ask(&format!("{command}0,{address:x},2"))?;
        ensure!(answer == "OK", "a breakpoint at {address:#x}: {answer}");
        Ok(())
    }

    /// Runs up to a breakpoint, and returns its address. None: the program has ended.
    fn go_on(&mut self) -> Result<Option<u32>> {
        let answer = self.ask("c")?;
        match answer.chars().next() {
            Some('T' | 'S') => self.register(COUNTER).map(Some),
            Some('W') => Ok(None),
            _ => bail!("the emulator stops with {answer}"),
        }
    }

    /// Writes a word to the memory of the program.
    pub(super) fn write(&mut self, address: u32, word: u32) -> Result<()> {
        let answer = self.ask(&format!("M{address:x},4:{:08x}", word.swap_bytes()))?;
        ensure!(answer == "OK", "a word at {address:#x}: {answer}");
        Ok(())
    }

    /// Runs up to `address`.
    pub(super) fn run_to(&mut self, address: u32) -> Result<()> {
        self.set_breakpoint(address, true)?;
        let stopped = self.go_on()?;
        ensure!(
            stopped == Some(address),
            "stopped at {stopped:x?}, not at {address:#x}"
        );
        self.set_breakpoint(address, false)
    }

    /// The first argument of a function, at its entry.
    pub(super) fn argument(&mut self) -> Result<u32> {
        self.register(0)
    }

    /// The address that a function returns to, at its entry.
    pub(super) fn return_address(&mut self) -> Result<u32> {
        Ok(self.register(LINK)? & !1)
    }

    /// A register of the core. Only whole sets are asked for: single ones need a description of the target.
    fn register(&mut self, number: usize) -> Result<u32> {
        let answer = self.ask("g")?;
        let digits = answer.get(8 * number..8 * (number + 1));
        let digits = digits.with_context(|| format!("registers: {answer}"))?;
        let value = u32::from_str_radix(digits, 16).with_context(|| answer.clone())?;
        // Its bytes come in the order of the target's memory.
        Ok(value.swap_bytes())
    }

    /// Gives the emulator's monitor a command, and returns what the monitor prints.
    pub(super) fn monitor(&mut self, command: &str) -> Result<String> {
        let hex: String = command.bytes().map(|byte| format!("{byte:02x}")).collect();
        self.send(&format!("qRcmd,{hex}"))?;
        let mut printed = String::new();
        loop {
            let answer = self.receive()?;
            match answer.strip_prefix('O') {
                Some("K") => return Ok(printed),
                Some(hex) => printed.push_str(&text(hex)?),
                None => bail!("{command}: the monitor answers {answer}"),
            }
        }
    }

    fn ask(&mut self, question: &str) -> Result<String> {
        self.send(question)?;
        self.receive()
    }

    fn send(&mut self, packet: &str) -> Result<()> {
        let sum = checksum(packet.as_bytes());
        Ok(write!(self.stream, "${packet}#{sum:02x}")?)
    }

    /// The next packet; it is acknowledged.
    fn receive(&mut self) -> Result<String> {
        loop {
            if let Some((packet, length)) = packet(&self.received)? {
                self.received.drain(..length);
                self.stream.write_all(b"+")?;
                return Ok(packet);
            }
            let mut bytes = [0; 4096];
            let count = self.stream.read(&mut bytes);
            let count = count.context("the emulator does not answer")?;
            ensure!(count > 0, "the emulator has closed its socket");
            self.received.extend_from_slice(&bytes[..count]);
        }
    }
}

fn checksum(bytes: &[u8]) -> u8 {
    bytes
        .iter()
        .fold(0, |sum: u8, byte| sum.wrapping_add(*byte))
}

fn text(hex: &str) -> Result<String> {
    let bytes = hex.as_bytes().chunks(2).map(|pair| {
        let pair = str::from_utf8(pair)?;
        Ok(u8::from_str_radix(pair, 16)?)
    });
    let bytes: Vec<u8> = bytes.collect::<Result<_>>()?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// The first whole packet of what was received, `$DATA#SUM`, with the length up to its end.
fn packet(received: &[u8]) -> Result<Option<(String, usize)>> {
    let place = |mark| received.iter().position(|byte| *byte == mark);
    let (Some(start), Some(hash)) = (place(b'$'), place(b'#')) else {
        return Ok(None);
    };
    let Some(sum) = received.get(hash + 1..hash + 3) else {
        return Ok(None);
    };
    let data = received
        .get(start + 1..hash)
        .context("a packet's end before its start")?;
    let sum = u8::from_str_radix(str::from_utf8(sum)?, 16)?;
    ensure!(checksum(data) == sum, "a packet with a wrong checksum");
    Ok(Some((str::from_utf8(data)?.to_owned(), hash + 3)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_packet_is_read_when_it_is_whole() {
        // 'O' + 'K' = 0x4f + 0x4b = 0x9a.
        for part in ["", "+", "+$", "+$OK", "+$OK#", "+$OK#9"] {
            assert!(packet(part.as_bytes()).expect("no error yet").is_none());
        }
        let whole = packet(b"+$OK#9a$T05").expect("a good one");
        assert_eq!(whole, Some(("OK".into(), 7)));
        assert!(packet(b"$OK#9b").is_err());
    }

    #[test]
    fn what_the_monitor_prints_is_text() {
        assert_eq!(text("68690d0a").expect("hex"), "hi\r\n");
        assert!(text("6x").is_err());
    }
}
