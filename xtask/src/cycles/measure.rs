//! Samples of traced calls on every board of a core.

use super::boards::{BOARDS, Board, MEMORIES, Memory};
use super::flash::FlashState;
use super::model::{Classes, Code, Processor};
use super::trace::trace;
use crate::callgraph::program::Program;
use crate::cores::Core;
use crate::elf::with_elf;
use anyhow::{Context, Result, ensure};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::path::Path;

/// Instructions that are traced of one image, about.
const INSTRUCTIONS: f64 = 120_000.0;

/// Fewest and most calls that the mean is made of.
const FEWEST: usize = 4;
const MOST: usize = 24;

/// Calls of an image: which functions make one piece of work, and what the image has counted.
pub(super) struct Calls<'a> {
    /// Function in which the image stops before a call that is wanted.
    pub(super) stop: &'static str,
    /// In the order in which they are called; each is called once for each piece of work.
    pub(super) functions: &'a [&'static str],
    /// Instructions of each call, by function; none: the image does not print this one.
    pub(super) counted: &'a dyn Fn(usize, usize) -> Option<u32>,
    /// Calls that the mean is of.
    pub(super) of: Range<usize>,
    /// Calls that are traced besides: the longest.
    pub(super) longest: Vec<usize>,
}

impl Calls<'_> {
    /// Calls that the mean is made of: evenly from the range, as many as `mean` instructions of one allow.
    /// The first call of all warms the caches.
    fn even(&self, mean: f64) -> BTreeSet<usize> {
        let range = self.of.start.max(1)..self.of.end;
        let count = ((INSTRUCTIONS / mean) as usize).clamp(FEWEST, MOST);
        let count = count.min(range.len());
        (0..count)
            .map(|nth| range.start + nth * range.len() / count)
            .collect()
    }
}

/// One board with one memory, and what each traced call took there, function by function.
pub(super) struct Meter {
    pub(super) board: &'static Board,
    pub(super) memory: Memory,
    processor: Processor,
    pub(super) samples: BTreeMap<usize, Vec<Classes>>,
}

impl Meter {
    fn new(board: &'static Board, memory: Memory) -> Self {
        let flash = match memory {
            Memory::Ram => None,
            Memory::Flash | Memory::ColdFlash => Some(FlashState::new(board.flash)),
        };
        Self {
            board,
            memory,
            processor: Processor::new(board.timing, flash),
            samples: BTreeMap::new(),
        }
    }
}

/// What was traced of an image.
pub(super) struct Traced {
    /// Instructions of each call, function by function.
    pub(super) instructions: BTreeMap<usize, Vec<u32>>,
    pub(super) meters: Vec<Meter>,
    /// Calls that the mean is made of.
    pub(super) even: BTreeSet<usize>,
}

impl Traced {
    /// Mean instructions of a piece of work.
    pub(super) fn mean_instructions(&self) -> f64 {
        let of = |call| -> u32 { self.instructions[call].iter().sum() };
        self.even
            .iter()
            .map(|call| f64::from(of(call)))
            .sum::<f64>()
            / self.even.len() as f64
    }
}

/// Traces `calls` of `image`, whose pieces of work have `mean` instructions.
pub(super) fn measure(core: &Core, image: &Path, calls: &Calls, mean: f64) -> Result<Traced> {
    let program = with_elf(image, Program::read)?;
    let named = |name: &str| {
        let entry = program.named(name);
        entry.with_context(|| format!("{}: no function {name}", image.display()))
    };
    let entries: Vec<u32> = calls
        .functions
        .iter()
        .map(|name| named(name))
        .collect::<Result<_>>()?;
    let stop = named(calls.stop)?;
    let even = calls.even(mean);
    let mut chosen = even.clone();
    chosen.extend(&calls.longest);
    // The first call only warms the caches, unless it was chosen.
    let is_warm = chosen.insert(0);

    let boards = BOARDS.iter().filter(|board| board.emulated == core.name);
    let meters = boards.flat_map(|board| MEMORIES.map(|memory| Meter::new(board, memory)));
    let mut traced = Traced {
        instructions: BTreeMap::new(),
        meters: meters.collect(),
        even,
    };
    let mut code = Code::new(&program);
    // What counting adds to a call: the same for every one.
    let mut added = vec![None; entries.len()];
    trace(
        core,
        image,
        stop,
        &entries,
        &chosen,
        |function, call, executed| {
            let length = u32::try_from(executed.len())?;
            if let Some(counted) = (calls.counted)(function, call) {
                let more = length.checked_sub(counted);
                let expected = *added[function].get_or_insert(more);
                ensure!(
                    more.is_some() && more == expected,
                    "call {call} of {}: {length} instructions were traced, {counted} counted",
                    calls.functions[function]
                );
            }
            traced.instructions.entry(call).or_default().push(length);
            let operations = code.operations(executed)?;
            for meter in &mut traced.meters {
                if function == 0 && meter.memory == Memory::ColdFlash {
                    meter.processor.empty_caches();
                }
                let classes = meter.processor.run(executed, &operations);
                meter.samples.entry(call).or_default().push(classes);
            }
            Ok(())
        },
    )?;
    if is_warm {
        traced.instructions.remove(&0);
        for meter in &mut traced.meters {
            meter.samples.remove(&0);
        }
    }
    Ok(traced)
}
