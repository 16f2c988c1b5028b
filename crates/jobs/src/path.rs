//! Elements of a tool path as the path of a job.

use crate::remarks::JobWatch;
use nalgebra::Vector2;
use trirrr_core::setpoint::Pose;
use trirrr_plan::corner::round_corners;
use trirrr_plan::course::PathPiece;
use trirrr_plan::piece::Piece;
use trirrr_scene::words::six_digits;
use trirrr_scene::{Dwell, JobPath, LevelRow, OutputBits, PathOutputs, Tool};
use trirrr_toolpath::{
    Act, Element, OutputAct, PathFault, ToolCurve, ToolMotion, ToolPlace, ToolWork,
};

/// Length, m or rad, below which a motion is what the rounding of decimals has left.
const LENGTH_MIN: f64 = 1e-9;

/// Largest distance of the played motion from the path, m.
pub const TOLERANCE_M: f64 = 1e-5;

/// Most motions of a path in memory.
const PIECES_MAX: usize = 1_000_000;

/// Largest deviation of alpha from the path, rad.
pub const TOLERANCE_RAD: f64 = 1e-4;

/// Takes the parts of a path as they come.
pub trait PathSink {
    /// Work of the tool in the element `source`, which comes before its piece or its dwell.
    fn tool(&mut self, source: usize, tool: Option<Tool>);

    /// A piece of the path, its corners sharp.
    fn piece(&mut self, piece: PathPiece);

    /// A stand behind the pieces so far.
    fn dwell(&mut self, dwell: Dwell);

    /// A change of outputs at an element, which comes before its piece or its dwell.
    fn outputs(&mut self, outputs: PathOutputs);
}

/// Reader of the elements of a path. The number of a piece in the file is its line.
pub struct PathReader {
    rate_hz: f64,
    start: Pose<f64>,
    /// End of the path.
    at: Pose<f64>,
    /// Work of the tool on the last piece, and changes of it so far.
    tool: Option<Tool>,
    setting: usize,
    /// The next piece begins at rest.
    stops: bool,
    /// Pieces so far,
    pieces: usize,
    /// and numbers of elements.
    sources: usize,
    /// Outputs that change with the next motion.
    waiting: Option<OutputBits>,
    /// Lines at which the job waits, for the user or for an input.
    pub pauses: Vec<u32>,
    /// Watch for what was hardly meant.
    pub watch: JobWatch,
}

impl PathReader {
    /// Begins a path at `start`, on a machine with `rate_hz` ticks a second.
    pub fn new(start: Pose<f64>, rate_hz: f64) -> Self {
        Self {
            rate_hz,
            start,
            at: start,
            tool: None,
            setting: 0,
            stops: true,
            pieces: 0,
            sources: 0,
            waiting: None,
            pauses: Vec::new(),
            watch: JobWatch::new(start.position.into()),
        }
    }

    /// Hands the parts of an element to `sink`, its number `offset` behind its line. A motion without a length is left out.
    ///
    /// # Errors
    /// A dwell that lasts longer than ticks are counted.
    pub fn push(
        &mut self,
        element: &Element,
        offset: usize,
        sink: &mut impl PathSink,
    ) -> Result<(), PathFault> {
        self.watch.push(element);
        let source = offset + element.line.saturating_sub(1) as usize;
        match &element.act {
            Act::Motion(motion) => {
                let tool = tool_of(element.tool, motion.feed_m_s);
                let piece = piece_from(self.at, motion);
                if has_length(&piece) {
                    if let Some(bits) = self.waiting.take() {
                        // Moves end where another setting begins.
                        self.change_setting();
                        sink.outputs(PathOutputs {
                            source,
                            with_motion: true,
                            bits,
                        });
                    }
                    self.note_tool(source, tool, sink);
                    self.add(piece, motion.feed_m_s, source, tool, sink);
                }
                self.stops |= motion.stops;
            }
            Act::Dwell { seconds } => {
                let ticks = (seconds * self.rate_hz).round().max(1.0);
                if ticks > f64::from(u32::MAX) {
                    return Err(PathFault {
                        line: element.line,
                        word: String::new(),
                        reason: format!(
                            "a stand of {} s is longer than a machine counts",
                            six_digits(*seconds)
                        ),
                    });
                }
                self.note_tool(source, tool_of(element.tool, None), sink);
                sink.dwell(Dwell {
                    source,
                    ticks: ticks as u32,
                });
                self.stops = true;
            }
            Act::Output(OutputAct {
                index,
                on,
                with_motion,
            }) => {
                let bits = OutputBits::one(*index, *on);
                if *with_motion {
                    let waiting = self.waiting.unwrap_or_default();
                    self.waiting = Some(waiting.then(bits));
                } else {
                    sink.outputs(PathOutputs {
                        source,
                        with_motion: false,
                        bits,
                    });
                    // A stand of one tick, in which they change, has its place on the path wherever that is.
                    self.note_tool(source, tool_of(element.tool, None), sink);
                    sink.dwell(Dwell { source, ticks: 1 });
                    self.stops = true;
                }
            }
            Act::Pause | Act::Input(_) => {
                self.pauses.push(element.line);
                self.stops = true;
            }
        }
        Ok(())
    }

