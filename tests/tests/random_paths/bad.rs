//! Paths that no machine follows: each is refused with its piece and the reason, in bounded work.

use crate::drawn::DrawnJob;
use crate::geometry::Drawn;
use crate::jobs;
use crate::scene_text::job_text;
use trirrr_scene::Scene;
use trirrr_tests::draw::Draw;

/// Reasons that a reader gives, by a part of each.
const REASONS: [&str; 9] = [
    "does not reach",
    "unreachable",
    "serial singularity",
    "parallel singularity",
    "cannot stand",
    "has no length",
    "a spline needs",
    "expected one of",
    "must be",
];

/// The text of `job` with its last piece changed for `piece`.
fn ending_with(job: &mut DrawnJob, piece: Drawn) -> String {
    *job.pieces.last_mut().expect("a piece") = piece;
    let head = job.text.find("[job]").expect("a job");
    job.text[..head].to_owned() + &job_text(job, [1e-5, 1e-4])
}

/// One way or another to make the last piece of `job` impossible; the number of the piece.
fn spoil(job: &mut DrawnJob, draw: &mut Draw) -> String {
    let mut from = job.start;
    for piece in &job.pieces[..job.pieces.len() - 1] {
        from = piece.end(from);
    }
    let reach = job
        .parameters
        .legs
        .iter()
        .map(|leg| leg.proximal_m + leg.distal_m + leg.base_m.amax())
        .fold(0.0, f64::max);
    let [x, y, alpha] = from;
    let far = reach * draw.log_within(2.0, 1e6);
    let piece = match draw.within(0.0, 6.0) as u32 {
        // Nothing.
        0 => Drawn::Line { to: from },
        // Out of every reach, by a line or on an arc.
        1 => Drawn::Line {
            to: [x + far, y, alpha],
        },
        2 => Drawn::Arc {
            centre: [x + far, y],
            turn: draw.within(0.5, 100.0),
            alpha,
        },
        3 => Drawn::Bezier {
            controls: [[x, y + far, alpha], [x + far, y, alpha], from],
        },
        // A turn of the platform about itself crosses a singularity.
        4 => Drawn::Line {
            to: [x, y, alpha + draw.within(7.0, 1e4)],
        },
        // Twice the same pose.
        _ => Drawn::Spline {
            through: vec![[x + 1e-3 * reach, y, alpha]; 2],
        },
    };
    ending_with(job, piece)
}

pub(crate) fn refuse(seed: u64, paths: usize) {
    let mut draw = Draw::new(seed ^ 0xbad);
    for mut job in jobs(seed).take(paths) {
        let text = spoil(&mut job, &mut draw);
        let error = match Scene::parse(&text, "bad.toml") {
            Ok(_) => panic!("read: {text}"),
            Err(error) => error.to_string(),
        };
        // A rounded corner belongs to the piece before.
        let rounded = usize::from(job.corner_m.is_some());
        let mut places = job.pieces.len() - rounded..=job.pieces.len();
        let is_named = places.any(|piece| error.contains(&format!("job.path[{piece}]")));
        assert!(is_named, "{error} is not about the last piece:\n{text}");
        assert!(
            REASONS.iter().any(|reason| error.contains(reason)),
            "{error}\n{text}"
        );
        assert!(!error.contains("NaN") && !error.contains("inf"), "{error}");
    }
}

/// A load that the motors cannot hold anywhere on the path.
pub(crate) fn refuse_standing(seed: u64, paths: usize) {
    for job in jobs(seed).take(paths) {
        let head = job.text.find("[limits]").expect("limits");
        let tail = job.text.find("[service]").expect("settings");
        let (machine, rest) = (&job.text[..head], &job.text[tail..]);
        let heavy = machine.replace("force_n = [", "force_n = [1e3, 0.0]\n#");
        let text = format!("{heavy}[limits]\ntorque_nm = 1e-6\n{rest}");
        let error = Scene::parse(&text, "heavy.toml")
            .expect_err("a load")
            .to_string();
        assert!(error.contains("job.path[1]"), "{error}");
        let known = ["no duration helps", "singularity", "leaves the range"];
        assert!(
            known.iter().any(|reason| error.contains(reason)),
            "{error}\n{text}"
        );
    }
}
