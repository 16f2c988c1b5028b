//! `trirrr linkage`: printed text, files written, exit codes.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// The folder of the shipped files.
fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../linkages")
}

fn shipped_text(name: &str) -> String {
    let file = folder().join(name).with_extension("toml");
    std::fs::read_to_string(&file).unwrap_or_else(|e| panic!("{}: {e}", file.display()))
}

fn run(file: &Path, more: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_trirrr"))
        .arg("linkage")
        .arg(file)
        .args(more)
        .output()
        .expect("trirrr starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("UTF-8")
}

#[test]
fn prints_the_groups_and_writes_table_and_figures() {
    let out = tempfile::tempdir().unwrap();
    let there = out.path().join("new/folder");
    let more = ["--steps", "36", "--out", there.to_str().unwrap()];
    let output = run(&folder().join("two-loop.toml"), &more);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let printed = text(&output.stdout);
    for line in [
        "6 links, 7 joints; degrees of freedom 3 (6 - 1) - 2 * 7 = 1, drives 1\n",
        "groups in solving order:\n\
         \x20 1  driven link  crank in O\n\
         \x20 2  dyad RRR     coupler, rocker by A, B, D\n\
         \x20 3  dyad RPR     upper, lower by P, slide, Q\n",
        "solved   37 of 37 positions",
    ] {
        assert!(printed.contains(line), "{line} in\n{printed}");
    }
    let table = std::fs::read_to_string(there.join("linkage.csv")).unwrap();
    let mut lines = table.lines();
    assert_eq!(
        lines.next().unwrap(),
        "t,q_O,th_crank,dth_crank,ddth_crank,th_coupler,dth_coupler,ddth_coupler,th_rocker,\
         dth_rocker,ddth_rocker,th_upper,dth_upper,ddth_upper,th_lower,dth_lower,ddth_lower,\
         s_slide,ds_slide,dds_slide,x_coupler.P,y_coupler.P,vx_coupler.P,vy_coupler.P,\
         ax_coupler.P,ay_coupler.P"
    );
    let rows: Vec<Vec<f64>> = lines
        .map(|row| row.split(',').map(|field| field.parse().unwrap()).collect())
        .collect();
    assert_eq!(rows.len(), 37);
    assert!(
        rows.iter()
            .all(|row| row.len() == 26 && row.iter().all(|v| v.is_finite()))
    );
    for figure in ["mechanism.svg", "links.svg", "points.svg", "polygons.svg"] {
        let svg = std::fs::read_to_string(there.join(figure)).unwrap();
        assert!(
            svg.starts_with("<svg") && svg.ends_with("</svg>\n"),
            "{figure}"
        );
        assert!(printed.contains(figure));
    }
}

#[test]
fn a_refused_file_exits_with_2_and_writes_nothing() {
    let here = tempfile::tempdir().unwrap();
    let file = here.path().join("bad.toml");
    std::fs::write(
        &file,
        shipped_text("four-bar").replace("length_m = 0.1", "length_m = -1"),
    )
    .unwrap();
    let out = here.path().join("out");
    let output = run(&file, &["--out", out.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(2));
    let said = text(&output.stderr);
    assert!(said.contains("bad.toml:"), "{said}");
    assert!(
        said.contains("link[2].length_m = -1: must be greater than 0 (m)"),
        "{said}"
    );
    assert!(output.stdout.is_empty() && !out.exists());
    let missing = run(&here.path().join("none.toml"), &[]);
    assert_eq!(missing.status.code(), Some(2));
    assert!(text(&missing.stderr).contains("none.toml: cannot be read"));
}

#[test]
fn a_motion_with_an_end_exits_with_1_and_leaves_what_there_was() {
    let here = tempfile::tempdir().unwrap();
    let file = here.path().join("rocking.toml");
    let longer = shipped_text("four-bar").replace("length_m = 0.1\n", "length_m = 0.3\n");
    std::fs::write(&file, longer).unwrap();
    let output = run(&file, &["--out", here.path().join("out").to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(1));
    let said = text(&output.stderr);
    assert!(said.contains("four-bar: stopped at O = "), "{said}");
    assert!(
        said.contains("group 2 (dyad RRR; coupler, rocker) cannot be assembled"),
        "{said}"
    );
    let table = std::fs::read_to_string(here.path().join("out/linkage.csv")).unwrap();
    assert!((2..361).contains(&table.lines().count()));
}
