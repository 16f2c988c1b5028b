//! Tables of angles and torques of the motors, as `drives.csv`, `plant.csv` and `ticks.csv` have them.

use crate::columns::{CellTable, ColumnFault};
use crate::parameter::wrapped;

/// Faults of cells that are told at once, at most.
const MOST_FAULTS: usize = 20;

/// Largest size of an angle, rad, and of a torque, N m.
const LARGEST: f64 = 1e5;

/// Columns of the angles that motion is taken from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MotionColumns {
    /// Measured angles: `th1_1` to `th1_3`.
    Measured,
    /// Commanded angles: `cmd_th1_1` of `drives.csv`, or `thref_1` of `plant.csv`.
    Commanded,
}

/// Angles and torques of the motors at an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointSample {
    /// Line in the file, from 1.
    pub line: u32,
    /// Time, s.
    pub t: f64,
    /// Angles, rad, not wrapped.
    pub angles_rad: [f64; 3],
    /// Torques of the motors at the joints, N m.
    pub torques_nm: [f64; 3],
}

/// Reads a table with a row of names: `t`, the angles of `columns`, and `tau1` to `tau3`. Other columns are not read.
///
/// # Errors
/// Faults of the table: separators, missing columns, cells, times that do not rise, with line, column and reason.
pub fn read_telemetry(
    text: &str,
    columns: MotionColumns,
) -> Result<Vec<JointSample>, Vec<ColumnFault>> {
    let table = CellTable::read(text).map_err(|fault| vec![fault])?;
    let place = |names: &[String]| {
        let found = names.iter().find_map(|name| table.place(name));
        found.ok_or_else(|| {
            let reason = "missing; the table is drives.csv or plant.csv of `trirrr run` or `trirrr stream`, or has t, th1_1 to th1_3 (rad) and tau1 to tau3 (N m)";
            vec![ColumnFault::of_column(&names.join(" or "), reason)]
        })
    };
    let angle = |motor: usize| match columns {
        MotionColumns::Measured => place(&[format!("th1_{motor}")]),
        MotionColumns::Commanded => place(&[format!("cmd_th1_{motor}"), format!("thref_{motor}")]),
    };
    let torque = |motor: usize| place(&[format!("tau{motor}")]);
    let places = [
        place(&["t".to_owned()])?,
        angle(1)?,
        angle(2)?,
        angle(3)?,
        torque(1)?,
        torque(2)?,
        torque(3)?,
    ];
    let mut samples: Vec<JointSample> = Vec::with_capacity(table.rows.len());
    let mut faults = Vec::new();
    for row in &table.rows {
        let mut values = [0.0; 7];
        let mut read = || -> Result<(), ColumnFault> {
            for (value, place) in values.iter_mut().zip(places) {
                let fault = |reason: String| ColumnFault {
                    line: row.0,
                    column: table.names[place].clone(),
                    reason,
                };
                *value = table
                    .number(row, place)?
                    .ok_or_else(|| fault("empty".into()))?;
                if value.abs() > LARGEST {
                    return Err(fault(format!("{value} is larger than {LARGEST}")));
                }
            }
            Ok(())
        };
        if let Err(fault) = read() {
            faults.push(fault);
            if faults.len() == MOST_FAULTS {
                return Err(faults);
            }
            continue;
        }
        let [t, a, b, c, d, e, f] = values;
        let mut sample = JointSample {
            line: row.0,
            t,
            angles_rad: [a, b, c],
            torques_nm: [d, e, f],
        };
        if let Some(before) = samples.last() {
            if t <= before.t {
                let reason = format!("{t} s does not come after {} s of the row above", before.t);
                faults.push(ColumnFault {
                    line: row.0,
                    column: "t".into(),
                    reason,
                });
                return Err(faults);
            }
            // Tables wrap angles; a motion does not.
            for (angle, before) in sample.angles_rad.iter_mut().zip(before.angles_rad) {
                *angle = before + wrapped(*angle - before);
            }
        }
        samples.push(sample);
    }
    match faults.is_empty() {
        true => Ok(samples),
        false => Err(faults),
    }
}
