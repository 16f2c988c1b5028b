//! Random drawings as SVG, held against the outlines that Chromium has of them.

mod drawings;

use drawings::Random;
use std::fmt::Write;
use std::fs;
use std::path::Path;
use std::process::Command;
use trirrr_toolpath::drawing::read_svg;

/// Drawings of one run of the browser.
const BATCH: u64 = 250;

/// Pixels of SVG in a metre.
const PIXELS: f64 = 96.0 / 0.0254;

/// Number that the environment gives, or else `usual`.
fn number(name: &str, usual: u64) -> u64 {
    let given = std::env::var(name).ok();
    given.and_then(|text| text.parse().ok()).unwrap_or(usual)
}

/// Strokes of a file as lists of coordinates in pixels, from the lower left corner of the page; or the refusal.
fn strokes(text: &str) -> String {
    let drawing = match read_svg(text) {
        Ok(drawing) => drawing,
        // What holds nothing that is seen.
        Err(fault) if fault.reason.contains("nothing in the file is drawn") => return "[]".into(),
        Err(fault) => return format!("{:?}", fault.to_string()),
    };
    let mut list = String::from("[");
    for stroke in &drawing.strokes {
        list.push('[');
        for [x, y] in stroke.points(1e-7) {
            let _ = write!(list, "{:.5},{:.5},", PIXELS * x, PIXELS * y);
        }
        list.push_str("],");
    }
    list + "]"
}

/// Differences that the browser finds in the drawings of these seeds: lost, added, or moved by more than 0.01 mm.
fn differences(seeds: std::ops::Range<u64>, folder: &Path) -> Vec<String> {
    let mut page = String::from(
        "<!DOCTYPE html><meta charset='utf-8'><body style='margin:0'><script>const CASES = [\n",
    );
    for seed in seeds.clone() {
        let text = Random::new(seed).file();
        let _ = writeln!(page, "[{seed}, {text:?}, {}],", strokes(&text));
    }
    page += "];\n";
    page += include_str!("compare.js");
    page += "</script>";
    let file = folder.join(format!("{}.html", seeds.start));
    fs::write(&file, page).expect("a page");
    let output = Command::new("chromium")
        .args([
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--dump-dom",
            "--window-size=4000,4000",
        ])
        .arg(format!("--user-data-dir={}", folder.display()))
        .arg(format!("file://{}", file.display()))
        .output()
        .expect("chromium");
    let shown = String::from_utf8_lossy(&output.stdout);
    let (_, found) = shown
        .split_once("<pre>")
        .unwrap_or_else(|| panic!("no answer: {}", String::from_utf8_lossy(&output.stderr)));
    let found = found.split("</pre>").next().unwrap_or_default();
    let (count, rest) = found.split_once('\n').unwrap_or((found, ""));
    println!("{seeds:?}: {count}");
    rest.lines().map(str::to_owned).collect()
}

#[test]
#[ignore = "needs chromium; ten thousand drawings take half an hour: TRIRRR_DRAWINGS sets another number"]
fn random_drawings_have_the_outlines_of_a_browser() {
    let count = number("TRIRRR_DRAWINGS", 10_000);
    let first = number("TRIRRR_FIRST", 0);
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("svg-random");
    fs::create_dir_all(&folder).expect("a folder");
    let mut found = Vec::new();
    for start in (first..first + count).step_by(BATCH as usize) {
        found.extend(differences(
            start..(start + BATCH).min(first + count),
            &folder,
        ));
    }
    for line in found.iter().take(40) {
        println!("{line}");
    }
    assert!(
        found.is_empty(),
        "{} of {count} drawings differ",
        found.len()
    );
}

/// Nothing panics, whatever bytes of a file are others, or gone.
#[test]
fn damaged_drawings_are_refused_or_drawn() {
    for seed in 0..number("TRIRRR_DAMAGED", 60) {
        let mut random = Random::new(seed);
        let text = random.file().into_bytes();
        for _ in 0..8 {
            let mut bytes = text.clone();
            for _ in 0..=random.below(3) {
                let at = random.below(bytes.len() as u64) as usize;
                match random.below(4) {
                    0 => bytes[at] = random.below(256) as u8,
                    1 => bytes.truncate(at.max(1)),
                    2 => {
                        bytes.remove(at);
                    }
                    _ => {
                        let letters = b"0123456789.-eE<>/&;:#()'\" \x00\xFF,{}%";
                        bytes.insert(at, letters[random.below(letters.len() as u64) as usize]);
                    }
                }
            }
            if let Ok(mut drawing) = read_svg(&bytes) {
                let _ = drawing.fill(1e-3);
                assert!(
                    drawing
                        .bounds_m()
                        .is_some_and(|[low, _]| low[0].is_finite())
                );
            }
        }
    }
}
