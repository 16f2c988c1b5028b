//! A study as a page that opens from disk: one file, with its figures in it.

use super::study::Study;
use super::text::{MODE_HEADS, MOTOR_HEADS, area, mode_cells, motor_cells};
use super::{DesignArgs, motor_figures};
use crate::figures::escaped;
use crate::terminal::digits;
use std::fmt::Write;

/// Style of the pages.
pub(super) const STYLE: &str = "body{font:16px/1.5 sans-serif;max-width:960px;margin:2em auto;padding:0 1em;color:#222}\
table{border-collapse:collapse;font-size:14px}th,td{border:1px solid #bbb;padding:.25em .6em;text-align:right}\
td:first-child,th{text-align:left}svg{max-width:100%;height:auto}.no{text-align:left;color:#a33}.own{background:#eef7f3}";

/// The page.
pub(super) fn html(study: &Study, args: &DesignArgs, figures: &[(&'static str, String)]) -> String {
    let name = escaped(&study.scene.name);
    let mut page = format!(
        "<!doctype html>\n<html lang=\"en\"><meta charset=\"utf-8\"><title>{name}: design report</title><style>{STYLE}</style>\n<h1>{name}: design report</h1>\n<p>{}</p>\n",
        escaped(&study.scene.description)
    );
    let figure = |page: &mut String, wanted: &str| {
        for (_, svg) in figures.iter().filter(|(name, _)| *name == wanted) {
            *page += svg;
            page.push('\n');
        }
    };
    page += "<h2>The machine</h2>\n";
    figure(&mut page, "geometry");
    page += "<h2>The job in motion</h2>\n";
    page += &study.animation.player();
    page += "<h2>Working modes</h2>\n<p>Each row is the job of the scene with other elbows. A job that asks for the least time is planned in each mode. \
        The shaded row is the mode of the scene.</p>\n";
    modes(&mut page, study);
    if let Some(best) = study.best_mode() {
        let signs = best.result.elbows.map(|elbow| elbow.sign().to_string());
        let _ = writeln!(
            page,
            "<p>The least peak torque has the mode with the elbows {}.</p>",
            signs.join(", ")
        );
    }
    figure(&mut page, "modes");
    let turn = match args.turn > 0.0 {
        true => format!(
            ", and with all angles up to {} degrees to both sides of it",
            args.turn
        ),
        false => String::new(),
    };
    let _ = writeln!(
        page,
        "<h2>Workspace</h2>\n<p>With the platform at {:.3} degrees{turn}. Every pose of a coloured cell is proven to keep the conditions, and every pose of a white one to break one. \
        The legs reach {}. The machine keeps its distances to singularities in {}; {:.2} cm^2 of that are connected with the start. \
        {:.3} % of the map are undecided.</p>",
        study.alpha_rad.to_degrees(),
        area(study.reach.area_m2()),
        area(study.work.map.area_m2()),
        1e4 * study.work.connected_m2(),
        100.0 * study.work.map.undecided()
    );
    figure(&mut page, "workspace");
    let total = &study.total;
    let disc = total.disc.map_or("no circle fits".to_owned(), |disc| {
        format!(
            "the largest circle has a radius of {} m",
            digits(disc.radius_m)
        )
    });
    let _ = writeln!(
        page,
        "<p>The total-orientation workspace is that in which the platform can have every angle: {}; {disc}.</p>",
        area(total.map.area_m2())
    );
    figure(&mut page, "total_orientation");
    figure(&mut page, "angles");
    page += "<h2>Speeds, forces, stiffness, accuracy</h2>\n<p>Values at the centres of cells, at rest and without friction. Near a serial singularity the motors have to be fast; \
        near the parallel one they have to be strong, and the platform is hardly held.</p>\n";
    for name in [
        "singularities",
        "rates",
        "forces",
        "torques",
        "force_limit",
        "compliance",
        "accuracy",
        "tolerances",
        "angle_loads",
    ] {
        figure(&mut page, name);
    }
    for (is_missing, what, how) in [
        (
            study.scene.limits.torque_nm.is_none(),
            "force that the motors allow",
            "[limits] torque_nm",
        ),
        (
            study.stiffness_nm_rad.is_none(),
            "compliance",
            "--stiffness-nm-rad, or stiffness_nm_rad of the drives or the plant",
        ),
        (
            study.errors_m.is_none(),
            "offset within tolerances",
            "a table [tolerances]",
        ),
    ] {
        if is_missing {
            let _ = writeln!(page, "<p>A map of the {what} needs {how}.</p>");
        }
    }
    page += "<h2>Velocity ratios along the job</h2>\n<p>The source divides the platform's rates by each motor's. These ratios depend on the motion; the Jacobian below depends on the pose alone.</p>\n";
    figure(&mut page, "ratios");
    figure(&mut page, "jacobian");
    page += "<h2>Bearings and pins</h2>\n<p>Sizes of the forces in the joints along the job, N. A: motor, B: elbow, C: platform.</p>\n<table><tr><th>leg</th>";
    for joint in ["A", "B", "C"] {
        let _ = write!(page, "<th>{joint} peak</th><th>{joint} RMS</th>");
    }
    page += "</tr>\n";
    for (leg, joints) in study.reactions.forces.iter().enumerate() {
        let _ = write!(page, "<tr><td>{}</td>", leg + 1);
        for force in joints {
            let _ = write!(
                page,
                "<td>{}</td><td>{}</td>",
                digits(force.peak_n),
                digits(force.rms_n)
            );
        }
        page += "</tr>\n";
    }
    page += "</table>\n<p>Each curve is the tip of the force, from the middle of the figure; the dot is the start of the job.</p>\n";
    figure(&mut page, "reactions");
    page += "<h2>Motors</h2>\n";
    motors(&mut page, study);
    for name in motor_figures::NAMES {
        figure(&mut page, name);
    }
    page += "<h2>Duration</h2>\n<p>The same motion of the platform, faster and slower.</p>\n";
    figure(&mut page, "durations");
    page += "</html>\n";
    page
}

fn modes(page: &mut String, study: &Study) {
    *page += "<table><tr>";
    for head in MODE_HEADS {
        let _ = write!(page, "<th>{head}</th>");
    }
    *page += "</tr>\n";
    for row in &study.modes {
        let own = if row.result.elbows == study.own_mode() {
            " class=\"own\""
        } else {
            ""
        };
        let _ = write!(page, "<tr{own}><td>{}</td>", row.result.name());
        match row.reason() {
            Some(reason) => {
                let _ = write!(
                    page,
                    "<td class=\"no\" colspan=\"8\">{}</td>",
                    escaped(&reason)
                );
            }
            None => {
                for cell in mode_cells(row) {
                    let _ = write!(page, "<td>{cell}</td>");
                }
            }
        }
        *page += "</tr>\n";
    }
    *page += "</table>\n";
}

fn motors(page: &mut String, study: &Study) {
    let _ = write!(
        page,
        "<p>Each motor of the catalogue with the gear that leaves the most. A margin is what there is over what is asked for: at every instant the torque at the \
        speed, and over the job the continuous torque over the root mean square. Below 1 the motor does not do the job. The inertia of its rotor counts, friction does not; where the catalogue has no inertia, the margins are those of a rotor that weighs nothing, and the motor stands behind the others. \
        What is brought back is the sum of what each motor gives to a supply of its own in braking. \
        A curve that is estimated is the pull-out torque by the winding of a stepper, without resonance: plan with half of it. {}</p>\n<table><tr>",
        match study.scene.job.path.is_some() {
            true =>
                "The least time is that of a plan with the rates and torques of the motor in place of the limits of the scene.",
            false =>
                "The least time is that of the moves of the job, all of them faster or slower by one factor: their durations are given.",
        }
    );
    for head in MOTOR_HEADS {
        let _ = write!(page, "<th>{head}</th>");
    }
    *page += "</tr>\n";
    for row in &study.motors {
        let does = if row.candidate.margin() >= 1.0 {
            " class=\"own\""
        } else {
            ""
        };
        let name = escaped(&row.motor.name);
        // A second page of figures stands behind the first.
        let source = row.motor.source.split_whitespace().next().unwrap_or("");
        let source = escaped(source).replace('"', "&quot;");
        let _ = write!(page, "<tr{does}><td><a href=\"{source}\">{name}</a></td>");
        for cell in motor_cells(row) {
            let _ = write!(page, "<td>{cell}</td>");
        }
        *page += "</tr>\n";
    }
    *page += "</table>\n";
}
