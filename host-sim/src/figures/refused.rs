//! Figures of a job that is refused: when and where it breaks limits, as far as the machine can follow it.

use super::job::DrawnJob;
use super::machine::{self, DrawnInstant, Scenery};
use crate::tick_record::AnyTick;
use std::path::{Path, PathBuf};
use trirrr_core::units::Units;
use trirrr_figures::canvas::Drawn;
use trirrr_figures::chart::{Chart, Figure, Gathering};
use trirrr_figures::panel::{Panel, draw};
use trirrr_scene::record::Record;
use trirrr_scene::{JobPlayer, Scene, pipeline};

/// Records of a job without limits.
pub(crate) struct RefusedJob<'a> {
    scene: &'a Scene,
    records: Vec<Record>,
    /// Time, s, and status that ends the motion.
    end: Option<(f64, String)>,
}

/// Most records that are kept: breaches that are shorter are seen as long as one.
const RECORDS: u32 = 20_000;

impl<'a> RefusedJob<'a> {
    /// Computes the job of `scene` in binary64, whatever its limits are, until the machine cannot follow. None where the machine is refused
    /// or has no moves.
    pub(crate) fn of(scene: &'a Scene) -> Option<Self> {
        if scene.job.moves.is_empty() {
            return None;
        }
        let machine = pipeline::of_scene::<f64>(scene, Units::SI).ok()?;
        let player = JobPlayer::<f64>::new(&scene.job, scene.period_s());
        let step = player.ticks() / RECORDS + 1;
        let mut job = Self {
            scene,
            records: Vec::new(),
            end: None,
        };
        let ticks = (0..player.ticks()).step_by(step as usize);
        for tick in ticks.chain([player.ticks()]) {
            let t = f64::from(tick) * scene.period_s();
            match machine.evaluate(t, &player.at(tick)) {
                Ok(record) => job.records.push(record),
                Err(status) => {
                    job.end = Some((t, status.to_string()));
                    break;
                }
            }
        }
        Some(job)
    }

    /// Draws the curves with the breaches for `file`, and the machine at the first of them for a file beside it.
    pub(crate) fn draw(&self, file: &Path) -> [(PathBuf, Drawn); 2] {
        let name = &self.scene.name;
        let figures = DrawnJob::of(self.scene).figures().into_iter();
        let charts = figures.flat_map(|figure| figure.charts);
        let panels = self.panels(charts.filter(|chart| !chart.limits.is_empty()).collect());
        let is_broken = panels.iter().any(|panel| !panel.breaches.is_empty());
        let title = match &self.end {
            Some((t, status)) => format!("{name}, refused: {status} at t = {t} s"),
            None if is_broken => format!("{name}, refused: where it breaks limits"),
            None => format!("{name}: what its limits are for"),
        };
        let curves = draw(&title, &panels);
        let beside = file.with_file_name(format!(
            "{}-machine.svg",
            file.file_stem().unwrap_or_default().to_string_lossy()
        ));
        let scenery = self.scenery(&panels);
        let title = match is_broken {
            true => format!("{name}, refused: the machine at its first breach"),
            false => format!("{name}: the machine and its path"),
        };
        let machine = machine::draw(&title, &scenery);
        [(file.to_owned(), curves), (beside, machine)]
    }

    /// Panels of `charts`, with the breaches of their limits.
    fn panels(&self, charts: Vec<Chart<AnyTick>>) -> Vec<Panel> {
        let breaches: Vec<_> = charts.iter().map(|chart| self.breaches(chart)).collect();
        let rows = self.records.iter();
        let rows = rows.map(|record| (record.t, record as &AnyTick));
        let mut gathering = Gathering::new(rows.len() as u64, vec![Figure::new("", "", charts)]);
        rows.for_each(|(t, record)| gathering.push(t, record));
        let figures = gathering.finish(&DrawnJob::of(self.scene).ends_s);
        let panels = figures.into_iter().flat_map(|figure| figure.panels);
        let marked = panels
            .zip(breaches)
            .map(|(panel, breaches)| Panel { breaches, ..panel });
        marked.collect()
    }

