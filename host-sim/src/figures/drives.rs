//! Figure of the drives: how far the platform is off by what they measure, and what pushes it.

use trirrr_client::drive_records::DriveRecord;
use trirrr_figures::chart::{Chart, Figure, Gathering, Series};
use trirrr_figures::style::{ANGLE, PATH, X, Y};

/// Gathers the figure from about `rows` samples, of a scene with or without `torque`.
pub(crate) fn drive_figure(rows: u64, torque: bool) -> Gathering<DriveRecord> {
    // The platform of a sample without a pose is not drawn off its path.
    let off = Series::new("measured", |record: &DriveRecord| {
        record.off.map_or(0.0, |[off, _]| off)
    });
    let wrench = |label, axis: usize, colour| {
        Series::new(label, move |record: &DriveRecord| record.wrench[axis]).coloured(colour)
    };
    let mut charts = vec![Chart::new("D off its path", "m", [off.coloured(PATH)])];
    if torque {
        let force = [wrench("x", 0, X), wrench("y", 1, Y)];
        charts.push(Chart::new("estimated force", "N", force));
        let moment = [wrench("about D", 2, ANGLE)];
        charts.push(Chart::new("estimated moment", "N m", moment));
    }
    let charts = charts.into_iter().map(Chart::with_zero);
    let figure = Figure::new("drives.svg", "what the drives measure", charts);
    Gathering::new(rows, vec![figure])
}
