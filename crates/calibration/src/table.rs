//! Tables of measurements: CSV.

use crate::columns::{CellTable, ColumnFault};
use crate::measurement::{DeviceReading, MeasuredRow, MeasurementNoise};

/// Faults of cells that are told at once, at most.
const MOST_FAULTS: usize = 20;

/// Largest size of an angle, rad: beyond it the column is likely in degrees.
const LARGEST_ANGLE_RAD: f64 = 100.0;

/// Quantity of a table, and its columns: the name with the SI unit, then the other one and its unit in SI.
struct ColumnQuantity {
    names: [&'static str; 2],
    other_unit: f64,
}

const DEGREE: f64 = std::f64::consts::PI / 180.0;

const fn angle(names: [&'static str; 2]) -> ColumnQuantity {
    ColumnQuantity {
        names,
        other_unit: DEGREE,
    }
}

const fn length(names: [&'static str; 2]) -> ColumnQuantity {
    ColumnQuantity {
        names,
        other_unit: 1e-3,
    }
}

/// Angles of the motors, place and angle of the target, distance and its fixed point, noise of lengths and angles.
const QUANTITIES: [ColumnQuantity; 11] = [
    angle(["th1_1", "th1_1_deg"]),
    angle(["th1_2", "th1_2_deg"]),
    angle(["th1_3", "th1_3_deg"]),
    length(["x_m", "x_mm"]),
    length(["y_m", "y_mm"]),
    angle(["alpha_rad", "alpha_deg"]),
    length(["distance_m", "distance_mm"]),
    length(["centre_x_m", "centre_x_mm"]),
    length(["centre_y_m", "centre_y_mm"]),
    length(["noise_m", "noise_mm"]),
    angle(["noise_rad", "noise_deg"]),
];

const X: usize = 3;
const Y: usize = 4;
const ALPHA: usize = 5;
const DISTANCE: usize = 6;
const NOISE: usize = 9;

/// Column that nobody reads.
const NOTE: &str = "note";

/// Place and unit of the column of each quantity.
type ColumnPlaces = [Option<(usize, f64)>; QUANTITIES.len()];

/// Reads a table of measurements with a row of names. Each row has the angles of the three motors, and either a place
/// (and an angle where it was measured) or a distance with its fixed point. `noise` holds for rows that give none. Rows that
/// begin with `#` are comments, and so is a column `note`.
///
/// # Errors
/// Everything that is wrong: separators, columns, cells, with line, column and reason.
pub fn read_measurements(
    text: &str,
    noise: &MeasurementNoise,
) -> Result<Vec<MeasuredRow>, Vec<ColumnFault>> {
    let table = CellTable::read(text).map_err(|fault| vec![fault])?;
    let places = places(&table).map_err(|fault| vec![fault])?;
    let mut rows = Vec::with_capacity(table.rows.len());
    let mut faults = Vec::new();
    for row in &table.rows {
        match read_row(&table, &places, row, noise) {
            Ok(row) => rows.push(row),
            Err(fault) => faults.push(fault),
        }
    }
    if rows.is_empty() && faults.is_empty() {
        faults.push(ColumnFault::of_line(1, "there is no row of measurements"));
    }
    faults.truncate(MOST_FAULTS);
    match faults.is_empty() {
        true => Ok(rows),
        false => Err(faults),
    }
}

fn places(table: &CellTable) -> Result<ColumnPlaces, ColumnFault> {
    let is_known = |name: &String| {
        name == NOTE
            || QUANTITIES
                .iter()
                .any(|one| one.names.contains(&name.as_str()))
    };
    let unknown: Vec<&str> = table
        .names
        .iter()
        .filter(|name| !is_known(name))
        .map(String::as_str)
        .collect();
    if let [first, others @ ..] = &unknown[..] {
        let known = QUANTITIES.map(|one| one.names.join(" or ")).join(", ");
        let others = match others {
            [] => String::new(),
            others => format!(", and so are {}", others.join(", ")),
        };
        return Err(ColumnFault::of_column(
            first,
            format!(
                "not known{others}; a column is one of {known}; `{NOTE}` is the one column for words of your own: take others out"
            ),
        ));
    }
    let mut places = ColumnPlaces::default();
    for (place, quantity) in places.iter_mut().zip(&QUANTITIES) {
        let [si, other] = quantity.names.map(|name| table.place(name));
        *place = match (si, other) {
            (Some(_), Some(_)) => {
                let [si, other] = quantity.names;
                let reason = format!("there is {other}, too; give one of them");
                return Err(ColumnFault::of_column(si, reason));
            }
            (Some(column), None) => Some((column, 1.0)),
            (None, Some(column)) => Some((column, quantity.other_unit)),
            (None, None) => None,
        };
    }
    let missing = |index: usize| {
        let [si, other] = QUANTITIES[index].names;
        let reason = format!("missing, or {other}; the first row has the names of the columns");
        ColumnFault::of_column(si, reason)
    };
    if let Some(motor) = (0..3).find(|motor| places[*motor].is_none()) {
        return Err(missing(motor));
    }
    let needs: &[usize] = match (places[X].or(places[Y]), places[DISTANCE]) {
        (None, None) => &[X],
        (Some(_), _) => &[X, Y],
        (None, Some(_)) => &[],
    };
    let of_distance: &[usize] = match places[DISTANCE] {
        Some(_) => &[DISTANCE + 1, DISTANCE + 2],
        None => &[],
    };
    let needed = needs.iter().chain(of_distance);
    match needed.copied().find(|index| places[*index].is_none()) {
        Some(index) => Err(missing(index)),
        None => Ok(places),
    }
}

fn read_row(
    table: &CellTable,
    places: &ColumnPlaces,
    row: &(u32, csv::StringRecord),
    noise: &MeasurementNoise,
) -> Result<MeasuredRow, ColumnFault> {
    let fault = |index: usize, reason: String| {
        let place = places[index].map_or(0, |(place, _)| place);
        ColumnFault {
            line: row.0,
            column: table.names[place].clone(),
            reason,
        }
    };
    let value = |index: usize| match places[index] {
        None => Ok(None),
        Some((place, unit)) => Ok(table.number(row, place)?.map(|value| value * unit)),
    };
    let required =
        |index: usize, reason: &str| value(index)?.ok_or_else(|| fault(index, reason.to_owned()));
    let motor = |index: usize| {
        let angle = required(index, "empty; each row has the angles of the three motors")?;
        match angle.abs() <= LARGEST_ANGLE_RAD {
            true => Ok(angle),
            false => {
                let name = QUANTITIES[index].names[1];
                Err(fault(
                    index,
                    format!("{angle} rad is no joint angle; a column in degrees is {name}"),
                ))
            }
        }
    };
    let angles_rad = [motor(0)?, motor(1)?, motor(2)?];
    let place = (value(X)?, value(Y)?, value(ALPHA)?);
    let reading = match (place, value(DISTANCE)?) {
        ((None, None, None), Some(distance_m)) => {
            if distance_m <= 0.0 {
                return Err(fault(DISTANCE, "must be greater than 0".into()));
            }
            let reason = "empty; a distance needs its fixed point";
            let centre_m = [
                required(DISTANCE + 1, reason)?,
                required(DISTANCE + 2, reason)?,
            ];
            DeviceReading::Distance {
                distance_m,
                centre_m,
            }
        }
        ((Some(x), Some(y), angle_rad), None) => DeviceReading::Place {
            place_m: [x, y],
            angle_rad,
        },
        ((None, None, None), None) => {
            let index = if places[X].is_some() { X } else { DISTANCE };
            return Err(fault(
                index,
                "empty; a row has a place or a distance".into(),
            ));
        }
        (_, Some(_)) => {
            let reason =
                "a row has a place or a distance, not both; give the other one a row of its own";
            return Err(fault(DISTANCE, reason.into()));
        }
        ((x, _, _), None) => {
            let index = if x.is_some() { Y } else { X };
            return Err(fault(index, "empty; a place has both coordinates".into()));
        }
    };
    let deviation = |index: usize, or: f64| match value(index)? {
        None => Ok(or),
        Some(value) if value > 0.0 => Ok(value),
        Some(_) => Err(fault(
            index,
            "must be greater than 0: a standard deviation".into(),
        )),
    };
    Ok(MeasuredRow {
        line: row.0,
        angles_rad,
        reading,
        noise: MeasurementNoise {
            place_m: deviation(NOISE, noise.place_m)?,
            angle_rad: deviation(NOISE + 1, noise.angle_rad)?,
        },
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const NOISE: MeasurementNoise = MeasurementNoise {
        place_m: 1e-5,
        angle_rad: 1e-4,
    };

    #[test]
    fn units_are_those_of_the_names() {
        let text = "\u{feff}# by laser\nth1_1_deg,th1_2,th1_3,x_mm,y_m,alpha_deg,noise_mm,note\n90,0.1,0.2,210,0.22,,,first\n\n0,0,0,1,2,180,0.5,\n";
        let rows = read_measurements(text, &NOISE).expect("a table");
        let [first, second] = &rows[..] else {
            panic!("{rows:?}");
        };
        assert_eq!((first.line, second.line), (3, 5));
        assert_eq!(first.angles_rad[0], std::f64::consts::FRAC_PI_2);
        let DeviceReading::Place { place_m, angle_rad } = first.reading else {
            panic!("no place");
        };
        assert!((place_m[0] - 0.21).abs() < 1e-15 && place_m[1] == 0.22);
        assert_eq!((angle_rad, first.noise), (None, NOISE));
        assert_eq!(second.noise.place_m, 5e-4);
        let text = "th1_1,th1_2,th1_3,distance_mm,centre_x_mm,centre_y_mm\n0,0,0,150,10,20\n";
        let rows = read_measurements(text, &NOISE).expect("a table");
        assert_eq!(rows[0].value_count(), 1);
    }

    #[test]
    fn faults_name_line_column_and_reason() {
        const NAMES: &str = "th1_1,th1_2,th1_3,x_m,y_m,alpha_rad";
        for (table, line, column, word) in [
            ("", 1, "th1_1", "missing"),
            (
                "th1_1;th1_2;th1_3;x_m;y_m\n0,1;0,2;0,3;0,1;0,2\n",
                1,
                "",
                "semicolons",
            ),
            ("th1_1\tth1_2\tx_m\n", 1, "", "tabs"),
            ("th1_1,th1_2,x_m,y_m\n", 1, "th1_3", "th1_3_deg"),
            ("th1_1,th1_2,th1_3\n", 1, "x_m", "missing"),
            ("th1_1,th1_2,th1_3,x_m\n", 1, "y_m", "missing"),
            (
                "th1_1,th1_2,th1_3,distance_m,centre_x_m\n",
                1,
                "centre_y_m",
                "missing",
            ),
            (
                "th1_1,th1_1_deg,th1_2,th1_3,x_m,y_m\n",
                1,
                "th1_1",
                "one of them",
            ),
            ("th1_1,th1_2,th1_3,x,y\n", 1, "x", "not known"),
            ("th1_1,th1_2,th1_3,x_m,x_m\n", 1, "x_m", "two columns"),
            (NAMES, 1, "", "no row"),
        ] {
            let faults = read_measurements(table, &NOISE).expect_err(table);
            assert_eq!(
                (faults[0].line, faults[0].column.as_str()),
                (line, column),
                "{table}"
            );
            assert!(faults[0].reason.contains(word), "{table}: {}", faults[0]);
        }
        for (row, column, word) in [
            ("0,0,0,0.1,NaN,", "y_m", "finite"),
            ("0,0,0,0.1,inf,", "y_m", "finite"),
            ("0,0,0,0.1,x,", "y_m", "no number"),
            ("0,0,0,0.1,\"0,2\",", "y_m", "decimal comma"),
            ("0,0,0,0,1,0,2,0", "", "decimal points"),
            ("0,0,,0.1,0.2,", "th1_3", "empty"),
            ("0,0,172.5,0.1,0.2,", "th1_3", "th1_3_deg"),
            ("0,0,0,0.1,,", "y_m", "both coordinates"),
            ("0,0,0,,,", "x_m", "place or a distance"),
        ] {
            let table = format!("{NAMES}\n0,0,0,0.1,0.2,\n{row}\n");
            let faults = read_measurements(&table, &NOISE).expect_err(row);
            assert_eq!(
                (faults[0].line, faults[0].column.as_str()),
                (3, column),
                "{row}"
            );
            assert!(faults[0].reason.contains(word), "{row}: {}", faults[0]);
        }
        let table = "th1_1,th1_2,th1_3,x_m,y_m,noise_m\n0,0,0,1,1,0\n0,0,0,1,1,-1\n";
        let faults = read_measurements(table, &NOISE).expect_err(table);
        assert_eq!(faults.len(), 2);
    }
}
