//! A study as a page: the machine before and after, side by side.

use super::files::{StudyResult, set_arguments, value_in_words};
use super::record::StudyRecord;
use super::{DesignArgs, folder_of};
use crate::design::figures;
use crate::design::page::STYLE;
use crate::design::study::Study;
use crate::figures::escaped;
use crate::terminal::digits;
use std::fmt::Write;
use trirrr_design::optimise::StudyScene;

/// Figures of the report that stand side by side.
const SIDE_BY_SIDE: [&str; 2] = ["geometry", "workspace"];

/// Rows of the front in the page, at most.
const FRONT_SHOWN: usize = 40;

/// The page.
pub(super) fn html(
    args: &DesignArgs,
    study: &StudyScene,
    record: &StudyRecord,
    result: &StudyResult,
    figures: &[(&'static str, String)],
) -> String {
    let name = escaped(&record.scene);
    let feasible = result.all.iter().filter(|each| each.found.is_ok()).count();
    let mut page = format!(
        "<!doctype html>\n<html lang=\"en\"><meta charset=\"utf-8\"><title>{name}: study</title><style>{STYLE}\
         .pair{{display:flex;gap:1em}}.pair>div{{flex:1;min-width:0}}body{{max-width:1200px}}</style>\n<h1>{name}: study</h1>\n<p>{} candidates were looked at, {feasible} of them do the job.{}</p>\n",
        result.all.len(),
        match record.partial {
            true => " The study was interrupted.",
            false => "",
        }
    );
    compared(&mut page, study, record, result);
    for (_, svg) in figures {
        page += svg;
        page.push('\n');
    }
    machines(&mut page, args, study, result);
    if study.objectives.len() > 1 {
        front_table(&mut page, study, result);
    }
    let folder = folder_of(args, &record.scene);
    let _ = writeln!(
        page,
        "<p>The scene of the best machine: <a href=\"best.toml\">best.toml</a>, to be run with <code>trirrr run {}</code>. All candidates: \
         <a href=\"evaluations.csv\">evaluations.csv</a>.</p>\n</html>",
        escaped(&folder.join("best.toml").display().to_string())
    );
    page
}

/// Table of quantities and values, before and after.
fn compared(page: &mut String, study: &StudyScene, record: &StudyRecord, result: &StudyResult) {
    *page += "<table><tr><th></th><th>before</th><th>after</th><th>bounds</th></tr>\n";
    let best = result.best.map(|index| &result.all[index]);
    let mut row = |cells: [String; 4]| {
        let [head, before, after, bounds] = cells.map(|cell| escaped(&cell));
        let _ = writeln!(
            page,
            "<tr><td>{head}</td><td>{before}</td><td>{after}</td><td>{bounds}</td></tr>"
        );
    };
    for (index, objective) in study.objectives.iter().enumerate() {
        let [words, _] = objective.words();
        let before = match &record.own.found {
            Some(found) => value_in_words(*objective, found[index]),
            None => "refused".into(),
        };
        let after = best.and_then(|each| Some(each.found.as_ref().ok()?[index]));
        let after = after.map_or(String::new(), |value| value_in_words(*objective, value));
        row([words.into(), before, after, String::new()]);
    }
    let draft = study.draft().ok();
    if let (Some(mode), Some(draft)) = (best.and_then(|each| each.point.mode), &draft) {
        let elbows = draft.parameters.legs.each_ref().map(|leg| leg.elbow);
        let own = trirrr_design::optimise::StudyMode(elbows).to_string();
        row(["working mode".into(), own, mode.to_string(), String::new()]);
    }
    let own = super::own_values(study).unwrap_or_default();
    let after = best
        .map(|each| each.point.values.clone())
        .unwrap_or_default();
    for ((range, before), after) in study.space.ranges.iter().zip(own).zip(after) {
        row([
            range.name(),
            before.to_string(),
            after.to_string(),
            format!("{} to {}", range.low, range.high),
        ]);
    }
    *page += "</table>\n";
    if let Some(reason) = &record.own.reason {
        let _ = writeln!(page, "<p class=\"no\">Before: {}</p>", escaped(reason));
    }
}

/// Figures of both machines.
fn machines(page: &mut String, args: &DesignArgs, study: &StudyScene, result: &StudyResult) {
    let drawn = |added: &[String]| {
        let mut args = args.clone();
        let settings = added.iter().filter_map(|setting| setting.parse().ok());
        args.set.set.extend(settings);
        Study::brief(&args).ok().map(|study| {
            let drawn = figures::all(&study).into_iter();
            let drawn = drawn.filter_map(|(name, drawn)| Some((name, drawn.ok()?)));
            drawn.collect::<Vec<_>>()
        })
    };
    let before = drawn(&[]);
    let best = result
        .best
        .map(|index| set_arguments(study, &result.all[index]));
    let after = best.and_then(|set| drawn(&set));
    *page += "<h2>The machine</h2>\n<p>Before on the left, after on the right.</p>\n";
    for wanted in SIDE_BY_SIDE {
        *page += "<div class=\"pair\">\n";
        for figures in [&before, &after] {
            let figure = figures.iter().flatten().find(|(name, ..)| *name == wanted);
            let svg = figure.map_or(
                "<p>The scene is refused in all working modes.</p>",
                |each| each.1.as_str(),
            );
            let _ = writeln!(page, "<div>{svg}</div>");
        }
        *page += "</div>\n";
    }
}

/// Candidates that no other one beats.
fn front_table(page: &mut String, study: &StudyScene, result: &StudyResult) {
    *page += "<h2>Front</h2>\n<p>No other candidate is better than one of these in both quantities. The shaded one is the knee: beyond it, one quantity \
        costs much for little of the other.</p>\n<table><tr><th>candidate</th>";
    for objective in &study.objectives {
        let [words, unit] = objective.words();
        let _ = write!(page, "<th>{words}, {unit}</th>");
    }
    *page += "<th>values</th></tr>\n";
    let step = result.front.len().div_ceil(FRONT_SHOWN).max(1);
    for (row, &index) in result.front.iter().enumerate() {
        let is_knee = Some(index) == result.best;
        if row % step != 0 && !is_knee {
            continue;
        }
        let each = &result.all[index];
        let class = if is_knee { " class=\"own\"" } else { "" };
        let _ = write!(page, "<tr{class}><td>{}</td>", index + 1);
        for value in each.found.iter().flatten() {
            let _ = write!(page, "<td>{}</td>", digits(*value));
        }
        let set = escaped(&set_arguments(study, each).join(" "));
        let _ = writeln!(page, "<td>{set}</td></tr>");
    }
    *page += "</table>\n";
}
