//! Largest shapes within a map.

use super::CellGrid;

/// Circle in the plane, m.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Disc {
    /// Centre, m.
    pub centre_m: [f64; 2],
    /// Radius, m.
    pub radius_m: f64,
}

/// Rectangle along the axes, m.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Rectangle {
    /// Lower left corner, m.
    pub low_m: [f64; 2],
    /// Sides, m.
    pub size_m: [f64; 2],
}

impl CellGrid {
    /// Largest circle about the centre of a cell with whole cells that are `kept` alone; none: no cell is kept.
    pub fn largest_disc(&self, kept: &[bool]) -> Option<Disc> {
        let [columns, rows] = self.size;
        let is_kept = |column: isize, row: isize| {
            let inside =
                (0..columns as isize).contains(&column) && (0..rows as isize).contains(&row);
            inside && kept[row as usize * columns + column as usize]
        };
        // Cells beside kept ones: a circle must not touch them.
        let mut edge = Vec::new();
        for row in -1..=rows as isize {
            for column in -1..=columns as isize {
                let beside = [(1, 0), (-1, 0), (0, 1), (0, -1)]
                    .iter()
                    .any(|(x, y)| is_kept(column + x, row + y));
                if beside && !is_kept(column, row) {
                    edge.push([column as f64, row as f64]);
                }
            }
        }
        let mut best: Option<(f64, [usize; 2])> = None;
        for row in 0..rows {
            for column in 0..columns {
                if !kept[row * columns + column] {
                    continue;
                }
                let least = best.map_or(0.0, |(radius, _)| radius);
                let mut radius = f64::INFINITY;
                for [x, y] in &edge {
                    // Nearest point of that cell.
                    let off = |at: f64, own: usize| ((at - own as f64).abs() - 0.5).max(0.0);
                    radius = radius.min(off(*x, column).hypot(off(*y, row)));
                    if radius <= least {
                        break;
                    }
                }
                if radius > least {
                    best = Some((radius, [column, row]));
                }
            }
        }
        best.map(|(radius, [column, row])| Disc {
            centre_m: self.centre_m(column, row),
            radius_m: radius * self.cell_m,
        })
    }

    /// Largest rectangle along the axes of cells that are `kept`; none: no cell is.
    pub fn largest_rectangle(&self, kept: &[bool]) -> Option<Rectangle> {
        let [columns, _] = self.size;
        let mut heights = vec![0_usize; columns + 1];
        let mut best: Option<(usize, [usize; 4])> = None;
        for (row, line) in kept.chunks(columns).enumerate() {
            for (height, is_kept) in heights.iter_mut().zip(line) {
                *height = if *is_kept { *height + 1 } else { 0 };
            }
            // Columns at which rectangles under way begin, with rising heights.
            let mut open: Vec<(usize, usize)> = Vec::new();
            for (column, &height) in heights.iter().enumerate() {
                let mut from = column;
                while let Some(&(begin, taller)) = open.last()
                    && taller > height
                {
                    let area = taller * (column - begin);
                    if best.is_none_or(|(most, _)| area > most) {
                        best = Some((area, [begin, row + 1 - taller, column - begin, taller]));
                    }
                    from = begin;
                    open.pop();
                }
                if height > 0 && open.last().is_none_or(|(_, last)| *last < height) {
                    open.push((from, height));
                }
            }
        }
        best.map(|(_, [column, row, width, height])| Rectangle {
            low_m: [
                self.low_m[0] + column as f64 * self.cell_m,
                self.low_m[1] + row as f64 * self.cell_m,
            ],
            size_m: [width, height].map(|cells| cells as f64 * self.cell_m),
        })
    }
}
