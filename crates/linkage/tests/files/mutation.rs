//! Random edits of the shipped files: refused or followed, never a panic, never a number that is
//! none.

use crate::shipped_text;
use proptest::prelude::*;
use trirrr_linkage::assur::{Linkage, files, track};

const FILES: [&str; 5] = [
    "fairbairn",
    "quick-return-slotted",
    "scotch-yoke",
    "serial-arm",
    "stephenson",
];

/// What a number is replaced by.
const NUMBERS: [&str; 14] = [
    "0", "0.0", "-1", "1", "1e-9", "1e6", "-1e6", "1e300", "nan", "inf", "-0.3", "0.25", "3", "7e5",
];

#[derive(Clone, Debug)]
enum Edit {
    /// The n-th number becomes another.
    Number(usize, usize),
    /// The n-th line goes.
    Drop(usize),
    /// The n-th line comes twice.
    Double(usize),
    /// Two lines change places.
    Swap(usize, usize),
    /// A character is written over.
    Character(usize, char),
}

fn edit() -> impl Strategy<Value = Edit> {
    let at = any::<usize>;
    prop_oneof![
        4 => (at(), at()).prop_map(|(n, value)| Edit::Number(n, value)),
        1 => at().prop_map(Edit::Drop),
        1 => at().prop_map(Edit::Double),
        1 => (at(), at()).prop_map(|(a, b)| Edit::Swap(a, b)),
        1 => (at(), any::<char>()).prop_map(|(n, c)| Edit::Character(n, c)),
    ]
}

fn apply(text: &str, edit: &Edit) -> String {
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let count = lines.len().max(1);
    match edit {
        Edit::Number(n, value) => {
            let is_number = |c: char| c.is_ascii_digit() || matches!(c, '.' | '-' | 'e');
            let starts: Vec<usize> = text
                .char_indices()
                .zip(std::iter::once(' ').chain(text.chars()))
                .filter(|((_, c), before)| c.is_ascii_digit() && matches!(before, ' ' | '[' | '-'))
                .map(|((at, _), _)| at)
                .collect();
            if starts.is_empty() {
                return text.to_owned();
            }
            let start = starts[n % starts.len()];
            let length = text[start..].find(|c| !is_number(c)).unwrap_or(0);
            let number = NUMBERS[value % NUMBERS.len()];
            return format!("{}{number}{}", &text[..start], &text[start + length..]);
        }
        Edit::Drop(n) => {
            lines.remove(n % count);
        }
        Edit::Double(n) => lines.insert(n % count, lines[n % count].clone()),
        Edit::Swap(a, b) => lines.swap(a % count, b % count),
        Edit::Character(n, c) => {
            let chars: Vec<char> = text.chars().collect();
            let at = n % chars.len().max(1);
            let written = chars.iter().enumerate();
            return written
                .map(|(i, old)| if i == at { *c } else { *old })
                .collect();
        }
    }
    lines.join("\n")
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]

    #[test]
    fn edited_files_are_refused_or_followed(
        file in 0..FILES.len(),
        edits in prop::collection::vec(edit(), 1..4),
    ) {
        let mut text = shipped_text(FILES[file]);
        for edit in &edits {
            text = apply(&text, edit);
        }
        match Linkage::parse(&text, "edited.toml") {
            Err(error) => {
                let message = error.to_string();
                prop_assert!(message.lines().all(|line| line.starts_with("edited.toml:")));
            }
            Ok(mut linkage) => {
                linkage.motion.steps = linkage.motion.steps.min(12);
                let track = track(&linkage);
                prop_assert!(track.stop.is_some() || track.positions.len() > 1);
                for position in &track.positions {
                    for state in &position.states {
                        prop_assert!(state.motion.is_finite() && state.angle.is_finite());
                    }
                }
                if !track.positions.is_empty() {
                    let drawn = files(&linkage, &track).filter(|(_, drawn)| drawn.is_ok());
                    prop_assert!(drawn.count() >= 4);
                }
            }
        }
    }
}
