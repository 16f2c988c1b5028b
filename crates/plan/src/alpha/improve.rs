//! Descent by trials: what is faster is kept.

/// First and last change of alpha that is tried, rad.
const STEPS: [f64; 6] = [0.4, 0.2, 0.1, 0.05, 0.025, 0.0125];
/// Farthest that a parabola through three trials is followed, in steps.
const FARTHEST: f64 = 2.0;

/// Changes `values`, but those that are `fixed`, as long as `cost` falls: one hat after the other, wide ones first. At
/// most about `trials` of it. Returns the cost at the end; it was `known` before.
pub(crate) fn improve(
    values: &mut Vec<f64>,
    fixed: &[bool],
    known: f64,
    trials: usize,
    mut cost: impl FnMut(&[f64]) -> f64,
) -> f64 {
    let mut best = known;
    let mut left = trials;
    for step in STEPS {
        let mut width = values.len().next_power_of_two();
        while width > 0 {
            let centres = (0..values.len()).step_by(width.div_ceil(2));
            for centre in centres {
                if left == 0 {
                    return best;
                }
                let hat = |index: usize| match fixed[index] {
                    true => 0.0,
                    false => (1.0 - index.abs_diff(centre) as f64 / width as f64).max(0.0),
                };
                if (0..values.len()).all(|index| hat(index) == 0.0) {
                    continue;
                }
                let changed = |by: f64| -> Vec<f64> {
                    let each = |(index, value): (usize, &f64)| value + by * hat(index);
                    values.iter().enumerate().map(each).collect()
                };
                let mut trial = |by: f64| {
                    left = left.saturating_sub(1);
                    (cost(&changed(by)), by)
                };
                let (up, down) = (trial(step), trial(-step));
                let mut found = if up.0 < down.0 { up } else { down };
                // The vertex of the parabola through the three costs, where it opens upwards.
                let bend = up.0 + down.0 - 2.0 * best;
                let vertex = 0.5 * step * (down.0 - up.0) / bend;
                if bend > 0.0 && vertex.abs() <= FARTHEST * step {
                    let there = trial(vertex);
                    found = if there.0 < found.0 { there } else { found };
                }
                if found.0 < best {
                    best = found.0;
                    *values = changed(found.1);
                }
            }
            width /= 2;
        }
    }
    best
}
