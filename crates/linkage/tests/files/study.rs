//! Figures over the motion, against closed forms of textbooks.

use crate::{link, parse, shipped};
use std::f64::consts::{PI, TAU};
use trirrr_linkage::assur::{
    ChainKind, CrankChain, Linkage, LinkageStudy, Mobility, Travel, Traveller, study, track,
};
use trirrr_linkage::{FourBar, Grashof};

const FILES: [&str; 15] = [
    "fairbairn",
    "five-bar",
    "four-bar",
    "inserter",
    "quick-return",
    "quick-return-slotted",
    "scotch-yoke",
    "serial-arm",
    "shaper",
    "slider-crank",
    "slider-crank-eccentric",
    "stephenson",
    "tetrad",
    "two-loop",
    "worked-example",
];

fn studied(linkage: &Linkage) -> LinkageStudy {
    study(linkage, &track(linkage))
}

fn swing<'a>(linkage: &Linkage, study: &'a LinkageStudy, name: &str) -> &'a Travel {
    let of = link(linkage, name);
    let swings =
        |travel: &&Travel| matches!(&travel.of, Traveller::Links(links) if links.contains(&of));
    study.travels.iter().find(swings).expect("it turns")
}

fn stroke<'a>(linkage: &Linkage, study: &'a LinkageStudy, name: &str) -> &'a Travel {
    let slides = |travel: &&Travel| matches!(travel.of, Traveller::Slide(joint) if linkage.joints[joint].name == name);
    study.travels.iter().find(slides).expect("it slides")
}

fn near(value: f64, expected: f64, bound: f64, what: &str) {
    assert!(
        (value - expected).abs() <= bound,
        "{what}: {value} for {expected}"
    );
}

/// Values of the first drive at times, within a turn and in order.
fn drive_values(linkage: &Linkage, times: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = times
        .map(|t| linkage.drives[0].at(t)[0].rem_euclid(TAU))
        .collect();
    values.sort_by(f64::total_cmp);
    values
}

/// A crank at the origin and a rocker at (ground, 0), the drive from `start`.
fn four_bar(lengths: [f64; 4], start: f64, branch: i32, more: &str) -> Linkage {
    let [ground, crank, coupler, rocker] = lengths;
    let joint = |name: &str, a: &str, b: &str, more: &str| {
        format!(
            "[[joint]]\nname = \"{name}\"\nkind = \"revolute\"\nat = [\"{a}\", \"{b}\"]\n{more}"
        )
    };
    let rod = |name: &str, length: f64, ends: [&str; 2]| {
        format!("[[link]]\nname = \"{name}\"\nlength_m = {length:?}\nends = {ends:?}\n")
    };
    let text = [
        format!(
            "name = \"random\"\n[[link]]\nname = \"frame\"\npoints_m = {{ O = [0, 0], C = [{ground:?}, 0] }}\n"
        ),
        rod("crank", crank, ["O", "A"]),
        rod("coupler", coupler, ["A", "B"]),
        rod("rocker", rocker, ["C", "B"]),
        joint("O", "frame.O", "crank.O", ""),
        joint("A", "crank.A", "coupler.A", ""),
        joint(
            "B",
            "coupler.B",
            "rocker.B",
            &format!("branch = {branch}\n"),
        ),
        joint("C", "rocker.C", "frame.C", ""),
        format!("[[drive]]\njoint = \"O\"\nstart_rad = {start:?}\nrate_rad_s = 1.0\n{more}"),
    ];
    parse(&text.concat())
}

/// Grashof's inequality and the place of the shortest link.
fn class_of([ground, crank, coupler, rocker]: [f64; 4]) -> Grashof {
    let mut sorted = [ground, crank, coupler, rocker];
    sorted.sort_by(f64::total_cmp);
    match sorted[0] + sorted[3] < sorted[1] + sorted[2] {
        false => Grashof::TripleRocker,
        true if sorted[0] == crank => Grashof::CrankRocker,
        true if sorted[0] == rocker => Grashof::RockerCrank,
        true if sorted[0] == ground => Grashof::DoubleCrank,
        true => Grashof::DoubleRocker,
    }
}

fn only_chain(study: &LinkageStudy) -> &CrankChain {
    let [chain] = study.chains.as_slice() else {
        panic!("{:?}", study.chains)
    };
    chain
}

