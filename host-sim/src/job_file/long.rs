//! Paths of long files, read block by block.

use std::collections::VecDeque;
use std::fs::File;
use std::io::BufReader;
use std::path::PathBuf;
use trirrr_core::setpoint::Pose;
use trirrr_jobs::{PathReader, PathSink, TOLERANCE_M, TOLERANCE_RAD};
use trirrr_plan::corner::CornerRounding;
use trirrr_plan::course::PathPiece;
use trirrr_scene::read::files;
use trirrr_scene::{BlockCutter, Dwell, PathBlock, PathOutputs, Tool};
use trirrr_toolpath::PathFault;
use trirrr_toolpath::gcode::{self, GcodeFile, GcodeSetup};

/// Path of a long file of G-code, which was looked through.
pub(super) struct LongPath {
    pub(super) file: PathBuf,
    pub(super) setup: GcodeSetup,
    pub(super) start: Pose<f64>,
    pub(super) rate_hz: f64,
    /// Distance by which corners are rounded, m.
    pub(super) corner_m: f64,
    /// Numbers of elements of a pass through the file.
    pub(super) pass: u32,
    pub(super) repeat: u32,
}

impl LongPath {
    /// Number of elements, those of all passes.
    pub(super) fn elements(&self) -> u64 {
        u64::from(self.pass) * u64::from(self.repeat)
    }

    /// Reads the path once more, in constant memory.
    pub(super) fn blocks(&self) -> LongBlocks<'_> {
        LongBlocks {
            long: self,
            time: 0,
            elements: None,
            reader: PathReader::new(self.start, self.rate_hz),
            sink: Some(BlockSink {
                corners: CornerRounding::new(self.corner_m),
                cutter: BlockCutter::new(TOLERANCE_M, TOLERANCE_RAD),
                ready: VecDeque::new(),
            }),
            last: None,
        }
    }

    fn open(&self) -> Result<GcodeFile<BufReader<File>>, PathFault> {
        let file = files::open(&self.file).map_err(|error| PathFault {
            line: 0,
            word: String::new(),
            reason: format!("cannot be read once more: {error}"),
        })?;
        Ok(gcode::elements(BufReader::new(file), self.setup.clone()))
    }
}

/// Blocks of a long path. See [`LongPath::blocks`].
pub(super) struct LongBlocks<'a> {
    long: &'a LongPath,
    /// Passes through the file that are behind.
    time: u32,
    elements: Option<GcodeFile<BufReader<File>>>,
    reader: PathReader,
    /// None behind the end of the path.
    sink: Option<BlockSink>,
    /// Last block.
    last: Option<PathBlock>,
}

/// Rounds corners, and cuts blocks.
struct BlockSink {
    corners: CornerRounding,
    cutter: BlockCutter,
    ready: VecDeque<PathBlock>,
}

impl PathSink for BlockSink {
    fn tool(&mut self, source: usize, tool: Option<Tool>) {
        self.cutter.tool(source, tool);
    }

    fn piece(&mut self, piece: PathPiece) {
        let Self {
            corners,
            cutter,
            ready,
        } = self;
        corners.push(piece, |piece| ready.extend(cutter.piece(piece)));
    }

    fn dwell(&mut self, dwell: Dwell) {
        self.cutter.dwell(dwell);
    }

    fn outputs(&mut self, outputs: PathOutputs) {
        self.cutter.outputs(outputs);
    }
}

impl LongBlocks<'_> {
    /// Reads on to the end of a block, or of the path.
    fn advance(&mut self) -> Result<Option<PathBlock>, PathFault> {
        let pass = self.long.pass as usize;
        while let Some(sink) = &mut self.sink {
            if let Some(block) = sink.ready.pop_front() {
                return Ok(Some(block));
            }
            let elements = match &mut self.elements {
                Some(elements) => elements,
                none => none.insert(self.long.open()?),
            };
            let offset = self.time as usize * pass;
            if let Some(element) = elements.next() {
                self.reader.push(&element?, offset, sink)?;
                continue;
            }
            self.time += 1;
            self.elements = None;
            if self.time < self.long.repeat {
                self.reader.back(offset + pass - 1, sink);
            } else if let Some(sink) = self.sink.take() {
                let (mut cutter, mut ready) = (sink.cutter, sink.ready);
                sink.corners
                    .finish(|piece| ready.extend(cutter.piece(piece)));
                self.last = cutter.finish();
                if let Some(block) = ready.pop_front() {
                    return Ok(Some(block));
                }
            }
        }
        Ok(self.last.take())
    }
}

impl Iterator for LongBlocks<'_> {
    type Item = Result<PathBlock, PathFault>;

    fn next(&mut self) -> Option<Self::Item> {
        let next = self.advance();
        if next.is_err() {
            self.sink = None;
        }
        next.transpose()
    }
}
