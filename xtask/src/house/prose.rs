//! Documentation blocks that open with a question word: a reader looks for a statement.

use super::source::Source;

/// Words that no documentation block opens with.
const QUESTIONS: [&str; 7] = ["what", "whether", "where", "how", "why", "which", "who"];

/// `FILE:LINE: first line` of each block that opens with a question word.
pub(super) fn questions(sources: &[Source]) -> Vec<String> {
    let mut found = Vec::new();
    for source in sources {
        let before = std::iter::once("").chain(source.text.lines());
        for (line, (before, text)) in (1..).zip(before.zip(source.text.lines())) {
            if let (None, Some(first)) = (documentation(before), documentation(text))
                && is_question(first)
            {
                found.push(format!("{}:{line}: {first}", source.path.display()));
            }
        }
    }
    found
}

/// Text of a line of documentation. Four slashes are a plain comment.
fn documentation(line: &str) -> Option<&str> {
    let line = line.trim_start();
    let text = line.strip_prefix("///").or(line.strip_prefix("//!"))?;
    (!text.starts_with('/')).then(|| text.trim())
}

fn is_question(first: &str) -> bool {
    let word = first.split(|c: char| !c.is_alphabetic()).next();
    word.is_some_and(|word| QUESTIONS.contains(&word.to_lowercase().as_str()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_block_is_known_by_its_first_word() {
        let text = "//! Room.\n//! What follows is no opening.\n\n/// Whether.\nfn a() {}\n//// What\n/// Whatever.\n";
        let source = Source {
            path: "a.rs".into(),
            text: text.into(),
            syntax: syn::parse_file("").expect("Rust"),
        };
        assert_eq!(questions(&[source]), ["a.rs:4: Whether."]);
    }
}