    /// Times in which a curve of `chart` is beyond its limit, from and to.
    fn breaches(&self, chart: &Chart<AnyTick>) -> Vec<(f64, f64)> {
        let mut breaches: Vec<(f64, f64)> = Vec::new();
        let mut was = false;
        for record in &self.records {
            let mut values = chart
                .series
                .iter()
                .map(|series| series.value(record))
                .enumerate();
            let is = values.any(|(motor, value)| breaks(chart, motor, value));
            match breaches.last_mut().filter(|_| is && was) {
                Some(last) => last.1 = record.t,
                None if is => breaches.push((record.t, record.t)),
                None => {}
            }
            was = is;
        }
        breaches.extend(self.end.iter().map(|(t, _)| (*t, *t)));
        breaches
    }

    fn scenery(&self, panels: &[Panel]) -> Scenery {
        let breaches: Vec<(f64, f64)> = panels
            .iter()
            .flat_map(|panel| panel.breaches.iter().copied())
            .collect();
        let is_broken = |record: &Record| {
            breaches
                .iter()
                .any(|(from, to)| (*from..=*to).contains(&record.t))
        };
        let place = |record: &Record| [record.pose[0], record.pose[1]];
        let stretches = self
            .records
            .chunk_by(|one, other| is_broken(one) == is_broken(other));
        let broken = stretches.filter(|stretch| is_broken(&stretch[0]));
        let mut broken: Vec<Vec<[f64; 2]>> = broken
            .map(|stretch| stretch.iter().map(place).collect())
            .collect();
        // Where the machine cannot follow, the last place is where it stops.
        if self.end.is_some() {
            broken.extend(self.records.last().map(|record| vec![place(record)]));
        }
        let first = self.records.iter().find(|record| is_broken(record));
        let last = self.records.last().filter(|_| first.is_none());
        let start = self.records.first();
        let instants = start.into_iter().chain(first).chain(last);
        let instant = |record: &Record| DrawnInstant::from(record as &AnyTick);
        let mut instants: Vec<DrawnInstant> = instants.map(instant).collect();
        instants.dedup();
        Scenery {
            instants,
            guides: Vec::new(),
            path: self.records.iter().map(place).collect(),
            broken,
        }
    }
}

/// Returns `true` if `value` of the curve `motor` is beyond its limit: the largest size, or the least distance.
fn breaks(chart: &Chart<AnyTick>, motor: usize, value: f64) -> bool {
    // One line for all curves, or one for each.
    let limit = chart.limits.get(motor).or_else(|| chart.limits.first());
    let limit = limit.and_then(|line| line.values.first());
    limit.is_some_and(|limit| match chart.from_zero {
        true => value < *limit,
        false => value.abs() > *limit,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_breach_is_marked_from_its_start_to_its_end() {
        let text = include_str!("../../../scenes/vertical.toml");
        let mut scene = Scene::parse(text, "vertical.toml").unwrap();
        scene.limits.torque_nm = Some([9.0, 9.0, 2.45]);
        let job = RefusedJob::of(&scene).unwrap();
        let figures = DrawnJob::of(&scene).figures().into_iter();
        let mut charts = figures.flat_map(|figure| figure.charts);
        let torque = charts.find(|chart| chart.quantity == "torque").unwrap();
        let panel = job.panels(vec![torque]).remove(0);
        assert!(!panel.breaches.is_empty());
        for (t, value) in &panel.curves[2].points {
            let is_marked = panel
                .breaches
                .iter()
                .any(|(from, to)| (*from..=*to).contains(t));
            assert_eq!(is_marked, value.abs() > 2.45, "{t}");
        }
        let scenery = job.scenery(&[panel]);
        assert!(!scenery.broken.is_empty());
        assert_eq!(scenery.instants.len(), 2);
    }
}
