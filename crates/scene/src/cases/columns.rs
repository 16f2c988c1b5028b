//! Columns of the table, by what they hold.

use csv::ByteRecord;

/// A column: its name, for messages, and where it stands in a row.
#[derive(Clone, Debug)]
pub(super) struct Column {
    pub(super) name: String,
    pub(super) index: usize,
}

/// The columns of one leg.
#[derive(Clone, Debug)]
pub(super) struct LegColumns {
    pub(super) base: [Column; 2],
    pub(super) proximal: Column,
    pub(super) distal: Column,
    pub(super) joint_radius: Column,
    pub(super) joint_angle: Column,
    pub(super) elbow: Column,
}

/// Columns that the setpoint comes from.
#[derive(Clone, Debug)]
pub(super) enum SetpointColumns {
    /// x, y, alpha, vx, vy, valpha, acx, acy, acalpha.
    State([Column; 9]),
    /// A move from rest to rest.
    Move(MoveColumns),
}

/// The columns of a move.
#[derive(Clone, Debug)]
pub(super) struct MoveColumns {
    /// x0, y0, a0.
    pub(super) from: [Column; 3],
    /// xf, yf, af.
    pub(super) to: [Column; 3],
    pub(super) duration: Column,
    pub(super) time: Column,
}

/// Columns of a table of cases, by their names in its header.
#[derive(Clone, Debug)]
pub struct Columns {
    case: Option<Column>,
    pub(super) legs: [LegColumns; 3],
    pub(super) mass: Column,
    pub(super) inertia: Column,
    /// Missing ones of these count as 0.
    pub(super) link_mass: Option<Column>,
    pub(super) gravity: [Option<Column>; 2],
    pub(super) wrench: [Option<Column>; 3],
    pub(super) motion: SetpointColumns,
    /// Fields in a whole row.
    pub(super) width: usize,
}

const STATE: [&str; 9] = [
    "x", "y", "alpha", "vx", "vy", "valpha", "acx", "acy", "acalpha",
];
const MOVE: [&str; 8] = ["x0", "xf", "y0", "yf", "a0", "af", "T", "t"];

/// Reason for which a header of one column is refused: its columns are separated by something else than commas. None if they are not.
pub fn other_separator(only: &str) -> Option<String> {
    let separators = [(';', "semicolons"), ('\t', "tabs")];
    let (_, word) = separators
        .iter()
        .find(|(separator, _)| only.contains(*separator))?;
    Some(format!(
        "the columns are separated by {word}; separate them by commas, and write decimal points"
    ))
}

impl Columns {
    /// Finds the columns in the header.
    ///
    /// Columns of other names may stand beside them, but for one that was meant to be a column with a default.
    ///
    /// # Errors
    /// Columns that are missing, one that is there twice, or one whose name was probably meant otherwise.
    pub fn find(header: &ByteRecord) -> Result<Self, String> {
        let mut finder = Finder {
            header,
            missing: Vec::new(),
            twice: Vec::new(),
            absent: Vec::new(),
        };
        let columns = Self {
            case: finder.defaulted("case"),
            legs: [1, 2, 3].map(|leg| finder.leg(leg)),
            mass: finder.required("m"),
            inertia: finder.required("I"),
            link_mass: finder.defaulted("ml"),
            gravity: ["gx", "gy"].map(|name| finder.defaulted(name)),
            wrench: ["Wx", "Wy", "Wa"].map(|name| finder.defaulted(name)),
            motion: finder.motion(),
            width: header.len(),
        };
        if let Some(name) = finder.twice.first() {
            return Err(format!("column {name} is there more than once"));
        }
        let mut fields = header.iter();
        if let (Some(only), None) = (fields.next(), fields.next())
            && let Some(reason) = other_separator(&String::from_utf8_lossy(only))
        {
            return Err(reason);
        }
        if let Some((name, meant)) = finder.misspelt() {
            return Err(format!("column {name} is not known; did you mean {meant}?"));
        }
        match finder.missing.as_slice() {
            [] => Ok(columns),
            [name] => Err(format!("column {name} is missing")),
            names => Err(format!("columns {} are missing", names.join(", "))),
        }
    }

