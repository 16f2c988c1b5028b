//! Elements of a tool path as the path of a job.

use nalgebra::Vector2;
use trirrr_core::setpoint::Pose;
use trirrr_plan::corner::round_corners;
use trirrr_plan::course::PathPiece;
use trirrr_plan::piece::Piece;
use trirrr_scene::{Dwell, JobPath, LevelRow, Tool};
use trirrr_toolpath::{Act, Element, PathFault, ToolCurve, ToolMotion, ToolPlace, ToolWork};

/// Length, m or rad, below which a motion is what the rounding of decimals has left.
const LENGTH_MIN: f64 = 1e-9;

/// Largest distance of the played motion from the path, m.
const TOLERANCE_M: f64 = 1e-5;

/// Most motions of a path.
const PIECES_MAX: usize = 20_000_000;

/// Largest deviation of alpha from the path, rad.
const TOLERANCE_RAD: f64 = 1e-4;

/// Path of a job under construction. The number of a piece in the file is its line.
pub(crate) struct PathBuilder {
    rate_hz: f64,
    /// End of the path.
    at: Pose<f64>,
    pieces: Vec<PathPiece>,
    dwells: Vec<Dwell>,
    /// Tool of each line, from line 1 on.
    tools: Vec<Option<Tool>>,
    /// Different tools so far.
    settings: Vec<Option<Tool>>,
    /// The next piece begins at rest.
    stops: bool,
    /// Rows of levels.
    rows: Vec<LevelRow>,
    /// Lines at which the job waits for the user.
    pub(crate) pauses: Vec<u32>,
}

impl PathBuilder {
    /// Begins a path at `start`, on a machine with `rate_hz` ticks a second.
    pub(crate) fn new(start: Pose<f64>, rate_hz: f64) -> Self {
        Self {
            rate_hz,
            at: start,
            pieces: Vec::new(),
            dwells: Vec::new(),
            tools: Vec::new(),
            settings: Vec::new(),
            stops: true,
            rows: Vec::new(),
            pauses: Vec::new(),
        }
    }

    /// Adds an element. A motion without a length is left out.
    ///
    /// # Errors
    /// A dwell that lasts longer than ticks are counted.
    pub(crate) fn push(&mut self, element: &Element) -> Result<(), PathFault> {
        let source = element.line.saturating_sub(1) as usize;
        match &element.act {
            Act::Motion(motion) => {
                let tool = tool_of(element.tool, motion.feed_m_s);
                let piece = piece_from(self.at, motion);
                if has_length(&piece) {
                    self.note_tool(source, tool);
                    let setting = self.setting(tool);
                    self.at = piece.end();
                    self.pieces.push(PathPiece {
                        piece,
                        feed_m_s: motion.feed_m_s,
                        source,
                        stops: self.stops,
                        setting,
                    });
                    self.stops = false;
                }
                self.stops |= motion.stops;
            }
            Act::Dwell { seconds } => {
                let ticks = (seconds * self.rate_hz).round().max(1.0);
                if ticks > f64::from(u32::MAX) {
                    return Err(PathFault {
                        line: element.line,
                        word: String::new(),
                        reason: format!("a stand of {seconds} s is longer than a machine counts"),
                    });
                }
                self.note_tool(source, tool_of(element.tool, None));
                self.dwells.push(Dwell {
                    source,
                    ticks: ticks as u32,
                });
                self.stops = true;
            }
            Act::Pause => {
                self.pauses.push(element.line);
                self.stops = true;
            }
        }
        Ok(())
    }

    /// Adds a straight motion with levels of the tool's power at equal distances.
    ///
    /// # Errors
    /// As [`push`](Self::push).
    pub(crate) fn push_row(&mut self, element: &Element, levels: &[u8]) -> Result<(), PathFault> {
        let (from, pieces) = (self.at.position, self.pieces.len());
        self.push(element)?;
        if let Some(piece) = self.pieces.get_mut(pieces) {
            // No other motion has its setting: moves end where it ends.
            piece.setting = self.settings.len();
            self.settings.push(self.tools[piece.source]);
            self.rows.push(LevelRow {
                source: piece.source,
                ends_m: [from.into(), self.at.position.into()],
                levels: levels.to_vec(),
            });
        }
        Ok(())
    }

