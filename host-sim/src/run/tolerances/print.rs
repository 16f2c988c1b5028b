//! The bounds of a run, for a reader.

use super::Bounded;
use crate::run::summary::line;
use crate::terminal::digits;
use std::io::{self, Write};
use trirrr_tolerances::{Margin, Parameter, TimeSpan};

/// Parameters of the budget that are printed; the file has all.
const PRINTED: usize = 8;
/// Of each torque.
const PRINTED_OF_TORQUE: usize = 3;

impl Bounded<'_> {
    /// Prints what the tolerances do.
    pub(in crate::run) fn print(&self, out: &mut dyn Write) -> io::Result<()> {
        writeln!(out)?;
        let spans = self.spans;
        let scope = match self.is_stopped {
            true => "stopped by Ctrl-C after",
            false => "whole job in",
        };
        let text =
            format!("{scope} {spans} intervals of time; bounds hold for every machine within them");
        line(out, "tolerances", &text)?;
        self.half_widths(out)?;
        self.errors(out)?;
        self.budget(out)?;
        self.motors(out)?;
        writeln!(out)?;
        for (i, file) in self.files.iter().enumerate() {
            let label = if i == 0 { "written" } else { "" };
            line(out, label, &file.display().to_string())?;
        }
        out.flush()
    }

    /// One line for each kind of parameter: one value for all legs, or three.
    fn half_widths(&self, out: &mut dyn Write) -> io::Result<()> {
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
        let mut label = "  within";
        for (name, unit, values) in kinds {
            let values = match values.as_slice() {
                [all @ .., last] if all.iter().all(|value| value == last) => vec![*last],
                _ => values,
            };
            if values == [0.0] {
                continue;
            }
            let values: Vec<String> = values.into_iter().map(digits).collect();
            let text = format!("{name:<25} +- {} {unit}", values.join(", "));
            line(out, label, &text)?;
            label = "";
        }
        Ok(())
    }

    fn errors(&self, out: &mut dyn Write) -> io::Result<()> {
        if let Some(span) = &self.worst.not_bounded {
            let text = format!(
                "no bound of the error is proven {}: for these tolerances a parallel singularity may be too near",
                at(span)
            );
            line(out, "  unbounded", &text)?;
        }
        if let Some((span, tool)) = &self.worst.distance {
            let text = format!(
                "tool: at most {} um {}",
                digits(1e6 * tool.distance_m()),
                at(span)
            );
            line(out, "  deviation", &text)?;
        }
        if let Some((span, tool)) = &self.worst.angle {
            let [_, _, dalpha] = tool.sizes();
            line(
                out,
                "",
                &format!("tool: at most {} mrad {}", digits(1e3 * dalpha), at(span)),
            )?;
        }
        Ok(())
    }

    fn budget(&self, out: &mut dyn Write) -> io::Result<()> {
        let Some((_, tool)) = &self.worst.distance else {
            return Ok(());
        };
        let shares = self.analysis.budget(tool);
        let um = |value: f64| format!("{:>8} um", digits(1e6 * value));
        let (first, rest) = shares.split_at(shares.len().min(PRINTED));
        for (i, share) in first.iter().enumerate() {
            let label = if i == 0 { "  budget" } else { "" };
            let (half_width, unit) = (digits(share.half_width), share.parameter.unit());
            let text = format!(
                "{}  {} + {half_width} {unit}",
                um(share.along_m),
                share.parameter
            );
            line(out, label, &text)?;
        }
        if !rest.is_empty() {
            let sum = rest.iter().map(|share| share.along_m.abs()).sum();
            line(
                out,
                "",
                &format!("{}  {} others, sum of the sizes", um(sum), rest.len()),
            )?;
        }
        Ok(())
    }

    fn motors(&self, out: &mut dyn Write) -> io::Result<()> {
        if let Some(span) = &self.worst.torque_not_bounded {
            let text = format!(
                "no bound of the torques is proven {}: a singularity may be too near",
                at(span)
            );
            line(out, "  unbounded", &text)?;
        }
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
        for motor in 0..3 {
            let rate = self.worst.rates[motor].as_ref();
            let torque = self.worst.torques[motor].as_ref();
            let rate = rate.map(|worst| text(worst, "rate", "rad/s"));
            let torque = torque.map(|worst| text(worst, "torque", "N m"));
            let shares = self.torque_shares(motor);
            for (i, text) in rate.iter().chain(&torque).chain(&shares).enumerate() {
                let label = format!("  motor {}", motor + 1);
                line(out, if i == 0 { &label } else { "" }, text)?;
            }
        }
        Ok(())
    }

    /// The greatest shares in the greatest torque of a motor.
    fn torque_shares(&self, motor: usize) -> Option<String> {
        let worst = self.worst.torques[motor].as_ref()?;
        let shares = self.analysis.torque_budget(&worst.span, motor);
        let first = shares.iter().take(PRINTED_OF_TORQUE);
        let texts: Vec<String> = first
            .map(|(parameter, share)| format!("{} N m {parameter}", digits(*share)))
            .collect();
        (!texts.is_empty()).then(|| format!("most of its band by {}", texts.join(", ")))
    }
}

fn at_time(span: &TimeSpan) -> String {
    format!("at t = {} s", digits((span.start_s + span.end_s) / 2.0))
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
