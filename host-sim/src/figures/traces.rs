//! Curves of the figures, gathered tick by tick in bounded memory.

use super::animation::Animation;
use super::catalogue::{CurveSource, figures, sources};
use super::machine::{DrawnInstant, Scenery};
use super::marks::JobMarks;
use trirrr_figures::decimate::Decimator;
use trirrr_figures::panel::{Curve, Panel};
use trirrr_scene::record::Record;

/// The machine is drawn at its start, its end and each of these fractions of the job.
const INSTANTS: [(u64, u64); 3] = [(1, 4), (1, 2), (3, 4)];

/// A curve while it is gathered.
pub(super) struct Trace {
    points: Decimator<1>,
    /// Last value and turns added, where the curve is an angle.
    last: Option<f64>,
    turns: f64,
}

/// Gathers the curves of all figures from the records of a run.
pub struct Traces {
    /// The scene computes torques.
    torque: bool,
    marks: JobMarks,
    traces: Vec<Trace>,
    /// x, y, speed of D, and the largest torque.
    path: Decimator<4>,
    animation: Animation,
    ticks: u64,
    seen: u64,
    instants: Vec<Record>,
    last: Option<Record>,
}

impl Traces {
    /// Gathers a job of `ticks` records of a scene with or without `torque`.
    pub fn new(ticks: u64, torque: bool, marks: JobMarks) -> Self {
        Self {
            torque,
            marks,
            animation: Animation::new(ticks, torque),
            traces: sources(torque).map(|_| Trace::new(ticks)).collect(),
            path: Decimator::new(ticks),
            ticks,
            seen: 0,
            instants: Vec::new(),
            last: None,
        }
    }

    /// Adds the record of the next tick.
    pub fn push(&mut self, record: &Record) {
        for (source, trace) in sources(self.torque).zip(&mut self.traces) {
            let value = (source.value)(record);
            trace.push(record.t, value, source.unwrap);
        }
        let [x, y, _] = record.pose;
        let [vx, vy, _] = record.velocity;
        let torques = record.legs.iter().map(|leg| leg.torque.abs());
        let values = [x, y, vx.hypot(vy), torques.fold(0.0, f64::max)];
        self.path.push(record.t, values);
        self.animation.push(record);
        let last_tick = self.ticks.saturating_sub(1);
        if is_drawn(self.seen, last_tick) {
            self.instants.push(*record);
        }
        self.seen += 1;
        self.last = Some(*record);
    }

    /// Returns the last record.
    pub fn last(&self) -> Option<&Record> {
        self.last.as_ref()
    }

    /// The figures against time: file, title and panels.
    pub(super) fn panels(&mut self) -> Vec<(&'static str, &'static str, Vec<Panel>)> {
        let mut traces = std::mem::take(&mut self.traces).into_iter();
        let curve = |(source, trace): (&CurveSource, Trace)| Curve {
            label: source.label.into(),
            colour: Some(source.colour),
            dashed: false,
            points: trace.finish(),
        };
        figures(self.torque)
            .map(|figure| {
                let panels = figure.panels.iter().map(|panel| Panel {
                    quantity: panel.quantity,
                    unit: panel.unit,
                    from_zero: panel.from_zero,
                    curves: panel
                        .curves
                        .iter()
                        .zip(traces.by_ref())
                        .map(curve)
                        .collect(),
                    limits: (panel.limits)(&self.marks.limits),
                    breaches: Vec::new(),
                    marks: self.marks.ends_s.clone(),
                });
                (figure.file, figure.title, panels.collect())
            })
            .collect()
    }

    /// Torques of the motors over time, and their powers; none of a scene without torques.
    pub(super) fn of_motors(panels: &[(&'static str, &'static str, Vec<Panel>)]) -> MotorCurves {
        let points = |file: &str| {
            let figure = panels.iter().find(|(name, ..)| *name == file);
            let curves = figure.map(|(.., panels)| &panels[0].curves);
            curves.map(|curves| [0, 1, 2].map(|motor| curves[motor].points.clone()))
        };
        MotorCurves {
            torques: points("torque.svg"),
            powers: points("power.svg"),
        }
    }

