//! Text of a DXF file: letters and ends of lines of every system, and what other programs leave out.

use encoding_rs::{UTF_8, WINDOWS_1252};
use std::borrow::Cow;
use std::fmt::Write as _;

/// Text of a file: in UTF-8 or UTF-16 by its mark, in UTF-8, or else in the letters of western Europe; lines end with a line feed.
pub(super) fn text_of(bytes: &[u8]) -> Cow<'_, str> {
    let text = match encoding_rs::Encoding::for_bom(bytes) {
        Some((encoding, _)) => encoding.decode(bytes).0,
        None => UTF_8
            .decode_without_bom_handling_and_without_replacement(bytes)
            .unwrap_or_else(|| WINDOWS_1252.decode(bytes).0),
    };
    // DOS ends a text with Ctrl-Z.
    let text = match text.find('\u{1a}') {
        Some(end) => Cow::Owned(text[..end].to_owned()),
        None => text,
    };
    match text.contains('\r') {
        true => Cow::Owned(
            text.replace("\r\r\n", "\n")
                .replace("\r\n", "\n")
                .replace('\r', "\n"),
        ),
        false => text,
    }
}

/// The text with a height of 0 for points of splines without one: the library leaves such points out.
pub(super) fn with_heights(text: &str) -> Cow<'_, str> {
    let mut lines = text.lines();
    let mut added = String::new();
    let mut is_spline = false;
    // Code of the height that is to follow.
    let mut due: Option<i32> = None;
    // End of what is in `added`.
    let (mut copied, mut at) = (0, 0);
    while let (Some(first), Some(second)) = (lines.next(), lines.next()) {
        let code: i32 = first.trim().parse().unwrap_or(-1);
        if let Some(height) = due.take().filter(|height| *height != code) {
            added.push_str(&text[copied..at]);
            // Writing to a String does not fail.
            let _ = write!(added, "{height}\n0\n");
            copied = at;
        }
        if code == 0 {
            is_spline = second.trim() == "SPLINE";
        } else if is_spline && matches!(code, 20 | 21) {
            due = Some(code + 10);
        }
        at = (at + first.len() + second.len() + 2).min(text.len());
    }
    match copied {
        0 => Cow::Borrowed(text),
        _ => {
            added.push_str(&text[copied..]);
            Cow::Owned(added)
        }
    }
}
