//! `[[job.path]]`: a path without durations, whose moves are planned.

use crate::duration::whole_ticks;
use crate::job_move::{Tool, read_tool};
use crate::levels::LevelRow;
use crate::outputs::{OutputBits, PathOutputs};
use crate::read::{Bound, Place, Section};
use nalgebra::{Vector2, Vector3};
use trirrr_core::setpoint::Pose;
use trirrr_plan::alpha::FreePath;
use trirrr_plan::corner::round_corners;
use trirrr_plan::course::PathPiece;
use trirrr_plan::natural::natural_spline;
use trirrr_plan::piece::Piece;

/// Default of `tolerance_m`.
pub(crate) const TOLERANCE_M: f64 = 1e-5;
/// Default of `tolerance_rad`.
pub(crate) const TOLERANCE_RAD: f64 = 1e-4;
/// The same where alpha is free: what is played need not have just the alpha that was chosen.
const FREE_TOLERANCE_RAD: f64 = 1e-2;

/// Length of a piece, m or rad, below which it is what the rounding of its ends has left.
const LENGTH_MIN: f64 = 1e-12;

/// A path that a job follows in the least time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct JobPath {
    /// The pieces as they are played, corners rounded; each knows its number in the file.
    pub pieces: Vec<PathPiece>,
    /// The path whose alpha the planner may choose, if it may.
    pub free: Option<FreeAlpha>,
    /// Stands between the pieces, in order.
    pub dwells: Vec<Dwell>,
    /// Work of the tool on each table of the file, a piece or a dwell.
    pub tools: Vec<Option<Tool>>,
    /// Straight parts with levels of the tool's power, in order.
    pub rows: Vec<LevelRow>,
    /// Changes of outputs, in order.
    pub outputs: Vec<PathOutputs>,
    /// Largest distance of the played motion from the path, m.
    pub tolerance_m: f64,
    /// Largest deviation of alpha, rad.
    pub tolerance_rad: f64,
}

/// A stand of the machine on the path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Dwell {
    /// Number of its table in the file, from 0. The machine stands where the piece before ends. A stand that waits for the tool has
    /// the number of the piece behind it.
    pub source: usize,
    /// Duration in ticks, positive.
    pub ticks: u32,
}

impl JobPath {
    /// Stands behind the piece with the number `after` in the file, and before that with the number `before`; none: the
    /// path begins or ends there.
    pub fn dwells_between(
        &self,
        after: Option<usize>,
        before: Option<usize>,
    ) -> impl Iterator<Item = &Dwell> {
        let lies = move |dwell: &&Dwell| {
            after.is_none_or(|after| dwell.source > after)
                && before.is_none_or(|before| dwell.source <= before)
        };
        self.dwells.iter().filter(lies)
    }

    /// Returns the ticks for which the machine stands in [those](Self::dwells_between) dwells.
    pub fn stand_ticks(&self, after: Option<usize>, before: Option<usize>) -> u64 {
        let dwells = self.dwells_between(after, before);
        dwells.map(|each| u64::from(each.ticks)).sum()
    }
}

/// A path whose alpha is free.
#[derive(Clone, Debug, PartialEq)]
pub struct FreeAlpha {
    /// The pieces with alpha as the file gives it, corners rounded.
    pub given: Vec<PathPiece>,
    /// D's way, with alpha where it is fixed.
    pub way: FreePath,
}

/// Pieces of one table, and alpha at the end of each if the table gives it.
type Pieces = Vec<(Piece<f64>, Option<f64>)>;

/// A path, and where its pieces stand in the file.
pub(crate) struct PlacedPath {
    pub(crate) path: JobPath,
    pub(crate) places: Vec<Place>,
}

