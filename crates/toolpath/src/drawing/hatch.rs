//! Fill of an area with parallel lines.

use super::{Area, Drawing, FLATNESS_M, Stroke, StrokeCurve};
use crate::{PathFault, six};

/// Most lines of a drawing's fill.
const LINES_MAX: f64 = 1e6;

impl Drawing {
    /// Fills every area with lines along x at a distance of `pitch_m`, in the colour of its fill. Outlines without a
    /// colour of their own are no longer drawn.
    ///
    /// # Errors
    /// The fill has more than a million lines.
    pub fn fill(&mut self, pitch_m: f64) -> Result<(), PathFault> {
        let areas = std::mem::take(&mut self.areas);
        // Where areas are filled, only outlines with a stroke remain.
        let bare: Vec<usize> = areas
            .iter()
            .filter(|area| !area.stroked)
            .map(|area| area.shape)
            .collect();
        self.strokes
            .retain(|stroke| bare.binary_search(&stroke.shape).is_err());
        for area in &areas {
            hatch(area, pitch_m, &mut self.strokes)?;
        }
        Ok(())
    }
}

/// Edge of an outline that crosses horizontal lines.
struct Edge {
    from: [f64; 2],
    to: [f64; 2],
    /// +1: upward, -1: downward.
    winding: i32,
}

fn hatch(area: &Area, pitch_m: f64, strokes: &mut Vec<Stroke>) -> Result<(), PathFault> {
    let edges = edges_of(&area.outlines);
    let low = edges
        .iter()
        .map(|edge| edge.from[1])
        .fold(f64::INFINITY, f64::min);
    let high = edges
        .iter()
        .map(|edge| edge.to[1])
        .fold(f64::NEG_INFINITY, f64::max);
    let lines = ((high - low) / pitch_m).floor();
    if lines + strokes.len() as f64 > LINES_MAX {
        return Err(PathFault {
            line: 0,
            word: String::new(),
            reason: format!(
                "the fill has more than {LINES_MAX} lines; take a larger distance of lines than {} mm",
                six(1e3 * pitch_m)
            ),
        });
    }
    if edges.is_empty() {
        return Ok(());
    }
    // The lines stand in the middle of the height.
    let rows = FillRows {
        first: low + 0.5 * (high - low - lines * pitch_m),
        pitch_m,
        count: lines as usize + 1,
    };
    let mut inside = rows.inside(&edges, area.non_zero);
    let mut region = vec![Vec::new(); rows.count];
    for clip in &area.clips {
        let shape = rows.inside(&edges_of(&clip.outlines), clip.non_zero);
        for ((row, region), shape) in inside.iter_mut().zip(&mut region).zip(&shape) {
            let adds = clip.adds;
            *region = combined(region, shape, |within, on| if on { adds } else { within });
            if clip.is_last {
                *row = combined(row, &std::mem::take(region), |one, other| one && other);
            }
        }
    }
    for (index, row) in inside.iter().enumerate() {
        let y = rows.first + index as f64 * pitch_m;
        for [from, to] in row {
            strokes.push(Stroke {
                shape: area.shape,
                colour: area.colour,
                start: [*from, y],
                curves: vec![StrokeCurve::Line([*to, y])],
            });
        }
    }
    Ok(())
}

/// Rows of a fill.
struct FillRows {
    /// Height of the first, m.
    first: f64,
    pitch_m: f64,
    count: usize,
}

impl FillRows {
    /// Stretches of each row that are inside the edges.
    fn inside(&self, edges: &[Edge], non_zero: bool) -> Vec<Vec<[f64; 2]>> {
        let mut crossings: Vec<Vec<(f64, i32)>> = vec![Vec::new(); self.count];
        for edge in edges {
            let row = |y: f64| (y - self.first) / self.pitch_m;
            let rows = row(edge.from[1]).ceil().max(0.0) as usize..crossings.len();
            for index in rows {
                let y = self.first + index as f64 * self.pitch_m;
                // A line through a corner crosses the edge above it, so that it counts once.
                if y >= edge.to[1] {
                    break;
                }
                if y < edge.from[1] {
                    continue;
                }
                let p = (y - edge.from[1]) / (edge.to[1] - edge.from[1]);
                let x = edge.from[0] + p * (edge.to[0] - edge.from[0]);
                crossings[index].push((x, edge.winding));
            }
        }
        let rows = crossings.iter_mut().map(|row| {
            row.sort_by(|one, other| one.0.total_cmp(&other.0));
            inside(row, non_zero)
        });
        rows.collect()
    }
}

/// Stretches at whose places `holds` is true, by whether the places are in one list, and in the other.
fn combined(
    one: &[[f64; 2]],
    other: &[[f64; 2]],
    holds: impl Fn(bool, bool) -> bool,
) -> Vec<[f64; 2]> {
    let mut places: Vec<f64> = one.iter().chain(other).flatten().copied().collect();
    places.sort_by(f64::total_cmp);
    let within = |list: &[[f64; 2]], place: f64| {
        let behind = list.partition_point(|stretch| stretch[0] <= place);
        behind > 0 && place < list[behind - 1][1]
    };
    let mut found: Vec<[f64; 2]> = Vec::new();
    for pair in places.windows(2) {
        let middle = 0.5 * (pair[0] + pair[1]);
        if pair[1] <= pair[0] || !holds(within(one, middle), within(other, middle)) {
            continue;
        }
        match found.last_mut() {
            Some(last) if last[1] == pair[0] => last[1] = pair[1],
            _ => found.push([pair[0], pair[1]]),
        }
    }
    found
}

/// Edges of outlines, upward. Level ones are left out, outlines are closed.
fn edges_of(outlines: &[Stroke]) -> Vec<Edge> {
    let mut edges = Vec::new();
    for outline in outlines {
        let mut points = outline.points(FLATNESS_M);
        points.push(outline.start);
        for pair in points.windows(2) {
            let (from, to) = (pair[0], pair[1]);
            if from[1] < to[1] {
                edges.push(Edge {
                    from,
                    to,
                    winding: 1,
                });
            } else if to[1] < from[1] {
                edges.push(Edge {
                    from: to,
                    to: from,
                    winding: -1,
                });
            }
        }
    }
    edges
}

/// Stretches of a line inside the area, from its crossings in ascending order.
fn inside(row: &[(f64, i32)], non_zero: bool) -> Vec<[f64; 2]> {
    let mut stretches: Vec<[f64; 2]> = Vec::new();
    let mut winding = 0;
    for pair in row.windows(2) {
        winding += if non_zero { pair[0].1 } else { 1 };
        let within = match non_zero {
            true => winding != 0,
            false => winding % 2 == 1,
        };
        if !within || pair[1].0 <= pair[0].0 {
            continue;
        }
        match stretches.last_mut() {
            Some(last) if last[1] == pair[0].0 => last[1] = pair[1].0,
            _ => stretches.push([pair[0].0, pair[1].0]),
        }
    }
    stretches
}
