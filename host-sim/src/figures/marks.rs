//! Marks of a job in figures against time: its limits, and the ends of its moves.

use trirrr_core::limits::LimitParameters;
use trirrr_figures::panel::LimitLine;
use trirrr_figures::style::{LIMIT, MOTORS};
use trirrr_scene::Scene;

/// Limits and ends of moves of a job.
#[derive(Clone, Debug)]
pub struct JobMarks {
    /// Limits of the scene.
    pub(super) limits: LimitParameters,
    /// Ends of the moves, s; empty where the clock is not that of the path.
    pub(super) ends_s: Vec<f64>,
}

impl JobMarks {
    /// Marks of the job of `scene`.
    pub fn of(scene: &Scene) -> Self {
        let mut ticks = 0;
        let ends = scene.job.moves.iter().map(|each| {
            ticks += each.duration_ticks;
            f64::from(ticks) * scene.period_s()
        });
        Self {
            limits: scene.limits,
            ends_s: ends.collect(),
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
pub(super) fn of_motors(limit: Option<[f64; 3]>) -> Vec<LimitLine> {
    let line = |label: String, value: f64, colour| LimitLine {
        label,
        values: vec![value, -value],
        colour,
    };
    match limit {
        None => Vec::new(),
        Some([one, two, three]) if one == two && two == three => {
            vec![line(format!("limit \u{b1}{one}"), one, LIMIT)]
        }
        Some(each) => (0..3)
            .map(|motor| {
                let text = format!("limit {} \u{b1}{}", motor + 1, each[motor]);
                line(text, each[motor], MOTORS[motor])
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
