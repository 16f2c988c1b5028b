//! Refusals of what cannot be solved: too many or too few joints or drives, locked parts, PPP,
//! missing guesses, branches where there are none.

use crate::refusals::{refusal, refused};
use crate::{pin, slide};

#[test]
fn degrees_of_freedom_with_their_numbers() {
    refused(
        "five-bar",
        "[[drive]]\njoint = \"C\"\nstart_rad = 3.0\nrate_rad_s = -10.0\n",
        "",
        "drive: under-constrained: degrees of freedom 3 (5 - 1) - 2 * 5 = 2, drives 1",
    );
    refused(
        "four-bar",
        "[[drive]]\n",
        "[[drive]]\njoint = \"C\"\nrate_rad_s = 1.0\n\n[[drive]]\n",
        "drive: over-constrained: degrees of freedom 3 (4 - 1) - 2 * 4 = 1, drives 2; the drive in \
         joint O ties links that the joints and drives before it leave no freedom for it: \
         frame, crank, coupler, rocker",
    );
    // A second rod between crank and rocker: a structure.
    refused(
        "four-bar",
        "[[drive]]\n",
        &(pin("X", ["frame.O", "coupler.P"]) + "[[drive]]\n"),
        "over-constrained: degrees of freedom 3 (4 - 1) - 2 * 5 = -1, drives 1; joint X ties",
    );
}

/// The count is right as a sum and wrong in its parts: one part locked, one loose.
#[test]
fn a_locked_part_beside_a_loose_one() {
    let link =
        |name: &str| format!("[[link]]\nname = \"{name}\"\nlength_m = 1\nends = [\"A\", \"B\"]\n");
    let more = [
        link("loose-1"),
        link("loose-2"),
        pin("L1", ["coupler.P", "loose-1.A"]),
        pin("L2", ["loose-1.B", "loose-2.A"]),
        pin("X", ["frame.O", "coupler.P"]),
        "[[drive]]\n".into(),
    ];
    refused(
        "four-bar",
        "[[drive]]\n",
        &more.concat(),
        "over-constrained in one part and under-constrained in another, although degrees of \
         freedom 3 (6 - 1) - 2 * 7 = 1 equal the drives: joint X ties",
    );
}

#[test]
fn three_prismatic_joints_are_no_group() {
    let text = r#"
name = "ppp"
[[link]]
name = "frame"
points_m = { O = [0, 0] }
[[link]]
name = "crank"
length_m = 1
ends = ["O", "A"]
[[link]]
name = "one"
points_m = { P = [0, 0] }
[[link]]
name = "two"
points_m = { P = [0, 0] }
"#;
    let joints = [
        pin("O", ["frame.O", "crank.O"]),
        slide("P1", "crank.A", "one.P", ""),
        slide("P2", "one.P", "two.P", "direction_rad = 1.0\n"),
        slide("P3", "frame.O", "two.P", "direction_rad = 2.0\n"),
    ];
    let drive = "[[drive]]\njoint = \"O\"\nrate_rad_s = 1\n";
    let said = refusal(&[text, &joints.concat(), drive].concat());
    assert!(
        said.starts_with("a.toml:31: joint[4]: PPP, which is no Assur group: "),
        "{said}"
    );
    assert!(
        said.contains("around the joints O, P1, P2, P3 nothing can turn"),
        "{said}"
    );
}

#[test]
fn branches_and_guesses_where_they_are_needed_or_make_no_sense() {
    refused(
        "four-bar",
        "name = \"A\"\nkind = \"revolute\"",
        "name = \"A\"\nbranch = 1\nkind = \"revolute\"",
        "joint[2].branch = 1: the joint is not between the two links of a dyad",
    );
    refused(
        "scotch-yoke",
        "name = \"slot\"",
        "name = \"slot\"\nbranch = -1",
        "there is no branch to choose",
    );
    refused(
        "stephenson",
        "guess = { at_m = [0.08, 0.24], angle_rad = 0.0 }\n",
        "",
        "link[4].guess: missing: the links rod, coupler, left-rocker, right-rocker are no dyad",
    );
    refused(
        "four-bar",
        "B = [0.35, 0.0]",
        "B = [0.0, 0.0]",
        "link[3]: both joints of the link are at one point",
    );
}
