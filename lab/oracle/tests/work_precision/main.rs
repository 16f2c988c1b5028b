//! The truth of every case of the work-precision study (`trirrr report --section work-precision`,
//! by Radau IIA) against the stiff solver of the crate diffsol, which is itself held against the
//! reference file of 21 digits.
//!
//! diffsol knows nothing of modes: it is started afresh at each event, at the instants that the
//! truth has. That they are where they should be is checked with diffsol's own solution.

mod bdf;
mod truth;

use trirrr_integrate::{Direction, System};
use trirrr_plant::{Plant, layout_of};
use trirrr_report::work_precision::COMPARED_S;
use trirrr_report::work_precision::cases::{CASES, Case};
use trirrr_report::{Block, docs};
use truth::{build, known};

/// Poses are compared every so often, s; between events the signs of their functions are, too.
const ROW_S: f64 = 1e-3;

/// What the two solutions agree to.
#[derive(Clone, Copy, Debug, Default)]
struct Agreement {
    /// Largest difference of poses, m and rad.
    pose: f64,
    /// Largest difference of the instants of events, s.
    event_s: f64,
    /// Events in the run.
    events: usize,
}

/// A case and what is asserted of it.
struct Bound {
    case: &'static str,
    /// Difference of poses, m and rad.
    pose: f64,
    /// Difference of the instants of events, s. The ends of moves are exact.
    event_s: f64,
}

/// Every case but the refused one; what is found and printed is two to five times smaller.
const BOUNDS: [Bound; 9] = [
    bound("reference", 5e-11, 0.0),
    bound("inductance", 5e-11, 0.0),
    bound("gains", 1e-12, 0.0),
    bound("elastic", 2e-12, 0.0),
    bound("stick-slip", 5e-11, 5e-8),
    bound("light", 5e-12, 0.0),
    bound("heavy", 3e-10, 2e-9),
    bound("parallel", 5e-10, 2e-9),
    bound("stretched", 1e-10, 0.0),
];

const fn bound(case: &'static str, pose: f64, event_s: f64) -> Bound {
    Bound {
        case,
        pose,
        event_s,
    }
}

/// States by diffsol every [`ROW_S`] up to the end of the run, and how they agree with what is known.
fn follow<const N: usize>(case: &Case) -> (Vec<[f64; N]>, Agreement) {
    let known = known::<N>(case);
    let (mut plant, mut y, _) = build::<N>(case);
    let mut rows = vec![y];
    let mut agreement = Agreement {
        events: known.events.len(),
        ..Agreement::default()
    };
    let mut values = vec![0.0; plant.events()];
    for phase in known.phases() {
        let end = phase.end;
        let mut instants: Vec<f64> = (rows.len()..)
            .map(|row| row as f64 * ROW_S)
            .take_while(|&instant| instant < end - 1e-9)
            .collect();
        let inner = instants.len();
        let last = instants.last().copied().unwrap_or(phase.start);
        // Shortly before the end: for the rate at which the events' functions come to zero.
        let before = end - 1e-2 * (end - last);
        instants.extend([before, end]);
        let states = bdf::solve(&plant, (phase.start, &y), &instants);
        let (inside, [near, there]) = states.split_at(inner) else {
            panic!("{}: {} states", case.name, states.len());
        };
        check_signs(case, &plant, &instants, inside);
        rows.extend(inside);
        y = *there;
        for &event in &phase.events {
            plant.event_values(before, near, &mut values);
            let earlier = values[event];
            plant.event_values(end, there, &mut values);
            let rate = (values[event] - earlier) / (end - before);
            agreement.event_s = agreement.event_s.max((values[event] / rate).abs());
        }
        for &event in &phase.events {
            plant.at_event(event, end, &mut y).unwrap();
        }
        if phase.events.is_empty() {
            rows.push(y);
        }
    }
    let every = (COMPARED_S / ROW_S).round() as usize;
    let compared: Vec<_> = rows.iter().step_by(every).zip(&known.poses).collect();
    assert_eq!(compared.len(), known.poses.len(), "{}", case.name);
    for (state, pose) in compared {
        for (value, truth) in state.iter().zip(pose) {
            agreement.pose = agreement.pose.max((value - truth).abs());
        }
    }
    (rows, agreement)
}