/// Reads the pieces of `job` from `start`; `sections` are its `[[job.path]]`, and `of_table` reads the outputs that change there. Without
/// a tick `rate`, dwells are not checked.
pub(crate) fn read_path(
    job: &Section,
    sections: &[Section],
    start: Option<Pose<f64>>,
    rate: Option<f64>,
    mut of_table: impl FnMut(&Section) -> OutputBits,
) -> Option<PlacedPath> {
    let tolerance_m = job.number_or("tolerance_m", Bound::Positive, TOLERANCE_M);
    let feed_m_s = read_feed(job);
    let corner_m = match job.has("corner_tolerance_m") {
        true => job.number("corner_tolerance_m", Bound::Positive).map(Some),
        false => Some(None),
    };
    let is_free = match job.has("alpha") {
        true => job.choice("alpha", &[("given", false), ("free", true)]),
        false => Some(false),
    };
    let default_rad = match is_free {
        Some(true) => FREE_TOLERANCE_RAD,
        _ => TOLERANCE_RAD,
    };
    let tolerance_rad = job.number_or("tolerance_rad", Bound::Positive, default_rad);
    let mut from = start;
    let (mut pieces, mut ends, mut tools) = (Vec::new(), Vec::new(), Vec::new());
    let (mut dwells, mut outputs): (Vec<Dwell>, Vec<PathOutputs>) = (Vec::new(), Vec::new());
    let mut complete = true;
    // Work of the tool on the last piece, and changes of the setting so far.
    let (mut last_tool, mut setting) = (None, 0);
    for (source, each) in sections.iter().enumerate() {
        let stands = stands(each);
        let bits = of_table(each);
        let switches = bits != OutputBits::default();
        if switches {
            outputs.push(PathOutputs {
                source,
                with_motion: !stands,
                bits,
            });
        }
        if stands {
            match (read_stand(each, rate), read_tool(each)) {
                (Some(ticks), Some(tool)) => {
                    dwells.push(Dwell { source, ticks });
                    tools.push(tool);
                }
                _ => complete = false,
            }
            continue;
        }
        let piece = read_piece(each, from, is_free == Some(true));
        let own_feed = read_feed(each);
        let tool = read_tool(each);
        if let Some(piece) = &piece
            && piece.iter().any(|(piece, _)| !has_length(piece))
        {
            each.refuse_at(&each.place(), "has no length: it ends where it begins");
            complete = false;
        }
        from = piece
            .as_ref()
            .and_then(|piece| piece.last())
            .map(|(piece, _)| piece.end());
        let whole = || Some((piece?, own_feed?.or(feed_m_s?), tool?));
        match whole() {
            Some((piece, feed_m_s, tool)) => {
                // A spline has several; the machine stands before the first of them.
                let mut stops = dwells.last().is_some_and(|last| last.source + 1 == source);
                let is_other = last_tool.replace(tool) != Some(tool);
                // Moves end where another setting begins.
                if is_other || switches {
                    setting += 1;
                }
                for (piece, end) in piece {
                    ends.push(end);
                    pieces.push(PathPiece {
                        piece,
                        feed_m_s,
                        source,
                        stops,
                        setting,
                    });
                    stops = false;
                }
                tools.push(tool);
            }
            None => complete = false,
        }
    }
    let (tolerance_m, tolerance_rad, corner_m) = (tolerance_m?, tolerance_rad?, corner_m?);
    let is_free = is_free?;
    if !complete {
        return None;
    }
    if pieces.is_empty() {
        let reason =
            "the machine only stands: a path needs at least one line, arc, bezier or spline";
        job.refuse_list("path", reason);
        return None;
    }
    let way = is_free.then(|| FreePath::new(&pieces, &ends, corner_m));
    if let Some(corner_m) = corner_m {
        pieces = round_corners(&pieces, corner_m);
    }
    Some(PlacedPath {
        path: JobPath {
            free: way.map(|way| FreeAlpha {
                given: pieces.clone(),
                way,
            }),
            pieces,
            dwells,
            tools,
            rows: Vec::new(),
            outputs,
            tolerance_m,
            tolerance_rad,
        },
        places: sections.iter().map(Section::place).collect(),
    })
}

/// `feed_m_s`: `Some(None)` where it is left out.
fn read_feed(section: &Section) -> Option<Option<f64>> {
    match section.has("feed_m_s") {
        true => section.number("feed_m_s", Bound::Positive).map(Some),
        false => Some(None),
    }
}

fn has_length(piece: &Piece<f64>) -> bool {
    let first = [0.0, 0.5, 1.0].map(|p| piece.at(p).first);
    first.iter().any(|first| first.amax() > LENGTH_MIN)
}

/// Keys of which a table has one.
const KINDS: [&str; 5] = ["line", "arc", "bezier", "spline", "dwell_s"];

/// Returns true if the machine stands in this table, and nothing else: for a time, or for a change of outputs.
fn stands(each: &Section) -> bool {
    match KINDS.iter().filter(|kind| each.has(kind)).count() {
        0 => each.has("outputs"),
        1 => each.has("dwell_s"),
        _ => false,
    }
}

