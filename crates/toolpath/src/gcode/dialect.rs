//! Files of other dialects and formats, told by their lines: the user is to know the one reason, and not a code at a time.

/// Kind of a file that is not read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct ForeignDialect {
    /// Name of the dialect or format, with its users.
    pub(super) name: &'static str,
    /// Way to a file that is read.
    pub(super) remedy: &'static str,
}

/// Lines at the beginning of a file that are looked at.
pub(super) const LOOKED_AT: u32 = 200;

const GRBL: &str = "save the program for GRBL or LinuxCNC";

const MARLIN: ForeignDialect = dialect("G-code of 3D printers (Marlin)", GRBL);
const REPRAP: ForeignDialect = dialect("G-code of 3D printers (RepRap)", GRBL);
const SHOPBOT: ForeignDialect = dialect("a program for ShopBot machines", GRBL);
const ISEL: ForeignDialect = dialect("a program for isel machines (NCP)", GRBL);
const KLIPPER: ForeignDialect = dialect("G-code of 3D printers (Klipper)", GRBL);
const HEIDENHAIN: ForeignDialect = dialect("a program for Heidenhain controls", GRBL);
const SINUMERIK: ForeignDialect = dialect("a program for Siemens controls (Sinumerik)", GRBL);
const HPGL: ForeignDialect = dialect("HPGL, for plotters", "save the drawing as SVG or DXF");
const GERBER: ForeignDialect = dialect(
    "a Gerber file",
    "make G-code of it by a program such as FlatCAM",
);
const EXCELLON: ForeignDialect = dialect(
    "a drill file (Excellon)",
    "make G-code of it by a program such as FlatCAM",
);
const POSTSCRIPT: ForeignDialect = dialect("PostScript or PDF", "save the drawing as SVG or DXF");
const XML: ForeignDialect = dialect("XML", "name a drawing .svg");
const IMAGE: ForeignDialect = dialect("an image or an archive", "images are .png, .jpg or .bmp");

const fn dialect(name: &'static str, remedy: &'static str) -> ForeignDialect {
    ForeignDialect { name, remedy }
}

/// First words of files, with their formats.
const HEADS: [(&str, ForeignDialect); 18] = [
    ("GIF8", IMAGE),
    ("\u{89}PNG", IMAGE),
    ("PK\u{3}\u{4}", IMAGE),
    ("%PDF", POSTSCRIPT),
    ("%!PS", POSTSCRIPT),
    ("<?xml", XML),
    ("<svg", XML),
    ("%FSLA", GERBER),
    ("%FSTA", GERBER),
    ("%MOMM*%", GERBER),
    ("%MOIN*%", GERBER),
    ("\u{1b}%-", HPGL),
    ("\u{1b}.", HPGL),
    ("%_N_", SINUMERIK),
    ("BEGIN PGM", HEIDENHAIN),
    ("'SHOPBOT", SHOPBOT),
    ("IMF_PBL", ISEL),
    ("FASTABS", ISEL),
];

/// Codes that dialects have for themselves, by their numbers.
const PRINTERS_M: [u32; 24] = [
    82, 83, 84, 92, 104, 105, 106, 107, 109, 114, 115, 117, 140, 190, 201, 203, 204, 205, 220, 221,
    280, 300, 400, 420,
];
const REPRAP_M: [u32; 6] = [110, 111, 563, 569, 574, 906];

/// ForeignDialect that a line tells, and the words by which it does.
pub(super) fn told_by(text: &str) -> Option<(ForeignDialect, &str)> {
    let line = text.trim_start_matches('\u{feff}').trim();
    let upper = line.to_ascii_uppercase();
    let head = HEADS
        .iter()
        .find(|(head, _)| upper.starts_with(&head.to_ascii_uppercase()));
    if let Some((head, dialect)) = head {
        return Some((*dialect, line.get(..head.len()).unwrap_or(line)));
    }
    by_comment(line, &upper).or_else(|| {
        let words = line.split([';', '(']).next().unwrap_or_default().trim();
        by_words(words, &upper, line)
    })
}

/// Slicers sign their programs in a comment.
fn by_comment<'t>(line: &'t str, upper: &str) -> Option<(ForeignDialect, &'t str)> {
    let comment = upper.starts_with(';').then(|| line[1..].trim())?;
    let upper = upper[1..].trim_start();
    let dialect = match () {
        () if upper.starts_with("FLAVOR:REPRAP") => REPRAP,
        () if upper.starts_with("FLAVOR:KLIPPER") => KLIPPER,
        () if upper.starts_with("FLAVOR:GRBL") => return None,
        () if upper.starts_with("FLAVOR:") => MARLIN,
        () if upper.starts_with("$PATH=") => SINUMERIK,
        () if [
            "CURA_STEAMENGINE",
            "PRUSASLICER",
            "SLIC3R",
            "SUPERSLICER",
            "ORCASLICER",
            "SIMPLIFY3D",
        ]
        .iter()
        .any(|slicer| upper.contains(slicer)) =>
        {
            MARLIN
        }
        () => return None,
    };
    Some((dialect, comment))
}

