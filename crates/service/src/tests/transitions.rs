//! The table of transitions: which of its rows a search has taken, and its diagram and table in the documentation.

use super::State;
use crate::states::{
    Known,
    Transition::{Kept, To},
    Trigger, next,
};
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::format;
use std::path::Path;
use std::string::{String, ToString};
use std::vec::Vec;

const STATES: [State; 14] = [
    State::Disabled,
    State::Enabling,
    State::Disabling,
    State::Idle,
    State::Running,
    State::Slowing,
    State::Holding,
    State::Stopping,
    State::Recovering,
    State::Unhomed,
    State::Homing,
    State::Reacting,
    State::Fault,
    State::Cleared,
];

/// Every trigger, and its words in the documentation.
const TRIGGERS: [(Trigger, &str); 33] = [
    (Trigger::Enable, "`Enable`"),
    (Trigger::DrivesOn(Known::POSE), "the drives hold"),
    (
        Trigger::DrivesOn(Known::ANGLES),
        "the drives hold, the pose is not known",
    ),
    (
        Trigger::DrivesOn(Known::NOTHING),
        "the drives hold, a scene with homing",
    ),
    (Trigger::Disable, "`Disable`"),
    (Trigger::EndsOff, "at rest after `Disable`"),
    (Trigger::DrivesOff, "the drives are off"),
    (Trigger::Home, "`Home`"),
    (Trigger::Found, "every motor angle is known"),
    (Trigger::Recover, "`Recover`"),
    (Trigger::Start, "`Start`, `Probe`"),
    (Trigger::Hold, "`Hold`"),
    (Trigger::Resume, "`Resume`"),
    (Trigger::Rests, "at rest on the path"),
    (Trigger::GoesOn, "resumed, or the queue is filled"),
    (Trigger::AtPace, "at the pace asked for"),
    (Trigger::RunsDry, "the queue runs dry"),
    (Trigger::StandsDry, "at the end of too few moves"),
    (Trigger::Silence, "host timeout"),
    (Trigger::Door, "open door"),
    (Trigger::Touch, "the probe touches"),
    (Trigger::Stop, "`Stop`"),
    (Trigger::Ends(Known::POSE), "the motion is over"),
    (
        Trigger::Ends(Known::ANGLES),
        "the motion is over, the pose is not known",
    ),
    (
        Trigger::Ends(Known::NOTHING),
        "the motion is over, homing was stopped",
    ),
    (Trigger::Measured, "the board measured other motor angles"),
    (
        Trigger::FaultOnPath,
        "a fault of stop category 1 or 2, or a contact",
    ),
    (
        Trigger::FaultAtOnce,
        "a fault of category 0, or one where no motion is left",
    ),
    (Trigger::Reacted, "at rest, the drives hold"),
    (
        Trigger::ClearFault(None),
        "`ClearFault`, the drives are off",
    ),
    (
        Trigger::ClearFault(Some(Known::POSE)),
        "`ClearFault`, the drives hold",
    ),
    (
        Trigger::ClearFault(Some(Known::ANGLES)),
        "`ClearFault`, the drives hold, the pose is not known",
    ),
    (
        Trigger::ClearFault(Some(Known::NOTHING)),
        "`ClearFault`, the drives hold, a scene with homing",
    ),
];

std::thread_local! {
    static TAKEN: RefCell<BTreeSet<Row>> = const { RefCell::new(BTreeSet::new()) };
}

/// Notes that the tick of this thread has taken `trigger` in `state`.
pub(crate) fn take_note(state: State, trigger: Trigger) {
    TAKEN.with_borrow_mut(|all| all.insert((index(state), index_of(trigger))));
}

fn index(state: State) -> usize {
    STATES.iter().position(|other| *other == state).unwrap()
}

/// Fails for a trigger that the documentation does not show.
fn index_of(trigger: Trigger) -> usize {
    let place = TRIGGERS.iter().position(|other| other.0 == trigger);
    place.unwrap_or_else(|| panic!("{trigger:?} is in no row"))
}

/// A row: a state, by its place among [`STATES`], and a trigger, among [`TRIGGERS`].
type Row = (usize, usize);

/// Every row of the table in which something changes, and the state that follows.
fn rows() -> BTreeMap<Row, State> {
    let all = (0..STATES.len()).flat_map(|state| (0..TRIGGERS.len()).map(move |row| (state, row)));
    all.filter_map(|row| match next(STATES[row.0], TRIGGERS[row.1].0) {
        To(to) => Some((row, to)),
        _ => None,
    })
    .collect()
}

/// Rows of the table: all of these triggers in these states.
type Rows = (&'static [Trigger], &'static [State]);

