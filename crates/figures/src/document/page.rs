//! A document as a page that opens from disk: one file, with its figures in it.

use super::text::{TextColumn, columns};
use super::{Document, DocumentPart, Facts, Reader};
use std::fmt::Write;

const STYLE: &str = "body{font:16px/1.5 sans-serif;max-width:1200px;margin:2em auto;padding:0 1em;color:#222}\
table{border-collapse:collapse;font-size:14px}th,td{border:1px solid #bbb;padding:.25em .6em;text-align:left}\
td.number{text-align:right}svg{max-width:100%;height:auto}.own{background:#eef7f3}\
.pair{display:flex;gap:1em}.pair>div{flex:1;min-width:0}";

/// Text with `&`, `<`, `>` and `"` escaped.
pub fn escaped(text: &str) -> String {
    let text = text.replace('&', "&amp;").replace('<', "&lt;");
    text.replace('>', "&gt;").replace('"', "&quot;")
}

impl Document {
    /// Page with `title`.
    pub fn page(&self, title: &str) -> String {
        let title = escaped(title);
        let mut page = format!(
            "<!doctype html>\n<html lang=\"en\"><meta charset=\"utf-8\"><title>{title}</title><style>{STYLE}</style>\n<h1>{title}</h1>\n"
        );
        for (_, section) in self
            .sections
            .iter()
            .filter(|(reader, _)| *reader >= Reader::Page)
        {
            // Writing to a string does not fail.
            let _ = match section {
                DocumentPart::Heading(heading) => writeln!(page, "<h2>{}</h2>", escaped(heading)),
                DocumentPart::Pairs { facts, .. } => writeln!(page, "{}", pairs(facts)),
                DocumentPart::Table { rows, .. } => writeln!(page, "{}", table(rows)),
                DocumentPart::Note(note) => writeln!(page, "<p>{}</p>", escaped(note)),
                DocumentPart::Figure(svg) => writeln!(page, "{svg}"),
                DocumentPart::Files(files) => {
                    let names = files
                        .iter()
                        .filter_map(|file| Some(escaped(&file.file_name()?.to_string_lossy())));
                    let links = names.map(|name| format!("<a href=\"{name}\">{name}</a>"));
                    writeln!(page, "<p>{}</p>", links.collect::<Vec<_>>().join(", "))
                }
            };
        }
        page + "</html>\n"
    }
}

/// Cell, with a link where it begins with an address.
fn cell(text: &str) -> String {
    match text.split_whitespace().next() {
        Some(address) if address.starts_with("https://") => {
            let address = escaped(address);
            format!("<a href=\"{address}\">{address}</a>")
        }
        _ => escaped(text),
    }
}

fn pairs(facts: &Facts) -> String {
    let rows = facts.shown(Reader::Page).filter_map(|field| {
        let lines: Vec<String> = field.lines().iter().map(|line| cell(line)).collect();
        let row = format!(
            "<tr><th>{}</th><td>{}</td></tr>",
            escaped(&field.label),
            lines.join("<br>")
        );
        (!lines.is_empty()).then_some(row)
    });
    let rows = rows.collect::<Vec<_>>();
    match rows.is_empty() {
        true => String::new(),
        false => format!("<table>{}</table>", rows.join("\n")),
    }
}

fn table(rows: &[Facts]) -> String {
    let columns = columns(rows, Reader::Page);
    let head = columns
        .iter()
        .map(|column| format!("<th>{}</th>", escaped(&column.head)));
    let mut text = format!("<table><tr>{}</tr>", head.collect::<String>());
    for (index, row) in rows.iter().enumerate() {
        let of = |column: &TextColumn| {
            let class = if column.is_number {
                " class=\"number\""
            } else {
                ""
            };
            format!("<td{class}>{}</td>", cell(&column.cells[index]))
        };
        let class = if row.is_marked { " class=\"own\"" } else { "" };
        let cells = columns.iter().map(of).collect::<String>();
        let _ = write!(text, "\n<tr{class}>{cells}</tr>");
    }
    text + "</table>"
}
