//! Rows of a raster image, as elements of a tool path.

use super::Raster;
use crate::{Act, Element, PathFault, ToolCurve, ToolMotion, ToolPlace, ToolWork};

/// Most runs of an image.
const RUNS_MAX: usize = 1_000_000;

/// Longest gap, m, that is crossed at the feed: a longer one is crossed as fast as the machine may.
const GAP_M: f64 = 5e-3;

/// Place of a raster image on the machine, and the work of the tool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RasterSetup {
    /// Lower left corner of the image in the fixed frame; alpha of the platform all along.
    pub origin: ToolPlace,
    /// Length of a pixel, and distance of rows, m, positive.
    pub pitch_m: f64,
    /// Speed along rows, m/s, positive.
    pub feed_m_s: f64,
    /// Work of the tool where the image has its full tone.
    pub work: ToolWork,
    /// Length, m, before and behind what is burnt, along which the machine has the speed of the row.
    pub overscan_m: f64,
    /// Every row goes along x. Otherwise every other one goes back.
    pub one_way: bool,
    /// Most levels of a [list](RasterPath::lists). None: each run of equal power is an element of its own.
    pub list: Option<usize>,
}

/// Tool path of a raster image.
#[derive(Clone, Debug, PartialEq)]
pub struct RasterPath {
    /// The elements. Their lines count the runs.
    pub elements: Vec<Element>,
    /// Levels of the pixels along an element, parts of 255 of its power, with the line of the element; in order.
    pub lists: Vec<(u32, Vec<u8>)>,
    /// Number of the first element of each row that is burnt, and the row, from 1.
    rows: Vec<(u32, usize)>,
}

impl RasterPath {
    /// Row of an element, by the number of the element: rows count from below.
    pub fn place_of(&self, line: u32) -> String {
        let behind = self.rows.partition_point(|(first, _)| *first <= line);
        match behind.checked_sub(1).map(|index| self.rows[index].1) {
            Some(row) => format!("row {row} from below"),
            None => String::new(),
        }
    }
}

impl Raster {
    /// Tool path of the image, row by row from below. The machine stops at the end of each row. Rows without a tone are left
    /// out, and what has no tone at the ends of a row.
    ///
    /// # Errors
    /// The image has more than a million runs.
    pub fn path(&self, setup: &RasterSetup) -> Result<RasterPath, PathFault> {
        let mut walk = RowWalk {
            setup,
            path: RasterPath {
                elements: Vec::new(),
                lists: Vec::new(),
                rows: Vec::new(),
            },
            line: 0,
        };
        let mut is_back = false;
        for (index, row) in self.levels.chunks(self.columns).enumerate() {
            let mut runs = runs(row);
            if runs.is_empty() {
                continue;
            }
            walk.path.rows.push((walk.line + 1, index + 1));
            if is_back {
                runs.reverse();
                runs.iter_mut().for_each(|run| run.ends.reverse());
            }
            walk.row(&runs, index, f64::from(self.full));
            is_back = !is_back && !setup.one_way;
            if walk.path.elements.len() > RUNS_MAX {
                return Err(PathFault {
                    line: 0,
                    word: String::new(),
                    reason: format!(
                        "the image has more than {RUNS_MAX} runs of equal power; take a larger --pitch or fewer --levels"
                    ),
                });
            }
        }
        Ok(walk.path)
    }
}

/// Pixels of a row that follow each other and have one level.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Stretch {
    /// Columns at which it begins and ends, in the sense in which it is burnt.
    ends: [usize; 2],
    level: u8,
}

/// Runs of a row, without those of level 0 at its ends.
fn runs(row: &[u8]) -> Vec<Stretch> {
    let mut runs: Vec<Stretch> = Vec::new();
    for (column, &level) in row.iter().enumerate() {
        match runs.last_mut() {
            Some(last) if last.level == level => last.ends[1] = column + 1,
            None if level == 0 => {}
            _ => runs.push(Stretch {
                ends: [column, column + 1],
                level,
            }),
        }
    }
    if runs.last().is_some_and(|last| last.level == 0) {
        runs.pop();
    }
    runs
}

