//! Machine and job of the figures of a run: what has a curve, its limits, and the ends of the moves.

use trirrr_figures::panel::LimitLine;
use trirrr_figures::style::{CURVES, LIMIT};
use trirrr_linkage::redundant::scene::{RedundantLimits, RedundantScene, columns};
use trirrr_scene::Scene;
use trirrr_scene::record::tick_columns;

/// Machine and job, as table and figures take them.
#[derive(Clone, Debug, Default)]
pub struct DrawnJob {
    /// Columns of the table.
    pub(crate) columns: Vec<String>,
    /// The scene computes torques.
    pub(crate) torque: bool,
    pub(super) legs: usize,
    /// The machine is no 3-RRR: its records have forces in the joints, too.
    pub(super) is_redundant: bool,
    /// Legs with a slider, from 0.
    pub(super) sliders: Vec<usize>,
    /// Both ends of each guide of a base joint, m.
    pub(super) guides: Vec<[[f64; 2]; 2]>,
    pub(super) limits: RedundantLimits,
    /// Ends of the moves, s; empty where the clock is not that of the path.
    pub(super) ends_s: Vec<f64>,
}

/// Ends of moves of so many ticks, s.
fn ends(ticks: impl Iterator<Item = u32>, period_s: f64) -> Vec<f64> {
    let mut end = 0;
    let mut next = |ticks: u32| {
        end += ticks;
        f64::from(end) * period_s
    };
    ticks.map(&mut next).collect()
}

impl DrawnJob {
    /// Job of a 3-RRR.
    pub fn of(scene: &Scene) -> Self {
        let limits = &scene.limits;
        let each = |limit: Option<[f64; 3]>| limit.map(Vec::from);
        let moves = scene.job.moves.iter().map(|each| each.duration_ticks);
        Self {
            columns: tick_columns(scene.torque).map(str::to_owned).collect(),
            torque: scene.torque,
            legs: 3,
            limits: RedundantLimits {
                rate_rad_s: each(limits.rate_rad_s),
                acceleration_rad_s2: each(limits.acceleration_rad_s2),
                torque_nm: each(limits.torque_nm),
                power_w: each(limits.power_w),
                serial_distance_min: limits.serial_distance_min,
                parallel_distance_min: limits.parallel_distance_min,
            },
            ends_s: ends(moves, scene.period_s()),
            ..Self::default()
        }
    }

    /// Job of a redundant machine.
    pub fn of_redundant(scene: &RedundantScene) -> Self {
        let legs = || scene.legs.iter().zip(&scene.sliders);
        let guides = legs().filter_map(|(leg, slider)| {
            let slider = (*slider)?;
            let (sin, cos) = slider.direction_rad.sin_cos();
            let at = |position: f64| [leg.base_m.x + cos * position, leg.base_m.y + sin * position];
            Some([at(slider.travel.low_m), at(slider.travel.high_m)])
        });
        let moves = scene.job.moves.iter().map(|each| each.duration_ticks);
        Self {
            columns: columns(scene),
            torque: true,
            legs: scene.legs.len(),
            is_redundant: true,
            sliders: scene.slider_legs(),
            guides: guides.collect(),
            limits: scene.limits.clone(),
            ends_s: ends(moves, scene.period_s()),
        }
    }

    /// Leaves the moves out, for times that a hold may shift.
    #[must_use]
    pub fn without_moves(mut self) -> Self {
        self.ends_s.clear();
        self
    }
}

/// Lines at a limit of either sign: one pair for all motors where they have the same, otherwise one for each.
pub(super) fn of_motors(limit: Option<&Vec<f64>>) -> Vec<LimitLine> {
    limit_lines(limit.map_or(&[], |each| each), true)
}

/// Lines at the limits of the motors, or at that of all where they have the same; `of_either_sign` at the negative values, too.
pub(crate) fn limit_lines(limits: &[f64], of_either_sign: bool) -> Vec<LimitLine> {
    let sign = if of_either_sign { "\u{b1}" } else { "" };
    let line = |label: String, value: f64, colour| LimitLine {
        label,
        values: match of_either_sign {
            true => vec![value, -value],
            false => vec![value],
        },
        colour,
    };
    match limits {
        [] => Vec::new(),
        [one, others @ ..] if others.iter().all(|each| each == one) => {
            vec![line(format!("limit {sign}{one}"), *one, LIMIT)]
        }
        each => (1..)
            .zip(each.iter().zip(CURVES))
            .map(|(motor, (limit, colour)): (u32, _)| {
                line(format!("limit {motor} {sign}{limit}"), *limit, colour)
            })
            .collect(),
    }
}

/// Line at the least distance that is allowed.
pub(super) fn least(limit: f64) -> Vec<LimitLine> {
    vec![LimitLine {
        label: format!("least {limit}"),
        values: vec![limit],
        colour: LIMIT,
    }]
}