    fn add(
        &mut self,
        piece: Piece<f64>,
        feed_m_s: Option<f64>,
        source: usize,
        tool: Option<Tool>,
        sink: &mut impl PathSink,
    ) {
        if std::mem::replace(&mut self.tool, tool) != tool {
            self.setting += 1;
        }
        self.at = piece.end();
        self.pieces += 1;
        sink.piece(PathPiece {
            piece,
            feed_m_s,
            source,
            stops: std::mem::take(&mut self.stops),
            setting: self.setting,
        });
    }

    /// Gives the pieces from here on a setting of their own.
    fn change_setting(&mut self) {
        self.setting += 1;
    }

    fn note_tool(&mut self, source: usize, tool: Option<Tool>, sink: &mut impl PathSink) {
        self.sources = self.sources.max(source + 1);
        sink.tool(source, tool);
    }

    /// Numbers of elements so far, and one for a way back.
    pub fn pass(&self) -> u32 {
        self.sources as u32 + 1
    }

    /// Number of pieces so far.
    pub fn pieces(&self) -> usize {
        self.pieces
    }

    /// Goes back to where the path began, as the element `source`: straight, as fast as the machine may, with the tool off.
    pub fn back(&mut self, source: usize, sink: &mut impl PathSink) {
        let back = Piece::line(self.at, self.start);
        self.note_tool(source, None, sink);
        if has_length(&back) {
            self.add(back, None, source, None, sink);
        }
        (self.at, self.stops) = (self.start, true);
    }
}

/// Path of a job under construction, in memory.
pub struct PathBuilder {
    /// Reader of the elements, which counts them.
    pub reader: PathReader,
    /// Parts so far; none of a path that is read once more, block by block.
    parts: Option<PathParts>,
}

/// Parts of a path.
#[derive(Default)]
struct PathParts {
    pieces: Vec<PathPiece>,
    dwells: Vec<Dwell>,
    /// Tool of each element.
    tools: Vec<Option<Tool>>,
    /// Rows of levels.
    rows: Vec<LevelRow>,
    /// Changes of outputs.
    outputs: Vec<PathOutputs>,
}

impl PathSink for Option<PathParts> {
    fn tool(&mut self, source: usize, tool: Option<Tool>) {
        if let Some(parts) = self {
            if parts.tools.len() <= source {
                parts.tools.resize(source + 1, None);
            }
            parts.tools[source] = tool;
        }
    }

    fn piece(&mut self, piece: PathPiece) {
        if let Some(parts) = self {
            parts.pieces.push(piece);
        }
    }

    fn dwell(&mut self, dwell: Dwell) {
        if let Some(parts) = self {
            parts.dwells.push(dwell);
        }
    }

    fn outputs(&mut self, outputs: PathOutputs) {
        if let Some(parts) = self {
            parts.outputs.push(outputs);
        }
    }
}

impl PathBuilder {
    /// Begins a path as [`PathReader::new`].
    pub fn new(start: Pose<f64>, rate_hz: f64) -> Self {
        Self {
            reader: PathReader::new(start, rate_hz),
            parts: Some(PathParts::default()),
        }
    }

    /// Adds an element as [`PathReader::push`].
    ///
    /// # Errors
    /// As there.
    pub fn push(&mut self, element: &Element) -> Result<(), PathFault> {
        self.reader.push(element, 0, &mut self.parts)
    }