fn by_words<'t>(words: &'t str, upper: &str, line: &'t str) -> Option<(ForeignDialect, &'t str)> {
    let numbered = words
        .trim_start_matches(|c: char| c.is_ascii_digit())
        .trim_start();
    let heidenhain = [
        "BEGIN PGM",
        "END PGM",
        "BLK FORM",
        "TOOL CALL",
        "TOOL DEF",
        "CYCL DEF",
        "LBL ",
        "CC X",
        "CC Y",
    ];
    let is_numbered = numbered.len() < words.len();
    let stands = numbered.to_ascii_uppercase();
    if heidenhain.iter().any(|word| stands.starts_with(word))
        || is_numbered
            && ["L ", "C ", "CC ", "CR ", "FN "]
                .iter()
                .any(|word| stands.starts_with(word))
    {
        return Some((HEIDENHAIN, words));
    }
    let first = words.split_whitespace().next().unwrap_or_default();
    let number = |letter: char| -> Option<u32> {
        let digits = first.strip_prefix([letter, letter.to_ascii_lowercase()])?;
        let end = digits
            .find(|c: char| !c.is_ascii_digit())
            .unwrap_or(digits.len());
        digits[..end].parse().ok()
    };
    // An asterisk ends each line: behind a number in programs of DIN/ISO for Heidenhain controls, else in Gerber files.
    if line.ends_with('*') || line.ends_with("*%") {
        let is_program = number('N').is_some() || upper.starts_with('%') && upper.contains(" G7");
        let dialect = if is_program { HEIDENHAIN } else { GERBER };
        return Some((dialect, line));
    }
    let behind_number = words.split_whitespace().nth(1).unwrap_or_default();
    if number('N').is_some() && !behind_number.is_empty() {
        let rest = words[first.len()..].trim_start();
        return by_words(rest, upper, line);
    }
    // HPGL has its instructions side by side, divided by semicolons.
    let hpgl = |text: &str| {
        let text = text.trim();
        [
            "IN", "DF", "PU", "PD", "PA", "PR", "SP", "VS", "IP", "SC", "LT",
        ]
        .iter()
        .any(|two| {
            text.strip_prefix(two).is_some_and(|rest| {
                rest.chars()
                    .all(|c| c.is_ascii_digit() || "-,. ".contains(c))
            })
        })
    };
    let mut parts = upper.split(';').filter(|part| !part.trim().is_empty());
    let is_hpgl =
        upper.contains(';') && parts.next().is_some_and(hpgl) && parts.next().is_none_or(hpgl);
    if is_hpgl {
        return Some((HPGL, line.split_inclusive(';').next().unwrap_or(line)));
    }
    let shopbot = ["J2,", "J3,", "M2,", "M3,", "JZ,", "MZ,", "MS,", "JS,"];
    if shopbot.iter().any(|word| upper.starts_with(word)) {
        return Some((SHOPBOT, words));
    }
    match number('M') {
        Some(48) if first.len() == 3 && words.len() == 3 => return Some((EXCELLON, first)),
        Some(code) if PRINTERS_M.contains(&code) => return Some((MARLIN, first)),
        Some(code) if REPRAP_M.contains(&code) => return Some((REPRAP, first)),
        _ => {}
    }
    if matches!(number('G'), Some(29)) {
        return Some((MARLIN, first));
    }
    // A word of the extruder, in a motion or in G92.
    let is_motion = matches!(number('G'), Some(0..=3 | 92));
    let extrudes = words.split_whitespace().skip(1).find(|word| {
        word.strip_prefix(['E', 'e'])
            .is_some_and(|rest| rest.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c)))
    });
    if let (true, Some(word)) = (is_motion, extrudes) {
        return Some((MARLIN, word));
    }
    if number('G') == Some(4)
        && words
            .split_whitespace()
            .skip(1)
            .any(|word| word.starts_with(['S', 's']))
    {
        return Some((MARLIN, words));
    }
    let klipper = [
        "SET_",
        "EXCLUDE_OBJECT",
        "START_PRINT",
        "END_PRINT",
        "BED_MESH_",
        "PRINT_START",
    ];
    if klipper.iter().any(|word| upper.starts_with(word)) {
        return Some((KLIPPER, first));
    }
    let sinumerik = [
        "MSG(",
        "CYCLE8",
        "DEF REAL",
        "DEF INT",
        "TRANS ",
        "G500",
        "WORKPIECE(",
        "STOPRE",
    ];
    (sinumerik.iter().any(|word| upper.starts_with(word))
        || words.contains("=AC(")
        || words.contains("=IC("))
    .then_some((SINUMERIK, first))
}