/// Uniform in 0..1, the same in every run.
struct Dice(u64);

impl Dice {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
}

#[test]
fn twice_the_loops_are_the_unknowns_of_every_shipped_file() {
    for file in FILES {
        let linkage = shipped(file);
        let study = studied(&linkage);
        let count = Mobility::count(linkage.links.len(), &linkage.joints);
        let loops = count.joints + count.slots - (count.links - 1);
        assert_eq!(study.loops.len(), loops, "{file}");
        assert_eq!(study.unknowns.count(), 2 * loops, "{file}");
        let iterated = linkage
            .groups
            .iter()
            .filter(|group| group.is_iterated())
            .count();
        assert_eq!(study.newton.len(), iterated, "{file}");
        for newton in &study.newton {
            assert!((2..=8).contains(&newton.iterations.0), "{file}: {newton:?}");
            assert!(
                newton.residual_m.0 < 1e-14 && newton.residual_m.0 > 0.0,
                "{file}: {newton:?}"
            );
        }
    }
}

#[test]
fn crank_rockers_have_the_dead_points_swings_and_ratios_of_the_cosine_law() {
    let mut dice = Dice(5);
    for case in 0..12 {
        let crank = 0.05 + 0.1 * dice.next();
        let (coupler, rocker) = (
            crank + 0.2 + 0.3 * dice.next(),
            crank + 0.15 + 0.2 * dice.next(),
        );
        // Between the bounds of Grashof's inequality.
        let (low, high) = ((coupler - rocker).abs() + crank, coupler + rocker - crank);
        let ground = low + (high - low) * (0.2 + 0.6 * dice.next());
        let lengths = [ground, crank, coupler, rocker];
        let branch = if dice.next() > 0.5 { 1 } else { -1 };
        let turns = 1 + (case % 2);
        let linkage = four_bar(
            lengths,
            TAU * dice.next(),
            branch,
            &format!("[motion]\nturns = {turns}\nsteps = {}\n", 180 * turns),
        );
        let motion = track(&linkage);
        let study = study(&linkage, &motion);
        let what = format!("case {case}: {lengths:?}");

        // Freudenstein's equation of crank and rocker angle.
        let rocker_link = link(&linkage, "rocker");
        let [k1, k2] = [ground / crank, ground / rocker];
        let k3 = (crank * crank - coupler * coupler + rocker * rocker + ground * ground)
            / (2.0 * crank * rocker);
        for position in &motion.positions {
            let (two, four) = (
                linkage.drives[0].at(position.t)[0],
                position.states[rocker_link].angle,
            );
            near(
                k1 * four.cos() - k2 * two.cos() + k3,
                (two - four).cos(),
                1e-13,
                &what,
            );
        }

        let chain = only_chain(&study);
        assert_eq!(
            chain.kind,
            ChainKind::FourBar {
                lengths: FourBar {
                    ground,
                    crank,
                    coupler,
                    rocker
                },
                class: class_of(lengths),
            },
            "{what}"
        );
        assert!(chain.turns_fully() && chain.singular_rad.is_empty());
        // Crank and coupler in one line: the triangle of ground, rocker and coupler plus or minus crank.
        let side = |a: f64, b: f64, c: f64| ((a * a + b * b - c * c) / (2.0 * a * b)).acos();
        let (out, inwards) = (coupler + crank, coupler - crank);
        // To the left of the way from the crank's pin to the rocker's joint is above the ground.
        let sign = f64::from(branch);
        let stretched = (sign * side(ground, out, rocker)).rem_euclid(TAU);
        let folded = (sign * side(ground, inwards, rocker) + PI).rem_euclid(TAU);
        let dead = |is_stretched: bool| {
            let dead = chain
                .dead
                .iter()
                .filter(move |dead| dead.is_stretched == is_stretched);
            drive_values(&linkage, dead.map(|dead| dead.t_s))
        };
        for (found, expected) in [(dead(true), stretched), (dead(false), folded)] {
            assert_eq!(found.len(), turns, "{what}");
            for value in found {
                near((value - expected).sin(), 0.0, 1e-12, &what);
            }
        }
        // The rocker's angle between both.
        let swing = swing(&linkage, &study, "rocker");
        let expected = side(ground, rocker, inwards) - side(ground, rocker, out);
        near(swing.range(), expected.abs(), 1e-13, &what);
        assert_eq!((swing.turns, swing.turning_s.len()), (0, 2 * turns));
        let imbalance = (side(ground, out, rocker) - side(ground, inwards, rocker)).abs();
        near(
            swing.time_ratio.unwrap(),
            (PI + imbalance) / (PI - imbalance),
            1e-11,
            &what,
        );
        // The least transmission angle is at one of the positions with the crank along the ground.
        let at = [ground - crank, ground + crank].map(|base| {
            let angle = side(coupler, rocker, base);
            angle.min(PI - angle)
        });
        near(
            chain.transmission.unwrap().0,
            at[0].min(at[1]),
            1e-12,
            &what,
        );
    }
}