/// Pixels that become lists.
#[derive(Clone, Debug, Default, PartialEq)]
struct OpenList {
    /// Columns as those of a [`Stretch`].
    ends: [usize; 2],
    levels: Vec<u8>,
}

impl OpenList {
    /// Adds a run that begins where the pixels end; `full` is the level of the full power.
    fn add(&mut self, run: &Stretch, full: f64) {
        if self.levels.is_empty() {
            self.ends[0] = run.ends[0];
        }
        self.ends[1] = run.ends[1];
        let level = (255.0 * f64::from(run.level) / full).round() as u8;
        let pixels = run.ends[0].abs_diff(run.ends[1]);
        self.levels.extend(std::iter::repeat_n(level, pixels));
    }
}

struct RowWalk<'s> {
    setup: &'s RasterSetup,
    path: RasterPath,
    line: u32,
}

impl RowWalk<'_> {
    fn row(&mut self, runs: &[Stretch], row: usize, full: f64) {
        let setup = self.setup;
        let (Some(first), Some(last)) = (runs.first(), runs.last()) else {
            return;
        };
        let along = |column: usize| column as f64 * setup.pitch_m;
        let sense = if first.ends[0] < first.ends[1] {
            1.0
        } else {
            -1.0
        };
        let overscan = sense * setup.overscan_m;
        let y = (row as f64 + 0.5) * setup.pitch_m;
        let feed = Some(setup.feed_m_s);
        self.to([along(first.ends[0]) - overscan, y], None, None);
        self.to([along(first.ends[0]), y], None, feed);
        let mut open = OpenList::default();
        for run in runs {
            let [from, to] = run.ends.map(along);
            let power = setup.work.power * f64::from(run.level) / full;
            let work = (run.level > 0).then_some(ToolWork {
                power,
                ..setup.work
            });
            let is_gap = work.is_none() && (to - from).abs() > GAP_M + 2.0 * setup.overscan_m;
            if setup.list.is_some() && !is_gap {
                open.add(run, full);
                continue;
            }
            self.list(&mut open, y);
            if is_gap {
                self.to([from + overscan, y], None, feed);
                self.to([to - overscan, y], None, None);
            }
            self.to([to, y], work, feed);
        }
        self.list(&mut open, y);
        self.to([along(last.ends[1]) + overscan, y], None, feed);
        if let Some(Element {
            act: Act::Motion(motion),
            ..
        }) = self.path.elements.last_mut()
        {
            motion.stops = true;
        }
    }

    /// Adds the pixels so far, divided evenly where they are too many for one element.
    fn list(&mut self, open: &mut OpenList, y: f64) {
        let setup = self.setup;
        let OpenList { ends, levels } = std::mem::take(open);
        let most = setup.list.unwrap_or(usize::MAX).max(1);
        let parts = levels.len().div_ceil(most).max(1);
        let most = levels.len().div_ceil(parts).max(1);
        let mut column = ends[0];
        for part in levels.chunks(most) {
            column = match ends[0] < ends[1] {
                true => column + part.len(),
                false => column - part.len(),
            };
            let to = [column as f64 * setup.pitch_m, y];
            self.to(to, Some(setup.work), Some(setup.feed_m_s));
            self.path.lists.push((self.line, part.to_vec()));
        }
    }

    /// Adds a line to a point of the image, m.
    fn to(&mut self, point: [f64; 2], tool: Option<ToolWork>, feed_m_s: Option<f64>) {
        let ToolPlace {
            position_m: [x, y],
            alpha_rad,
        } = self.setup.origin;
        let place = ToolPlace {
            position_m: [x + point[0], y + point[1]],
            alpha_rad,
        };
        self.line += 1;
        self.path.elements.push(Element {
            line: self.line,
            tool,
            act: Act::Motion(ToolMotion {
                curve: ToolCurve::Line,
                to: place,
                feed_m_s,
                stops: false,
            }),
        });
    }
}
