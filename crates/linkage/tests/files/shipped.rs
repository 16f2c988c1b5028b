//! Every shipped file: its decomposition, its motion over a turn.

use crate::{folder, joint, link, shipped};
use std::f64::consts::TAU;
use trirrr_linkage::assur::{Linkage, Mobility, Track, track};

/// The decomposition of each shipped file, as reviewed.
const DECOMPOSITIONS: [(&str, &str); 15] = [
    (
        "fairbairn",
        "driven link: crank in K | dyad RRR: rod, bridle in A, M, O | \
         dyad RRR: tracing, rocker in M, N, G",
    ),
    (
        "five-bar",
        "driven link: left-crank in O | driven link: right-crank in C | \
         dyad RRR: left-link, right-link in A, B, D",
    ),
    (
        "four-bar",
        "driven link: crank in O | dyad RRR: coupler, rocker in A, B, C",
    ),
    (
        "inserter",
        "driven link: crank in O | dyad RRR: coupler, rocker in A, B, C | \
         dyad RRP: rod, pusher in P, S, guide",
    ),
    (
        "quick-return",
        "driven link: crank in O | dyad RPR: block, lever in A, slot, Q | \
         dyad RRP: rod, ram in E, R, guide",
    ),
    (
        "quick-return-slotted",
        "driven link: crank in O | dyad RPR: block, lever in A, slot, Q | \
         dyad PRP: upper-block, ram in upper-slot, R, guide",
    ),
    (
        "scotch-yoke",
        "driven link: crank in O | dyad PPR: block, yoke in guide, slot, A",
    ),
    (
        "serial-arm",
        "driven link: upper in S | driven link: fore in E | driven link: tool in W",
    ),
    (
        "shaper",
        "driven link: crank in O | dyad RPR: lever, block of A in A (pin), A (slot), Q | \
         dyad PPR: ram, block of E in guide, E (slot), E (pin)",
    ),
    (
        "slider-crank",
        "driven link: crank in O | dyad RRP: rod, slider in A, B, guide",
    ),
    (
        "slider-crank-eccentric",
        "driven link: disc in O | dyad RRP: rod, slider in A, B, guide",
    ),
    (
        "stephenson",
        "driven link: crank in E | triad, by Newton-Raphson: \
         rod, coupler, left-rocker, right-rocker in D, P, A, B, O, C",
    ),
    (
        "tetrad",
        "driven link: crank in O | tetrad, by Newton-Raphson: \
         coupler, rocker, left-bar, right-bar in P, A, B, C, D, Q",
    ),
    (
        "two-loop",
        "driven link: crank in O | dyad RRR: coupler, rocker in A, B, D | \
         dyad RPR: upper, lower in P, slide, Q",
    ),
    (
        "worked-example",
        "driven link: crank in O | dyad RPR: bar, arm in A, z2, D",
    ),
];

fn decomposition(linkage: &Linkage) -> String {
    let groups = linkage.groups.iter().map(|group| {
        format!(
            "{}: {} in {}",
            group.title(),
            linkage.link_names(&group.links),
            linkage.joint_names(&group.joints)
        )
    });
    groups.collect::<Vec<_>>().join(" | ")
}

fn solved(linkage: &Linkage) -> Track {
    let track = track(linkage);
    assert_eq!(track.stop, None, "{}", linkage.name);
    assert_eq!(track.positions.len(), linkage.motion.steps as usize + 1);
    track
}

#[test]
fn each_decomposes_as_reviewed_and_none_is_left_out() {
    let mut files: Vec<String> = std::fs::read_dir(folder())
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .map(|path| path.file_stem().unwrap().to_str().unwrap().to_owned())
        .collect();
    files.sort();
    assert_eq!(files, DECOMPOSITIONS.map(|(name, _)| name));
    for (name, expected) in DECOMPOSITIONS {
        let linkage = shipped(name);
        assert_eq!(linkage.name, name);
        assert_eq!(decomposition(&linkage), expected, "{name}");
        let mobility = Mobility::count(linkage.links.len(), &linkage.joints);
        assert_eq!(mobility.freedoms(), linkage.drives.len() as i64, "{name}");
    }
}

/// The order of links and joints in the file changes the order of equals, never the groups.
#[test]
fn the_groups_do_not_depend_on_the_order_of_the_file() {
    for (name, expected) in DECOMPOSITIONS {
        let text = crate::shipped_text(name);
        let (head, rest) = text.split_at(text.find("[[link]]").unwrap());
        let mut tables: Vec<&str> = Vec::new();
        let mut rest = rest;
        while let Some(next) = rest[1..].find("[[").map(|at| at + 1) {
            tables.push(&rest[..next]);
            rest = &rest[next..];
        }
        tables.push(rest);
        // The frame stays first, and the first drive, which turns are counted of.
        let of = |kind: &str| -> Vec<String> {
            let of_kind = tables.iter().filter(|table| table.starts_with(kind));
            of_kind
                .map(|table| format!("{}\n", strip_comments(table)))
                .collect()
        };
        let (links, joints, drives) = (of("[[link]]"), of("[[joint]]"), of("[[drive]]"));
        let mut shuffled = head.to_owned() + &links[0];
        for table in links[1..]
            .iter()
            .rev()
            .chain(joints.iter().rev())
            .chain(&drives)
        {
            shuffled.push_str(table);
        }
        let kinds = |text: &str| {
            let mut titles: Vec<&str> = text
                .split(" | ")
                .map(|group| group.split(':').next().unwrap())
                .collect();
            titles.sort_unstable();
            titles.join(" ")
        };
        // Branches are signs on one side of a way that is now read backwards: only groups count.
        let linkage = crate::parse(&shuffled);
        assert_eq!(kinds(&decomposition(&linkage)), kinds(expected), "{name}");
    }
}