    /// Names and places of the columns that hold numbers.
    pub fn numbers(&self) -> impl Iterator<Item = (&str, usize)> {
        let legs = self.legs.iter().flat_map(|leg| {
            let [x, y] = &leg.base;
            let links = [&leg.proximal, &leg.distal];
            let joint = [&leg.joint_radius, &leg.joint_angle, &leg.elbow];
            [x, y].into_iter().chain(links).chain(joint)
        });
        let loads = self.link_mass.iter().chain(self.gravity.iter().flatten());
        let loads = loads.chain(self.wrench.iter().flatten());
        let motion: Vec<&Column> = match &self.motion {
            SetpointColumns::State(state) => state.iter().collect(),
            SetpointColumns::Move(each) => each
                .from
                .iter()
                .chain(&each.to)
                .chain([&each.duration, &each.time])
                .collect(),
        };
        legs.chain([&self.mass, &self.inertia])
            .chain(loads)
            .chain(motion)
            .map(|column| (column.name.as_str(), column.index))
    }

    /// Place of the column of labels, if the table has one.
    pub fn label_index(&self) -> Option<usize> {
        self.case.as_ref().map(|column| column.index)
    }

    /// Label of the case in `row`, if the table has a column for labels.
    pub fn label<'a>(&self, row: &'a ByteRecord) -> Option<&'a [u8]> {
        row.get(self.label_index()?)
    }
}

/// Looks columns up and notes what is wrong.
struct Finder<'a> {
    header: &'a ByteRecord,
    missing: Vec<String>,
    twice: Vec<String>,
    /// Columns with a default that are not there.
    absent: Vec<&'static str>,
}

