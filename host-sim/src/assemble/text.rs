//! Modes as tables for a reader, as CSV and as JSON.

use super::find::Modes;
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::PathBuf;
use trirrr_core::forward::Completeness;
use trirrr_core::machine::Elbow;
use trirrr_design::assembly::elbows_of;
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

/// Both tables, and the files written.
pub(super) fn tables(modes: &Modes, files: &[PathBuf]) -> String {
    let degrees = modes
        .angles_rad
        .map(|angle| format!("{:.4}", angle.to_degrees()))
        .join(", ");
    let mut text = format!(
        "{}: motor angles {degrees} deg, {}\n\nassembly modes: {}; {}\n",
        modes.scene.name,
        modes.given,
        modes.found.modes.len(),
        completeness(modes.found.completeness).1
    );
    text += "mode        x m        y m  alpha deg  elbows  det A  parallel   serial 1   serial 2   serial 3  residual m\n";
    // Writing to a string does not fail.
    for (index, mode) in modes.found.modes.iter().enumerate() {
        let Record {
            pose: [x, y, alpha],
            legs,
            ..
        } = &mode.record;
        let mark = if modes.is_own[index] { '*' } else { ' ' };
        let _ = write!(
            text,
            "{:>3}{mark} {x:>10.6} {y:>10.6} {:>10.4} {:>7} {:>6} {:>9.6}",
            index + 1,
            alpha.to_degrees(),
            signs(elbows_of(&mode.record)),
            side(&mode.record),
            mode.record.parallel
        );
        for leg in legs {
            let _ = write!(text, " {:>10.6}", leg.serial);
        }
        let double = if mode.double {
            "  two modes meet here"
        } else {
            ""
        };
        let _ = writeln!(text, "  {:>10.1e}{double}", mode.residual_m);
    }
    text += match modes.is_own.contains(&true) {
        true => "* elbows and sign of det A of the scene\n",
        false => "none has the elbows and the sign of det A of the scene\n",
    };
    let [x, y, alpha] = modes.found.modes[modes.chosen].record.pose;
    let _ = writeln!(
        text,
        "\nworking modes at the pose of mode {} ({x:.6} m, {y:.6} m, {:.4} deg): all eight reach it",
        modes.chosen + 1,
        alpha.to_degrees()
    );
    text += "elbows    motor 1 deg  motor 2 deg  motor 3 deg  det A  parallel   serial 1   serial 2   serial 3\n";
    for (elbows, record) in &modes.working {
        let mark = if is_own(modes, *elbows) { '*' } else { ' ' };
        let _ = write!(text, "{:>6}{mark} ", signs(elbows.map(Some)));
        for leg in &record.legs {
            let _ = write!(text, " {:>12.4}", leg.th1.to_degrees());
        }
        let _ = write!(text, " {:>6} {:>9.6}", side(record), record.parallel);
        for leg in &record.legs {
            let _ = write!(text, " {:>10.6}", leg.serial);
        }
        text.push('\n');
    }
    text.push('\n');
    for file in files {
        let _ = writeln!(text, "wrote    {}", file.display());
    }
    text
}

/// Returns `true` for the elbows of the scene.
pub(super) fn is_own(modes: &Modes, elbows: [Elbow; 3]) -> bool {
    modes.scene.parameters.legs.map(|leg| leg.elbow) == elbows
}

/// Values of a mode in the order of [`COLUMNS`].
fn row(elbows: [Option<Elbow>; 3], record: &Record) -> String {
    let angles = record.legs.iter().flat_map(|leg| [leg.th1, leg.th2]);
    let serial = record.legs.iter().map(|leg| leg.serial);
    let values = record
        .pose
        .into_iter()
        .chain(angles)
        .chain([record.det_a, record.parallel])
        .chain(serial);
    // Debug text is the shortest that reads back as the same number.
    let cells: Vec<String> = values.map(|value| format!("{value:?}")).collect();
    let signs = elbows.map(|elbow| elbow.map_or(0.0, Elbow::sign).to_string());
    format!("{},{}", signs.join(","), cells.join(","))
}

const COLUMNS: &str = "elbow_1,elbow_2,elbow_3,x,y,alpha,th1_1,th2_1,th1_2,th2_2,th1_3,th2_3,detA,parallel,serial1,serial2,serial3";

/// The assembly modes as CSV, SI units.
pub(super) fn assemblies_table(modes: &Modes) -> String {
    let mut text = format!("mode,scene,{COLUMNS},residual,double\n");
    for (index, mode) in modes.found.modes.iter().enumerate() {
        let own = u8::from(modes.is_own[index]);
        let values = row(elbows_of(&mode.record), &mode.record);
        let _ = writeln!(
            text,
            "{},{own},{values},{:?},{}",
            index + 1,
            mode.residual_m,
            u8::from(mode.double)
        );
    }
    text
}

/// The working modes as CSV, SI units.
pub(super) fn working_modes_table(modes: &Modes) -> String {
    let mut text = format!("scene,{COLUMNS}\n");
    for (elbows, record) in &modes.working {
        let own = u8::from(is_own(modes, *elbows));
        let _ = writeln!(text, "{own},{}", row(elbows.map(Some), record));
    }
    text
}

/// Everything as JSON, SI units.
pub(super) fn as_json(modes: &Modes) -> Value {
    let machine = |elbows: [Option<Elbow>; 3], record: &Record| {
        json!({
            "elbows": elbows.map(|elbow| elbow.map_or(0, |elbow| elbow.sign() as i32)),
            "pose": record.pose,
            "motor_angles_rad": record.legs.map(|leg| leg.th1),
            "distal_angles_rad": record.legs.map(|leg| leg.th2),
            "det_a": record.det_a,
            "parallel_distance": record.parallel,
            "serial_distances": record.legs.map(|leg| leg.serial),
        })
    };
    let with = |mut object: Value, more: Value| {
        if let (Some(object), Value::Object(more)) = (object.as_object_mut(), more) {
            object.extend(more);
        }
        object
    };
    let assemblies = modes
        .found
        .modes
        .iter()
        .zip(&modes.is_own)
        .map(|(mode, own)| {
            let more =
                json!({ "scene": own, "residual_m": mode.residual_m, "double": mode.double });
            with(machine(elbows_of(&mode.record), &mode.record), more)
        });
    let working = modes.working.iter().map(|(elbows, record)| {
        with(
            machine(elbows.map(Some), record),
            json!({ "scene": is_own(modes, *elbows) }),
        )
    });
    json!({
        "scene": modes.scene.name,
        "motor_angles_rad": modes.angles_rad,
        "completeness": completeness(modes.found.completeness).0,
        "assembly_modes": assemblies.collect::<Vec<_>>(),
        "chosen": modes.chosen,
        "working_modes": working.collect::<Vec<_>>(),
    })
}
