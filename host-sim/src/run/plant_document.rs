//! Part of a run's document that is about the plant.

use super::document::{seconds, signal};
use super::plant::Simulated;
use trirrr_figures::document::{Document, Facts, digits, quantity};
use trirrr_plant::PlantEnd;
use trirrr_plant::statistics::{Active, MotorStatistics};
use trirrr_scene::words::tick_time;

/// Adds a run of the plant to the document of the run.
pub(super) fn add_to(document: &mut Document, simulated: &Simulated) {
    let outcome = &simulated.outcome;
    let (method, statistics, tally) = (&outcome.method, &outcome.statistics, &outcome.tally);
    let took_s = outcome.elapsed.as_secs_f64();
    let (simulated_words, took) = (quantity(outcome.simulated_s, "s"), seconds(took_s));
    let ratio = digits(outcome.ratio());
    let (label, end) = match &outcome.end {
        PlantEnd::Complete => ("", String::new()),
        PlantEnd::Interrupted { t } => {
            ("  stopped", format!("at t = {} s by Ctrl-C", tick_time(*t)))
        }
        PlantEnd::Ended(ending) => ("  ended", ending.to_string()),
        PlantEnd::EnergyLost(loss) => ("  ended", loss.to_string()),
        PlantEnd::Failed(reason) => ("  failed", reason.clone()),
    };
    let how = match (method.step_s(), method.tolerance()) {
        (Some(step), _) => format!("steps of {}", quantity(step, "s")),
        (_, Some(tolerance)) => format!("tolerance {tolerance:e}"),
        _ => String::new(),
    };
    let work = format!(
        "{} steps and {} rejected, {} derivatives of {} variables, {} events",
        tally.steps, tally.rejected, tally.derivatives, outcome.dimension, tally.events
    );
    let tool = [
        signal(&statistics.tool_position).line_in(Some("m")),
        signal(&statistics.tool_angle).line_in(Some("rad")),
    ];
    let tool = tool.iter().map(|line| format!("tool: {line}"));
    let joints = (1..)
        .zip(&statistics.motors)
        .map(|(number, motor): (u32, _)| {
            let line = signal(&motor.error).line_in(Some("rad"));
            format!("joint {number}: {line}")
        });
    let reasons = outcome.reason.iter().map(ToString::to_string).chain([work]);
    document.pairs_in(
        "plant",
        Facts::new()
            .pair("simulated_s", "plant", outcome.simulated_s)
            .words(format!(
                "{simulated_words} simulated in {took}: {ratio} times faster than real time"
            ))
            .data("elapsed_s", took_s)
            .pair("reason", label, &simulated.reason)
            .words(end)
            .pair("method", "  method", method.name())
            .words(format!("{}, {how}", method.name()))
            .text("", Vec::from_iter(reasons))
            .data("steps", tally.steps)
            .data("warnings", &outcome.warnings)
            .text("  warning", outcome.warnings.clone())
            .text("  deviation", Vec::from_iter(tool.chain(joints)))
            .data("tool_position_error_m", signal(&statistics.tool_position))
            .data("tool_angle_error_rad", signal(&statistics.tool_angle)),
    );
    document.table(
        "plant.motors",
        (1..).zip(&statistics.motors).map(motor).collect(),
    );
    let balance = &outcome.balance;
    let limits = (1..).zip(&statistics.motors).flat_map(limits);
    document.pairs_in(
        "plant",
        Facts::new()
            .text("  motor", Vec::from_iter(limits))
            .text(
                "  energy",
                format!(
                    "work {} J = stored {} J + losses {} J, closed to {} of the largest",
                    digits(balance.work),
                    digits(balance.stored),
                    digits(balance.losses),
                    digits(balance.error().abs())
                ),
            )
            .data("work_j", balance.work)
            .data("stored_j", balance.stored)
            .data("losses_j", balance.losses)
            .data("balance_error_j", balance.error()),
    );
}

fn motor((number, motor): (usize, &MotorStatistics)) -> Facts {
    let active = |active: &Active| {
        Facts::new()
            .data("first_s", active.first)
            .data("total_s", active.total)
    };
    Facts::new()
        .text("", format!("  motor {number}"))
        .data("joint_error_rad", signal(&motor.error))
        .group("torque_nm", "torque", signal(&motor.torque))
        .derived("rms torque", "N m", motor.torque.rms())
        .group("current_a", "current", signal(&motor.current))
        .derived("rms current", "A", motor.current.rms())
        .group("power_w", "power", signal(&motor.power))
        .derived("rms power", "W", motor.power.rms())
        .data("current_limit", active(&motor.current_limit))
        .data("voltage_limit", active(&motor.voltage_limit))
        .data("first_slip_s", motor.first_slip)
        .data("slips", motor.slips)
        .data("lost_steps", motor.lost_steps)
}

/// Limits that a motor was at, and steps that it lost.
fn limits((number, motor): (usize, &MotorStatistics)) -> Vec<String> {
    let saturated = |what: &str, active: &Active| {
        let first = active.first?;
        let total = quantity(active.total, "s");
        Some(format!(
            "{number} saturated ({what}) from t = {first:.4} s, for {total} in all"
        ))
    };
    let slip = motor.first_slip.map(|first| {
        let side = if motor.lost_steps < 0 { "ahead of" } else { "behind" };
        format!(
            "{number} lost steps: {} slips of four full steps, the first at t = {first:.4} s; at the end {} full steps {side} its command",
            motor.slips,
            motor.lost_steps.abs()
        )
    });
    let current = saturated("current", &motor.current_limit);
    let voltage = saturated("voltage", &motor.voltage_limit);
    current.into_iter().chain(voltage).chain(slip).collect()
}