/// States of a machine that needs no homing.
const PLAIN: &[State] = {
    use State::*;
    &[
        Disabled, Enabling, Disabling, Idle, Running, Slowing, Holding, Stopping, Recovering,
        Reacting, Fault, Cleared,
    ]
};

/// The same, but where a fault is latched.
const PLAIN_BUT_FAULT: &[State] = {
    use State::*;
    &[
        Disabled, Enabling, Disabling, Idle, Running, Slowing, Holding, Stopping, Recovering,
        Reacting, Cleared,
    ]
};

/// Rows that each search, or test, takes: it asserts so by [`assert_taken`].
pub(super) mod taken {
    use super::{Known, PLAIN, PLAIN_BUT_FAULT, Rows, State, Trigger};

    pub(in crate::tests) const PLAIN_MACHINE: &[Rows] = &[
        (
            &[
                Trigger::Enable,
                Trigger::DrivesOn(Known::POSE),
                Trigger::DrivesOn(Known::ANGLES),
                Trigger::EndsOff,
                Trigger::Recover,
                Trigger::Start,
                Trigger::Hold,
                Trigger::Rests,
                Trigger::GoesOn,
                Trigger::AtPace,
                Trigger::RunsDry,
                Trigger::Silence,
                Trigger::Stop,
                Trigger::Ends(Known::ANGLES),
                Trigger::FaultOnPath,
                Trigger::FaultAtOnce,
                Trigger::ClearFault(None),
            ],
            PLAIN,
        ),
        (&[Trigger::Disable], PLAIN_BUT_FAULT),
        (
            &[Trigger::Ends(Known::POSE)],
            &[
                State::Running,
                State::Slowing,
                State::Stopping,
                State::Recovering,
            ],
        ),
        (&[Trigger::DrivesOff], &[State::Disabling, State::Reacting]),
    ];
    pub(in crate::tests) const HOMED_MACHINE: &[Rows] = &[
        (
            &[
                Trigger::DrivesOn(Known::NOTHING),
                Trigger::Home,
                Trigger::Found,
                Trigger::Ends(Known::NOTHING),
            ],
            &super::STATES,
        ),
        (
            &[
                Trigger::Stop,
                Trigger::Disable,
                Trigger::Silence,
                Trigger::FaultOnPath,
                Trigger::FaultAtOnce,
            ],
            &[State::Unhomed, State::Homing],
        ),
    ];
    pub(in crate::tests) const GUARDED_MACHINE: &[Rows] = &[(&[Trigger::Door], PLAIN)];
    pub(in crate::tests) const MEASURED_MACHINE: &[Rows] =
        &[(&[Trigger::DrivesOff], &[State::Enabling])];
    pub(in crate::tests) const TOUCHING_MACHINE: &[Rows] = &[(&[Trigger::Touch], PLAIN)];
    pub(in crate::tests) const MOVING_MACHINE: &[Rows] =
        &[(&[Trigger::StandsDry], &[State::Running, State::Slowing])];

    pub(in crate::tests) const DOOR_IN_HOMING: &[Rows] = &[(&[Trigger::Door], &[State::Homing])];
    pub(in crate::tests) const MEASURED_IN_IDLE: &[Rows] = &[(&[Trigger::Measured], PLAIN)];
    pub(in crate::tests) const MEASURED_UNHOMED: &[Rows] =
        &[(&[Trigger::Measured], &[State::Unhomed])];
    pub(in crate::tests) const DRIVES_THAT_HOLD: &[Rows] = &[
        (
            &[Trigger::Reacted, Trigger::ClearFault(Some(Known::POSE))],
            PLAIN,
        ),
        (&[Trigger::Disable], &[State::Fault]),
    ];
    pub(in crate::tests) const DRIVES_THAT_HOLD_LOST: &[Rows] =
        &[(&[Trigger::ClearFault(Some(Known::ANGLES))], PLAIN)];
    pub(in crate::tests) const DRIVES_THAT_HOLD_UNHOMED: &[Rows] =
        &[(&[Trigger::ClearFault(Some(Known::NOTHING))], PLAIN)];

    pub(super) const ALL: &[&[Rows]] = &[
        PLAIN_MACHINE,
        HOMED_MACHINE,
        GUARDED_MACHINE,
        MEASURED_MACHINE,
        TOUCHING_MACHINE,
        MOVING_MACHINE,
        DOOR_IN_HOMING,
        MEASURED_IN_IDLE,
        MEASURED_UNHOMED,
        DRIVES_THAT_HOLD,
        DRIVES_THAT_HOLD_LOST,
        DRIVES_THAT_HOLD_UNHOMED,
        // The background alone asks for these: the tick goes on by itself.
        &[(&[Trigger::Resume], &[State::Slowing, State::Holding])],
        // A pace of zero in the very tick in which the path, or a move, ends: no search has met it, and the machine has a way on.
        &[(
            &[Trigger::Ends(Known::POSE), Trigger::StandsDry],
            &[State::Holding],
        )],
    ];
}

