//! Figure of a plan: speed along the path beside the bound of any motion's speed; alpha where it was chosen.

use crate::plan::PlanPoint;
use trirrr_figures::chart::{Chart, Figure, Series};
use trirrr_figures::style::{ANGLE, LIMIT, PATH};

/// Figure of a plan; `with_alpha` draws alpha, too.
pub(crate) fn plan_figure(with_alpha: bool) -> Figure<PlanPoint> {
    let bound = Series::new("bound of any motion", |point: &PlanPoint| point.speed_max);
    let speed = Series::new("plan", |point: &PlanPoint| point.speed);
    let speeds = [bound.coloured(LIMIT).dashed(), speed.coloured(PATH)];
    let mut charts = vec![Chart::new("speed of D", "m/s", speeds).with_zero()];
    if with_alpha {
        let alpha = Series::new("\u{3b1}, chosen", |point: &PlanPoint| point.pose[2]);
        charts.push(Chart::new("orientation", "rad", [alpha.coloured(ANGLE)]));
    }
    Figure::new("plan.svg", "the plan and its bound", charts)
}
