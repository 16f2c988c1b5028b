//! Charts against time, of as many curves as a machine has legs and sliders.

use crate::failure::CliError;
use crate::figures::traces::Trace;
use crate::results::ResultFolder;
use std::path::PathBuf;
use trirrr_figures::panel::{Curve, Panel, draw};
use trirrr_linkage::redundant::scene::{RedundantLegRecord, RedundantRecord, SliderRecord};

/// Label of a curve, and its value in a record.
pub(super) type Labelled<R> = (String, Box<dyn Fn(&R) -> f64>);

/// The same of a function that needs to know nothing else.
type PlainCurve<R> = (&'static str, fn(&R) -> f64);

/// One curve: its label, its value in a record, and its points so far.
pub(super) struct Gathered<R> {
    pub(super) label: String,
    pub(super) value: Box<dyn Fn(&R) -> f64>,
    pub(super) unwrap: bool,
    pub(super) trace: Trace,
}

/// One panel of a figure.
pub(super) struct Chart<R> {
    pub(super) quantity: &'static str,
    pub(super) unit: &'static str,
    pub(super) from_zero: bool,
    pub(super) curves: Vec<Gathered<R>>,
}

/// One figure against time.
pub(super) struct Figure<R> {
    pub(super) file: &'static str,
    pub(super) title: &'static str,
    pub(super) charts: Vec<Chart<R>>,
}

/// Charts over a job of about `ticks` records.
pub(super) struct Charts {
    pub(super) ticks: u64,
}

impl Charts {
    pub(super) fn of<R>(
        &self,
        quantity: &'static str,
        unit: &'static str,
        curves: impl IntoIterator<Item = Labelled<R>>,
    ) -> Chart<R> {
        let gathered = |(label, value)| Gathered {
            label,
            value,
            unwrap: false,
            trace: Trace::new(self.ticks),
        };
        Chart {
            quantity,
            unit,
            from_zero: unit.is_empty(),
            curves: curves.into_iter().map(gathered).collect(),
        }
    }

    pub(super) fn of_legs(
        &self,
        quantity: &'static str,
        unit: &'static str,
        legs: usize,
        value: fn(&RedundantLegRecord) -> f64,
    ) -> Chart<RedundantRecord> {
        let curve = |leg: usize| -> Labelled<RedundantRecord> {
            let value = move |record: &RedundantRecord| value(&record.legs[leg]);
            (format!("leg {}", leg + 1), Box::new(value))
        };
        self.of(quantity, unit, (0..legs).map(curve))
    }

    pub(super) fn of_sliders(
        &self,
        quantity: &'static str,
        unit: &'static str,
        sliders: &[usize],
        value: fn(&SliderRecord) -> f64,
    ) -> Chart<RedundantRecord> {
        let curve = |&leg: &usize| -> Labelled<RedundantRecord> {
            let value =
                move |record: &RedundantRecord| record.legs[leg].slider.as_ref().map_or(0.0, value);
            (format!("slider {}", leg + 1), Box::new(value))
        };
        self.of(quantity, unit, sliders.iter().map(curve))
    }
}

pub(super) fn named<R, const COUNT: usize>(curves: [PlainCurve<R>; COUNT]) -> [Labelled<R>; COUNT]
where
    R: 'static,
{
    curves.map(|(label, value)| (label.to_owned(), Box::new(value) as Box<dyn Fn(&R) -> f64>))
}

impl<R> Figure<R> {
    pub(super) fn push(&mut self, t: f64, record: &R) {
        let charts = self.charts.iter_mut();
        for curve in charts.flat_map(|chart| &mut chart.curves) {
            curve.trace.push(t, (curve.value)(record), curve.unwrap);
        }
    }

    pub(super) fn write(
        self,
        results: &mut ResultFolder,
        heading: &str,
    ) -> Result<PathBuf, CliError> {
        let curve = |it: Gathered<R>| Curve {
            label: it.label.into(),
            points: it.trace.finish(),
            ..Curve::default()
        };
        let panel = |it: Chart<R>| Panel {
            quantity: it.quantity,
            unit: it.unit,
            from_zero: it.from_zero,
            curves: it.curves.into_iter().map(curve).collect(),
            ..Panel::default()
        };
        let panels: Vec<Panel> = self.charts.into_iter().map(panel).collect();
        let drawn = draw(&format!("{heading}: {}", self.title), &panels);
        results.figure(self.file, drawn)
    }
}
