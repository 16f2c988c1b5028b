//! A study as a document: the machine before and after, side by side.

use super::record::{StudyRecord, StudyResult, set_arguments};
use super::{DesignArgs, folder_of};
use crate::design::figures;
use crate::design::study::Study;
use trirrr_design::optimise::{StudyMode, StudyScene};
use trirrr_figures::document::{Document, Facts, digits};

/// Figures of the report that stand side by side.
const SIDE_BY_SIDE: [&str; 2] = ["geometry", "workspace"];

/// Rows of the front in the page, at most.
const FRONT_SHOWN: usize = 40;

/// Study with its `figures`. Its object is the `result` of `study.json`.
pub(super) fn document(
    study: &StudyScene,
    record: &StudyRecord,
    result: &StudyResult,
    figures: &[(&'static str, String)],
) -> Document {
    let mut document = Document::new();
    let feasible = result.all.iter().filter(|each| each.found.is_ok()).count();
    let looked_at = format!(
        "{}: {} candidates, {feasible} of them do the job{}",
        record.scene,
        result.all.len(),
        match record.partial {
            true => "; interrupted, so the best one so far",
            false => "",
        }
    );
    document.note(looked_at);
    document.data("feasible", feasible);
    document.table("", compared(study, record, result));
    if let Some(reason) = &record.own.reason {
        document.note(format!("the scene itself: {reason}"));
    }
    for (_, svg) in figures {
        document.figure(svg.as_str());
    }
    let of = |index: usize| {
        let each = &result.all[index];
        Facts::new()
            .data("candidate", index + 1)
            .data("found", each.found.as_ref().ok())
            .data("set", set_arguments(study, each))
    };
    let is_front = study.objectives.len() > 1;
    document.pairs(
        Facts::new()
            .data("best", result.best.map(of))
            .data("best_is", if is_front { "knee" } else { "optimum" })
            .rows("front", result.front.iter().map(|index| of(*index))),
    );
    if is_front {
        front(&mut document, study, result);
    }
    document
}

/// Quantities and values, before and after.
fn compared(study: &StudyScene, record: &StudyRecord, result: &StudyResult) -> Vec<Facts> {
    let best = result.best.map(|index| &result.all[index]);
    let row = |name: &str, before: String, after: String, bounds: String| {
        let pair = Facts::new().text("", name).text("before", before);
        pair.text("after", after).text("bounds", bounds)
    };
    let mut rows = Vec::new();
    for (index, objective) in study.objectives.iter().enumerate() {
        let [words, unit] = objective.words();
        let own = record.own.found.as_ref().map(|found| found[index]);
        let after = best.and_then(|each| Some(each.found.as_ref().ok()?[index]));
        let [before, after] = [own, after].map(|value| match value {
            Some(value) => format!("{} {unit}", digits(value)),
            None => "none".into(),
        });
        rows.push(row(words, before, after, String::new()));
    }
    let Some(best) = best else {
        return rows;
    };
    if let (Some(mode), Ok(draft)) = (best.point.mode, study.draft()) {
        let elbows = draft.parameters.legs.each_ref().map(|leg| leg.elbow);
        let own = StudyMode(elbows).to_string();
        rows.push(row("working mode", own, mode.to_string(), String::new()));
    }
    let own = super::own_values(study).unwrap_or_default();
    for ((range, before), after) in study.space.ranges.iter().zip(own).zip(&best.point.values) {
        let at = match *after {
            after if after == range.low => ", at its least",
            after if after == range.high => ", at its greatest",
            _ => "",
        };
        let bounds = format!("{} to {}{at}", range.low, range.high);
        rows.push(row(
            &range.name(),
            before.to_string(),
            after.to_string(),
            bounds,
        ));
    }
    rows
}

/// Candidates that no other one beats.
fn front(document: &mut Document, study: &StudyScene, result: &StudyResult) {
    document.page_heading("Front");
    document.note(format!(
        "front: {} candidates that no other one beats in both quantities. The best is its knee: beyond it, one quantity costs much for little of the other",
        result.front.len()
    ));
    let step = result.front.len().div_ceil(FRONT_SHOWN).max(1);
    let shown = result.front.iter().enumerate();
    let shown = shown.filter(|(row, index)| row % step == 0 || Some(**index) == result.best);
    let rows = shown.map(|(_, &index)| {
        let each = &result.all[index];
        let mut row = Facts::new().derived("candidate", "", index + 1);
        for (objective, value) in study.objectives.iter().zip(each.found.iter().flatten()) {
            let [words, unit] = objective.words();
            row = row.derived(words, unit, value);
        }
        let set = set_arguments(study, each).join(" ");
        row.text("values", set).marked(Some(index) == result.best)
    });
    document.page_table("", rows.collect());
}

/// Adds both machines and the ways to the files, for the page.
pub(super) fn add_machines(
    document: &mut Document,
    args: &DesignArgs,
    study: &StudyScene,
    record: &StudyRecord,
    result: &StudyResult,
) {
    let drawn = |added: &[String]| {
        let mut args = args.clone();
        let settings = added.iter().filter_map(|setting| setting.parse().ok());
        args.set.set.extend(settings);
        let study = Study::brief(&args).ok()?;
        let drawn = figures::all(&study).into_iter();
        let drawn = drawn.filter_map(|(name, drawn)| Some((name, drawn.ok()?)));
        Some(drawn.collect::<Vec<_>>())
    };
    let before = drawn(&[]);
    let best = result
        .best
        .map(|index| set_arguments(study, &result.all[index]));
    let after = best.and_then(|set| drawn(&set));
    document
        .page_heading("The machine")
        .page_note("Before on the left, after on the right.");
    for wanted in SIDE_BY_SIDE {
        let pair = [&before, &after].map(|figures| {
            let figure = figures.iter().flatten().find(|(name, ..)| *name == wanted);
            let refused = "<p>The scene is refused in all working modes.</p>";
            format!(
                "<div>{}</div>",
                figure.map_or(refused, |each| each.1.as_str())
            )
        });
        document.figure(format!("<div class=\"pair\">{}</div>", pair.concat()));
    }
    let best = folder_of(args, &record.scene).join("best.toml");
    document.page_note(format!("The scene of the best machine is played by `trirrr run {}`. All candidates are in evaluations.csv.", best.display()));
}