    fn note_tool(&mut self, source: usize, tool: Option<Tool>) {
        if self.tools.len() <= source {
            self.tools.resize(source + 1, None);
        }
        self.tools[source] = tool;
    }

    fn setting(&mut self, tool: Option<Tool>) -> usize {
        let known = self.settings.iter().position(|other| *other == tool);
        known.unwrap_or_else(|| {
            self.settings.push(tool);
            self.settings.len() - 1
        })
    }

    /// Numbers of elements so far, and one for a way back.
    pub(crate) fn pass(&self) -> u32 {
        self.tools.len() as u32 + 1
    }

    /// Lets the machine play the path so far `times` times. Between them it goes back to where it began: straight, as fast as it may,
    /// with the tool off. It waits for the user as often as the file says, the first time.
    ///
    /// # Errors
    /// The path becomes longer than a machine is told.
    pub(crate) fn repeat(&mut self, times: u32) -> Result<(), PathFault> {
        let pass = self.pass() as usize;
        let Some(first) = self.pieces.first().filter(|_| times > 1) else {
            return Ok(());
        };
        let start = first.piece.at(0.0).pose;
        if self.pieces.len().max(pass) * times as usize > PIECES_MAX {
            return Err(PathFault {
                line: 0,
                word: "--repeat".into(),
                reason: format!(
                    "{times} times have more than {PIECES_MAX} motions; take fewer, or start the job several times"
                ),
            });
        }
        let back = Piece::line(self.at, start);
        let off = self.setting(None);
        let (pieces, dwells, tools) =
            (self.pieces.clone(), self.dwells.clone(), self.tools.clone());
        let rows = self.rows.clone();
        for offset in (1..times as usize).map(|index| index * pass) {
            if has_length(&back) {
                self.pieces.push(PathPiece {
                    piece: back,
                    feed_m_s: None,
                    source: offset - 1,
                    stops: self.stops,
                    setting: off,
                });
            }
            self.tools.push(None);
            self.tools.extend(&tools);
            self.pieces.extend(pieces.iter().map(|each| PathPiece {
                source: each.source + offset,
                ..*each
            }));
            self.rows.extend(rows.iter().map(|each| LevelRow {
                source: each.source + offset,
                ..each.clone()
            }));
            self.dwells.extend(dwells.iter().map(|each| Dwell {
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
    pub(crate) fn finish(self, corner_m: f64) -> Result<JobPath, PathFault> {
        if self.pieces.is_empty() {
            return Err(PathFault {
                line: 0,
                word: String::new(),
                reason: "nothing in the file moves the machine".into(),
            });
        }
        let pieces = match corner_m > 0.0 {
            true => round_corners(&self.pieces, corner_m),
            false => self.pieces,
        };
        Ok(JobPath {
            pieces,
            free: None,
            dwells: self.dwells,
            tools: self.tools,
            rows: self.rows,
            tolerance_m: TOLERANCE_M,
            tolerance_rad: TOLERANCE_RAD,
        })
    }
}

/// Pose of a place.
pub(crate) fn pose_of(place: &ToolPlace) -> Pose<f64> {
    let [x, y] = place.position_m;
    Pose::from_f64(x, y, place.alpha_rad)
}

/// Piece of a motion from `at`.
pub(crate) fn piece_from(at: Pose<f64>, motion: &ToolMotion) -> Piece<f64> {
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
        }
    }
}

/// Returns false for what the rounding of decimals has left.
pub(crate) fn has_length(piece: &Piece<f64>) -> bool {
    let first = [0.0, 0.5, 1.0].map(|p| piece.at(p).first);
    first.iter().any(|first| first.amax() > LENGTH_MIN)
}

/// Tool of a motion at a feed. A power that follows the speed is the given one at the feed.
pub(crate) fn tool_of(work: Option<ToolWork>, feed_m_s: Option<f64>) -> Option<Tool> {
    work.map(|work| Tool {
        power: work.power,
        speed_m_s: match work.follows_speed {
            true => feed_m_s.unwrap_or(0.0),
            false => 0.0,
        },
    })
}