    /// Adds a straight motion with levels of the tool's power at equal distances.
    ///
    /// # Errors
    /// As [`push`](Self::push).
    pub fn push_row(&mut self, element: &Element, levels: &[u8]) -> Result<(), PathFault> {
        let from = self.reader.at.position;
        let pieces = self.reader.pieces();
        // No other motion has its setting: moves end where it ends.
        self.reader.change_setting();
        self.push(element)?;
        self.reader.change_setting();
        let row = self.parts.as_mut().and_then(|parts| {
            let source = parts.pieces.get(pieces)?.source;
            Some((source, &mut parts.rows))
        });
        if let Some((source, rows)) = row {
            rows.push(LevelRow {
                source,
                ends_m: [from.into(), self.reader.at.position.into()],
                levels: levels.to_vec(),
            });
        }
        Ok(())
    }

    /// Keeps no parts any more: they are only counted.
    pub fn count_only(&mut self) {
        self.parts = None;
    }

    /// Returns true if there are parts.
    pub fn has_parts(&self) -> bool {
        self.parts.is_some()
    }

    /// Lets the machine play the path so far `times` times. Between them it goes back to where it began. It waits for the user as often
    /// as the file says, the first time.
    ///
    /// # Errors
    /// The path becomes longer than fits into memory.
    pub fn repeat(&mut self, times: u32) -> Result<(), PathFault> {
        let pass = self.reader.pass() as usize;
        let Some(parts) = &mut self.parts else {
            return Ok(());
        };
        let length = parts.pieces.len().max(pass);
        if length > PIECES_MAX {
            return Err(too_long(length));
        }
        if length.saturating_mul(times as usize) > PIECES_MAX {
            return Err(too_often(times, PIECES_MAX));
        }
        if times <= 1 {
            return Ok(());
        }
        let (pieces, dwells, tools) = (
            parts.pieces.clone(),
            parts.dwells.clone(),
            parts.tools.clone(),
        );
        let (rows, outputs) = (parts.rows.clone(), parts.outputs.clone());
        let (at, stops) = (self.reader.at, self.reader.stops);
        for offset in (1..times as usize).map(|index| index * pass) {
            (self.reader.at, self.reader.stops) = (at, stops);
            self.reader.back(offset - 1, &mut self.parts);
            let Some(parts) = &mut self.parts else { break };
            parts.tools.resize(offset, None);
            parts.tools.extend(&tools);
            parts.pieces.extend(pieces.iter().map(|each| PathPiece {
                source: each.source + offset,
                ..*each
            }));
            parts.rows.extend(rows.iter().map(|each| LevelRow {
                source: each.source + offset,
                ..each.clone()
            }));
            parts.outputs.extend(outputs.iter().map(|each| PathOutputs {
                source: each.source + offset,
                ..*each
            }));
            parts.dwells.extend(dwells.iter().map(|each| Dwell {
                source: each.source + offset,
                ..*each
            }));
        }
        Ok(())
    }

    /// Ends the path. Corners are rounded within `corner_m`, if it is positive.
    ///
    /// # Errors
    /// Nothing moves.
    pub fn finish(self, corner_m: f64) -> Result<JobPath, PathFault> {
        let parts = self.parts.unwrap_or_default();
        if parts.pieces.is_empty() {
            return Err(PathFault {
                line: 0,
                word: String::new(),
                reason: "nothing in the file moves the machine".into(),
            });
        }
        Ok(JobPath {
            pieces: round_corners(&parts.pieces, corner_m),
            free: None,
            dwells: parts.dwells,
            tools: parts.tools,
            rows: parts.rows,
            outputs: parts.outputs,
            tolerance_m: TOLERANCE_M,
            tolerance_rad: TOLERANCE_RAD,
        })
    }
}

/// Refusal of a job of so many motions.
fn too_long(motions: usize) -> PathFault {
    PathFault {
        line: 0,
        word: String::new(),
        reason: format!(
            "the job has {motions} motions, at most {PIECES_MAX} fit into memory; play it in several files, or as G-code by `trirrr run`, which reads a long file block by block"
        ),
    }
}

/// Refusal of a job that is played so many times.
pub fn too_often(times: u32, most: usize) -> PathFault {
    PathFault {
        line: 0,
        word: "--repeat".into(),
        reason: format!(
            "{times} times have more than {most} motions; take fewer, or start the job several times"
        ),
    }
}

