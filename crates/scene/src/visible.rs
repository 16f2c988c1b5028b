//! Text from files, boards and lines, made harmless for a terminal.

use std::borrow::Cow;

/// Returns `text` on one line, with the characters that a terminal obeys replaced by their escapes, such as `\u{1b}`.
///
/// Those are the control characters of ASCII and Latin-1, and what turns the direction of writing, breaks a line or is not seen.
/// A name or a description that a stranger wrote shows all of itself, and commands nothing.
///
/// ```
/// use trirrr_scene::visible;
///
/// assert_eq!(visible("\u{1b}[31mred"), "\\u{1b}[31mred");
/// assert_eq!(visible("Pick and place, 40 µm"), "Pick and place, 40 µm");
/// ```
pub fn visible(text: &str) -> Cow<'_, str> {
    escaped(text, is_obeyed)
}

/// Returns `text` as [`visible`] does, and keeps its ends of lines: for a message of several lines.
pub fn visible_lines(text: &str) -> Cow<'_, str> {
    escaped(text, |c| c != '\n' && is_obeyed(c))
}

fn escaped(text: &str, is_escaped: impl Fn(char) -> bool) -> Cow<'_, str> {
    if !text.contains(&is_escaped) {
        return Cow::Borrowed(text);
    }
    let mut shown = String::with_capacity(text.len());
    for c in text.chars() {
        match is_escaped(c) {
            true => shown.extend(c.escape_unicode()),
            false => shown.push(c),
        }
    }
    Cow::Owned(shown)
}

/// Returns true for the controls C0, C1 and DEL, separators of lines, marks of the direction of writing, and characters without a
/// width.
fn is_obeyed(c: char) -> bool {
    c.is_control()
        || matches!(
            c,
            '\u{ad}'
                | '\u{61c}'
                | '\u{180e}'
                | '\u{200b}'..='\u{200f}'
                | '\u{2028}'..='\u{202e}'
                | '\u{2060}'..='\u{206f}'
                | '\u{feff}'
                | '\u{fff9}'..='\u{fffb}'
                | '\u{e0000}'..='\u{e007f}'
        )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_control_is_shown_and_none_is_left() {
        let controls = (0..0x20).chain(0x7f..0xa0);
        let hostile: String = controls.filter_map(char::from_u32).collect();
        assert_eq!(hostile.chars().count(), 32 + 33);
        let shown = visible(&hostile);
        assert!(
            shown.bytes().all(|byte| (0x20..0x7f).contains(&byte)),
            "{shown}"
        );
        assert!(
            shown.starts_with("\\u{0}\\u{1}") && shown.ends_with("\\u{9f}"),
            "{shown}"
        );
        assert_eq!(visible_lines("a\nb\r\n"), "a\nb\\u{d}\n");
    }

    #[test]
    fn the_direction_of_writing_is_not_turned() {
        assert_eq!(
            visible("a\u{202e}b\u{2066}c\u{feff}"),
            "a\\u{202e}b\\u{2066}c\\u{feff}"
        );
    }

    #[test]
    fn words_of_any_language_stay() {
        for text in [
            "",
            "Größe: 40 µm",
            "\u{65e5}\u{672c}",
            "it's a \"quote\" \\ slash",
        ] {
            assert!(matches!(visible(text), Cow::Borrowed(same) if same == text));
        }
    }
}
