//! Figures of a study.

use super::record::{StudyRecord, StudyResult};
use trirrr_design::optimise::{Appraisal, Objective, StudyScene};
use trirrr_figures::canvas::Drawn;
use trirrr_figures::scatter::{Over, Scatter, Series, draw};
use trirrr_figures::style::{BLUE, GREEN, INK, ORANGE, VERMILLION, faded};

/// Figures by their names. One that cannot be drawn is left out.
pub(super) fn all(
    study: &StudyScene,
    record: &StudyRecord,
    result: &StudyResult,
) -> Vec<(&'static str, String)> {
    let mut figures = vec![("progress", progress(study, record, result))];
    if study.objectives.len() > 1 {
        figures.push(("front", front(study, record, result)));
    }
    let drawn = figures
        .into_iter()
        .filter_map(|(name, drawn)| Some((name, drawn.ok()?)));
    drawn.collect()
}

/// Name of the quantity with its unit, and the factor of the numbers that are shown: square metres take no prefix.
fn shown(objective: Objective) -> (String, &'static str, f64) {
    match objective.words() {
        [words, "m^2"] => (format!("{words}, cm^2"), "", 1e4),
        [words, unit] => (words.into(), unit, 1.0),
    }
}

/// Figure of `series` over two axes.
fn drawn(title: &str, [x, y]: [Over<'_>; 2], series: &[Series]) -> Drawn {
    draw(&Scatter {
        title,
        x,
        y,
        series,
        marks: &[],
        fronts: &[],
    })
}

/// The first objective of each candidate, and the best so far.
fn progress(study: &StudyScene, record: &StudyRecord, result: &StudyResult) -> Drawn {
    let objective = study.objectives[0];
    let (quantity, unit, factor) = shown(objective);
    let value = |(index, each): (usize, &Appraisal)| {
        let found = each.found.as_ref().ok()?;
        Some([(index + 1) as f64, factor * found[0]])
    };
    let values: Vec<[f64; 2]> = result.all.iter().enumerate().filter_map(value).collect();
    let mut best: Vec<[f64; 2]> = Vec::new();
    for &[number, value] in &values {
        match best.last().copied() {
            Some([_, least]) if objective.cost(value) >= objective.cost(least) => {}
            Some([_, least]) => best.extend([[number, least], [number, value]]),
            None => best.push([number, value]),
        }
    }
    best.extend(
        best.last()
            .map(|[_, value]| [result.all.len() as f64, *value]),
    );
    let mut series = vec![
        Series::dots("does the job", 2.5, values).coloured(faded(BLUE, 0.45)),
        Series::line("best so far", best).coloured(VERMILLION),
    ];
    if let Some(own) = &record.own.found {
        let ends = [1.0, result.all.len() as f64].map(|number| [number, factor * own[0]]);
        series.push(Series::line("the scene itself", ends.into()).coloured(INK));
    }
    let over = |quantity, unit, from| Over::Linear {
        quantity,
        unit,
        from,
    };
    let axes = [
        over("candidate", "", Some(0.0)),
        over(&quantity, unit, None),
    ];
    let title = format!("{}: candidates in the order of the search", record.scene);
    drawn(&title, axes, &series)
}

/// Candidates that no other one beats.
fn front(study: &StudyScene, record: &StudyRecord, result: &StudyResult) -> Drawn {
    let shown = [0, 1].map(|index| shown(study.objectives[index]));
    let scaled = |found: &[f64]| [0, 1].map(|index| shown[index].2 * found[index]);
    let pair = |each: &Appraisal| Some(scaled(each.found.as_ref().ok()?));
    let of = |indices: &[usize]| -> Vec<[f64; 2]> {
        let points = indices.iter().filter_map(|index| pair(&result.all[*index]));
        points.collect()
    };
    let others: Vec<[f64; 2]> = result.all.iter().filter_map(pair).collect();
    let knee: Vec<usize> = result.best.into_iter().collect();
    let mut series = vec![
        Series::dots("does the job", 2.5, others).coloured(faded(BLUE, 0.3)),
        Series::line("front", of(&result.front)).coloured(GREEN),
        Series::dots("no other one beats it", 4.0, of(&result.front)).coloured(GREEN),
        Series::dots("knee: best.toml", 6.0, of(&knee)).coloured(VERMILLION),
    ];
    if let Some(own) = &record.own.found {
        let own = Series::dots("the scene itself", 6.0, vec![scaled(own)]);
        series.push(own.coloured(ORANGE));
    }
    let axes = shown.each_ref().map(|(quantity, unit, _)| Over::Linear {
        quantity,
        unit,
        from: None,
    });
    let title = format!("{}: what one quantity costs in the other", record.scene);
    drawn(&title, axes, &series)
}
