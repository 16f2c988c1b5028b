//! Figures of a job that is refused: when and where it breaks limits, as far as the machine can follow it.

use super::catalogue::{PanelSource, figures};
use super::machine::{self, DrawnInstant, Scenery};
use super::marks::JobMarks;
use std::path::{Path, PathBuf};
use trirrr_core::units::Units;
use trirrr_figures::canvas::Drawn;
use trirrr_figures::decimate::Decimator;
use trirrr_figures::panel::{Curve, LimitLine, Panel, draw};
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
        let limited = figures(self.scene.torque)
            .flat_map(|figure| figure.panels)
            .map(|source| (source, (source.limits)(&self.scene.limits)))
            .filter(|(_, limits)| !limits.is_empty());
        let panels: Vec<Panel> = limited
            .map(|(source, limits)| self.panel(source, limits))
            .collect();
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

    fn panel(&self, source: &PanelSource, limits: Vec<LimitLine>) -> Panel {
        let curves = source.curves.iter().map(|curve| {
            let mut points = Decimator::new(self.records.len() as u64);
            for record in &self.records {
                points.push(record.t, [(curve.value)(record)]);
            }
            let points = points.finish().into_iter();
            Curve {
                label: curve.label.into(),
                points: points.map(|(t, [value])| (t, value)).collect(),
                colour: Some(curve.colour),
                dashed: false,
            }
        });
        let mut breaches: Vec<(f64, f64)> = Vec::new();
        let mut was = false;
        for record in &self.records {
            let values = source.curves.iter().map(|curve| (curve.value)(record));
            let is = values
                .enumerate()
                .any(|(motor, value)| breaks(source, &limits, motor, value));
            match breaches.last_mut().filter(|_| is && was) {
                Some(last) => last.1 = record.t,
                None if is => breaches.push((record.t, record.t)),
                None => {}
            }
            was = is;
        }
        if let Some((t, _)) = self.end {
            breaches.push((t, t));
        }
        Panel {
            quantity: source.quantity,
            unit: source.unit,
            from_zero: source.from_zero,
            curves: curves.collect(),
            limits,
            breaches,
            marks: JobMarks::of(self.scene).ends_s,
        }
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
        let place = |record: &Record| (record.pose[0], record.pose[1]);
        let stretches = self
            .records
            .chunk_by(|one, other| is_broken(one) == is_broken(other));
        let broken = stretches.filter(|stretch| is_broken(&stretch[0]));
        let mut broken: Vec<Vec<(f64, f64)>> = broken
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
        let mut instants: Vec<DrawnInstant> = instants.map(DrawnInstant::from).collect();
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
fn breaks(source: &PanelSource, limits: &[LimitLine], motor: usize, value: f64) -> bool {
    // One line for all curves, or one for each.
    let limit = limits.get(motor).or_else(|| limits.first());
    let limit = limit.and_then(|line| line.values.first());
    limit.is_some_and(|limit| match source.from_zero {
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
        let limits = |panel: &PanelSource| (panel.limits)(&scene.limits);
        let panels = figures(true).flat_map(|figure| figure.panels);
        let torque = panels.into_iter().find(|panel| panel.quantity == "torque");
        let torque = torque.unwrap();
        let panel = job.panel(torque, limits(torque));
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
