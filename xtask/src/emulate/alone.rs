//! A board without a host in the emulator: what it plays is read out of its memory, before each tick.

use super::clients::Clients;
use super::{Built, stack_bound};
use crate::elf::{Elf, with_elf};
use crate::repository;
use anyhow::{Context, Result, bail, ensure};
use object::{Object, ObjectSymbol};
use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

/// Scene whose job begins when the board is switched on: no pin of the emulator has a level.
const SCENE: &str = "tests/mcu-bench/scenes/powered.toml";

/// Number types in which `ticks.csv` has the very numbers of the tick: those in SI units.
const SCALAR: &str = "f32";

/// Columns of the motors in `ticks.csv`.
const MOTORS: [&str; 12] = [
    "th1_1", "th1_2", "th1_3", "dth1_1", "dth1_2", "dth1_3", "ddth1_1", "ddth1_2", "ddth1_3",
    "tau1", "tau2", "tau3",
];

/// Most ticks before the job begins, and ticks that are looked at behind it.
const AROUND: usize = 20;

/// Longest time that the emulator may take for an answer.
const ANSWER: Duration = Duration::from_secs(20);

/// TickMemory of the tick's memory.
type TickMemory = Vec<u32>;

pub(super) fn run(clients: &Clients) -> Result<()> {
    let file = repository::root().join(SCENE).display().to_string();
    for scene in repository::scenes_named(&[file])? {
        let built = Built::new(&scene, SCALAR)?;
        let expected = table(&clients.run(&built)?)?;
        let memories = memories(&built.image, expected.len() + 2 * AROUND)?;
        let first = (0..AROUND).find(|first| has_motors(&memories[*first..], &expected));
        let first = first.with_context(|| {
            format!("{built}: the memory of no tick has the bits of what `trirrr run` plays")
        })?;
        // Behind the job: the angles of its last tick.
        let rest = memories.get(first + expected.len()..).unwrap_or_default();
        let last = expected.last().context("a job of a tick at least")?;
        let stands = |words: &TickMemory| last[..3].iter().all(|bits| words.contains(bits));
        let stands = rest.iter().all(stands);
        ensure!(
            stands && !rest.is_empty(),
            "{built}: it goes on behind its job"
        );
        let bound = stack_bound(&built.image, 0)?;
        println!(
            "{built}, without a host: {} ticks have the bits of `trirrr run`, from tick {first} on; by its code {bound} bytes of stack at most",
            expected.len()
        );
    }
    Ok(())
}

/// The bits of all motors in each tick of `ticks.csv`.
fn table(file: &Path) -> Result<Vec<TickMemory>> {
    let mut reader = csv::Reader::from_path(file)?;
    let headings = reader.headers()?.clone();
    let places = MOTORS.map(|name| headings.iter().position(|heading| heading == name));
    let mut rows = Vec::new();
    for record in reader.records() {
        let record = record?;
        let bits = places.iter().map(|place| {
            let text = place
                .and_then(|place| record.get(place))
                .context("a column of a motor")?;
            let value: f64 = text.parse()?;
            Ok((value as f32).to_bits())
        });
        rows.push(bits.collect::<Result<TickMemory>>()?);
    }
    Ok(rows)
}

/// Returns true if for each column of `expected` one word of the memory has its bits in every tick.
fn has_motors(memories: &[TickMemory], expected: &[TickMemory]) -> bool {
    let words = memories.first().map_or(0, Vec::len);
    (0..MOTORS.len()).all(|column| {
        (0..words).any(|word| {
            let ticks = memories.iter().zip(expected);
            ticks.clone().count() == expected.len()
                && ticks
                    .into_iter()
                    .all(|(memory, row)| memory[word] == row[column])
        })
    })
}

/// Address and length of a symbol whose name ends so.
fn symbol(elf: &Elf, end: &str) -> Result<(u64, u64)> {
    let found = elf
        .symbols()
        .find(|symbol| symbol.name().is_ok_and(|name| name.contains(end)));
    let found = found.with_context(|| format!("no symbol {end}"))?;
    Ok((found.address(), found.size()))
}

/// Returns the memory of the tick before each of the first `count` ticks.
fn memories(image: &Path, count: usize) -> Result<Vec<TickMemory>> {
    let ((tick, _), (memory, bytes)) = with_elf(image, |elf| {
        let memory = symbol(elf, "__rtic_internal_local_resource_tick")?;
        Ok((symbol(elf, "SysTick")?, memory))
    })?;
    let mut emulator = SteppedBoard::boot(image)?;
    // A breakpoint on two bytes of Thumb code.
    emulator.ask(&format!("Z0,{:x},2", tick & !1))?;
    let mut memories = Vec::with_capacity(count);
    for _ in 0..count {
        // Over the breakpoint where it stands, on to the next tick.
        emulator.ask("s")?;
        emulator.ask("c")?;
        let text = emulator.ask(&format!("m{memory:x},{bytes:x}"))?;
        let words = text.as_bytes().chunks_exact(8).map(|hex| {
            let value = u32::from_str_radix(std::str::from_utf8(hex)?, 16)?;
            Ok(value.swap_bytes())
        });
        memories.push(words.collect::<Result<TickMemory>>()?);
    }
    Ok(memories)
}

/// An emulator that stops where it is told, by the remote protocol of GDB.
struct SteppedBoard {
    child: Child,
    orders: TcpStream,
}

impl SteppedBoard {
    fn boot(image: &Path) -> Result<Self> {
        let port = TcpListener::bind("127.0.0.1:0")?.local_addr()?.port();
        let child = Command::new("qemu-system-arm")
            .args([
                "-M",
                "netduinoplus2",
                "-nographic",
                "-monitor",
                "none",
                "-serial",
                "null",
            ])
            .args(["-icount", "shift=4", "-S", "-gdb"])
            .arg(format!("tcp:127.0.0.1:{port}"))
            .arg("-kernel")
            .arg(image)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .spawn()
            .context("qemu-system-arm (Debian package qemu-system-arm) cannot be started")?;
        let start = Instant::now();
        let orders = loop {
            if let Ok(orders) = TcpStream::connect(("127.0.0.1", port)) {
                break orders;
            }
            ensure!(start.elapsed() < ANSWER, "the emulator does not listen");
            thread::sleep(Duration::from_millis(20));
        };
        orders.set_read_timeout(Some(ANSWER))?;
        orders.set_nodelay(true)?;
        Ok(Self { child, orders })
    }

    /// Sends an order, and returns the answer.
    fn ask(&mut self, order: &str) -> Result<String> {
        let sum = order.bytes().fold(0u8, u8::wrapping_add);
        write!(self.orders, "${order}#{sum:02x}")?;
        let mut answer = Vec::new();
        let mut byte = [0];
        loop {
            self.orders
                .read_exact(&mut byte)
                .context("the emulator does not answer")?;
            match byte[0] {
                b'#' => break,
                b'+' | b'$' => {}
                other => answer.push(other),
            }
        }
        self.orders.read_exact(&mut [0; 2])?;
        write!(self.orders, "+")?;
        let answer = String::from_utf8(answer)?;
        match answer.starts_with('E') {
            true => bail!("the emulator answers {order} with {answer}"),
            false => Ok(answer),
        }
    }
}

impl Drop for SteppedBoard {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
