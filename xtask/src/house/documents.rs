//! Links and tables of the documents.

use super::source::tracked;
use crate::repository::root;
use anyhow::{Context, Result};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Component, Path, PathBuf};

/// Findings in the documents that git tracks, as `FILE:LINE: text`.
pub(super) struct Documents {
    /// Links to a file or a heading that is not there.
    pub(super) lost_links: Vec<String>,
    /// Rows of tables behind an empty line: a reader sees them as text.
    pub(super) cut_tables: Vec<String>,
}

pub(super) fn measure() -> Result<Documents> {
    let mut texts = BTreeMap::new();
    for path in tracked("*.md")? {
        let text = fs::read_to_string(root().join(&path));
        let text = text.with_context(|| path.display().to_string())?;
        texts.insert(path, text);
    }
    let anchors: BTreeMap<&Path, BTreeSet<String>> = texts
        .iter()
        .map(|(path, text)| (path.as_path(), anchors(text)))
        .collect();
    let mut found = Documents {
        lost_links: Vec::new(),
        cut_tables: Vec::new(),
    };
    for (path, text) in &texts {
        let at = |line: usize, what: &str| format!("{}:{line}: {what}", path.display());
        for (line, link) in links(text) {
            let (file, anchor) = link.split_once('#').unwrap_or((link, ""));
            let target = match file {
                "" => path.clone(),
                file => beside(path, file),
            };
            let has_anchor = match anchors.get(target.as_path()) {
                Some(anchors) => anchor.is_empty() || anchors.contains(anchor),
                None => root().join(&target).exists(),
            };
            if !has_anchor {
                found.lost_links.push(at(line, link));
            }
        }
        let cut = cut_tables(text).into_iter();
        found
            .cut_tables
            .extend(cut.map(|(line, row)| at(line, row)));
    }
    Ok(found)
}

/// Lines with their numbers from 1, without those of code blocks.
fn prose(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut in_code = false;
    (1..).zip(text.lines()).filter(move |(_, line)| {
        let is_fence = line.trim_start().starts_with("```");
        in_code ^= is_fence;
        !in_code && !is_fence
    })
}

/// Targets of the links that lead into the repository.
fn links(text: &str) -> Vec<(usize, &str)> {
    let mut found = Vec::new();
    for (number, line) in prose(text) {
        // Every second part is code.
        for part in line.split('`').step_by(2) {
            let targets = part
                .split("](")
                .skip(1)
                .filter_map(|rest| rest.split_once(')'));
            let own = targets.filter(|(target, _)| !target.contains([':', ' ']));
            found.extend(own.map(|(target, _)| (number, target)));
        }
    }
    found
}

/// Names by which links lead to the headings of a document, as GitHub makes them.
fn anchors(text: &str) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    for (_, line) in prose(text) {
        let heading = line.trim_start_matches('#');
        if heading.len() == line.len() || !heading.starts_with(' ') {
            continue;
        }
        let kept = |c: &char| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_');
        let name: String = heading.trim().chars().filter(kept).collect();
        let name = name.to_lowercase().replace(' ', "-");
        let mut numbered = (1..).map(|number| format!("{name}-{number}"));
        let is_new = found.insert(name.clone());
        if !is_new {
            numbered.find(|name| found.insert(name.clone()));
        }
    }
    found
}

/// First rows of what looks like a table and has no head.
fn cut_tables(text: &str) -> Vec<(usize, &str)> {
    let lines: Vec<(usize, &str)> = prose(text).collect();
    let is_row = |index: usize| {
        lines
            .get(index)
            .is_some_and(|(_, line)| line.starts_with('|'))
    };
    let is_rule = |index: usize| {
        let line = lines.get(index).map_or("", |(_, line)| line);
        line.starts_with('|') && line.trim_matches(['|', '-', ':', ' ']).is_empty()
    };
    let begins = |index: &usize| is_row(*index) && (*index == 0 || !is_row(index - 1));
    let cut = (0..lines.len())
        .filter(begins)
        .filter(|index| !is_rule(index + 1));
    cut.map(|index| lines[index]).collect()
}

/// `file` seen from the document `path`.
fn beside(path: &Path, file: &str) -> PathBuf {
    let mut target = path.parent().map(Path::to_owned).unwrap_or_default();
    for part in Path::new(file).components() {
        match part {
            Component::ParentDir => drop(target.pop()),
            Component::Normal(name) => target.push(name),
            _ => {}
        }
    }
    target
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_and_headings_are_found_outside_of_code() {
        let text = "# `goto`, *jog*: a [page](a.md#b)\n`[no](x.md)` [out](https://a.b)\n```\n# no\n[no](y.md)\n```\n# A\n# A\n";
        assert_eq!(links(text), [(1, "a.md#b")]);
        let anchors = anchors(text);
        for name in ["goto-jog-a-pageamdb", "a", "a-1"] {
            assert!(anchors.contains(name), "{anchors:?}");
        }
        assert!(!anchors.contains("no"));
        assert_eq!(
            beside(Path::new("docs/a.md"), "../b/c.md"),
            Path::new("b/c.md")
        );
    }

    #[test]
    fn a_table_that_an_empty_line_cuts_is_found() {
        let whole = "| a | b |\n|---|:--|\n| 1 | 2 |\n";
        assert_eq!(cut_tables(whole), []);
        let cut = "| a |\n|---|\n| 1 |\n\n| 2 |\n| 3 |\n";
        assert_eq!(cut_tables(cut), [(5, "| 2 |")]);
    }
}
