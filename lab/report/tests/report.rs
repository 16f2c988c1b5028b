//! The report's copies in the documents are what the program prints.

use std::fs;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use trirrr_report::{Report, ReportSection, docs, measure};

/// Content of a file of the report.
fn content<'r>(report: &'r Report, name: &str) -> &'r [u8] {
    let file = report.files.iter().find(|file| file.name == name);
    &file.unwrap().content
}

/// Figures whose every coordinate is an error or a count.
const FIGURES: [&str; 7] = [
    "edges-links.svg",
    "edges-serial.svg",
    "edges-base.svg",
    "edges-parallel.svg",
    "numbers-massless.svg",
    "numbers-links.svg",
    "numbers-tool.svg",
];

#[test]
fn numerics_md_is_what_the_report_says() {
    let documents = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs");
    let most = AtomicUsize::new(0);
    let report = measure(
        &[ReportSection::Numbers, ReportSection::Extremes],
        &|done, steps| {
            assert!(done <= steps);
            most.fetch_max(1000 * steps + done, Ordering::Relaxed);
        },
    )
    .unwrap();
    // All steps are counted.
    let most = most.into_inner();
    assert!(most > 1000 && most / 1000 == most % 1000, "{most}");
    let document = fs::read_to_string(documents.join("numerics.md")).unwrap();
    let how = "refresh with: cargo run --release -- report --docs docs/numerics.md";
    let outdated = docs::outdated(&document, &report.blocks).unwrap();
    assert!(outdated.is_empty(), "{outdated:?}: {how}");
    assert!(report.blocks.len() >= 6, "{}", report.blocks.len());
    for figure in FIGURES {
        let drawn = content(&report, figure);
        let shown = fs::read(documents.join("images").join(figure));
        assert!(shown.is_ok_and(|shown| shown == drawn), "{figure}: {how}");
        assert!(document.contains(&format!("(images/{figure})")), "{figure}");
    }
}

/// Errors and counts of the study of integrators; times are those of one machine.
#[test]
#[ignore = "minutes unless optimised; cargo xtask ci runs it so"]
fn numerics_md_is_what_the_study_of_integrators_says() {
    let report = measure(&[ReportSection::WorkPrecision], &|_, _| {}).unwrap();
    let document = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/numerics.md");
    let document = fs::read_to_string(document).unwrap();
    let outdated = docs::outdated(&document, &report.blocks).unwrap();
    let how = "refresh with: cargo run --release -- report --docs docs/numerics.md";
    assert!(outdated.is_empty(), "{outdated:?}: {how}");
    check_runs(content(&report, "work-precision.csv"));
    let compared = report.blocks.iter().filter(|block| block.reproducible);
    assert_eq!(compared.count(), 2);
}

/// No run of the study hangs, for this is reached; each has an error or names why it ended early.
fn check_runs(file: &[u8]) {
    let mut runs = csv::Reader::from_reader(file);
    let mut count = 0;
    for run in runs.records() {
        let run = run.unwrap();
        let (error, ended) = (&run[4], &run[7]);
        let known = error.parse().is_ok_and(|error: f64| error.is_finite());
        assert!(known || !ended.is_empty(), "{run:?}");
        assert!(!run.iter().any(|field| field.contains("NaN")), "{run:?}");
        count += 1;
    }
    assert!(count > 150, "{count}");
}

/// Largest difference of two derivations, relative to torques and forces.
const SAME: f64 = 1e-12;

#[test]
fn the_core_and_the_equations_of_lagrange_agree_for_every_machine_of_the_source() {
    let report = measure(&[ReportSection::Lagrange], &|_, _| {}).unwrap();
    let mut rows = csv::Reader::from_reader(content(&report, "lagrange.csv"));
    let rows: Vec<csv::StringRecord> = rows.records().map(Result::unwrap).collect();
    let names: Vec<&str> = rows.iter().map(|row| &row[0]).collect();
    let machines = ["4-RRR", "6-RRR", "PRRR+2RRR", "2PRRR+RRR", "3PRRR"];
    assert_eq!(names[..3], ["3-RRR"; 3]);
    assert_eq!(names[3..], machines);
    for row in &rows {
        assert_eq!([&row[2], &row[3]], ["101", "100"], "{row:?}");
        let torque: f64 = row[5].parse().unwrap();
        assert!(torque > 0.0 && torque <= SAME, "{row:?}");
        if row[0].contains('P') {
            let force: f64 = row[6].parse().unwrap();
            assert!(force > 0.0 && force <= SAME, "{row:?}");
        }
    }
    let document = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/lagrange.md");
    let document = fs::read_to_string(document).unwrap();
    let outdated = docs::outdated(&document, &report.blocks).unwrap();
    let how =
        "refresh with: cargo run --release -- report --section lagrange --docs docs/lagrange.md";
    assert!(outdated.is_empty(), "{outdated:?}: {how}");
}
