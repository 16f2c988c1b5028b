//! Pins in slots, against the same mechanisms with blocks and against closed forms.

use crate::refusals::{refusal, refused};
use crate::{joint, link, parse, pin, shipped, shipped_text, slide};
use trirrr_linkage::assur::{GroupKind, Linkage, Mobility, Track, track};

/// Table of a pin in a slot.
fn in_slot(name: &str, slot: &str, pin: &str, more: &str) -> String {
    format!(
        "[[joint]]\nname = \"{name}\"\nkind = \"pin-in-slot\"\nslot = \"{slot}\"\npin = \"{pin}\"\n{more}"
    )
}

/// The same motion of all links and slides of `slotted`, within 1e-12 of the largest.
fn moves_like(slotted: &Linkage, blocked: &Linkage) -> Track {
    let (one, other) = (track(slotted), track(blocked));
    assert!(one.stop.is_none() && other.stop.is_none());
    assert_eq!(one.positions.len(), other.positions.len());
    let mut largest = [0.0f64; 3];
    let mut pairs: Vec<[[f64; 2]; 3]> = Vec::new();
    for (a, b) in one.positions.iter().zip(&other.positions) {
        for index in slotted.file_links() {
            let of = link(blocked, &slotted.links[index].name);
            let (s, t) = (&a.states[index].motion, &b.states[of].motion);
            pairs.push([
                [a.states[index].angle, b.states[of].angle],
                [s.rate, t.rate],
                [s.acceleration, t.acceleration],
            ]);
            for axis in 0..2 {
                pairs.push([
                    [s.origin.position[axis], t.origin.position[axis]],
                    [s.origin.velocity[axis], t.origin.velocity[axis]],
                    [s.origin.acceleration[axis], t.origin.acceleration[axis]],
                ]);
            }
        }
        for index in 0..slotted.joints.len() {
            if let Some(s) = a.slide(slotted, index) {
                let of = joint(blocked, &slotted.joints[index].name);
                let t = b.slide(blocked, of).expect("a slide");
                pairs.push([0, 1, 2].map(|order| [s[order], t[order]]));
            }
        }
    }
    for pair in &pairs {
        for (most, [a, _]) in largest.iter_mut().zip(pair) {
            *most = most.max(a.abs());
        }
    }
    for pair in &pairs {
        for (most, [a, b]) in largest.iter().zip(pair) {
            assert!((a - b).abs() <= 1e-12 * most, "{a} {b} of {most}");
        }
    }
    one
}

#[test]
fn the_shaper_moves_like_its_blocks_and_like_its_formulas() {
    let slotted = shipped("shaper");
    let block =
        |name: &str| format!("[[link]]\nname = \"{name}\"\npoints_m = {{ P = [0.0, 0.0] }}\n\n");
    let text = shipped_text("shaper");
    let (head, joints) = text.split_at(text.find("[[joint]]").unwrap());
    let mut parts: Vec<String> = vec![head.into(), block("one"), block("two")];
    for table in joints.split("[[joint]]").skip(1) {
        parts.push(match table {
            table if table.contains("name = \"A\"") => {
                pin("A-pin", ["crank.A", "one.P"]) + &slide("A", "lever.Q", "one.P", "branch = 1\n")
            }
            table if table.contains("name = \"E\"") => {
                let upright = "direction_rad = 1.5707963267948966\n";
                slide("E", "ram.R", "two.P", upright) + &pin("E-pin", ["lever.E", "two.P"])
            }
            table => format!("[[joint]]{table}"),
        });
    }
    let blocked = parse(&parts.concat());
    let count = |linkage: &Linkage| Mobility::count(linkage.links.len(), &linkage.joints);
    assert_eq!(count(&slotted).to_string(), "3 (4 - 1) - 2 * 3 - 2 = 1");
    assert_eq!(count(&blocked).to_string(), "3 (6 - 1) - 2 * 7 = 1");

    let track = moves_like(&slotted, &blocked);
    let (lever, ram) = (link(&slotted, "lever"), link(&slotted, "ram"));
    for position in &track.positions {
        let q = 6.0 * position.t;
        let expected = (0.25 + 0.1 * q.sin()).atan2(0.1 * q.cos());
        assert!((position.states[lever].angle - expected).abs() < 1e-14);
        let at = position.states[ram].motion.origin.position;
        assert!((at.x - 0.5 * expected.cos()).abs() < 1e-15 && (at.y - 0.18).abs() < 1e-15);
    }
}

