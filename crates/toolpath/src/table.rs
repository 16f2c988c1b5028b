//! Tables of poses: CSV.

use crate::{Act, Element, PathFault, ToolCurve, ToolMotion, ToolPlace, ToolWork};

/// Columns that a table may have. The first two it must have.
const COLUMNS: [&str; 6] = [
    "x_mm",
    "y_mm",
    "alpha_deg",
    "feed_mm_min",
    "power",
    "dwell_s",
];

/// Largest size of x and y, mm, and of alpha, degrees.
const LARGEST: f64 = 1e6;

/// Shortest distance to a value that is not 0.
const SMALLEST: f64 = 1e-9;

/// Zero point of a table, and what holds where a row leaves a cell empty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TableSetup {
    /// Zero point of x, y and alpha in the fixed frame.
    pub origin: ToolPlace,
    /// Angle of the platform until a row gives one, rad in the fixed frame.
    pub alpha_rad: f64,
    /// Greatest speed of rows without one, m/s. None: as fast as the machine may.
    pub feed_m_s: Option<f64>,
    /// The power follows the true speed.
    pub follows_speed: bool,
}

/// Reads a table of poses with a row of names: `x_mm` and `y_mm`, and where wanted `alpha_deg`, `feed_mm_min`, `power`
/// (0 to 1) and `dwell_s`. The tool point goes straight to the pose of each row, with the feed and the power of that
/// row. An empty cell: alpha stays, the feed is that of `setup`, the tool is off. A row with a dwell has nothing else: the
/// machine stands with the tool off. Rows that begin with `#` are comments.
///
/// # Errors
/// The first fault of the table: it cannot be read, a column is missing or not known, a cell is no number or out of
/// range.
pub fn read_table(text: &str, setup: &TableSetup) -> Result<Vec<Element>, PathFault> {
    let mut reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .from_reader(text.as_bytes());
    let header = reader.headers().map_err(|error| unread(&error))?.clone();
    let columns = columns(&header)?;
    let mut elements = Vec::new();
    let mut alpha_rad = setup.alpha_rad;
    for row in reader.into_records() {
        let row = row.map_err(|error| unread(&error))?;
        let line = row.position().map_or(0, |place| line_of(text, place));
        let row = Reading { line, columns, row };
        if let Some(seconds) = row.number(5, SMALLEST..=LARGEST)? {
            if (0..5).any(|column| !row.cell(column).is_empty()) {
                return Err(row.fault(
                    5,
                    "a row with a dwell has nothing else; give it a row of its own",
                ));
            }
            elements.push(Element {
                line,
                tool: None,
                act: Act::Dwell { seconds },
            });
            continue;
        }
        let place = |name: usize| row.required(name).map(|value| 1e-3 * value);
        let [x, y] = setup.origin.position_m;
        let position_m = [x + place(0)?, y + place(1)?];
        if let Some(degrees) = row.number(2, -LARGEST..=LARGEST)? {
            alpha_rad = setup.origin.alpha_rad + degrees.to_radians();
        }
        let feed = row.number(3, SMALLEST..=LARGEST)?;
        let power = row.number(4, 0.0..=1.0)?.filter(|power| *power > 0.0);
        let feed_m_s = feed.map(|feed| 1e-3 * feed / 60.0).or(setup.feed_m_s);
        if power.is_some() && feed_m_s.is_none() {
            return Err(row.fault(
                3,
                "a row with the tool on needs a speed: a feed_mm_min above 0",
            ));
        }
        elements.push(Element {
            line,
            tool: power.map(|power| ToolWork {
                power,
                follows_speed: setup.follows_speed,
            }),
            act: Act::Motion(ToolMotion {
                curve: ToolCurve::Line,
                to: ToolPlace {
                    position_m,
                    alpha_rad,
                },
                feed_m_s,
                stops: false,
            }),
        });
    }
    Ok(elements)
}

fn unread(error: &csv::Error) -> PathFault {
    PathFault {
        line: error.position().map_or(0, |place| place.line() as u32),
        word: String::new(),
        reason: match error.kind() {
            csv::ErrorKind::UnequalLengths {
                expected_len, len, ..
            } if len > expected_len => {
                format!(
                    "{len} cells, and the table has {expected_len} columns; with decimal commas in it, write decimal points"
                )
            }
            _ => format!("no table: {error}"),
        },
    }
}

/// Line of a row. The reader's place is before the empty rows and comments above it.
fn line_of(text: &str, place: &csv::Position) -> u32 {
    let from = text.get(place.byte() as usize..).unwrap_or_default();
    let above = |line: &&str| line.trim().is_empty() || line.starts_with('#');
    (place.line() as usize + from.lines().take_while(above).count()) as u32
}

