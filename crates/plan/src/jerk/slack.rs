//! Room that limits leave to a motion.

use super::problem::Problem;

/// Value of a limit, positive where it is kept, with its slopes at up to three marks from the first on.
pub(super) struct Slack {
    pub(super) first: usize,
    pub(super) value: f64,
    pub(super) slopes: [f64; 3],
}

impl Problem<'_> {
    /// Hands the slack of each limit to `take`, until it returns false. Returns true if it never does.
    pub(super) fn slacks(&self, parts: &[f64], mut take: impl FnMut(Slack) -> bool) -> bool {
        let count = self.cells.len();
        for (first, part) in parts.iter().enumerate().take(count).skip(1) {
            let slopes = |slope| [slope, 0.0, 0.0];
            let [above, below] = [1.0 - part, *part];
            let both = [(above, slopes(-1.0)), (below, slopes(1.0))];
            for (value, slopes) in both {
                if !take(Slack {
                    first,
                    value,
                    slopes,
                }) {
                    return false;
                }
            }
        }
        for (first, each) in &self.linear {
            let [y, z] = self.cells[*first].ends;
            // In parts of the limit.
            let (start, end) = (each.start * y / each.limit, each.end * z / each.limit);
            let slack = Slack {
                first: *first,
                value: 1.0 - start * parts[*first] - end * parts[first + 1],
                slopes: [-start, -end, 0.0],
            };
            if !take(slack) {
                return false;
            }
        }
        (0..=count).all(|mark| self.jerks(mark, parts, &mut take))
    }

    /// Limits of the jerk about `mark`.
    fn jerks(&self, mark: usize, parts: &[f64], take: &mut impl FnMut(Slack) -> bool) -> bool {
        let count = self.cells.len();
        let first = mark.saturating_sub(1);
        // The cells before and behind, those that there are.
        let cells = first..(mark + 1).min(count);
        let jumps = self.jerk.jumps.get(mark).copied().unwrap_or([0.0; 3]);
        let mut time = match jumps == [0.0; 3] {
            true => 0.0,
            false => self.jerk.step_s,
        };
        let mut time_slopes = [0.0; 3];
        let mut share = 1.0f64;
        for index in cells.clone() {
            let [cell_time, by_y, by_z, ..] = self.cell_time(index, parts);
            // From middle to middle; the motion is at rest before and behind.
            time += 0.5 * cell_time;
            time_slopes[index - first] += 0.5 * by_y;
            time_slopes[index - first + 1] += 0.5 * by_z;
            share = share.min(self.cells[index].share);
        }
        for (motor, limit) in self.jerk.limits.into_iter().enumerate() {
            let (mut change, mut slopes) = (0.0, [0.0; 3]);
            for index in cells.clone() {
                let cell = &self.cells[index];
                let [of_a, of_x] = self.jerk.turning[index][motor];
                let per_length = 0.5 * of_a / cell.length;
                let sign = if index == mark { 1.0 } else { -1.0 };
                let by_y = sign * (0.5 * of_x - per_length) * cell.ends[0];
                let by_z = sign * (0.5 * of_x + per_length) * cell.ends[1];
                slopes[index - first] += by_y;
                slopes[index - first + 1] += by_z;
                change += by_y * parts[index] + by_z * parts[index + 1];
            }
            // In parts of what a limit allows in the time of the passes.
            for sign in [1.0, -1.0] {
                let slack =
                    |of_time: f64, of_change: f64| share * of_time - sign * of_change / limit;
                let slack = Slack {
                    first,
                    value: slack(time, change),
                    slopes: [0, 1, 2].map(|at: usize| slack(time_slopes[at], slopes[at])),
                };
                if !take(slack) {
                    return false;
                }
            }
        }
        true
    }
}
