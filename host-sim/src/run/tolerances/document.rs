//! Bounds of a run in its document.

use super::Bounded;
use trirrr_figures::document::{Document, Facts, digits, quantity};
use trirrr_tolerances::{Margin, Parameter, TimeSpan};

/// Parameters of the budget that text shows; the file has all.
const SHOWN: usize = 8;
/// Of each torque.
const SHOWN_OF_TORQUE: usize = 3;

impl Bounded<'_> {
    /// Adds the effects of the tolerances.
    pub(in crate::run) fn add_to(&self, document: &mut Document) {
        let spans = self.spans;
        let scope = match self.is_stopped {
            true => "stopped by Ctrl-C after",
            false => "whole job in",
        };
        let text =
            format!("{scope} {spans} intervals of time; bounds hold for every machine within them");
        let [distance, angle] = [self.worst.distance, self.worst.angle];
        let distance_m = distance.map(|(_, tool)| tool.distance_m());
        let angle_rad = angle.map(|(_, tool)| tool.sizes()[2]);
        let deviation = |unit, value: Option<f64>, of: Option<TimeSpan>| {
            Some(format!(
                "tool: at most {} {}",
                quantity(value?, unit),
                at(&of?)
            ))
        };
        let [first, second] = [
            deviation("m", distance_m, distance.map(|(span, _)| span)),
            deviation("rad", angle_rad, angle.map(|(span, _)| span)),
        ];
        let unbounded = |span: &Option<TimeSpan>, what: &str, why: &str| {
            let span = span.as_ref()?;
            Some(format!(
                "no bound of the {what} is proven {}: {why}",
                at(span)
            ))
        };
        let error = unbounded(
            &self.worst.not_bounded,
            "error",
            "for these tolerances a parallel singularity may be too near",
        );
        let torque = unbounded(
            &self.worst.torque_not_bounded,
            "torques",
            "a singularity may be too near",
        );
        let record = Facts::new()
            .pair("intervals", "tolerances", spans)
            .words(text)
            .text("  within", self.half_widths())
            .text("  unbounded", error)
            .text(
                "  deviation",
                Vec::from_iter(first.into_iter().chain(second)),
            )
            .data("deviation_m", distance_m)
            .data("deviation_rad", angle_rad);
        let record = self.budget(record).text("  unbounded", torque);
        let record = (0..3).fold(record, |record, motor| {
            record.text(format!("  motor {}", motor + 1), self.motor(motor))
        });
        let motors = (0..3).map(|motor| {
            let [rate, torque] =
                [&self.worst.rates, &self.worst.torques].map(|all| all[motor].as_ref().map(margin));
            Facts::new()
                .data("rate_rad_s", rate)
                .data("torque_nm", torque)
        });
        document.pairs_in("tolerances", record.rows("motors", motors));
    }

    /// One line for each kind of parameter: one value for all legs, or three.
    fn half_widths(&self) -> Vec<String> {
        let mut kinds: Vec<(String, &str, Vec<f64>)> = Vec::new();
        for parameter in Parameter::all() {
            let half_width = self.analysis.half_width(parameter);
            let name = match parameter.leg() {
                Some(_) => parameter.name().into(),
                None => parameter.to_string(),
            };
            match kinds.iter_mut().find(|kind| kind.0 == name) {
                Some(kind) => kind.2.push(half_width),
                None => kinds.push((name, parameter.unit(), vec![half_width])),
            }
        }
        let line = |(name, unit, mut values): (String, &str, Vec<f64>)| {
            if values.iter().all(|value| *value == values[0]) {
                values.truncate(1);
            }
            let words: Vec<String> = values.iter().copied().map(digits).collect();
            (values != [0.0]).then(|| format!("{name:<25} +- {} {unit}", words.join(", ")))
        };
        kinds.into_iter().filter_map(line).collect()
    }

    fn budget(&self, record: Facts) -> Facts {
        let shares = match &self.worst.distance {
            Some((_, tool)) => self.analysis.budget(tool),
            None => Vec::new(),
        };
        let um = |value: f64| format!("{:>8} um", digits(1e6 * value));
        let (first, rest) = shares.split_at(shares.len().min(SHOWN));
        let first = first.iter().map(|share| {
            let (half_width, unit) = (digits(share.half_width), share.parameter.unit());
            format!(
                "{}  {} + {half_width} {unit}",
                um(share.along_m),
                share.parameter
            )
        });
        let others = (!rest.is_empty()).then(|| {
            let sum = rest.iter().map(|share| share.along_m.abs()).sum();
            format!("{}  {} others, sum of the sizes", um(sum), rest.len())
        });
        let rows = shares.iter().map(|share| {
            Facts::new()
                .data("parameter", share.parameter.to_string())
                .data("unit", share.parameter.unit())
                .data("half_width", share.half_width)
                .data("along_m", share.along_m)
        });
        record
            .text("  budget", Vec::from_iter(first.chain(others)))
            .rows("budget", rows)
    }

    fn motor(&self, motor: usize) -> Vec<String> {
        let text = |worst: &Margin, what: &str, unit: &str| {
            let margin = match (worst.margin(), worst.limit) {
                (Some(margin), Some(limit)) => {
                    let percent = 100.0 * margin / limit;
                    format!(", margin {} {unit} ({percent:.1} %)", digits(margin))
                }
                _ => String::new(),
            };
            format!(
                "{what} at most {} {unit}{margin}, {}",
                digits(worst.size),
                at_time(&worst.span)
            )
        };
        let rate = self.worst.rates[motor].as_ref();
        let torque = self.worst.torques[motor].as_ref();
        let shares = torque.map(|worst| {
            let shares = self.analysis.torque_budget(&worst.span, motor);
            let first = shares.iter().take(SHOWN_OF_TORQUE);
            first
                .map(|(parameter, share)| format!("{} N m {parameter}", digits(*share)))
                .collect::<Vec<_>>()
        });
        let shares = shares.filter(|shares| !shares.is_empty());
        let lines = [
            rate.map(|worst| text(worst, "rate", "rad/s")),
            torque.map(|worst| text(worst, "torque", "N m")),
            shares.map(|shares| format!("most of its band by {}", shares.join(", "))),
        ];
        lines.into_iter().flatten().collect()
    }
}

fn margin(worst: &Margin) -> Facts {
    Facts::new()
        .data("size", worst.size)
        .data("limit", worst.limit)
        .data("margin", worst.margin())
        .data("t_s", middle_s(&worst.span))
}

fn middle_s(span: &TimeSpan) -> f64 {
    (span.start_s + span.end_s) / 2.0
}

fn at_time(span: &TimeSpan) -> String {
    format!("at t = {} s", digits(middle_s(span)))
}

/// The middle of an interval: time, pose, move.
fn at(span: &TimeSpan) -> String {
    let (place, alpha) = (span.pose.position, span.pose.angle);
    format!(
        "{} in move {}: x = {} m, y = {} m, alpha = {} rad",
        at_time(span),
        span.job_move + 1,
        digits(place.x),
        digits(place.y),
        digits(alpha)
    )
}
