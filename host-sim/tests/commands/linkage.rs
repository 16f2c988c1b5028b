//! `trirrr linkage`: printed text, files written, exit codes.

use std::path::{Path, PathBuf};
use std::process::Output;

/// The folder of the shipped files.
fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../linkages")
}

fn shipped_text(name: &str) -> String {
    let file = folder().join(name).with_extension("toml");
    std::fs::read_to_string(&file).unwrap_or_else(|e| panic!("{}: {e}", file.display()))
}

fn run(file: &Path, more: &[&str]) -> Output {
    crate::common::command(".", &[])
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

#[test]
fn the_summary_has_loops_dead_points_and_time_ratios() {
    let here = tempfile::tempdir().unwrap();
    let out = here.path().join("out");
    let output = run(
        &folder().join("shaper.toml"),
        &["--out", out.to_str().unwrap()],
    );
    let printed = text(&output.stdout);
    for line in [
        "4 links, 3 joints, 2 pins in slots; degrees of freedom 3 (4 - 1) - 2 * 3 - 2 = 1, drives 1\n",
        "loops    2 independent: 2 * 2 = 4 equations, 4 unknowns: ",
        // Twice asin(0.1 / 0.25), and what follows from it.
        "swing    lever 47.156 deg, ",
        "time ratio 1.7100\n",
        "stroke   guide 0.400000 m, ",
        "loops.svg",
    ] {
        assert!(printed.contains(line), "{line} in\n{printed}");
    }
    let output = run(
        &folder().join("tetrad.toml"),
        &["--out", out.to_str().unwrap()],
    );
    let printed = text(&output.stdout);
    assert!(printed.contains("Newton   group 2: at most "), "{printed}");
}

#[test]
fn the_summary_as_json_has_the_figures_in_si_units() {
    let here = tempfile::tempdir().unwrap();
    let out = here.path().join("out");
    let output = run(
        &folder().join("four-bar.toml"),
        &["--json", "--out", out.to_str().unwrap()],
    );
    assert_eq!(output.status.code(), Some(0));
    let found: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(found["freedoms"], 1);
    assert_eq!(found["unknowns"]["count"], 2);
    let chain = &found["crank_loops"][0];
    assert_eq!(chain["class"], "CrankRocker");
    // Stretched: ground 0.4, crank and coupler 0.45, rocker 0.25.
    let expected = ((0.4f64 * 0.4 + 0.45 * 0.45 - 0.25 * 0.25) / (2.0 * 0.4 * 0.45)).acos();
    let dead = chain["dead_points"].as_array().unwrap();
    let stretched = dead
        .iter()
        .find(|point| point["stretched"] == true)
        .unwrap();
    let angle = stretched["at"]["drives"]["O"].as_f64().unwrap();
    assert!((angle - expected).abs() < 1e-12, "{angle} {expected}");
    assert!(found["stopped"].is_null() && found["loads"].as_array().unwrap().is_empty());
}

#[test]
fn an_arm_has_its_inverse_and_other_linkages_have_none() {
    let here = tempfile::tempdir().unwrap();
    let out = here.path().join("out");
    let out = out.to_str().unwrap();
    let arm = folder().join("serial-arm.toml");
    let output = run(
        &arm,
        &[
            "--inverse-deg",
            "0.5,0.2,45",
            "--end-velocity",
            "0.1,0,1",
            "--json",
            "--out",
            out,
        ],
    );
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let found: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    for branch in found["branches"].as_array().unwrap() {
        let angles: Vec<f64> = branch["angles_rad"]
            .as_array()
            .unwrap()
            .iter()
            .map(|v| v.as_f64().unwrap())
            .collect();
        let lengths = [0.4, 0.3, 0.1];
        let (mut at, mut angle) = ([0.0, 0.0], 0.0f64);
        for (turn, length) in angles.iter().zip(lengths) {
            angle += turn;
            at = [at[0] + length * angle.cos(), at[1] + length * angle.sin()];
        }
        assert!(
            (at[0] - 0.5).abs() < 1e-15 && (at[1] - 0.2).abs() < 1e-15,
            "{at:?}"
        );
        assert!((angle - std::f64::consts::FRAC_PI_4).sin().abs() < 1e-15);
        assert_eq!(branch["torques_nm"].as_array().unwrap().len(), 3);
    }
    let table = std::fs::read_to_string(Path::new(out).join("inverse.csv")).unwrap();
    assert_eq!(
        table.lines().next().unwrap(),
        "elbow,q_S,q_E,q_W,dq_S,dq_E,dq_W,ddq_S,ddq_E,ddq_W,distance,residual,tau_S,tau_E,tau_W"
    );
    assert_eq!(table.lines().count(), 3);
    assert!(Path::new(out).join("inverse.svg").is_file());

    let refused = |file: &Path, more: &[&str], reason: &str| {
        let output = run(file, &[more, &["--out", out]].concat());
        assert_eq!(output.status.code(), Some(2));
        let said = text(&output.stderr);
        assert!(said.contains(reason), "{reason} in\n{said}");
        // The earlier results stay.
        assert!(Path::new(out).join("inverse.csv").is_file());
    };
    refused(
        &arm,
        &["--inverse-deg", "0.95,0,0"],
        "out of reach: the wrist would be 0.850000 m from the base, farther than the arm can; by 0.150000 m",
    );
    refused(&arm, &["--inverse-deg", "0.5,y,0"], "Y = `y` is no number");
    refused(
        &arm,
        &["--inverse-deg", "0.5,0,0", "--inverse-rad", "0.5,0,0"],
        "cannot be used with",
    );
    refused(
        &arm,
        &["--inverse-deg", "0.5,0,0", "--steps", "36"],
        "cannot be used with",
    );
    refused(
        &arm,
        &["--end-velocity", "1,0,0"],
        "--end-velocity belongs to --inverse-deg",
    );
    refused(
        &folder().join("four-bar.toml"),
        &["--inverse-rad", "0,0,0"],
        "four-bar.toml: no serial arm of three driven links",
    );
}
