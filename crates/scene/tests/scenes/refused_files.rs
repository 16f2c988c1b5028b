//! Files that are wrong as a whole, or in several places at once.

use crate::common::{THESIS, edit, problems};
use trirrr_scene::{Scene, SceneError};

#[test]
fn numbers_of_legs_drives_and_moves() {
    let leg = "[[machine.leg]]\nbase_m = [1, 1]\nproximal_m = 1\ndistal_m = 1\n\
               joint_radius_m = 0\njoint_angle_rad = 0\nelbow = 1\n\n[platform]";
    let found = problems(&edit(THESIS, "[platform]", 1, leg));
    assert_eq!(found.len(), 1);
    assert_eq!(found[0].key, "machine.leg");
    assert_eq!(found[0].reason, "expected three [[machine.leg]], found 4");

    let start = THESIS.find("[[machine.leg]]").unwrap();
    let end = THESIS.find("[platform]").unwrap();
    let without = format!("{}[machine]\n{}", &THESIS[..start], &THESIS[end..]);
    assert_eq!(
        problems(&without)[0].reason,
        "expected three [[machine.leg]], found 0"
    );
    let without = format!("{}{}", &THESIS[..start], &THESIS[end..]);
    let found = problems(&without);
    assert_eq!(
        (found[0].key.as_str(), found.len()),
        ("machine", 1),
        "{found:#?}"
    );
    assert_eq!(found[0].reason, "missing, expected a table");

    let job = THESIS.find("[[job.move]]").unwrap();
    let found = problems(&THESIS[..job]);
    assert_eq!(
        (found[0].key.as_str(), found.len()),
        ("job.move", 1),
        "{found:#?}"
    );
    assert_eq!(found[0].reason, "a job needs at least one [[job.move]]");

    let two = "[[drive]]\nkind = \"can\"\nprotocol = \"moteus\"\nnode_id = 1\n\
               [[drive]]\nkind = \"can\"\nprotocol = \"moteus\"\nnode_id = 2\n[platform]";
    let found = problems(&edit(THESIS, "[platform]", 1, two));
    assert_eq!((found[0].key.as_str(), found.len()), ("drive", 1));
    assert!(found[0].reason.ends_with("or three, found 2"), "{found:#?}");
}

#[test]
fn text_that_is_no_toml() {
    for (text, line, reason) in [
        ("name = \"a\"\nname = \"b\"\n", 2, "duplicate key"),
        ("name = \"a\ntick_rate_hz = 100\n", 1, "not TOML: "),
        ("name = \n", 1, "not TOML: "),
        ("[machine\n", 1, "not TOML: "),
        ("a = 1\nb = 0.2 m\n", 2, "not TOML: "),
    ] {
        let found = problems(text);
        assert_eq!(
            (found[0].line, found[0].key.as_str()),
            (line, ""),
            "{found:#?}"
        );
        assert!(found[0].reason.contains(reason), "{found:#?}");
    }
}

#[test]
fn all_problems_come_at_once_in_the_order_of_the_file() {
    let mut text = THESIS.to_owned();
    for (from, to) in [
        ("tick_rate_hz = 100", "tick_rate_hz = 0"),
        ("distal_m = 0.2", "distal_m = -0.2"),
        ("mass_kg = 0.5", "mass = 0.5"),
        ("x_m = 0.28", "x_m = nan"),
    ] {
        text = edit(&text, from, 1, to);
    }
    let error = Scene::parse(&text, "dir/bad.toml").unwrap_err();
    let message = error.to_string();
    let keys: Vec<String> = problems(&text)
        .into_iter()
        .map(|problem| problem.key)
        .collect();
    for key in [
        "tick_rate_hz",
        "machine.leg[1].distal_m",
        "platform.mass_kg",
        "platform.mass",
        "job.move[1].to.x_m",
    ] {
        assert!(keys.iter().any(|other| other == key), "{key} in {keys:?}");
    }
    assert_eq!(keys.len(), 5, "{message}");
    let mut last = 0;
    for line in message.lines() {
        let rest = line.strip_prefix("dir/bad.toml:").expect("file name first");
        let number: usize = rest
            .split(':')
            .next()
            .unwrap()
            .parse()
            .expect("then the line");
        assert!(number >= last, "{message}");
        last = number;
    }
    let line = 1 + text
        .lines()
        .position(|line| line == "distal_m = -0.2")
        .unwrap();
    let expected =
        format!("dir/bad.toml:{line}: machine.leg[1].distal_m = -0.2: must be greater than 0 (m)");
    assert!(message.lines().any(|line| line == expected), "{message}");
}

#[test]
fn a_file_that_is_not_there() {
    let error = Scene::read("no/such/scene.toml").unwrap_err();
    assert!(matches!(error, SceneError::Unreadable { .. }));
    assert!(
        error
            .to_string()
            .starts_with("no/such/scene.toml: cannot be read: "),
        "{error}"
    );
}
