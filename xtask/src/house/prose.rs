//! Documentation blocks and the words that they open with.

use super::source::Source;

/// Words that no documentation block opens with: a reader looks for a statement.
const QUESTIONS: [&str; 7] = ["what", "whether", "where", "how", "why", "which", "who"];

/// Documentation blocks of all items, public or not.
pub(super) struct Prose {
    pub(super) blocks: usize,
    /// `FILE:LINE: first line` of each block that opens with a question word.
    pub(super) openers: Vec<String>,
}

pub(super) fn measure(sources: &[Source]) -> Prose {
    let mut prose = Prose {
        blocks: 0,
        openers: Vec::new(),
    };
    for source in sources {
        for (line, first) in openings(&source.text) {
            prose.blocks += 1;
            if is_question(first) {
                let place = source.path.display();
                prose.openers.push(format!("{place}:{line}: {first}"));
            }
        }
    }
    prose
}

/// Line number, from 1, and first line of each block: of lines in a row that begin with `///` or `//!`.
fn openings(text: &str) -> Vec<(usize, &str)> {
    let mut found = Vec::new();
    let mut inside = false;
    for (line, words) in text.lines().enumerate() {
        let words = words.trim_start();
        let comment = ["///", "//!"]
            .iter()
            .find_map(|mark| words.strip_prefix(mark));
        // Four slashes are a plain comment.
        let comment = comment.filter(|rest| !rest.starts_with('/'));
        if let (false, Some(first)) = (inside, comment) {
            found.push((line + 1, first.trim()));
        }
        inside = comment.is_some();
    }
    found
}

fn is_question(first: &str) -> bool {
    let word = first
        .split(|c: char| !c.is_alphabetic())
        .next()
        .unwrap_or_default();
    QUESTIONS.contains(&word.to_lowercase().as_str())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_block_is_known_by_its_first_line() {
        let text = "//! Room.\n//! What follows is no opening.\n\n/// Whether.\nfn a() {}\n//// not docs\n";
        assert_eq!(openings(text), [(1, "Room."), (4, "Whether.")]);
    }

    #[test]
    fn a_question_is_a_whole_word() {
        for (first, question) in [
            ("What it says.", true),
            ("Who's there", true),
            ("Whatever is left.", false),
            ("Somewhat slower.", false),
            ("`how` in a file.", false),
        ] {
            assert_eq!(is_question(first), question, "{first}");
        }
    }
}
