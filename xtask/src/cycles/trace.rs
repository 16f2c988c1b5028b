//! Traces of calls: each executed instruction with the registers before it, from QEMU.
//!
//! The emulator runs at full speed up to the entry of a function. Only there it is told to log, one instruction at a
//! time, up to the return. The image is the one that counts.

use super::gdb::Debugger;
use crate::cores::Core;
use crate::repository::target_directory;
use anyhow::{Context, Result};
use std::collections::BTreeSet;
use std::env;
use std::fs::{self, File};
use std::io::{BufRead, BufReader, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio, id};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Commands of the monitor for single instructions: of QEMU from 8.1 on, and before.
const ONE_BY_ONE: [&str; 2] = ["one-insn-per-tb", "singlestep"];

/// Flags and the state of `it`, in the program status register.
const NEGATIVE: u32 = 1 << 31;
const ZERO: u32 = 1 << 30;
const CARRY: u32 = 1 << 29;
const OVERFLOW: u32 = 1 << 28;

/// An instruction, with what the registers held before.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Executed {
    pub(super) registers: [u32; 16],
    /// Program status.
    pub(super) status: u32,
}

impl Executed {
    pub(super) fn address(&self) -> u32 {
        self.registers[15]
    }

    /// Returns false for an instruction of an `it` block whose condition does not hold.
    pub(super) fn is_executed(&self) -> bool {
        // Eight bits: condition, and a mask that is zero outside of a block.
        let block = (self.status >> 8 & 0xfc) | (self.status >> 25 & 0b11);
        if block & 0xf == 0 {
            return true;
        }
        let has = |flag| self.status & flag != 0;
        let holds = match block >> 5 {
            0b000 => has(ZERO),
            0b001 => has(CARRY),
            0b010 => has(NEGATIVE),
            0b011 => has(OVERFLOW),
            0b100 => has(CARRY) && !has(ZERO),
            0b101 => has(NEGATIVE) == has(OVERFLOW),
            0b110 => !has(ZERO) && has(NEGATIVE) == has(OVERFLOW),
            _ => return true,
        };
        holds == (block & 0x10 == 0)
    }
}

/// An emulator that a debugger drives, with its files.
struct Emulator {
    process: Child,
    log: PathBuf,
    socket: PathBuf,
}

impl Emulator {
    fn start(core: &Core, image: &Path) -> Result<Self> {
        // Several may run at a time.
        static STARTED: AtomicUsize = AtomicUsize::new(0);
        let name = format!("{}-{}", id(), STARTED.fetch_add(1, Ordering::Relaxed));
        let logs = target_directory().join("traces");
        fs::create_dir_all(&logs).with_context(|| logs.display().to_string())?;
        let log = logs.join(&name);
        // The path of a socket must be short.
        let socket = env::temp_dir().join(format!("trirrr-{name}"));
        let mut command = Command::new(core.emulator.command);
        command.arg("-M").args(core.machine);
        command
            .args(["-display", "none", "-monitor", "none", "-serial", "null"])
            .args(["-semihosting-config", "enable=on,target=native"])
            .arg("-chardev")
            .arg(format!(
                "socket,id=gdb,server=on,wait=off,path={}",
                socket.display()
            ))
            .args(["-gdb", "chardev:gdb", "-S", "-D"])
            .arg(&log)
            .arg("-kernel")
            .arg(image)
            // What it prints was read when it counted.
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null());
        let process = command.spawn().with_context(|| {
            format!(
                "{command:?}, of the Debian package {}",
                core.emulator.package
            )
        })?;
        Ok(Self {
            process,
            log,
            socket,
        })
    }
}

impl Drop for Emulator {
    fn drop(&mut self) {
        // Nothing can be done where one of them fails.
        let _ = self.process.kill();
        let _ = self.process.wait();
        let _ = fs::remove_file(&self.log);
        let _ = fs::remove_file(&self.socket);
    }
}

