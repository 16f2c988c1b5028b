//! Closed form against closure: the dyads of the core against Newton-Raphson on the equations.

use super::*;
use crate::assur::groups::GroupKind;
use crate::assur::track;
use crate::redundant::random::share;
use std::path::Path;

/// Poses, rates and accelerations of the group's links, lengths in sizes of the linkage.
fn values(group: &Group, states: &[LinkState], size: f64) -> [Vec<f64>; 3] {
    let of = |value: fn(&LinkState) -> [f64; 3]| -> Vec<f64> {
        let each = group.links.iter().flat_map(|&link| {
            let [x, y, angle] = value(&states[link]);
            [x / size, y / size, angle]
        });
        each.collect()
    };
    [of(LinkState::pose), of(velocity), of(acceleration)]
}

/// Every dyad, at every position, is also solved by Newton-Raphson from poses a little off:
/// closed form and closure give the same motion within 4 u cond. Rates are computed from poses
/// and accelerations from both, so their errors are amplified once and twice more at worst:
/// allowed for where `amplified`. Returns the number of dyads compared.
fn compare(linkage: &Linkage, what: &str, amplified: bool) -> usize {
    let size = linkage.size();
    let track = track(linkage);
    let groups = linkage.groups.iter().enumerate();
    let dyads: Vec<_> = groups
        .filter(|(_, group)| matches!(group.kind, GroupKind::Dyad(_)))
        .collect();
    let mut compared = 0;
    for position in &track.positions {
        // Squares of rates go into the accelerations, those of the known links too.
        let rates = position.states.iter().map(|state| state.motion.rate.abs());
        let fastest = rates.fold(0.0, f64::max);
        for &(index, group) in &dyads {
            // Nearer, a start a little off may lie on the other branch.
            if position.groups[index].distance < 0.1 {
                continue;
            }
            compared += 1;
            let mut states = position.states.clone();
            // What comes later is not known yet.
            for later in &linkage.groups[index..] {
                for &link in &later.links {
                    states[link].known = false;
                }
            }
            for &link in &group.links {
                let [x, y, angle] = states[link].pose();
                states[link].move_to([x + 0.01 * size, y - 0.01 * size, angle + 0.01]);
            }
            let found = solve(linkage, group, &mut states, position.t).unwrap();
            let closed = values(group, &position.states, size);
            let iterated = values(group, &states, size);
            let mut bound = 4.0 * (f64::EPSILON / 2.0) / found.distance;
            for (order, (closed, iterated)) in closed.iter().zip(&iterated).enumerate() {
                let scale = closed.iter().fold(1.0, |s, value| f64::max(s, value.abs()));
                let scale = match order {
                    2 => scale.max(fastest * fastest),
                    _ => scale,
                };
                for (a, b) in closed.iter().zip(iterated) {
                    assert!(
                        (a - b).abs() <= bound * scale,
                        "{what}: group {index}, order {order}, t = {}: {a} and {b}",
                        position.t
                    );
                }
                if amplified {
                    bound /= found.distance;
                }
            }
        }
    }
    compared
}

#[test]
fn closed_form_and_closure_agree_over_a_turn_of_every_shipped_file() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../linkages");
    let files = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path());
    let compared = files.map(|file| {
        let linkage = Linkage::read(&file).unwrap();
        compare(&linkage, &linkage.name, false)
    });
    // 18 dyads at 361 positions each.
    assert_eq!(compared.sum::<usize>(), 18 * 361);
}

/// Uniform in -1..1, the same in every run.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        // Knuth's MMIX multiplier and increment; the upper bits are the random ones.
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / f64::from(1u32 << 26) / f64::from(1u32 << 26) - 1.0
    }
}

/// Crank and one dyad between the crank and the frame, of the three letters, with guides and
/// sliders on either side and offsets everywhere.
fn random_machine(letters: [char; 3], random: &mut Random) -> String {
    let mut point = |x: f64, y: f64, spread: f64| {
        format!(
            "[{:?}, {:?}]",
            x + spread * random.next(),
            y + spread * random.next()
        )
    };
    let links = format!(
        "name = \"random\"\n[motion]\nsteps = 24\n\
         [[link]]\nname = \"frame\"\npoints_m = {{ O = [0, 0], C = {} }}\n\
         [[link]]\nname = \"crank\"\npoints_m = {{ O = [0, 0], A = {} }}\n\
         [[link]]\nname = \"one\"\npoints_m = {{ U = {}, V = {} }}\n\
         [[link]]\nname = \"two\"\npoints_m = {{ V = {}, W = {} }}\n",
        point(1.5, 0.2, 0.2),
        point(0.2, 0.0, 0.1),
        point(0.0, 0.0, 0.3),
        point(1.2, 0.0, 0.3),
        point(0.0, 0.0, 0.3),
        point(1.1, 0.0, 0.3),
    );
    let mut joint = |name: &str, letter: char, a: &str, b: &str| match letter {
        'R' => {
            format!("[[joint]]\nname = \"{name}\"\nkind = \"revolute\"\nat = [\"{a}\", \"{b}\"]\n")
        }
        _ => {
            let (guide, slider) = if random.next() > 0.0 { (a, b) } else { (b, a) };
            format!(
                "[[joint]]\nname = \"{name}\"\nkind = \"prismatic\"\nguide = \"{guide}\"\n\
                 slider = \"{slider}\"\ndirection_rad = {:?}\nangle_rad = {:?}\n\
                 offset_m = {:?}\n",
                3.0 * random.next(),
                3.0 * random.next(),
                0.2 * random.next()
            )
        }
    };
    let joints = [
        joint("O", 'R', "frame.O", "crank.O"),
        joint("first", letters[0], "crank.A", "one.U"),
        joint("inner", letters[1], "one.V", "two.V"),
        joint("last", letters[2], "two.W", "frame.C"),
    ];
    let branch = if random.next() > 0.0 { 1 } else { -1 };
    let joints = joints.concat();
    let joints = match letters {
        ['P', 'R', 'P'] | ['P', 'P', 'R'] | ['R', 'P', 'P'] => joints,
        _ => joints.replace(
            "name = \"inner\"\n",
            &format!("name = \"inner\"\nbranch = {branch}\n"),
        ),
    };
    format!("{links}{joints}[[drive]]\njoint = \"O\"\nrate_rad_s = 1.5\n")
}

#[test]
fn closed_form_and_closure_agree_for_random_dyads_of_every_kind() {
    let mut random = Random(7);
    for letters in ["RRR", "RPR", "RRP", "PRR", "PRP", "PPR", "RPP"] {
        let kinds: Vec<char> = letters.chars().collect();
        let compared = (0..share(300)).map(|number| {
            let text = random_machine([kinds[0], kinds[1], kinds[2]], &mut random);
            let linkage = Linkage::parse(&text, letters)
                .unwrap_or_else(|error| panic!("{letters} {number}: {error}\n{text}"));
            compare(&linkage, &format!("{letters} {number}"), true)
        });
        let compared: usize = compared.sum();
        assert!(
            compared > share(1000) as usize,
            "{letters}: only {compared}"
        );
    }
}