/// Between events no function that is watched changes its sign.
fn check_signs<const N: usize>(
    case: &Case,
    plant: &Plant<N>,
    instants: &[f64],
    states: &[[f64; N]],
) {
    let mut values = vec![0.0; plant.events()];
    let mut first: Option<Vec<f64>> = None;
    for (&t, state) in instants.iter().zip(states) {
        plant.event_values(t, state, &mut values);
        let first = first.get_or_insert_with(|| values.clone());
        for (event, (value, first)) in values.iter().zip(&*first).enumerate() {
            let passed = match plant.direction(event) {
                Some(Direction::Either) => value * first < 0.0,
                Some(Direction::Rising) => *first < 0.0 && *value > 0.0,
                Some(Direction::Falling) => *first > 0.0 && *value < 0.0,
                None => false,
            };
            let name = plant.event_name(event);
            assert!(!passed, "{}: {name} was passed before {t} s", case.name);
        }
    }
}

fn agreement(case: &Case) -> Agreement {
    match layout_of(&case.scene().unwrap()).dimension() {
        11 => follow::<11>(case).1,
        17 => follow::<17>(case).1,
        other => panic!("{}: {other} state variables", case.name),
    }
}

#[test]
fn diffsol_agrees_with_the_reference_file() {
    let (rows, _) = follow::<11>(&CASES[0]);
    let file = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../tests/reference/fd_continuous_pd.csv"
    );
    let text = std::fs::read_to_string(file).unwrap();
    let mut worst = [0.0_f64; 3];
    let mut lines = text.lines().skip(1);
    for state in &rows {
        let line = lines.next().unwrap();
        // Time, then pose, rates and currents.
        let fields = line.split(',').skip(1);
        for (i, (value, field)) in state[..9].iter().zip(fields).enumerate() {
            let difference = (value - field.parse::<f64>().unwrap()).abs();
            worst[i / 3] = worst[i / 3].max(difference);
        }
    }
    assert_eq!((rows.len(), lines.next()), (1201, None));
    let [pose, rates, currents] = worst;
    println!("pose {pose:.1e} m or rad, rates {rates:.1e}, currents {currents:.1e} A");
    assert!(pose < 1e-10 && rates < 1e-8 && currents < 1e-7, "{worst:?}");
}

#[test]
fn truths_agree_with_diffsol() {
    let mut bounds = BOUNDS.iter();
    for case in &CASES {
        if truth::refused(case) {
            // The loop is unstable: there is nothing to compare.
            assert_eq!(case.name, "gain");
            continue;
        }
        let bound = bounds.next().unwrap();
        assert_eq!(bound.case, case.name);
        let found = agreement(case);
        println!(
            "{}: poses {:.1e}, {} events within {:.1e} s",
            case.name, found.pose, found.events, found.event_s
        );
        assert!(found.pose <= bound.pose, "{}: {found:?}", case.name);
        assert!(found.event_s <= bound.event_s, "{}: {found:?}", case.name);
    }
    assert!(bounds.next().is_none());
}

#[test]
fn integrators_md_says_what_is_asserted() {
    let mut table = String::from(
        "| case | poses within (m, rad) | events within (s) |\n| --- | ---: | ---: |\n",
    );
    for Bound {
        case,
        pose,
        event_s,
    } in &BOUNDS
    {
        let event = match *event_s {
            0.0 => "exact".into(),
            some => format!("{some:e}"),
        };
        table += &format!("| {case} | {pose:e} | {event} |\n");
    }
    let document = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/integrators.md");
    let document = std::fs::read_to_string(document).unwrap();
    let block = Block {
        name: "work-precision-oracle".into(),
        text: table.clone(),
        reproducible: true,
    };
    let outdated = docs::outdated(&document, &[block]).unwrap();
    assert!(
        outdated.is_empty(),
        "docs/integrators.md should have\n{table}"
    );
}