fn is_among(rows: &[Rows], (state, trigger): Row) -> bool {
    let here = |(triggers, states): &Rows| {
        triggers.contains(&TRIGGERS[trigger].0) && states.contains(&STATES[state])
    };
    rows.iter().any(here)
}

fn words((state, trigger): Row) -> String {
    format!("{:?}: {}", STATES[state], TRIGGERS[trigger].1)
}

/// This thread has taken each of `wanted`.
pub(super) fn assert_taken(wanted: &[Rows]) {
    let taken = TAKEN.with_borrow(Clone::clone);
    for row in rows().into_keys().filter(|row| is_among(wanted, *row)) {
        assert!(taken.contains(&row), "{}", words(row));
    }
}

#[test]
fn every_row_is_taken_by_a_search_or_a_test() {
    for row in rows().into_keys() {
        let is_taken = taken::ALL.iter().any(|rows| is_among(rows, row));
        assert!(is_taken, "{}", words(row));
    }
}

fn names(states: &[State]) -> String {
    let names: Vec<_> = states.iter().map(|state| format!("`{state:?}`")).collect();
    names.join(", ")
}

/// The diagram: an arrow for each pair of states. Faults lead from almost everywhere: a note says so.
fn diagram() -> String {
    let mut lines = String::from("```mermaid\nstateDiagram-v2\n    [*] --> Disabled\n");
    let mut arrows: BTreeMap<(usize, usize), Vec<&str>> = BTreeMap::new();
    for ((from, trigger), to) in rows() {
        let (trigger, words) = TRIGGERS[trigger];
        let is_fault = matches!(trigger, Trigger::FaultOnPath | Trigger::FaultAtOnce);
        if from != index(to) && !is_fault {
            arrows.entry((from, index(to))).or_default().push(words);
        }
    }
    for ((from, to), words) in arrows {
        let words = words.join(", or ").replace('`', "");
        lines += &format!("    {:?} --> {:?}: {words}\n", STATES[from], STATES[to]);
    }
    lines
        + "    note right of Reacting: from where drives are on, by a fault\n    \
           note right of Fault: from any state, by a fault\n```"
}

/// The table: for each trigger the states from which it leads to one, and those in which it changes nothing.
fn table() -> String {
    let mut lines = String::from("| trigger | leads | changes nothing in |\n|---|---|---|\n");
    for (trigger, words) in TRIGGERS {
        let mut ends: BTreeMap<usize, Vec<State>> = BTreeMap::new();
        let mut kept = Vec::new();
        for state in STATES {
            match next(state, trigger) {
                To(to) => ends.entry(index(to)).or_default().push(state),
                Kept => kept.push(state),
                _ => {}
            }
        }
        let leads: Vec<_> = ends
            .into_iter()
            .map(|(to, from)| format!("{} → `{:?}`", names(&from), STATES[to]))
            .collect();
        lines += &format!("| {words} | {} | {} |\n", leads.join("; "), names(&kept));
    }
    lines.trim_end().to_string()
}

#[test]
fn the_diagram_and_the_table_of_the_documentation_are_those_of_the_tick() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/service.md");
    let before = std::fs::read_to_string(&path).unwrap();
    let mut text = before.clone();
    for (name, made) in [("states", diagram()), ("transitions", table())] {
        let (first, last) = (
            format!("<!-- {name} -->\n"),
            format!("\n<!-- end of {name} -->"),
        );
        let start = text.find(&first).expect("the beginning") + first.len();
        let end = text.find(&last).expect("the end");
        text.replace_range(start..end, &made);
    }
    if std::env::var_os("TRIRRR_BLESS").is_some() {
        std::fs::write(&path, text).unwrap();
    } else {
        assert!(text == before, "docs/service.md: TRIRRR_BLESS=1 writes it");
    }
}

/// A trigger that leads to no state, or a state to which nothing leads, is a row that is left over.
#[test]
fn every_trigger_and_every_state_has_a_row() {
    let rows = rows();
    for (trigger, (_, words)) in TRIGGERS.iter().enumerate() {
        assert!(rows.keys().any(|row| row.1 == trigger), "{words}");
    }
    for state in STATES {
        let index = index(state);
        let leaves = rows.iter().any(|(row, to)| row.0 == index && *to != state);
        let comes = rows.iter().any(|(row, to)| *to == state && row.0 != index);
        assert!(leaves && comes, "{state:?}");
    }
}