fn strip_comments(table: &str) -> String {
    let lines = table.lines().filter(|line| !line.starts_with('#'));
    lines.collect::<Vec<_>>().join("\n")
}

#[test]
fn loops_close_to_rounding_over_the_whole_motion() {
    for (name, _) in DECOMPOSITIONS {
        let linkage = shipped(name);
        let track = solved(&linkage);
        // Positions are sums of a few vectors, each rounded a few times.
        let bound = 12.0 * f64::EPSILON * linkage.size();
        assert!(track.closure <= bound, "{name}: {:e}", track.closure);
    }
}

#[test]
fn after_whole_turns_everything_is_where_it_was() {
    for (name, _) in DECOMPOSITIONS {
        let linkage = shipped(name);
        let track = solved(&linkage);
        let (first, last) = (&track.positions[0], track.positions.last().unwrap());
        for (link, (a, b)) in first.states.iter().zip(&last.states).enumerate() {
            let (a, b) = (a.pose(), b.pose());
            let turned = (b[2] - a[2]) / TAU;
            let off = [b[0] - a[0], b[1] - a[1], TAU * (turned - turned.round())];
            let name = &linkage.links[link].name;
            assert!(off.iter().all(|off| off.abs() < 1e-13), "{name}: {off:?}");
        }
    }
}

#[test]
fn rates_and_accelerations_are_what_finite_differences_say() {
    for (name, _) in DECOMPOSITIONS {
        let mut linkage = shipped(name);
        linkage.motion.steps = 1440;
        let h = linkage.motion.duration / 1440.0;
        let track = solved(&linkage);
        // Pose, rate and acceleration of each link, and what the slides do.
        let values = |index: usize| -> Vec<[f64; 3]> {
            let position = &track.positions[index];
            let links = position.states[1..].iter().flat_map(|state| {
                let (m, [x, y, angle]) = (&state.motion, state.pose());
                let (v, a) = (m.origin.velocity, m.origin.acceleration);
                [
                    [x, v.x, a.x],
                    [y, v.y, a.y],
                    [angle, m.rate, m.acceleration],
                ]
            });
            let slides =
                (0..linkage.joints.len()).filter_map(|joint| position.slide(&linkage, joint));
            links.chain(slides).collect()
        };
        let rows: Vec<_> = (0..track.positions.len()).map(values).collect();
        for quantity in 0..rows[0].len() {
            for order in 0..2 {
                let largest = rows.iter().map(|row| row[quantity][order + 1].abs());
                let scale = largest.fold(0.0, f64::max) + 1e-3;
                for at in 2..rows.len() - 2 {
                    let value = |index: usize| rows[index][quantity][order];
                    // Five points: the error is of the fourth order in the step.
                    let difference = (8.0 * (value(at + 1) - value(at - 1))
                        - (value(at + 2) - value(at - 2)))
                        / (12.0 * h);
                    let off = difference - rows[at][quantity][order + 1];
                    assert!(
                        off.abs() < 2e-7 * scale,
                        "{name}: quantity {quantity}, order {order}, step {at}: {off:e} of {scale}"
                    );
                }
            }
        }
    }
}

/// z1 e^(i phi1) + z2 e^(i phi2) + z3 e^(i (phi2 - delta)) - z4 = 0.
#[test]
fn the_worked_example_satisfies_its_equation() {
    let linkage = shipped("worked-example");
    let track = solved(&linkage);
    let (bar, slide) = (link(&linkage, "bar"), joint(&linkage, "z2"));
    let delta = 84f64.to_radians();
    for position in &track.positions {
        let phi1 = linkage.drives[0].at(position.t)[0];
        let phi2 = position.states[bar].angle;
        let [z2, ..] = position.slide(&linkage, slide).unwrap();
        let terms = [(0.1, phi1), (z2, phi2), (0.17, phi2 - delta), (-0.4, 0.0)];
        let x: f64 = terms.iter().map(|(z, phi)| z * phi.cos()).sum();
        let y: f64 = terms.iter().map(|(z, phi)| z * phi.sin()).sum();
        assert!(x.hypot(y) < 1e-15, "{x:e} {y:e} at {phi1}");
        assert!(z2 > 0.0);
    }
    let first = linkage.drives[0].at(0.0)[0];
    assert!((first.to_degrees() - 60.0).abs() < 1e-12);
}

#[test]
fn the_fairbairn_guide_is_nearly_straight_and_the_return_is_quick() {
    let linkage = shipped("fairbairn");
    let t = crate::point(&linkage, "tracing", "T");
    let places: Vec<_> = solved(&linkage)
        .positions
        .iter()
        .map(|p| p.point(&linkage, t).position)
        .collect();
    let span = |axis: usize| {
        let values = || places.iter().map(|at| at[axis]);
        values().fold(f64::MIN, f64::max) - values().fold(f64::MAX, f64::min)
    };
    assert!(
        span(1) > 0.16 && span(0) < 0.03 * span(1),
        "{} {}",
        span(0),
        span(1)
    );

    let linkage = shipped("quick-return");
    let ram = link(&linkage, "ram");
    let track = solved(&linkage);
    let forth = track
        .positions
        .iter()
        .filter(|p| p.states[ram].motion.origin.velocity.x < 0.0)
        .count();
    let share = forth as f64 / track.positions.len() as f64;
    // The lever's extremes: the crank stands across it, asin(0.1 / 0.25) off the quarter turn.
    let expected = 0.5 + (0.1f64 / 0.25).asin() / std::f64::consts::PI;
    assert!((share - expected).abs() < 0.02, "{share} for {expected}");
}