#[test]
fn four_bars_that_do_not_turn_fully_stop_where_they_are_said_to_be_singular() {
    let mut dice = Dice(11);
    let mut classes = Vec::new();
    for case in 0..30 {
        let lengths = [0; 4].map(|_| 0.1 + 0.4 * dice.next());
        let class = class_of(lengths);
        if matches!(class, Grashof::CrankRocker | Grashof::DoubleCrank) {
            continue;
        }
        let [ground, crank, coupler, rocker] = lengths;
        // A crank angle at which the ends are within reach.
        let reaches = |angle: f64| {
            let d = (ground * ground + crank * crank - 2.0 * ground * crank * angle.cos()).sqrt();
            d < 0.99 * (coupler + rocker) && d > 1.01 * (coupler - rocker).abs()
        };
        let Some(start) = (0..90)
            .map(|k| f64::from(k) * PI / 90.0)
            .find(|angle| reaches(*angle))
        else {
            continue;
        };
        let linkage = four_bar(lengths, start + 0.001, 1, "");
        let motion = track(&linkage);
        let stop = motion
            .stop
            .unwrap_or_else(|| panic!("case {case}: {lengths:?} turns fully"));
        let study = study(&linkage, &motion);
        let chain = only_chain(&study);
        assert!(matches!(chain.kind, ChainKind::FourBar { class: found, .. } if found == class));
        assert!(!chain.turns_fully());
        let end = linkage.drives[0].at(stop.t)[0].rem_euclid(TAU);
        let off = chain
            .singular_drive_rad
            .iter()
            .map(|angle| (angle - end).abs());
        assert!(
            off.fold(1.0, f64::min) < 1e-7,
            "case {case}: {end} of {:?}",
            chain.singular_drive_rad
        );
        classes.push(class);
    }
    for class in [
        Grashof::RockerCrank,
        Grashof::DoubleRocker,
        Grashof::TripleRocker,
    ] {
        assert!(classes.contains(&class), "{class:?} is not among them");
    }
}

#[test]
fn the_eccentric_slider_crank_has_the_stroke_of_its_formula() {
    let linkage = shipped("slider-crank-eccentric");
    let study = studied(&linkage);
    let (r, l, e) = (0.025, 0.2, 0.02f64);
    let (far, close) = (
        ((l + r) * (l + r) - e * e).sqrt(),
        ((l - r) * (l - r) - e * e).sqrt(),
    );
    let guide = stroke(&linkage, &study, "guide");
    near(guide.range(), far - close, 1e-15, "stroke");
    let (stretched, folded) = ((e / (l + r)).asin(), PI + (e / (l - r)).asin());
    let chain = only_chain(&study);
    let found = drive_values(&linkage, chain.dead.iter().map(|dead| dead.t_s));
    for (value, expected) in found.iter().zip([stretched, folded]) {
        near(*value, expected, 1e-12, "dead point");
    }
    let imbalance = folded - stretched - PI;
    near(
        guide.time_ratio.unwrap(),
        (PI + imbalance) / (PI - imbalance),
        1e-12,
        "time ratio",
    );
    near(
        chain.transmission.unwrap().0,
        ((r + e) / l).acos(),
        1e-12,
        "transmission",
    );
    assert_eq!(
        chain.kind,
        ChainKind::SliderCrank {
            crank: r,
            coupler: l,
            offset: e
        }
    );
    assert!(chain.turns_fully());

    // With a rod of 0.03 m the crank's pin leaves the rod's reach where r sin q = e - l.
    let text = crate::shipped_text("slider-crank-eccentric")
        .replace("length_m = 0.2\n", "length_m = 0.03\n");
    let linkage = parse(&text);
    let motion = track(&linkage);
    let study = trirrr_linkage::assur::study(&linkage, &motion);
    let chain = only_chain(&study);
    let below = ((e - 0.03) / r).asin();
    let mut expected = [PI - below, TAU + below];
    expected.sort_by(f64::total_cmp);
    assert_eq!(
        chain.singular_drive_rad.len(),
        2,
        "{:?}",
        chain.singular_drive_rad
    );
    for (value, expected) in chain.singular_drive_rad.iter().zip(expected) {
        near(*value, expected, 1e-12, "singular");
    }
    let end = linkage.drives[0].at(motion.stop.unwrap().t)[0];
    near(end, PI - below, 1e-7, "end");
}