/// The ticks of a stand. Outputs that change by themselves take one.
fn read_stand(each: &Section, rate: Option<f64>) -> Option<u32> {
    let has_feed = each.has("feed_m_s");
    if has_feed {
        let reason = "the machine stands during a dwell or a change of outputs: it has no speed";
        each.refuse("feed_m_s", reason);
    }
    let ticks = match each.has("dwell_s") {
        true => whole_ticks(each.number("dwell_s", Bound::Positive)?, rate?)
            .map_err(|reason| each.refuse("dwell_s", reason))
            .ok()?,
        false => 1,
    };
    (!has_feed).then_some(ticks)
}

/// The piece of one table, from `from`: several cubics for a spline.
fn read_piece(each: &Section, from: Option<Pose<f64>>, is_free: bool) -> Option<Pieces> {
    let mut given = KINDS.iter().filter(|kind| each.has(kind));
    let (kind, second) = (given.next(), given.next());
    let Some(kind) = kind.filter(|_| second.is_none()) else {
        let reason = "expected one of line, arc, bezier, spline and dwell_s, or outputs alone";
        each.refuse_at(&each.place(), reason);
        each.ignore_rest();
        return None;
    };
    let section = each.section(kind)?;
    let piece = match *kind {
        "line" => {
            let to = read_end(&section, from);
            Piece::line(from?, to?)
        }
        "arc" => {
            let centre = section.vector("centre_m", None);
            let turn = section.number("turn_rad", Bound::Finite);
            let angle = read_angle(&section, from);
            Piece::arc(from?, Vector2::from(centre?), turn?, angle?)
        }
        "bezier" => read_bezier(&section, from, is_free)?,
        _ => return read_spline(&section, from?),
    };
    let end = section.has("alpha_rad").then(|| piece.end().angle);
    Some(vec![(piece, end)])
}

fn read_bezier(section: &Section, from: Option<Pose<f64>>, is_free: bool) -> Option<Piece<f64>> {
    let [c1, c2] = section.vectors::<2>("controls_m")?;
    let to = read_end(section, from);
    let angles = match section.has("controls_alpha_rad") {
        true if is_free => {
            let reason = "gives alpha all the way, but alpha = \"free\" leaves it to the planner";
            section.refuse("controls_alpha_rad", reason);
            None
        }
        true => Some(Some(section.vector("controls_alpha_rad", None)?)),
        false => Some(None),
    };
    let (from, to) = (from?, to?);
    // Linear in p where nothing is said.
    let third = (to.angle - from.angle) / 3.0;
    let [a1, a2] = angles?.unwrap_or([from.angle + third, to.angle - third]);
    let control = |[x, y]: [f64; 2], angle| Pose::from_f64(x, y, angle);
    Some(Piece::bezier([from, control(c1, a1), control(c2, a2), to]).straightened())
}

fn read_spline(section: &Section, from: Pose<f64>) -> Option<Pieces> {
    let through = section.sections("through")?;
    if through.is_empty() {
        let reason = "a spline needs at least one pose to pass through";
        section.refuse_list("through", reason);
        return None;
    }
    let mut poses = vec![from];
    let mut ends = Vec::with_capacity(through.len());
    for each in &through {
        let pose = read_end(each, poses.last().copied())?;
        ends.push(each.has("alpha_rad").then_some(pose.angle));
        poses.push(pose);
    }
    Some(spline(&poses).into_iter().zip(ends).collect())
}

/// x_m, y_m, and alpha_rad, which stays as in `from` where it is left out.
fn read_end(section: &Section, from: Option<Pose<f64>>) -> Option<Pose<f64>> {
    let x = section.number("x_m", Bound::Finite);
    let y = section.number("y_m", Bound::Finite);
    let angle = read_angle(section, from);
    Some(Pose::from_f64(x?, y?, angle?))
}

fn read_angle(section: &Section, from: Option<Pose<f64>>) -> Option<f64> {
    match section.has("alpha_rad") {
        true => section.number("alpha_rad", Bound::Finite),
        false => from.map(|from| from.angle),
    }
}

/// The natural cubic spline through `poses`, over the lengths of its chords: curvature is continuous, and zero at
/// both ends.
fn spline(poses: &[Pose<f64>]) -> Vec<Piece<f64>> {
    let vector = |pose: &Pose<f64>| Vector3::new(pose.position.x, pose.position.y, pose.angle);
    let points: Vec<_> = poses.iter().map(vector).collect();
    let chords: Vec<f64> = points
        .windows(2)
        .map(|pair| {
            let chord = pair[1] - pair[0];
            chord.dot(&chord).sqrt()
        })
        .collect();
    let coefficients = natural_spline(&chords, &points);
    let starts = poses.iter().zip(coefficients);
    starts
        .map(|(start, coefficients)| Piece::cubic(*start, coefficients))
        .collect()
}
