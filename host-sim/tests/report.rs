//! The report's copies in the documents are what the program prints.

use std::fs;
use std::path::Path;
use tempfile::TempDir;
use trirrr_host_sim::report::{Section, docs, write};

/// Figures whose every coordinate is an error or a count.
const FIGURES: [&str; 3] = [
    "numbers-massless.svg",
    "numbers-links.svg",
    "numbers-tool.svg",
];

#[test]
fn numerics_md_is_what_the_report_says() {
    let documents = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs");
    let folder = TempDir::new().unwrap();
    let report = write(&[Section::Numbers, Section::Extremes], folder.path()).unwrap();
    let document = fs::read_to_string(documents.join("numerics.md")).unwrap();
    let how = "refresh with: cargo run --release -- report --docs docs/numerics.md";
    let outdated = docs::outdated(&document, &report.blocks).unwrap();
    assert!(outdated.is_empty(), "{outdated:?}: {how}");
    assert!(report.blocks.len() >= 6, "{}", report.blocks.len());
    for figure in FIGURES {
        let drawn = fs::read(folder.path().join(figure)).unwrap();
        let shown = fs::read(documents.join("images").join(figure));
        assert!(shown.is_ok_and(|shown| shown == drawn), "{figure}: {how}");
        assert!(document.contains(&format!("(images/{figure})")), "{figure}");
    }
}
