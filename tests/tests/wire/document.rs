//! `docs/wire.md`, read by its headings and tables.

use std::path::PathBuf;
use std::sync::Mutex;

/// Set, the parts that the code writes are written into the document instead of compared with it.
const BLESS: &str = "TRIRRR_BLESS";

/// Tests run side by side; each writes its part into what the others have written.
static WRITING: Mutex<()> = Mutex::new(());

fn path() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../docs/wire.md")
}

pub(crate) fn text() -> String {
    let path = path();
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The cells of the table under the heading `### name`, without its head, code marks taken off.
pub(crate) fn table(text: &str, name: &str) -> Vec<Vec<String>> {
    let heading = format!("\n### {name}\n");
    let start = text
        .find(&heading)
        .unwrap_or_else(|| panic!("docs/wire.md has no heading `### {name}`"));
    let section = &text[start + heading.len()..];
    let section = &section[..section.find("\n#").unwrap_or(section.len())];
    let rows = section.lines().filter(|line| line.starts_with('|'));
    rows.skip(2)
        .map(|row| {
            let cells = row.trim_matches('|').split('|');
            cells.map(|cell| cell.trim().replace('`', "")).collect()
        })
        .collect()
}

/// Compares what stands between the lines `from` and `to` with `expected`.
pub(crate) fn compare(from: &str, to: &str, expected: &str) {
    let _writing = WRITING.lock();
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
