//! Scenes made wrong by small edits, and what they must be refused with.

use trirrr_scene::{Problem, Scene, SceneError};

pub(crate) const THESIS: &str = include_str!("../../../../scenes/thesis.toml");
/// Limits of the motors in [`THESIS`].
pub(crate) const MOTORS: &str = "rate_rad_s = 2.0\ntorque_nm = 0.1";
pub(crate) const VERTICAL: &str = include_str!("../../../../scenes/vertical.toml");

/// [`THESIS`] without limits of the motors: what stands in the way of a move is the machine alone.
pub(crate) fn unlimited() -> String {
    edit(THESIS, MOTORS, 1, "")
}

/// The problems of `text`, which must have some.
pub(crate) fn problems(text: &str) -> Vec<Problem> {
    match Scene::parse(text, "bad.toml") {
        Err(SceneError::Refused { file, problems }) => {
            assert_eq!(file, "bad.toml");
            problems
        }
        Err(error) => panic!("{error}"),
        Ok(_) => panic!("accepted:\n{text}"),
    }
}

/// `text` with the `nth` (from 1) occurrence of `from` replaced.
pub(crate) fn edit(text: &str, from: &str, nth: usize, to: &str) -> String {
    let (start, _) = text
        .match_indices(from)
        .nth(nth - 1)
        .unwrap_or_else(|| panic!("no {nth} times {from:?}"));
    format!("{}{to}{}", &text[..start], &text[start + from.len()..])
}

/// One edit and the only problem it must lead to.
pub(crate) struct Case {
    from: &'static str,
    nth: usize,
    to: &'static str,
    key: &'static str,
    value: Option<&'static str>,
    reason: &'static str,
}

pub(crate) const fn case(
    (from, nth, to): (&'static str, usize, &'static str),
    key: &'static str,
    value: Option<&'static str>,
    reason: &'static str,
) -> Case {
    Case {
        from,
        nth,
        to,
        key,
        value,
        reason,
    }
}

pub(crate) fn check(base: &str, cases: &[Case]) {
    for case in cases {
        let text = edit(base, case.from, case.nth, case.to);
        let found = problems(&text);
        let label = format!("{:?} -> {:?}: {found:#?}", case.from, case.to);
        let [only] = found.as_slice() else {
            panic!("one problem expected, {label}");
        };
        assert_eq!(only.key, case.key, "{label}");
        assert_eq!(only.value.as_deref(), case.value, "{label}");
        assert!(
            only.reason.contains(case.reason),
            "{:?} in {label}",
            case.reason
        );
    }
}
