//! Modes drawn beside each other, all to one scale.

use super::document::{is_own, side, signs};
use super::find::Modes;
use crate::figures::pose_marks;
use trirrr_design::assembly::elbows_of;
use trirrr_figures::canvas::{CENTRED, Canvas, Draw, Drawn, RIGHT_OF, Size, page};
use trirrr_figures::plane::View;
use trirrr_figures::sketch::SketchMark;
use trirrr_figures::style::{INK, MOTORS, PATH};
use trirrr_scene::record::Record;

const LEFT: f64 = 84.0;
const TOP: f64 = 84.0;
const SIDE: f64 = 300.0;
const GAP: f64 = 96.0;
/// From the bottom of a row of panels to the top of the next.
const BETWEEN: f64 = 100.0;

/// One mode: heading, machine, and `true` for that of the scene.
type Shown<'a> = (String, &'a Record, bool);

/// The assembly modes.
pub(super) fn assemblies(modes: &Modes) -> Drawn {
    let each = modes.found.modes.iter().zip(&modes.is_own).enumerate();
    let shown: Vec<Shown> = each
        .map(|(index, (mode, own))| {
            let elbows = signs(elbows_of(&mode.record));
            (
                heading(&format!("mode {}", index + 1), &elbows, &mode.record),
                &mode.record,
                *own,
            )
        })
        .collect();
    draw(
        &format!(
            "{}: assembly modes at one set of motor angles",
            modes.scene.name
        ),
        &shown,
        3,
    )
}

/// The working modes.
pub(super) fn working_modes(modes: &Modes) -> Drawn {
    let each = modes.working.iter().enumerate();
    let shown: Vec<Shown> = each
        .map(|(index, (elbows, record))| {
            let signs = signs(elbows.map(Some));
            (
                heading(&format!("mode {}", index + 1), &signs, record),
                record,
                is_own(modes, *elbows),
            )
        })
        .collect();
    draw(
        &format!("{}: working modes at one pose", modes.scene.name),
        &shown,
        4,
    )
}

fn heading(name: &str, elbows: &str, record: &Record) -> String {
    let signs = format!(
        "{name}: elbows {elbows}, det A {}, parallel {:.3}",
        side(record),
        record.parallel
    );
    signs.replace('-', "\u{2212}")
}

fn draw(title: &str, shown: &[Shown], most: usize) -> Drawn {
    let points: Vec<[f64; 2]> = shown
        .iter()
        .flat_map(|(_, record, _)| {
            record
                .legs
                .iter()
                .flat_map(|leg| [leg.base, leg.elbow(), leg.platform_joint()])
        })
        .collect();
    let columns = shown.len().clamp(1, most);
    let rows = shown.len().div_ceil(columns).max(1);
    let first = View::around(&points, "m", (LEFT, TOP), SIDE);
    let (across, down) = (first.width + GAP, first.height + BETWEEN);
    let width = (LEFT + across * columns as f64 - GAP + 40.0).max(Size::Title.width(title) + 40.0);
    let height = TOP + down * rows as f64 + 24.0;
    page(width, height, |canvas| {
        canvas.text(title, (width / 2.0, 26.0), Size::Title, CENTRED, INK)?;
        for (index, (heading, record, own)) in shown.iter().enumerate() {
            let (column, row) = (index % columns, index / columns);
            let corner = (LEFT + across * column as f64, TOP + down * row as f64);
            let view = View::around(&points, "m", corner, SIDE);
            panel(canvas, &view, heading, record, *own)?;
        }
        legend(canvas, height - 26.0)
    })
}

fn panel(canvas: &Canvas<'_>, view: &View, heading: &str, record: &Record, own: bool) -> Draw {
    let (left, top) = view.corner();
    let middle = (left + view.width / 2.0, top - 16.0);
    let colour = if own { PATH } else { INK };
    canvas.text(heading, middle, Size::Tick, CENTRED, colour)?;
    view.grid(canvas, ["x", "y"])?;
    if own {
        let (right, bottom) = (left + view.width, top + view.height);
        let frame = [
            (left, top),
            (right, top),
            (right, bottom),
            (left, bottom),
            (left, top),
        ];
        canvas.line(&frame, PATH, 3.0)?;
    }
    let [x, y, _] = record.pose;
    let pose = pose_marks(&record.legs, |colour| colour).into_iter();
    let mut marks = pose.chain([SketchMark::Dot([x, y], 3.2, PATH)]);
    marks.try_for_each(|mark| mark.draw(canvas, view))
}

fn legend(canvas: &Canvas<'_>, y: f64) -> Draw {
    let entries = [
        (MOTORS[0], "leg 1"),
        (MOTORS[1], "leg 2"),
        (MOTORS[2], "leg 3"),
        (PATH, "platform, D; frame: as in the scene"),
    ];
    let mut x = LEFT;
    for (colour, text) in entries {
        canvas.line(&[(x, y), (x + 24.0, y)], colour, 3.6)?;
        canvas.text(text, (x + 33.0, y), Size::Label, RIGHT_OF, INK)?;
        x += 57.0 + Size::Label.width(text);
    }
    Ok(())
}