/// The pin of the crank runs in a slot of the coupler of a four-bar: four links that are solved together.
#[test]
fn a_slot_in_an_iterated_group_needs_no_guess_and_moves_like_its_block() {
    let text = shipped_text("stephenson");
    let (head, rest) = text.split_at(text.find("[[link]]\nname = \"rod\"").unwrap());
    let rest = &rest[rest.find("[[link]]\nname = \"coupler\"").unwrap()..];
    let (links, joints) = rest.split_at(rest.find("[[joint]]").unwrap());
    let head = head.replace("trace = [\"coupler.P\", \"coupler.A\"]", "");
    let links = links.replace("P = [0.1, 0.12]", "S = [0.5, 0.0]");
    let upright = "direction_rad = 1.5707963267948966\n";
    let (slot_line, mut kept) = ("name = \"D\"", String::new());
    for table in joints.split("[[joint]]").skip(1) {
        if !table.contains(slot_line) && !table.contains("name = \"P\"") {
            kept += &format!("[[joint]]{table}");
        }
    }
    let slot = in_slot("D", "coupler.S", "crank.D", upright);
    let slotted = parse(&[head.as_str(), &links, &slot, &kept].concat());
    assert_eq!(slotted.groups[1].kind, GroupKind::Triad);
    let block = "[[link]]\nname = \"block\"\npoints_m = { P = [0, 0] }\n\
                 guess = { at_m = [0.6, 0.35], angle_rad = 0.1 }\n";
    let joints =
        pin("D-pin", ["crank.D", "block.P"]) + &slide("D", "coupler.S", "block.P", upright);
    let blocked = parse(&[head.as_str(), &links, block, &joints, &kept].concat());
    let track = moves_like(&slotted, &blocked);
    // The pin stays on the line of the slot.
    let coupler = link(&slotted, "coupler");
    for position in &track.positions {
        let state = &position.states[coupler];
        let q = slotted.drives[0].at(position.t)[0];
        let pin = [0.55 + 0.05 * q.cos(), 0.35 + 0.05 * q.sin()];
        let from = state.motion.origin.position;
        let (sin, cos) = state.angle.sin_cos();
        let along = cos * (pin[0] - from.x) + sin * (pin[1] - from.y);
        assert!((along - 0.5).abs() < 1e-15, "{along}");
    }
}

#[test]
fn slots_are_refused_in_words() {
    let slot = "slot = \"lever.Q\"\npin = \"crank.A\"";
    refused(
        "shaper",
        slot,
        "slot = \"lever.Q\"\npin = \"lever.E\"",
        "slot and pin are of one link",
    );
    refused(
        "shaper",
        slot,
        "slot = \"lever.Q\"",
        "joint[2].pin: missing",
    );
    refused(
        "shaper",
        slot,
        "slot = \"lever.X\"\npin = \"crank.A\"",
        "the link has no point `X`",
    );
    refused(
        "shaper",
        slot,
        &format!("{slot}\nangle_rad = 1.0"),
        "joint[2].angle_rad = 1.0: unknown key",
    );
    refused(
        "shaper",
        "kind = \"pin-in-slot\"",
        "kind = \"pin-slot\"",
        "pin-in-slot",
    );
    refused(
        "shaper",
        "pin = \"lever.E\"",
        "pin = \"lever.E\"\nbranch = 1",
        "joint[4].branch = 1: the joint is not between the two links of a dyad",
    );
    refused(
        "shaper",
        "[[drive]]\njoint = \"O\"\nrate_rad_s = 6.0",
        "[[drive]]\njoint = \"A\"\nrate_rad_s = 6.0",
        "drive[1].joint = \"A\": a pin in a slot cannot be driven",
    );
    // One slot more, and one less.
    let more = in_slot("X", "frame.O", "lever.E", "") + "[[drive]]\n";
    refused(
        "shaper",
        "[[drive]]\n",
        &more,
        "over-constrained: degrees of freedom 3 (4 - 1) - 2 * 3 - 3 = 0, drives 1",
    );
    let text = shipped_text("shaper");
    let (before, from) = text.split_at(text.find("[[joint]]\nname = \"E\"").unwrap());
    let after = &from[from.find("[[joint]]\nname = \"guide\"").unwrap()..];
    let said = refusal(&format!("{before}{after}"));
    assert!(
        said.contains("under-constrained: degrees of freedom 3 (4 - 1) - 2 * 3 - 1 = 2"),
        "{said}"
    );
}

/// A rod whose pin runs in a slot of the frame is a slider-crank without its slider; the branch belongs to the block's pin.
#[test]
fn a_slot_in_the_frame_is_a_slider_crank() {
    for branch in [1, -1] {
        let text = shipped_text("slider-crank-eccentric");
        let (links, from) = text.split_at(text.find("[[link]]\nname = \"slider\"").unwrap());
        let (joints, drive) = from.split_at(from.find("[[drive]]").unwrap());
        let joints = &joints[joints.find("[[joint]]").unwrap()..];
        let mut kept = String::new();
        for table in joints.split("[[joint]]").skip(1) {
            if !table.contains("name = \"B\"") && !table.contains("name = \"guide\"") {
                kept += &format!("[[joint]]{table}");
            }
        }
        let blocked = parse(&text.replace("branch = 1", &format!("branch = {branch}")));
        let guide = joint(&blocked, "guide");
        let offset = match &blocked.joints[guide].kind {
            trirrr_linkage::assur::JointKind::Prismatic(slide) => slide.offset,
            trirrr_linkage::assur::JointKind::Revolute(_) => panic!(),
        };
        let more = format!("offset_m = {offset:?}\nbranch = {branch}\n");
        let slot = in_slot("guide", "frame.O", "rod.B", &more);
        let slotted = parse(&[links, &slot, &kept, drive].concat());
        assert_eq!(slotted.groups[1].title(), "dyad RRP");
        moves_like(&slotted, &blocked);
    }
}