    /// The machine at its instants, the path with speed and torque, and the animation.
    pub(super) fn scenery(self) -> (Scenery, Vec<(f64, [f64; 4])>, Animation) {
        let mut instants = self.instants;
        // The end, once, whether the job came to its end or was stopped.
        if let Some(last) = self.last.filter(|last| instants.last() != Some(last)) {
            instants.push(last);
        }
        let path = self.path.finish();
        let scenery = Scenery {
            instants: instants.iter().map(DrawnInstant::from).collect(),
            guides: Vec::new(),
            path: path.iter().map(|(_, [x, y, ..])| (*x, *y)).collect(),
            broken: Vec::new(),
        };
        (scenery, path, self.animation)
    }
}

/// Returns true if the machine is drawn at `tick` of a job that ends with `last_tick`.
pub(super) fn is_drawn(tick: u64, last_tick: u64) -> bool {
    let at = |(part, whole): &(u64, u64)| {
        tick == (u128::from(last_tick) * u128::from(*part) / u128::from(*whole)) as u64
    };
    tick == 0 || INSTANTS.iter().any(at)
}

/// Points of three curves over time.
type MotorPoints = [Vec<(f64, f64)>; 3];

/// Curves of the motors as the job asks for them, beside those of a plant.
#[derive(Clone, Debug, Default)]
pub struct MotorCurves {
    /// Torques, N m.
    pub(super) torques: Option<MotorPoints>,
    /// Powers, W.
    pub(super) powers: Option<MotorPoints>,
}

impl Trace {
    /// Curve of about `ticks` points.
    pub(super) fn new(ticks: u64) -> Self {
        Self {
            points: Decimator::new(ticks),
            last: None,
            turns: 0.0,
        }
    }

    /// Points of the curve.
    pub(super) fn finish(self) -> Vec<(f64, f64)> {
        let points = self.points.finish().into_iter();
        points.map(|(t, [value])| (t, value)).collect()
    }

    /// Adds a value; with `unwrap` that of an angle.
    pub(super) fn push(&mut self, t: f64, value: f64, unwrap: bool) {
        use std::f64::consts::{PI, TAU};
        if unwrap && let Some(last) = self.last {
            if value - last > PI {
                self.turns -= TAU;
            } else if value - last < -PI {
                self.turns += TAU;
            }
        }
        self.last = Some(value);
        self.points.push(t, [value + self.turns]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn marks() -> JobMarks {
        JobMarks {
            limits: trirrr_core::limits::LimitParameters::default(),
            ends_s: Vec::new(),
        }
    }

    #[test]
    fn angles_are_drawn_without_jumps() {
        let mut traces = Traces::new(200, true, marks());
        for tick in 0..200 {
            let turning = 0.1 * f64::from(tick);
            let mut record = Record {
                t: f64::from(tick),
                ..Record::default()
            };
            record.legs[0].th1 = f64::atan2(turning.sin(), turning.cos());
            traces.push(&record);
        }
        let figures = traces.panels();
        let (_, _, panels) = figures
            .iter()
            .find(|(file, ..)| *file == "joint_angle.svg")
            .unwrap();
        let drawn = &panels[0].curves[0].points;
        assert_eq!(drawn.len(), 200);
        for (tick, (_, value)) in drawn.iter().enumerate() {
            assert!((value - 0.1 * tick as f64).abs() < 1e-9);
        }
    }

    #[test]
    fn the_machine_is_drawn_at_start_quarters_and_end() {
        let times = |ticks: u64, pushed: u64| {
            let mut traces = Traces::new(ticks, false, marks());
            for tick in 0..pushed {
                traces.push(&Record {
                    t: tick as f64,
                    ..Record::default()
                });
            }
            let (scenery, ..) = traces.scenery();
            scenery
                .instants
                .iter()
                .map(|record| record.t)
                .collect::<Vec<_>>()
        };
        assert_eq!(times(101, 101), [0.0, 25.0, 50.0, 75.0, 100.0]);
        assert_eq!(times(101, 41), [0.0, 25.0, 40.0]);
        assert_eq!(times(1, 1), [0.0]);
        assert_eq!(times(2, 2), [0.0, 1.0]);
        assert!(times(2, 0).is_empty());
    }
}