impl Finder<'_> {
    fn optional(&mut self, name: &str) -> Option<Column> {
        let mut places = self
            .header
            .iter()
            .enumerate()
            .filter(|(_, field)| field.trim_ascii() == name.as_bytes());
        let (index, _) = places.next()?;
        if places.next().is_some() {
            self.twice.push(name.into());
        }
        Some(Column {
            name: name.into(),
            index,
        })
    }

    /// A column that has a default: where it is not there, its name is noted.
    fn defaulted(&mut self, name: &'static str) -> Option<Column> {
        let found = self.optional(name);
        if found.is_none() {
            self.absent.push(name);
        }
        found
    }

    /// A column whose name differs from that of an absent one in capitals, blanks or signs alone, and that one: it would be
    /// left out silently.
    fn misspelt(&self) -> Option<(String, &'static str)> {
        let letters = |name: &[u8]| -> Vec<u8> {
            let letters = name.iter().filter(|byte| byte.is_ascii_alphanumeric());
            letters.map(u8::to_ascii_lowercase).collect()
        };
        self.header.iter().find_map(|field| {
            let meant = |name: &&&str| letters(field) == letters(name.as_bytes());
            let name = String::from_utf8_lossy(field.trim_ascii()).into_owned();
            self.absent.iter().find(meant).map(|meant| (name, *meant))
        })
    }

    /// A column that is missing is noted; what is returned for it is not used then.
    fn required(&mut self, name: &str) -> Column {
        self.optional(name).unwrap_or_else(|| {
            self.missing.push(name.into());
            Column {
                name: name.into(),
                index: 0,
            }
        })
    }

    fn leg(&mut self, leg: usize) -> LegColumns {
        let mut column = |quantity: &str| self.required(&format!("{quantity}_{leg}"));
        LegColumns {
            base: [column("ax"), column("ay")],
            proximal: column("z1"),
            distal: column("z2"),
            joint_radius: column("h"),
            joint_angle: column("lam"),
            elbow: column("sg"),
        }
    }

    /// The state if it is complete, otherwise the move; if neither is, the one that has more of
    /// its columns says which are missing.
    fn motion(&mut self) -> SetpointColumns {
        let has = |name: &&&str| {
            self.header
                .iter()
                .any(|f| f.trim_ascii() == name.as_bytes())
        };
        let state = STATE.iter().filter(has).count();
        let in_move = MOVE.iter().filter(has).count();
        let take_state = state == STATE.len()
            || (in_move < MOVE.len() && state * MOVE.len() >= in_move * STATE.len());
        if take_state {
            return SetpointColumns::State(STATE.map(|name| self.required(name)));
        }
        SetpointColumns::Move(MoveColumns {
            from: ["x0", "y0", "a0"].map(|name| self.required(name)),
            to: ["xf", "yf", "af"].map(|name| self.required(name)),
            duration: self.required("T"),
            time: self.required("t"),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn header(motion: &[&str], without: &str) -> ByteRecord {
        let legs = (1..=3).flat_map(|leg| {
            ["ax", "ay", "z1", "z2", "h", "lam", "sg"].map(|name| format!("{name}_{leg}"))
        });
        let rest = ["m", "I"]
            .iter()
            .chain(motion)
            .map(|name| (*name).to_string());
        let names: Vec<String> = legs.chain(rest).filter(|name| name != without).collect();
        ByteRecord::from(names)
    }

    #[test]
    fn other_separators_are_named() {
        for (header, word) in [("x;y;alpha", "semicolons"), ("x\ty", "tabs")] {
            let error = Columns::find(&ByteRecord::from(vec![header])).unwrap_err();
            assert!(error.contains(word), "{error}");
        }
        assert_eq!(other_separator("case"), None);
    }

    #[test]
    fn missing_columns_are_named() {
        for missing in ["z2_3", "m", "I", "alpha", "acx"] {
            let error = Columns::find(&header(&STATE, missing)).unwrap_err();
            assert_eq!(error, format!("column {missing} is missing"));
        }
        for missing in ["T", "t", "yf"] {
            let error = Columns::find(&header(&MOVE, missing)).unwrap_err();
            assert_eq!(error, format!("column {missing} is missing"));
        }
        let error = Columns::find(&header(&[], "")).unwrap_err();
        assert_eq!(
            error,
            "columns x, y, alpha, vx, vy, valpha, acx, acy, acalpha are missing"
        );
    }

    /// Without gravity, a row would have other torques, and no word about it.
    #[test]
    fn a_column_that_was_meant_otherwise_is_refused() {
        for (name, meant) in [("g_y", "gy"), (" GX", "gx"), ("W-a", "Wa"), ("m_l", "ml")] {
            let mut table = header(&STATE, "");
            table.push_field(name.as_bytes());
            let error = Columns::find(&table).unwrap_err();
            let name = name.trim();
            assert_eq!(
                error,
                format!("column {name} is not known; did you mean {meant}?")
            );
            // Beside the column itself it may hold what it wants.
            table.push_field(meant.as_bytes());
            assert!(Columns::find(&table).is_ok(), "{name}");
        }
    }

    #[test]
    fn the_state_goes_before_the_move_and_an_incomplete_state_behind_it() {
        let both: Vec<&str> = MOVE.iter().chain(&STATE).copied().collect();
        let columns = Columns::find(&header(&both, "")).unwrap();
        assert!(matches!(columns.motion, SetpointColumns::State(_)));
        let columns = Columns::find(&header(&both, "vx")).unwrap();
        assert!(matches!(columns.motion, SetpointColumns::Move(_)));
    }

    #[test]
    fn a_column_that_is_there_twice_is_refused() {
        let mut twice = header(&STATE, "");
        twice.push_field(b" z1_2 ");
        assert_eq!(
            Columns::find(&twice).unwrap_err(),
            "column z1_2 is there more than once"
        );
        let mut unknown_twice = header(&STATE, "");
        unknown_twice.push_field(b"note");
        unknown_twice.push_field(b"note");
        assert!(Columns::find(&unknown_twice).is_ok());
    }
}
