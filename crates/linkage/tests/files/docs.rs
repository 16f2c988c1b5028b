//! The table of figures in `docs/linkages.md`, as the ready files give it.

use crate::shipped;
use std::path::Path;
use trirrr_linkage::assur::{ChainKind, Traveller, study, track};

const FILES: [&str; 11] = [
    "four-bar",
    "slider-crank",
    "slider-crank-eccentric",
    "scotch-yoke",
    "quick-return",
    "shaper",
    "fairbairn",
    "inserter",
    "two-loop",
    "stephenson",
    "tetrad",
];

fn row(file: &str) -> String {
    let linkage = shipped(file);
    let motion = track(&linkage);
    let study = study(&linkage, &motion);
    let classes = study.chains.iter().filter_map(|chain| match chain.kind {
        ChainKind::FourBar { class, .. } => Some(format!("{class:?}")),
        ChainKind::SliderCrank { .. } => None,
    });
    let classes: Vec<String> = classes.collect();
    let angles = study.chains.iter().filter_map(|chain| chain.transmission);
    let angles: Vec<String> = angles
        .map(|(angle, _)| format!("{:.2}", angle.to_degrees()))
        .collect();
    let mut ranges = Vec::new();
    let mut ratios = Vec::new();
    for travel in study.travels.iter().filter(|travel| travel.turns == 0) {
        let (name, range) = match &travel.of {
            Traveller::Links(links) => (
                linkage.link_names(links).replace(", ", " + "),
                format!("{:.2} deg", travel.range().to_degrees()),
            ),
            Traveller::Slide(joint) => (
                linkage.joints[*joint].name.clone(),
                format!("{:.1} mm", 1e3 * travel.range()),
            ),
        };
        ranges.push(format!("{name} {range}"));
        ratios.extend(travel.time_ratio);
    }
    let quickest = ratios.into_iter().fold(1.0, f64::max);
    let or_none = |texts: &[String]| match texts {
        [] => "-".to_owned(),
        texts => texts.join("; "),
    };
    let newton = study
        .newton
        .iter()
        .map(|figures| figures.iterations.0.to_string());
    format!(
        "| `{file}` | {} | {} | {} | {} | {} | {quickest:.3} |",
        study.loops.len(),
        or_none(&newton.collect::<Vec<_>>()),
        or_none(&classes),
        or_none(&angles),
        ranges.join("; ")
    )
}

#[test]
fn the_table_of_figures_is_that_of_the_ready_files() {
    let head = "| file | loops | Newton | four-bar loops | transmission, deg | swings and strokes | time ratio |\n|---|---:|---:|---|---:|---|---:|";
    let rows = FILES.map(row).join("\n");
    let table = format!("<!-- figures -->\n{head}\n{rows}\n<!-- end of figures -->");
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/linkages.md");
    let text = std::fs::read_to_string(&path).unwrap();
    let start = text
        .find("<!-- figures -->")
        .expect("the table's beginning");
    let end_mark = "<!-- end of figures -->";
    let end = text.find(end_mark).expect("the table's end") + end_mark.len();
    if std::env::var_os("TRIRRR_BLESS").is_some() {
        std::fs::write(&path, format!("{}{table}{}", &text[..start], &text[end..])).unwrap();
    } else {
        assert!(
            text[start..end] == table,
            "docs/linkages.md differs; TRIRRR_BLESS=1 writes:\n{table}"
        );
    }
}
