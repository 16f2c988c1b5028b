//! Length of the path of D: bounds for any stretch of a job, from the control polygons of its moves.
//!
//! D moves along a polynomial of time, so along a Bezier curve of the fifth degree: no longer than its control polygon, and no faster
//! than that of its velocity. Both come near to the truth as a curve is divided.

use crate::job_move::JobMove;
use nalgebra::Vector2;

/// Stretches of a move whose lengths are kept.
const STRETCHES: usize = 16;

/// Rounding, in parts of a length.
const ROUNDING: f64 = 1e-12;

type Control = [Vector2<f64>; 6];

/// Way of D in one move.
pub(crate) struct MoveWay {
    ticks: f64,
    control: Control,
    /// Most length, m, and most speed, m per tick, of each stretch.
    stretches: [[f64; 2]; STRETCHES],
}

impl MoveWay {
    /// Way of a move in ticks of `period_s`.
    pub(crate) fn of(each: &JobMove, period_s: f64) -> Self {
        let ticks = f64::from(each.duration_ticks);
        let time = ticks * period_s;
        let (from, to) = (each.from.position, each.to.position);
        // To the units of the whole move.
        let [start, end] = [each.start_velocity, each.end_velocity].map(|v| v.xy() * time);
        let [first, last] = match each.accelerations {
            Some(both) => both.map(|a| a.xy() * (time * time)),
            // Those of the cubic.
            None => {
                let chord = (to - from) * 6.0;
                [
                    chord - start * 4.0 - end * 2.0,
                    start * 2.0 + end * 4.0 - chord,
                ]
            }
        };
        let control = [
            from,
            from + start / 5.0,
            from + start * 0.4 + first / 20.0,
            to - end * 0.4 + last / 20.0,
            to - end / 5.0,
            to,
        ];
        let stretch = |index: usize| {
            let [from, to] = [index, index + 1].map(|i| i as f64 / STRETCHES as f64);
            let steps = steps(&between(&control, from, to));
            let most = steps.iter().copied().fold(0.0, f64::max);
            [steps.iter().sum(), most * (5 * STRETCHES) as f64 / ticks]
        };
        Self {
            ticks,
            control,
            stretches: core::array::from_fn(stretch),
        }
    }

    /// Most length between two ticks, and most speed in m per tick.
    fn over(&self, from: f64, to: f64) -> [f64; 2] {
        let [from, to] = [from, to].map(|tick| (tick / self.ticks).clamp(0.0, 1.0));
        let (mut length, mut fastest) = (0.0, 0.0f64);
        for (index, [whole, speed]) in self.stretches.iter().enumerate() {
            let [begin, end] = [index, index + 1].map(|i| i as f64 / STRETCHES as f64);
            let [first, last] = [from.max(begin), to.min(end)];
            if first >= last {
                continue;
            }
            fastest = fastest.max(*speed);
            length += match last - first < end - begin {
                true => steps(&between(&self.control, first, last)).iter().sum(),
                false => *whole,
            };
        }
        [length, fastest]
    }
}

/// Most way of D in m from one place to another, on which it is for at most `ticks`: each is a move and a tick in it.
pub(crate) fn way_m(
    ways: &[MoveWay],
    (first, from): (usize, f64),
    (last, to): (usize, f64),
    ticks: f64,
) -> f64 {
    let (mut length, mut fastest) = (0.0, 0.0f64);
    for (index, way) in ways.iter().enumerate().take(last + 1).skip(first) {
        let from = if index == first { from } else { 0.0 };
        let to = if index == last { to } else { way.ticks };
        let [more, speed] = way.over(from, to);
        length += more;
        fastest = fastest.max(speed);
    }
    length.min(fastest * ticks) * (1.0 + ROUNDING)
}

fn distance(from: Vector2<f64>, to: Vector2<f64>) -> f64 {
    (to.x - from.x).hypot(to.y - from.y)
}

/// Sides of a control polygon.
fn steps(control: &Control) -> [f64; 5] {
    core::array::from_fn(|i| distance(control[i], control[i + 1]))
}

/// Control points between two fractions of a curve.
fn between(control: &Control, from: f64, to: f64) -> Control {
    let mut part = *control;
    // The part before `to`, then the part of that behind `from`.
    for left in 1..6 {
        for i in (left..6).rev() {
            part[i] = part[i - 1].lerp(&part[i], to);
        }
    }
    let at = if to > 0.0 { from / to } else { 0.0 };
    for right in (0..5).rev() {
        for i in 0..=right {
            part[i] = part[i].lerp(&part[i + 1], at);
        }
    }
    part
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;
    use trirrr_core::setpoint::Pose;

    /// Lengths by chords of a hundred parts of a tick are never more, and hardly less.
    #[test]
    fn a_way_is_not_shorter_than_its_chords() {
        let rest = Vector3::zeros();
        let [start, end] = [Vector3::new(0.4, -0.3, 1.0), Vector3::new(-0.2, 0.5, 0.0)];
        let both = Some([Vector3::new(2.0, 1.0, 0.0), Vector3::new(-3.0, 0.5, 1.0)]);
        for (velocities, accelerations) in [
            ([rest; 2], None),
            ([start, end], None),
            ([start, end], both),
        ] {
            let each = JobMove {
                from: Pose::from_f64(0.1, 0.2, 0.0),
                to: Pose::from_f64(0.25, 0.1, 0.3),
                start_velocity: velocities[0],
                end_velocity: velocities[1],
                accelerations,
                duration_ticks: 40,
                tool: None,
            };
            let segment = each.segment::<f64>(40, 0.01);
            let place = |hundredth: u32| {
                let part = f64::from(hundredth % 100) / 100.0;
                segment
                    .between(hundredth / 100, (part > 0.0).then_some(part))
                    .pose
                    .position
            };
            let ways = [MoveWay::of(&each, 0.01)];
            for (from, to) in [(0, 4000), (0, 700), (130, 2270), (1990, 2010), (3000, 4000)] {
                let chords: f64 = (from..to).map(|i| distance(place(i), place(i + 1))).sum();
                let [a, b] = [from, to].map(|hundredth| f64::from(hundredth) / 100.0);
                let way = way_m(&ways, (0, a), (0, b), 40.0);
                assert!(
                    way >= chords && way < 1.01 * chords,
                    "{from} {to}: {way} {chords}"
                );
                // And by the speed.
                let way = way_m(&ways, (0, a), (0, b), b - a);
                assert!(way >= chords, "{from} {to}: {way} {chords}");
            }
        }
    }
}
