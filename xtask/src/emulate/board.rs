//! An emulated STM32F405 with an image in its flash.

use crate::callgraph;
use crate::repository::target_directory;
use anyhow::{Context, Result, ensure};
use std::fs;
use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::Mutex;
use std::thread;
use std::time::{Duration, Instant};

/// Virtual time per instruction, 2 to the power of this in ns: 62 million instructions per second,
/// which an emulator reaches and silicon at 168 MHz exceeds several times. Time passes with
/// instructions, so a host that is busy slows the board down and makes no tick late.
const SHIFT: u32 = 4;

/// Clock of the core's timer in QEMU, whatever the program sets, Hz.
const TIMER_HZ: f64 = 168e6;

/// Counts of the tick's timer per instruction.
pub(super) const COUNTS_PER_INSTRUCTION: f64 = TIMER_HZ * 1e-9 * (1_u64 << SHIFT) as f64;

/// Longest time that the emulator may take to start.
const BOOT: Duration = Duration::from_secs(20);

/// Word with which the start of the program (cortex-m-rt) paints the stack.
const PAINT: [u8; 4] = 0xcccc_cccc_u32.to_le_bytes();

/// Held from the choice of ports until the emulator listens there. Counts the boards.
static BOOTING: Mutex<u32> = Mutex::new(0);

/// A board that runs; it ends with this value.
pub(super) struct Board {
    child: Child,
    address: String,
    log: PathBuf,
    /// Port on which the emulator takes orders.
    monitor: u16,
    /// Addresses of the image's stack.
    stack: Range<u32>,
}

/// Remains of a board that was switched off.
pub(super) struct Ended {
    /// File with the output of the board's log port.
    pub(super) log: PathBuf,
    /// Bytes of stack that it has used at most, interrupts included.
    pub(super) stack: u32,
}

impl Board {
    /// Boots the image. The link, USART2, listens at a port that was free; the log, USART3, goes to
    /// a file.
    pub(super) fn boot(image: &Path) -> Result<Self> {
        Self::boot_with(image, &[])
    }

    /// The same, with a file of accesses to peripherals that the emulator does not have, in QEMU's
    /// words.
    pub(super) fn boot_watched(image: &Path) -> Result<(Self, PathBuf)> {
        let name = image.file_name().context("an image has a name")?;
        let accesses = folder()?.join(name).with_extension("accesses");
        let file = accesses.to_str().context("a path that is text")?;
        Ok((
            Self::boot_with(image, &["-d", "unimp", "-D", file])?,
            accesses,
        ))
    }

    fn boot_with(image: &Path, arguments: &[&str]) -> Result<Self> {
        // One board boots at a time: a port that is free again must not go to another one.
        let mut boots = BOOTING.lock().expect("no boot panics");
        *boots += 1;
        // Both at once, or they might be the same.
        let (line, orders) = (
            TcpListener::bind("127.0.0.1:0")?,
            TcpListener::bind("127.0.0.1:0")?,
        );
        let port = line.local_addr()?.port();
        let monitor = orders.local_addr()?.port();
        drop((line, orders));
        // Numbered: boards with the same image run at once, each with files of its own.
        let name = image.file_name().context("an image has a name")?;
        let log = folder()?.join(name).with_extension(format!("{boots}.log"));
        let child = Command::new("qemu-system-arm")
            .args(["-M", "netduinoplus2", "-nographic", "-monitor"])
            .arg(format!("tcp:127.0.0.1:{monitor},server=on,wait=off"))
            .args(["-icount", &format!("shift={SHIFT}")])
            .args(["-serial", "null", "-serial"])
            .arg(format!(
                "tcp:127.0.0.1:{port},server=on,wait=off,nodelay=on"
            ))
            .arg("-serial")
            .arg(format!("file:{}", log.display()))
            .args(arguments)
            .arg("-kernel")
            .arg(image)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .context("qemu-system-arm (Debian package qemu-system-arm) cannot be started")?;
        let board = Self {
            child,
            address: format!("tcp:127.0.0.1:{port}"),
            log,
            monitor,
            stack: callgraph::place(image)?,
        };
        board.wait_for_line(port)?;
        Ok(board)
    }

    /// Waits until the emulator listens.
    fn wait_for_line(&self, port: u16) -> Result<()> {
        let start = Instant::now();
        while TcpStream::connect(("127.0.0.1", port)).is_err() {
            ensure!(
                start.elapsed() < BOOT,
                "the emulator does not listen at {}",
                self.address
            );
            thread::sleep(Duration::from_millis(20));
        }
        Ok(())
    }

    /// Returns the address of the board's link.
    pub(super) fn address(&self) -> &str {
        &self.address
    }

    /// Switches it off.
    pub(super) fn end(mut self) -> Result<Ended> {
        let early = self.child.try_wait()?;
        let stack = match early {
            None => self.used_stack().context("the stack cannot be read")?,
            Some(_) => 0,
        };
        self.kill();
        let mut said = String::new();
        if let Some(mut stderr) = self.child.stderr.take() {
            stderr.read_to_string(&mut said)?;
        }
        ensure!(early.is_none(), "the emulator ended by itself: {said}");
        Ok(Ended {
            log: self.log.clone(),
            stack,
        })
    }

    /// Returns the bytes of stack, from its top, down to the deepest word that has lost its paint.
    fn used_stack(&self) -> Result<u32> {
        let file = self.log.with_extension("stack");
        // What an earlier board left is not to be taken for this one's.
        let _ = fs::remove_file(&file);
        let mut monitor = TcpStream::connect(("127.0.0.1", self.monitor))?;
        monitor.set_read_timeout(Some(BOOT))?;
        let (from, bytes) = (self.stack.start, self.stack.end - self.stack.start);
        writeln!(monitor, "pmemsave {from:#x} {bytes} \"{}\"", file.display())?;
        // The emulator closes the line once it has done both.
        writeln!(monitor, "quit")?;
        let mut said = Vec::new();
        monitor.read_to_end(&mut said)?;
        let stack = fs::read(&file).with_context(|| String::from_utf8_lossy(&said).into_owned())?;
        ensure!(
            stack.len() == bytes as usize && stack.starts_with(&PAINT),
            "the stack was not painted, or is used up"
        );
        let painted = stack.chunks(4).take_while(|word| *word == PAINT).count();
        Ok(bytes - 4 * u32::try_from(painted)?)
    }

    fn kill(&mut self) {
        // It may have ended by itself; then there is nothing to do.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Drop for Board {
    fn drop(&mut self) {
        self.kill();
    }
}

/// Returns the folder in which boards leave their files, and creates it if need be.
fn folder() -> Result<PathBuf> {
    let folder = target_directory().join("emulate");
    fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
    Ok(folder)
}