#[test]
fn quick_returns_have_the_ratio_of_their_levers_extremes() {
    let half = (0.1f64 / 0.25).asin();
    let expected = (PI + 2.0 * half) / (PI - 2.0 * half);
    for (file, lever, slot) in [
        ("quick-return", "lever", "slot"),
        ("quick-return-slotted", "lever", "slot"),
        ("shaper", "lever", "A"),
    ] {
        let linkage = shipped(file);
        let study = studied(&linkage);
        let lever = swing(&linkage, &study, lever);
        near(lever.range(), 2.0 * half, 1e-14, file);
        near(lever.time_ratio.unwrap(), expected, 1e-12, file);
        near(stroke(&linkage, &study, slot).range(), 0.2, 1e-15, file);
    }
    let linkage = shipped("shaper");
    let study = studied(&linkage);
    let ram = stroke(&linkage, &study, "guide");
    near(ram.range(), 2.0 * 0.5 * half.sin(), 1e-15, "ram");
    let crank = swing(&linkage, &study, "crank");
    assert_eq!((crank.turns, crank.time_ratio), (1, None));
}

#[test]
fn every_four_bar_loop_is_found_once() {
    let names = |file: &str| -> Vec<String> {
        let linkage = shipped(file);
        let study = studied(&linkage);
        study
            .chains
            .iter()
            .map(|chain| linkage.link_names(&chain.links))
            .collect()
    };
    assert_eq!(
        names("fairbairn"),
        [
            "frame, crank, rod, bridle",
            "frame, bridle, tracing, rocker"
        ]
    );
    assert_eq!(names("tetrad"), ["coupler, left-bar, rocker, right-bar"]);
    assert_eq!(
        names("stephenson"),
        ["frame, left-rocker, coupler, right-rocker"]
    );
    assert_eq!(names("inserter"), ["frame, crank, coupler, rocker"]);
    assert_eq!(names("quick-return"), ["frame, lever, rod, ram"]);
    assert!(names("five-bar").is_empty() && names("serial-arm").is_empty());
}

#[test]
fn few_steps_and_many_turns_miss_no_turning_point() {
    let half = (0.1f64 / 0.25).asin();
    let expected = (PI + 2.0 * half) / (PI - 2.0 * half);
    for motion in ["steps = 4", "turns = 5\nsteps = 30"] {
        let text = crate::shipped_text("shaper");
        let linkage = parse(&format!("{text}\n[motion]\n{motion}\n"));
        let study = studied(&linkage);
        let lever = swing(&linkage, &study, "lever");
        near(lever.range(), 2.0 * half, 1e-14, motion);
        near(lever.time_ratio.unwrap(), expected, 1e-11, motion);
    }
    // Less than a turn has no ratio, and ends where it ends.
    let linkage = parse(&format!(
        "{}\n[motion]\nturns = 0.25\n",
        crate::shipped_text("slider-crank")
    ));
    let study = studied(&linkage);
    let guide = stroke(&linkage, &study, "guide");
    assert_eq!(guide.time_ratio, None);
    near(
        guide.ends[0].0,
        (0.35f64 * 0.35 - 0.1 * 0.1).sqrt(),
        1e-15,
        "at a quarter",
    );
    near(guide.ends[1].0, 0.45, 1e-15, "at the start");
}
