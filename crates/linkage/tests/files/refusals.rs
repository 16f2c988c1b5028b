//! Refusals of single keys, with line, key, value and reason.

use crate::shipped_text;
use trirrr_linkage::assur::Linkage;

pub(crate) fn refusal(text: &str) -> String {
    match Linkage::parse(text, "a.toml") {
        Ok(linkage) => panic!("{} was not refused:\n{text}", linkage.name),
        Err(error) => error.to_string(),
    }
}

/// The shipped file with `from` replaced, which must be in it, is refused with `reason`.
pub(crate) fn refused(file: &str, from: &str, to: &str, reason: &str) {
    let text = shipped_text(file);
    assert!(text.contains(from), "{from:?} is not in {file}");
    let text = text.replacen(from, to, 1);
    let said = refusal(&text);
    assert!(said.contains(reason), "{reason:?} is not in\n{said}");
    // Where there is a value, its line has it.
    for line in said.lines() {
        let rest = line.strip_prefix("a.toml:").expect("the file's name");
        let (number, _) = rest.split_once(':').expect("a line number");
        let number: usize = number.parse().expect("a line number");
        assert!((1..=text.lines().count() + 1).contains(&number), "{line}");
    }
}

#[test]
fn lines_keys_and_values_are_named() {
    let text = "name = \"x\"\n[[link]]\nname = \"a b\"\nlength_m = -2\nends = [\"A\", \"B\"]\n";
    let said = refusal(text);
    assert!(
        said.contains("a.toml:2: link: expected 2 to 100 tables"),
        "{said}"
    );
    let said =
        refusal(&shipped_text("four-bar").replace("rate_rad_s = 10.0", "rate_rad_s = \"x\""));
    assert!(said.starts_with("a.toml:"), "{said}");
    assert!(
        said.contains("drive[1].rate_rad_s = \"x\": expected a number in rad/s, found a string"),
        "{said}"
    );
    // All that is wrong is said at once.
    let both = shipped_text("four-bar")
        .replace("length_m = 0.1\n", "length_m = 0\n")
        .replace("length_m = 0.25\n", "length_m = true\n");
    assert_eq!(refusal(&both).lines().count(), 2);
}

#[test]
fn the_file_as_a_whole() {
    refused("four-bar", "name = \"four-bar\"", "name = ", "not TOML");
    refused(
        "four-bar",
        "name = \"four-bar\"",
        "name = \"a/b\"",
        "for it names a folder",
    );
    refused("four-bar", "trace = [", "paths = [", "unknown key");
    refused(
        "four-bar",
        "trace = [\"coupler.P\"]",
        "trace = [\"coupler.X\"]",
        "no point `X`",
    );
    refused(
        "four-bar",
        "trace = [\"coupler.P\"]",
        "trace = 3",
        "expected an array of strings",
    );
    refused(
        "four-bar",
        "trace = [\"coupler.P\"]",
        "trace = [\"coupler.P\", \"coupler.P\"]",
        "listed twice",
    );
}

#[test]
fn links() {
    let four_bar = |from, to, reason| refused("four-bar", from, to, reason);
    four_bar(
        "name = \"crank\"",
        "name = \"coupler\"",
        "another link of this name",
    );
    four_bar("name = \"crank\"", "name = \"a.b\"", "letters, digits");
    four_bar("name = \"crank\"\n", "", "missing, expected a string");
    four_bar(
        "length_m = 0.1\n",
        "length_m = 0\n",
        "must be greater than 0 (m)",
    );
    four_bar(
        "length_m = 0.1\n",
        "length_m = 2e6\n",
        "must be at most 1000000 (m)",
    );
    four_bar(
        "ends = [\"O\", \"A\"]",
        "ends = [\"O\", \"O\"]",
        "two different names",
    );
    four_bar(
        "ends = [\"O\", \"A\"]",
        "ends = [\"O\"]",
        "two different names",
    );
    four_bar(
        "ends = [\"O\", \"A\"]",
        "ends = [\"O\", \"A\"]\npoints_m = { A = [0, 0] }",
        "`A` is in points_m too",
    );
    four_bar("B = [0.35, 0.0]", "B = [0.35]", "expected [x, y]");
    four_bar(
        "B = [0.35, 0.0]",
        "B = [0.35, nan]",
        "must be a finite number",
    );
    four_bar(
        "B = [0.35, 0.0]",
        "B = [0.35, 1e7]",
        "within 1000000 of the origin",
    );
    four_bar(
        "B = [0.35, 0.0]",
        "\"B b\" = [0.35, 0.0]",
        "letters, digits",
    );
    four_bar("points_m = { O", "points_cm = { O", "unknown key");
    four_bar(
        "points_m = { A = [0.0, 0.0], B = [0.35, 0.0], P = [0.2, 0.12] }",
        "points_m = {}",
        "a link needs a point",
    );
    four_bar(
        "C = [0.4, 0.0] }",
        "C = [0.4, 0.0] }\nguess = { angle_rad = 0 }",
        "the first link is the frame",
    );
    let guess = "guess = { at_m = [0.45, 0.0], angle_rad = 0.0 }";
    refused("slider-crank", guess, "guess = 1", "expected a table");
    refused(
        "slider-crank",
        guess,
        "guess = { at_m = [1, 2] }",
        "missing, expected a number in rad",
    );
    refused(
        "slider-crank",
        guess,
        "guess = { angle_rad = 1e3 }",
        "must be from -100 to 100",
    );
    refused(
        "slider-crank",
        guess,
        "guess = { at_m = [1e7, 0], angle_rad = 0 }",
        "within 1000000 of the origin",
    );
}

