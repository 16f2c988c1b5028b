//! Moves of a long job, in a file of records of one size: a job of any length in little memory.

use crate::job_move::{JobMove, Tool};
use crate::longest_stop::LongestStop;
use core::ops::Range;
use nalgebra::Vector3;
use std::fs::File;
use std::io::{self, BufWriter, Read, Seek, SeekFrom, Write};
use std::sync::{Mutex, PoisonError};
use trirrr_core::setpoint::Pose;

/// Numbers of a record: two poses, two velocities, two accelerations, power and speed of the tool.
const NUMBERS: usize = 20;

/// Bytes of a record: ticks of the job before it, its own, its kind, its numbers; little-endian.
const RECORD: usize = 8 + 4 + 4 + 8 * NUMBERS;

/// Kind of a move: a quintic, and one with a tool.
const QUINTIC: u32 = 1;
const TOOL: u32 = 2;

/// Bytes that wait to be written.
const BUFFER: usize = 1 << 20;

/// Moves of a job in a file.
#[derive(Debug)]
pub struct MoveSpool {
    file: Mutex<File>,
    facts: SpoolFacts,
    longest_stop: Option<LongestStop>,
}

/// Facts of the moves in a spool.
#[derive(Clone, Copy, Debug, Default)]
struct SpoolFacts {
    count: u32,
    ticks: u64,
    has_quintics: bool,
    /// Ticks of the shortest move.
    shortest: Option<u32>,
}

/// Moves in a row out of a spool.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SpooledMoves {
    /// Ticks of the job before the first of them.
    pub before: u64,
    /// The moves.
    pub moves: Vec<JobMove>,
}

/// Two spools are the same if they are one.
impl PartialEq for MoveSpool {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self, other)
    }
}

impl MoveSpool {
    /// Number of moves.
    pub fn count(&self) -> u32 {
        self.facts.count
    }

    /// Ticks of all moves.
    pub fn ticks(&self) -> u32 {
        // A longer job is refused when it is spooled.
        self.facts.ticks as u32
    }

    /// Returns true if a move is a quintic.
    pub fn has_quintics(&self) -> bool {
        self.facts.has_quintics
    }

    /// Ticks of the shortest move; `None` without moves.
    pub fn shortest_ticks(&self) -> Option<u32> {
        self.facts.shortest
    }

    /// The longest stop of the job.
    pub fn longest_stop(&self) -> Option<LongestStop> {
        self.longest_stop
    }

    /// Reads the moves of `range`, as far as there are any.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn read(&self, range: Range<u32>) -> io::Result<SpooledMoves> {
        let range = range.start..range.end.min(self.facts.count);
        let mut bytes = vec![0; RECORD * range.len()];
        {
            let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
            file.seek(SeekFrom::Start(u64::from(range.start) * RECORD as u64))?;
            file.read_exact(&mut bytes)?;
        }
        let (records, _) = bytes.as_chunks();
        Ok(SpooledMoves {
            before: records.first().map_or(self.facts.ticks, ticks_before),
            moves: records.iter().map(decode).collect(),
        })
    }
}

/// Spool under way.
#[derive(Debug)]
pub(crate) struct SpoolWriter {
    out: BufWriter<File>,
    facts: SpoolFacts,
    last: Option<JobMove>,
}

impl SpoolWriter {
    /// Begins a spool in `file`, which is empty.
    pub(crate) fn new(file: File) -> Self {
        Self {
            out: BufWriter::with_capacity(BUFFER, file),
            facts: SpoolFacts::default(),
            last: None,
        }
    }

    /// Ticks of the moves so far.
    pub(crate) fn ticks(&self) -> u64 {
        self.facts.ticks
    }

    /// Number of the moves so far.
    pub(crate) fn count(&self) -> u32 {
        self.facts.count
    }

    /// The last move so far.
    pub(crate) fn last(&self) -> Option<&JobMove> {
        self.last.as_ref()
    }

    /// Adds moves.
    ///
    /// # Errors
    /// The file cannot be written.
    pub(crate) fn write(&mut self, moves: &[JobMove]) -> io::Result<()> {
        for each in moves {
            self.out.write_all(&encode(each, self.facts.ticks))?;
            let facts = &mut self.facts;
            let ticks = each.duration_ticks;
            facts.count = facts
                .count
                .checked_add(1)
                .ok_or(io::ErrorKind::FileTooLarge)?;
            facts.ticks += u64::from(ticks);
            facts.has_quintics |= each.accelerations.is_some();
            facts.shortest = Some(facts.shortest.map_or(ticks, |shortest| shortest.min(ticks)));
        }
        self.last = moves.last().copied().or(self.last);
        Ok(())
    }

    /// Ends the spool of a job with that longest stop.
    ///
    /// # Errors
    /// The file cannot be written.
    pub(crate) fn finish(self, longest_stop: Option<LongestStop>) -> io::Result<MoveSpool> {
        let file = self
            .out
            .into_inner()
            .map_err(io::IntoInnerError::into_error)?;
        Ok(MoveSpool {
            file: Mutex::new(file),
            facts: self.facts,
            longest_stop,
        })
    }
}

fn encode(each: &JobMove, before: u64) -> [u8; RECORD] {
    let quintic = each.accelerations.map_or(0, |_| QUINTIC);
    let tool = each.tool.map_or(0, |_| TOOL);
    let [start, end] = each.accelerations.unwrap_or_default();
    let (power, speed) = each
        .tool
        .map_or((0.0, 0.0), |tool| (tool.power, tool.speed_m_s));
    let pose = |pose: &Pose<f64>| [pose.position.x, pose.position.y, pose.angle];
    let triples = [
        pose(&each.from),
        pose(&each.to),
        each.start_velocity.into(),
        each.end_velocity.into(),
        start.into(),
        end.into(),
    ];
    let numbers = triples.into_iter().flatten().chain([power, speed]);
    let fields = (before.to_le_bytes().into_iter())
        .chain(each.duration_ticks.to_le_bytes())
        .chain((quintic | tool).to_le_bytes())
        .chain(numbers.flat_map(f64::to_le_bytes));
    let mut record = [0; RECORD];
    for (byte, value) in record.iter_mut().zip(fields) {
        *byte = value;
    }
    record
}

fn ticks_before(record: &[u8; RECORD]) -> u64 {
    let [before, ..] = words(record);
    before
}

/// The record in words of eight bytes.
fn words(record: &[u8; RECORD]) -> [u64; 2 + NUMBERS] {
    let (chunks, _) = record.as_chunks();
    let mut words = [0; 2 + NUMBERS];
    for (word, bytes) in words.iter_mut().zip(chunks) {
        *word = u64::from_le_bytes(*bytes);
    }
    words
}

fn decode(record: &[u8; RECORD]) -> JobMove {
    let [_, kind, numbers @ ..] = words(record);
    let n = numbers.map(f64::from_bits);
    let (ticks, kind) = (kind as u32, (kind >> 32) as u32);
    let pose = |at: usize| Pose::from_f64(n[at], n[at + 1], n[at + 2]);
    let vector = |at: usize| Vector3::new(n[at], n[at + 1], n[at + 2]);
    JobMove {
        from: pose(0),
        to: pose(3),
        start_velocity: vector(6),
        end_velocity: vector(9),
        accelerations: (kind & QUINTIC != 0).then(|| [vector(12), vector(15)]),
        duration_ticks: ticks,
        tool: (kind & TOOL != 0).then_some(Tool {
            power: n[18],
            speed_m_s: n[19],
        }),
    }
}
