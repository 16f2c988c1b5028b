//! `docs/wire.md`, between lines of it.

use std::path::PathBuf;

/// Set, the parts that the code writes are written into the document instead of compared with it.
const BLESS: &str = "TRIRRR_BLESS";

fn path() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../docs/wire.md")
}

pub(crate) fn text() -> String {
    let path = path();
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Compares what stands between the lines `from` and `to` with `expected`.
pub(crate) fn compare(from: &str, to: &str, expected: &str) {
    let text = text();
    let begin = text.find(from).expect(from) + from.len();
    let end = begin + text[begin..].find(to).expect(to);
    if text[begin..end] == *expected {
        return;
    }
    assert!(
        std::env::var_os(BLESS).is_some(),
        "docs/wire.md does not say what the code does; with {BLESS}=1 this test writes it. \
         Expected after {from:?}:\n{expected}"
    );
    let blessed = [&text[..begin], expected, &text[end..]].concat();
    std::fs::write(path(), blessed).expect("docs/wire.md can be written");
}
