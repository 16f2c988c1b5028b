//! Lines of goals.

use std::io::{self, BufRead};
use std::sync::mpsc::{Receiver, channel};

/// Reads lines on a thread of its own: a read cannot be waited for in pieces. The thread ends with the program.
pub(super) fn listen(
    lines: impl FnOnce() -> Box<dyn BufRead> + Send + 'static,
) -> Receiver<String> {
    let (sender, receiver) = channel();
    std::thread::spawn(move || {
        for line in lines().lines() {
            let Ok(line) = line else { return };
            if sender.send(line).is_err() {
                return;
            }
        }
    });
    receiver
}

/// Standard input.
pub(super) fn standard_input() -> Box<dyn BufRead> {
    Box::new(io::BufReader::new(io::stdin()))
}

/// Numbers with commas or blanks between. None if one is none.
pub(super) fn numbers(text: &str) -> Option<Vec<f64>> {
    let parts = text.split(|c: char| c == ',' || c.is_whitespace());
    let parts = parts.filter(|part| !part.is_empty());
    let numbers: Option<Vec<f64>> = parts.map(|part| part.parse().ok()).collect();
    numbers.filter(|numbers| numbers.iter().all(|number: &f64| number.is_finite()))
}

/// Returns true for a line without a goal: empty, a comment or a heading.
pub(super) fn is_skipped(line: &str) -> bool {
    let first = line.trim().chars().next();
    first.is_none_or(|c| c == '#' || c.is_alphabetic())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_stand_between_commas_or_blanks() {
        assert_eq!(numbers("0.2, -0.1 1e-3"), Some(vec![0.2, -0.1, 1e-3]));
        assert_eq!(numbers(""), Some(vec![]));
        assert_eq!(numbers("0.2 x"), None);
        assert_eq!(numbers("0.2 inf"), None);
    }

    #[test]
    fn headings_and_comments_are_no_goals() {
        assert!(is_skipped("x_m,y_m") && is_skipped(" # late") && is_skipped("  "));
        assert!(!is_skipped("0.2 0.2") && !is_skipped("-0.1,0.2"));
    }
}
