//! Modes as a document, and as CSV.

use super::find::Modes;
use trirrr_core::forward::Completeness;
use trirrr_core::machine::Elbow;
use trirrr_design::assembly::elbows_of;
use trirrr_figures::document::{Document, Facts, csv};
use trirrr_scene::record::Record;

/// Elbow signs as `+-+`; `0` for a leg that is stretched or folded.
pub(super) fn signs(elbows: [Option<Elbow>; 3]) -> String {
    let sign = |elbow: Option<Elbow>| match elbow {
        Some(Elbow::Positive) => '+',
        Some(Elbow::Negative) => '-',
        None => '0',
    };
    elbows.map(sign).iter().collect()
}

/// Sign of det A.
pub(super) fn side(record: &Record) -> &'static str {
    match record.det_a {
        det_a if det_a > 0.0 => "+",
        det_a if det_a < 0.0 => "-",
        _ => "0",
    }
}

/// Completeness in words, and its name.
fn completeness(of: Completeness) -> (&'static str, &'static str) {
    match of {
        Completeness::Complete => (
            "complete",
            "complete: every real root is simple, and its pose is in the list",
        ),
        Completeness::Double => (
            "double",
            "two modes meet in one entry, to within rounding: a parallel singularity; all others are in the list",
        ),
        Completeness::Undecided => (
            "undecided",
            "undecided: rounding hides the number of roots somewhere, or a root gave no pose; there may be more",
        ),
    }
}

/// Modes, and the ways to them.
pub(super) fn document(modes: &Modes) -> Document {
    let mut document = Document::new();
    let found = &modes.found;
    let degrees = modes
        .angles_rad
        .map(|angle| format!("{:.4}", angle.to_degrees()));
    let (name, words) = completeness(found.completeness);
    document.pairs(
        Facts::new()
            .pair("scene", "scene", &modes.scene.name)
            .pair("motor_angles_rad", "motor angles", modes.angles_rad)
            .words(format!("{} deg, {}", degrees.join(", "), modes.given))
            .pair("completeness", "list", name)
            .words(words)
            .data("chosen", modes.chosen),
    );
    document.heading(format!("assembly modes: {}", found.modes.len()));
    let assemblies = found.modes.iter().zip(&modes.is_own).zip(1..);
    let assemblies = assemblies.map(|((mode, own), number): (_, u32)| {
        let [x, y, alpha] = mode.record.pose;
        let double = if mode.double {
            "two modes meet here"
        } else {
            ""
        };
        Facts::new()
            .text("mode", number.to_string())
            .derived("x", "m", x)
            .decimals(6)
            .derived("y", "m", y)
            .decimals(6)
            .derived("alpha", "deg", alpha.to_degrees())
            .decimals(4)
            .and(machine(elbows_of(&mode.record), &mode.record))
            .pair("residual_m", "residual, m", mode.residual_m)
            .words(format!("{:.1e}", mode.residual_m))
            .pair("double", "note", mode.double)
            .words(double)
            .data("scene", own)
            .marked(*own)
    });
    document.table("assembly_modes", assemblies.collect());
    document.note(match modes.is_own.contains(&true) {
        true => "* elbows and sign of det A of the scene",
        false => "none has the elbows and the sign of det A of the scene",
    });
    let [x, y, alpha] = found.modes[modes.chosen].record.pose;
    document.heading(format!(
        "working modes at the pose of mode {} ({x:.6} m, {y:.6} m, {:.4} deg): all eight reach it",
        modes.chosen + 1,
        alpha.to_degrees()
    ));
    let working = modes.working.iter().map(|(elbows, record)| {
        let own = is_own(modes, *elbows);
        let legs = record.legs.iter().zip(1..);
        let angles = legs.fold(Facts::new(), |row, (leg, number): (_, u32)| {
            let label = format!("motor {number}");
            row.derived(label, "deg", leg.th1.to_degrees()).decimals(4)
        });
        machine(elbows.map(Some), record)
            .and(angles)
            .data("scene", own)
            .marked(own)
    });
    document.table("working_modes", working.collect());
    document
}

/// Record of the machine in a mode.
fn machine(elbows: [Option<Elbow>; 3], record: &Record) -> Facts {
    let numbers = elbows.map(|elbow| elbow.map_or(0, |elbow| elbow.sign() as i32));
    let row = Facts::new()
        .pair("elbows", "elbows", numbers)
        .words(signs(elbows))
        .pair("det_a", "det A", record.det_a)
        .words(side(record))
        .pair("parallel_distance", "parallel", record.parallel)
        .decimals(6)
        .data("pose", record.pose)
        .data("motor_angles_rad", record.legs.map(|leg| leg.th1))
        .data("distal_angles_rad", record.legs.map(|leg| leg.th2))
        .data("serial_distances", record.legs.map(|leg| leg.serial));
    let legs = record.legs.iter().zip(1..);
    legs.fold(row, |row, (leg, number): (_, u32)| {
        row.derived(format!("serial {number}"), "", leg.serial)
            .decimals(6)
    })
}

/// Returns `true` for the elbows of the scene.
pub(super) fn is_own(modes: &Modes, elbows: [Elbow; 3]) -> bool {
    modes.scene.parameters.legs.map(|leg| leg.elbow) == elbows
}

/// Values of a mode in the order of the columns.
fn row(record: Facts, elbows: [Option<Elbow>; 3], state: &Record) -> Facts {
    let [x, y, alpha] = state.pose;
    let record = (1..)
        .zip(elbows)
        .fold(record, |row, (leg, elbow): (u32, _)| {
            row.data(
                format!("elbow_{leg}"),
                elbow.map_or(0, |elbow| elbow.sign() as i32),
            )
        });
    let record = record.data("x", x).data("y", y).data("alpha", alpha);
    let legs = || (1_u32..).zip(&state.legs);
    let record = legs().fold(record, |row, (leg, of)| {
        row.data(format!("th1_{leg}"), of.th1)
            .data(format!("th2_{leg}"), of.th2)
    });
    let record = record
        .data("detA", state.det_a)
        .data("parallel", state.parallel);
    legs().fold(record, |row, (leg, of)| {
        row.data(format!("serial{leg}"), of.serial)
    })
}

/// The assembly modes as CSV, SI units.
pub(super) fn assemblies_table(modes: &Modes) -> String {
    let rows = modes.found.modes.iter().zip(&modes.is_own).zip(1..);
    let rows = rows.map(|((mode, own), number): (_, u32)| {
        let head = Facts::new().data("mode", number).data("scene", own);
        let row = row(head, elbows_of(&mode.record), &mode.record);
        row.data("residual", mode.residual_m)
            .data("double", mode.double)
    });
    csv(&rows.collect::<Vec<_>>())
}

/// The working modes as CSV, SI units.
pub(super) fn working_modes_table(modes: &Modes) -> String {
    let rows = modes.working.iter().map(|(elbows, record)| {
        let head = Facts::new().data("scene", is_own(modes, *elbows));
        row(head, elbows.map(Some), record)
    });
    csv(&rows.collect::<Vec<_>>())
}