#[test]
fn joints() {
    let four_bar = |from, to, reason| refused("four-bar", from, to, reason);
    four_bar(
        "[[joint]]\nname = \"A\"",
        "[[joint]]\nname = \"O\"",
        "another joint of this name",
    );
    four_bar(
        "[[joint]]\nname = \"A\"",
        "[[joint]]\nname = \"\"",
        "letters, digits",
    );
    four_bar(
        "kind = \"revolute\"",
        "kind = \"ball\"",
        "must be one of \"revolute\", \"prismatic\"",
    );
    four_bar(
        "at = [\"frame.O\", \"crank.O\"]",
        "at = [\"frame.O\"]",
        "two or more",
    );
    four_bar(
        "at = [\"frame.O\", \"crank.O\"]",
        "at = [\"frame.O\", 3]",
        "found a number",
    );
    four_bar(
        "at = [\"frame.O\", \"crank.O\"]",
        "at = [\"frame.O\", \"frame.C\"]",
        "the link is at this joint already",
    );
    four_bar(
        "\"crank.O\"",
        "\"krank.O\"",
        "no link `krank`; the links are frame, crank",
    );
    four_bar(
        "\"crank.O\"",
        "\"crank.X\"",
        "no point `X`; its points are O, A",
    );
    four_bar("\"crank.O\"", "\"crank\"", "expected \"link.point\"");
    four_bar("branch = 1", "branch = 0.5", "must be 1 or -1");
    four_bar("branch = 1", "branch = 2", "must be 1 or -1");
    let slider = |from, to, reason| refused("slider-crank", from, to, reason);
    slider(
        "slider = \"slider.B\"",
        "slider = \"frame.O\"",
        "guide and slider are of one link",
    );
    slider("guide = \"frame.O\"", "guide = \"frame.X\"", "no point `X`");
    slider("guide = \"frame.O\"\n", "", "missing, expected a string");
    slider(
        "guide = \"frame.O\"",
        "guide = \"frame.O\"\noffset_m = 1e9",
        "must be from -1000000 to 1000000",
    );
    slider(
        "guide = \"frame.O\"",
        "guide = \"frame.O\"\ndirection_rad = \"x\"",
        "expected a number in rad",
    );
}

#[test]
fn drives_and_motion() {
    let drive = "[[drive]]\njoint = \"O\"\nrate_rad_s = 10.0\n";
    let four_bar = |to: &str, reason| refused("four-bar", drive, to, reason);
    four_bar("", "missing, expected tables [[drive]]");
    four_bar(
        "[[drive]]\njoint = \"X\"\nrate_rad_s = 1\n",
        "no joint `X`; the joints are O, A, B, C",
    );
    four_bar(
        "[[drive]]\njoint = \"O\"\n",
        "missing, expected a number in rad/s",
    );
    four_bar(&drive.repeat(2), "this joint is driven already");
    four_bar(
        &format!("{drive}link = \"frame\"\n"),
        "the joint's first link",
    );
    four_bar(
        &format!("{drive}link = \"rocker\"\n"),
        "the link is not at this joint",
    );
    four_bar(
        &format!("{drive}start_rad = 1e7\n"),
        "must be from -1000000 to 1000000",
    );
    four_bar(
        &format!("{drive}acceleration_rad_s2 = 1\n"),
        "turns are counted of",
    );
    four_bar(
        "[[drive]]\njoint = \"O\"\nrate_rad_s = 0\n",
        "turns are counted of",
    );
    four_bar(
        "[[drive]]\njoint = \"O\"\nrate_rad_s = 1e-9\n",
        "take too long",
    );
    let motion = |text: &str, reason| four_bar(&format!("{drive}[motion]\n{text}\n"), reason);
    motion("steps = 1", "must be a whole number from 2 to 100000");
    motion("steps = 2.5", "must be a whole number");
    motion("turns = 0", "must be from");
    motion("duration_s = -1", "must be from");
    motion("duration_s = 1\nturns = 1", "duration_s is given too");
    let slide = "[[drive]]\njoint = \"guide\"\nrate_m_s = 0.1\n";
    refused("slider-crank", drive, slide, "the first drive slides");
    let slide = format!("{slide}link = \"slider\"\n");
    refused("slider-crank", drive, &slide, "driven from guide to slider");
}