/// Pose of a place.
pub fn pose_of(place: &ToolPlace) -> Pose<f64> {
    let [x, y] = place.position_m;
    Pose::from_f64(x, y, place.alpha_rad)
}

/// Piece of a motion from `at`.
pub fn piece_from(at: Pose<f64>, motion: &ToolMotion) -> Piece<f64> {
    let to = pose_of(&motion.to);
    match motion.curve {
        ToolCurve::Line => Piece::line(at, to),
        ToolCurve::Arc { centre_m, turn_rad } => {
            Piece::arc(at, Vector2::from(centre_m), turn_rad, to.angle)
        }
        ToolCurve::Bezier { controls_m } => {
            let third = (to.angle - at.angle) / 3.0;
            let [[x1, y1], [x2, y2]] = controls_m;
            Piece::bezier([
                at,
                Pose::from_f64(x1, y1, at.angle + third),
                Pose::from_f64(x2, y2, to.angle - third),
                to,
            ])
            .straightened()
        }
    }
}

/// Returns false for what the rounding of decimals has left.
pub fn has_length(piece: &Piece<f64>) -> bool {
    let first = [0.0, 0.5, 1.0].map(|p| piece.at(p).first);
    first.iter().any(|first| first.amax() > LENGTH_MIN)
}

/// Tool of a motion at a feed. A power that follows the speed is the given one at the feed.
pub fn tool_of(work: Option<ToolWork>, feed_m_s: Option<f64>) -> Option<Tool> {
    work.map(|work| Tool {
        power: work.power,
        speed_m_s: match work.follows_speed {
            true => feed_m_s.unwrap_or(0.0),
            false => 0.0,
        },
    })
}

#[cfg(test)]
mod tests {
    use crate::{JobOptions, gcode_job};
    use trirrr_scene::{OutputBits, Scene};
    use trirrr_toolpath::ToolPlace;

    /// Each change is with the move that begins where the program has it.
    #[test]
    fn outputs_change_with_the_moves_of_their_places() {
        let file = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../scenes/inputs/valves.toml"
        );
        let mut scene = Scene::read(file).expect("a shipped scene");
        let options = JobOptions {
            origin: ToolPlace {
                position_m: [0.21, 0.22],
                alpha_rad: 0.0,
            },
            ..JobOptions::default()
        };
        // G64: the machine passes the places of M62 and M63 without a stop.
        let text = "G21 G90 G64\nM64 P1\nG1 X5 F3000\nM62 P0\nG4 P0.1\nX10\nM63 P0\nM63 P1\nX20\nM65 P1\nM64 P0\n";
        let job = gcode_job(text.as_bytes(), &scene, &options).expect("a good program");
        job.plan(&mut scene).expect("a plan");
        let (moves, outputs) = (&scene.job.moves, &scene.job.outputs);
        let found: Vec<(i64, bool, OutputBits)> = outputs
            .changes()
            .iter()
            .map(|(index, bits)| {
                let each = &moves[*index as usize];
                let x_um = ((each.from.position.x - 0.21) * 1e6).round() as i64;
                (x_um, each.from == each.to, *bits)
            })
            .collect();
        let one = OutputBits::one;
        let expected = [
            (0, true, one(1, true)),
            // Behind the dwell: that is no motion.
            (5000, false, one(0, true)),
            (10_000, false, one(0, false).then(one(1, false))),
            (20_000, true, one(1, false)),
            (20_000, true, one(0, true)),
        ];
        assert_eq!(found.len(), expected.len(), "{found:?}");
        for (found, expected) in found.iter().zip(&expected) {
            assert_eq!((found.1, found.2), (expected.1, expected.2));
            // A move has whole ticks: half of one, at 50 mm/s.
            let most = if found.1 { 0 } else { 25 };
            assert!(
                (found.0 - expected.0).abs() <= most,
                "{found:?} {expected:?}"
            );
        }
        // It does not rest at the place of M63.
        let passed = moves
            .iter()
            .find(|each| each.from.position.x >= 0.2199 && each.from != each.to);
        assert!(passed.expect("a move").start_velocity.x > 0.01);
        // Twice: the same changes once more, behind the way back.
        let twice = JobOptions {
            repeat: 2,
            ..options
        };
        let job = gcode_job(text.as_bytes(), &scene, &twice).expect("a good program");
        job.plan(&mut scene).expect("a plan");
        assert_eq!(scene.job.outputs.changes().len(), 2 * expected.len());
    }
}