/// Runs `image` and hands over its calls that are `wanted`, in their order: the function, the number of the call and
/// what was executed. The image stops at the entry `stop` before each wanted call, then calls the functions at `entries`.
///
/// # Errors
/// An emulator that does not start, answer or log; a program that ends before.
pub(super) fn trace(
    core: &Core,
    image: &Path,
    stop: u32,
    entries: &[u32],
    wanted: &BTreeSet<usize>,
    mut hand_over: impl FnMut(usize, usize, &[Executed]) -> Result<()>,
) -> Result<()> {
    let mut emulator = Emulator::start(core, image)?;
    let mut debugger = Debugger::connect(&emulator.socket, &mut emulator.process)?;
    let is_known = |debugger: &mut Debugger, command: &str| {
        let said = debugger.monitor(&format!("{command} off"));
        said.is_ok_and(|said| said.is_empty())
    };
    let one_by_one = ONE_BY_ONE
        .into_iter()
        .find(|command| is_known(&mut debugger, command))
        .context("the monitor knows no command for single instructions")?;
    let mut read = 0;
    // The image stops before its first call by itself.
    debugger.run_to(stop)?;
    let next = debugger.argument()?;
    for call in wanted {
        if *call > 0 {
            debugger.write(next, u32::try_from(*call)?)?;
            debugger.run_to(stop)?;
        }
        for (function, entry) in entries.iter().enumerate() {
            debugger.run_to(*entry)?;
            let end = debugger.return_address()?;
            // In this order: translated code that does not log would not begin to.
            debugger.monitor("log cpu")?;
            debugger.monitor(&format!("{one_by_one} on"))?;
            debugger.run_to(end)?;
            debugger.monitor("log none")?;
            debugger.monitor(&format!("{one_by_one} off"))?;
            let mut log = File::open(&emulator.log).context("the emulator has no log")?;
            log.seek(SeekFrom::Start(read))?;
            let executed = parse(&mut BufReader::with_capacity(1 << 16, &log))?;
            read = log.stream_position()?;
            hand_over(function, *call, &executed)?;
        }
    }
    Ok(())
}

/// Reads records of `R00=...` to `R15=...` and `XPSR=...`.
fn parse(log: &mut impl BufRead) -> Result<Vec<Executed>> {
    let mut all: Vec<Executed> = Vec::new();
    let (mut this, mut line) = (Executed::default(), String::new());
    while log.read_line(&mut line)? > 0 {
        let read = match line.strip_prefix("XPSR=") {
            Some(status) => hex(status).map(|status| this.status = status),
            None => parse_registers(line.trim_end(), &mut this.registers),
        };
        read.with_context(|| format!("in the log: {line}"))?;
        // An instruction that a request to the emulator stops is entered, and logged, again.
        if line.starts_with('X') && all.last() != Some(&this) {
            all.push(this);
        }
        line.clear();
    }
    Ok(all)
}

/// A number of eight digits.
fn hex(digits: &str) -> Option<u32> {
    u32::from_str_radix(digits.get(..8)?, 16).ok()
}

/// Reads `R04=203ffe60 R05=00ffd24d`: each takes 13 characters with the blank behind.
fn parse_registers(line: &str, registers: &mut [u32; 16]) -> Option<()> {
    let mut rest = line;
    while !rest.is_empty() {
        let number: usize = rest.get(1..3)?.parse().ok()?;
        *registers.get_mut(number)? = hex(rest.get(4..)?)?;
        rest = rest.get(13..).unwrap_or_default();
    }
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_log_becomes_instructions() {
        let log = "\
R00=00000004 R01=3f43858e R02=203ffed0 R03=00008bed
R04=203ffe60 R05=00ffd24d R06=203ffca0 R07=203ffb60
R08=0000000a R09=00000100 R10=000001b3 R11=0000005a
R12=203ffed0 R13=203ffb54 R14=0000012f R15=00009672
XPSR=21000000 --C- T priv-thread
";
        let executed = parse(&mut log.as_bytes()).expect("good");
        assert_eq!(executed.len(), 1);
        assert_eq!(executed[0].address(), 0x9672);
        assert_eq!(executed[0].registers[13], 0x203f_fb54);
        assert_eq!(executed[0].status, 0x2100_0000);
        // Entered twice, executed once.
        assert_eq!(parse(&mut log.repeat(2).as_bytes()).expect("good").len(), 1);
        assert!(parse(&mut "R16=0".as_bytes()).is_err());
        assert!(parse(&mut "Trace 0: 0x1".as_bytes()).is_err());
    }

    #[test]
    fn conditions_of_a_block_are_those_of_its_flags() {
        // `it eq`: condition 0000, mask 1000; its upper six bits stand at 10, its lower two at 25.
        let block = |bits: u32, flags| Executed {
            status: flags | (bits >> 2) << 10 | (bits & 0b11) << 25,
            ..Executed::default()
        };
        assert!(block(0b0000_1000, ZERO).is_executed());
        assert!(!block(0b0000_1000, CARRY).is_executed());
        // ne
        assert!(!block(0b0001_1000, ZERO).is_executed());
        assert!(block(0b0001_1000, 0).is_executed());
        // The last but one of a block of four, ge, and gt.
        assert!(block(0b1010_0010, NEGATIVE | OVERFLOW).is_executed());
        assert!(!block(0b1010_0001, NEGATIVE).is_executed());
        assert!(!block(0b1100_0100, ZERO).is_executed());
        // No block: flags mean nothing.
        assert!(block(0, 0).is_executed());
    }
}