/// Places of the known columns.
fn columns(header: &csv::StringRecord) -> Result<[Option<usize>; 6], PathFault> {
    let fault = |word: &str, reason: String| PathFault {
        line: 1,
        word: word.to_owned(),
        reason,
    };
    if let Some(unknown) = header.iter().find(|name| !COLUMNS.contains(name)) {
        let known = COLUMNS.join(", ");
        let hint = match unknown.contains([';', '\t']) {
            true => "; columns are separated by commas, and numbers have decimal points",
            false => "",
        };
        return Err(fault(
            unknown,
            format!("not known; a column is one of {known}{hint}"),
        ));
    }
    let places = COLUMNS.map(|name| header.iter().position(|other| other == name));
    for (name, place) in COLUMNS.iter().zip(places) {
        let count = header.iter().filter(|other| other == name).count();
        if count > 1 {
            return Err(fault(name, "two columns have this name".into()));
        }
        if place.is_none() && COLUMNS[..2].contains(name) {
            return Err(fault(
                name,
                "missing; the first row has the names of the columns".into(),
            ));
        }
    }
    Ok(places)
}

struct Reading {
    line: u32,
    columns: [Option<usize>; 6],
    row: csv::StringRecord,
}

impl Reading {
    fn fault(&self, column: usize, reason: &str) -> PathFault {
        PathFault {
            line: self.line,
            word: COLUMNS[column].to_owned(),
            reason: reason.to_owned(),
        }
    }

    fn cell(&self, column: usize) -> &str {
        let cell = self.columns[column].and_then(|at| self.row.get(at));
        cell.unwrap_or_default()
    }

    fn number(
        &self,
        column: usize,
        range: std::ops::RangeInclusive<f64>,
    ) -> Result<Option<f64>, PathFault> {
        let cell = self.cell(column);
        if cell.is_empty() {
            return Ok(None);
        }
        match cell.parse::<f64>() {
            Ok(value) if range.contains(&value) => Ok(Some(value)),
            _ => {
                let (low, high) = (range.start(), range.end());
                let reason = format!("{cell:?} is no number from {low} to {high}");
                Err(self.fault(column, &reason))
            }
        }
    }

    fn required(&self, column: usize) -> Result<f64, PathFault> {
        let value = self.number(column, -LARGEST..=LARGEST)?;
        value.ok_or_else(|| self.fault(column, "empty; a row without a dwell has x_mm and y_mm"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SETUP: TableSetup = TableSetup {
        origin: ToolPlace {
            position_m: [1.0, 2.0],
            alpha_rad: 0.5,
        },
        alpha_rad: 0.25,
        feed_m_s: None,
        follows_speed: true,
    };

    #[test]
    fn cells_are_poses_feeds_and_powers() {
        let table = "# poses\ny_mm,x_mm, alpha_deg,power,feed_mm_min,dwell_s\n10,-20,,,,\n\n11,-20,90,0.5,600,\n,,,,,1.5\n";
        let elements = read_table(table, &SETUP).expect("a table");
        let [first, second, stand] = &elements[..] else {
            panic!("{elements:?}");
        };
        let motion = |element: &Element| match element.act {
            Act::Motion(motion) => motion,
            _ => panic!("no motion"),
        };
        assert_eq!((first.line, second.line, stand.line), (3, 5, 6));
        let place = motion(first).to;
        assert_eq!((place.position_m, place.alpha_rad), ([0.98, 2.01], 0.25));
        assert_eq!((first.tool, motion(first).feed_m_s), (None, None));
        assert_eq!(
            motion(second).to.alpha_rad,
            0.5 + std::f64::consts::FRAC_PI_2
        );
        assert_eq!(motion(second).feed_m_s, Some(0.01));
        assert_eq!(second.tool.map(|tool| tool.power), Some(0.5));
        assert_eq!((stand.tool, stand.act), (None, Act::Dwell { seconds: 1.5 }));
    }

    #[test]
    fn faults_name_line_and_column() {
        for (table, line, word) in [
            ("x_mm,z_mm\n", 1, "z_mm"),
            ("x_mm,alpha_deg\n1,2\n", 1, "y_mm"),
            ("x_mm,y_mm,x_mm\n", 1, "x_mm"),
            ("x_mm,y_mm\n1,2\n1,\n", 3, "y_mm"),
            ("x_mm,y_mm\n1,nan\n", 2, "y_mm"),
            ("x_mm,y_mm,power\n1,2,1.1\n", 2, "power"),
            ("x_mm,y_mm,feed_mm_min\n1,2,0\n", 2, "feed_mm_min"),
            ("x_mm,y_mm,power\n1,2,0.5\n", 2, "feed_mm_min"),
            ("x_mm,y_mm,dwell_s\n1,2,3\n", 2, "dwell_s"),
            ("x_mm,y_mm,dwell_s\n,,0\n", 2, "dwell_s"),
            ("x_mm,y_mm\n1,2,3\n", 2, ""),
            ("", 1, "x_mm"),
            ("x_mm;y_mm\n1,5;2\n", 1, "x_mm;y_mm"),
        ] {
            let fault = read_table(table, &SETUP).expect_err(table);
            assert_eq!(
                (fault.line, fault.word.as_str()),
                (line, word),
                "{table}: {fault}"
            );
        }
        for table in [
            "x_mm;y_mm\n1;2\n",
            "x_mm\ty_mm\n1\t2\n",
            "x_mm,y_mm\n1,5,2\n",
        ] {
            let fault = read_table(table, &SETUP).expect_err(table);
            assert!(fault.reason.contains("decimal points"), "{table}: {fault}");
        }
    }
}
