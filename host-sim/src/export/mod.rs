//! `trirrr export`: the machine of a scene for simulators of other authors, as MJCF, SDF or URDF.

mod args;
mod machine;
mod mjcf;
mod sdf;
mod urdf;

pub use args::{ExportArgs, ExportFormat};

use crate::failure::CliError;
use crate::results::write_new;
use crate::terminal::print;
use machine::ExportedMachine;
use std::path::PathBuf;

/// Writes the machine.
///
/// # Errors
/// Refused: the scene, or a file that is there already. Failed: it cannot be written.
pub fn command(args: &ExportArgs) -> Result<(), CliError> {
    let scene = args.set.scene(&args.scene)?;
    let machine = ExportedMachine::of(&scene)
        .map_err(|reason| CliError::Refused(format!("{}: {reason}", args.scene.display())))?;
    let text = match args.format {
        ExportFormat::Mjcf => mjcf::text(&machine),
        ExportFormat::Sdf => sdf::text(&machine),
        ExportFormat::Urdf => urdf::text(&machine),
    };
    let file = match &args.out {
        Some(file) => file.clone(),
        None => PathBuf::from(format!("{}.{}", machine.name, args.format.ending())),
    };
    write_new(&file, text.as_bytes())?;
    let notes = machine.notes(args.format);
    print(&format!("wrote {}\n{notes}", file.display()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use trirrr_scene::Scene;

    fn machine(name: &str) -> ExportedMachine {
        let file = format!("{}/../scenes/{name}.toml", env!("CARGO_MANIFEST_DIR"));
        ExportedMachine::of(&Scene::read(file).unwrap()).unwrap()
    }

    /// Numbers of an attribute or of an element.
    fn numbers(text: &str) -> Vec<f64> {
        let numbers = text.split_whitespace().map(|word| word.parse().unwrap());
        numbers.collect()
    }

    /// Point of a frame at `pose` (x, y, angle), in the frame of the pose.
    fn moved([x, y, angle]: [f64; 3], [px, py]: [f64; 2]) -> [f64; 2] {
        let (sin, cos) = angle.sin_cos();
        [x + cos * px - sin * py, y + sin * px + cos * py]
    }

    fn near([ax, ay]: [f64; 2], [bx, by]: [f64; 2]) {
        assert!((ax - bx).hypot(ay - by) < 1e-12, "{ax} {ay}, {bx} {by}");
    }

    /// At the keyframe the sites that are to meet do so.
    #[test]
    fn loops_of_the_mjcf_close_at_the_start() {
        let text = mjcf::text(&machine("vertical"));
        let document = roxmltree::Document::parse(&text).unwrap();
        let named = |tag: &str, name: &str| {
            let mut all = document.descendants();
            all.find(|node| node.has_tag_name(tag) && node.attribute("name") == Some(name))
                .unwrap()
        };
        let of = |tag: &str, name: &str, attribute: &str| {
            numbers(named(tag, name).attribute(attribute).unwrap())
        };
        let start = of("key", "start", "qpos");
        let platform = [start[6], start[7], start[8]];
        for leg in 0..3 {
            let name = |part: &str| format!("leg{}_{part}", leg + 1);
            let base = of("body", &name("proximal"), "pos");
            let elbow = of("body", &name("distal"), "pos");
            let end = of("site", &name("end"), "pos");
            let joint = of("site", &name("joint"), "pos");
            let (first, second) = (start[2 * leg], start[2 * leg] + start[2 * leg + 1]);
            let elbow = moved([base[0], base[1], first], [elbow[0], elbow[1]]);
            let end = moved([elbow[0], elbow[1], second], [end[0], end[1]]);
            near(end, moved(platform, [joint[0], joint[1]]));
            let ends = named("connect", &name("loop"));
            assert_eq!(ends.attribute("site1"), Some(&*name("end")));
            assert_eq!(ends.attribute("site2"), Some(&*name("joint")));
        }
    }

    /// Joints of the SDF lie where both of their links have them.
    #[test]
    fn links_of_the_sdf_meet_in_their_joints() {
        let text = sdf::text(&machine("vertical"));
        let document = roxmltree::Document::parse(&text).unwrap();
        let pose = |name: &str| {
            let mut links = document.descendants();
            let link = links
                .find(|node| node.has_tag_name("link") && node.attribute("name") == Some(name));
            let pose = link.unwrap().children();
            let mut pose = pose.filter(|node| node.has_tag_name("pose"));
            let all = numbers(pose.next().unwrap().text().unwrap());
            [all[0], all[1], all[5]]
        };
        let own = machine("vertical");
        for (index, leg) in own.legs.iter().enumerate() {
            let name = |part: &str| format!("leg{}_{part}", index + 1);
            let (proximal, distal) = (pose(&name("proximal")), pose(&name("distal")));
            near(
                [distal[0], distal[1]],
                moved(proximal, [leg.proximal_m, 0.0]),
            );
            near(
                moved(distal, [leg.distal_m, 0.0]),
                moved(pose("platform"), leg.joint_m),
            );
        }
    }

    /// The tree of the URDF goes from the base over leg 1 to the platform; every link has one joint to it.
    #[test]
    fn links_of_the_urdf_are_a_tree_with_a_mass_in_each_that_moves() {
        for name in ["vertical", "thesis"] {
            let text = urdf::text(&machine(name));
            let document = roxmltree::Document::parse(&text).unwrap();
            let root = document.root_element();
            let of = |tag: &'static str| {
                let parts = root.children().filter(move |node| node.has_tag_name(tag));
                parts.map(|node| node.attribute("name").unwrap().to_owned())
            };
            let links: Vec<String> = of("link").collect();
            let children: Vec<String> = document
                .descendants()
                .filter(|node| node.has_tag_name("child") && node.has_attribute("link"))
                .map(|node| node.attribute("link").unwrap().to_owned())
                .collect();
            assert_eq!(links.len(), children.len() + 1);
            for link in links.iter().filter(|link| *link != "base") {
                assert_eq!(children.iter().filter(|child| *child == link).count(), 1);
            }
            let masses = document
                .descendants()
                .filter(|node| node.has_tag_name("mass"));
            let masses: Vec<f64> = masses
                .map(|node| node.attribute("value").unwrap().parse().unwrap())
                .collect();
            assert_eq!(masses.len(), 7);
            assert!(masses.iter().all(|mass| *mass > 0.0));
        }
    }

    #[test]
    fn what_is_left_out_or_added_is_said() {
        assert_eq!(machine("thesis-links").notes(ExportFormat::Mjcf), "");
        let notes = machine("vertical").notes(ExportFormat::Mjcf);
        assert_eq!(notes, "the wrench of the scene is left out\n");
        let notes = machine("thesis").notes(ExportFormat::Urdf);
        assert!(
            notes.contains("6 links without a mass have 1e-6 kg"),
            "{notes}"
        );
        assert!(notes.contains("no gravity"), "{notes}");
        assert!(notes.contains("leg2_end and leg2_joint"), "{notes}");
    }
}
