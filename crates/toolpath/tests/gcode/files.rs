//! Files: ends, faults of reading, and memory.
use crate::common::{motion, place, same};
use std::io::{self, BufRead, BufReader, Read};
use trirrr_toolpath::gcode::{GcodeSetup, elements};
use trirrr_toolpath::{Element, PathFault};

fn read(text: &[u8]) -> Vec<Result<Element, PathFault>> {
    elements(text, GcodeSetup::default()).collect()
}

fn count(text: &str) -> usize {
    read(text.as_bytes())
        .into_iter()
        .map(Result::unwrap)
        .count()
}

/// The one refusal, behind so many elements.
fn fault(text: &[u8], before: usize) -> PathFault {
    let mut items = read(text);
    let fault = items.pop().unwrap().unwrap_err();
    assert_eq!(items.len(), before);
    assert!(items.iter().all(Result::is_ok));
    fault
}

#[test]
fn elements_know_their_lines() {
    let all: Vec<_> = read(b"; head\r\nG0 X1\r\n\r\nG1 X2 F60\r\nX3")
        .into_iter()
        .map(Result::unwrap)
        .collect();
    assert_eq!(
        all.iter().map(|element| element.line).collect::<Vec<_>>(),
        [2, 4, 5]
    );
    same(motion(&all[2]).to, place(3.0, 0.0, 0.0));
}

#[test]
fn a_program_ends_at_its_end() {
    assert_eq!(count("G0 X1\nM2\nG0 X2"), 1);
    assert_eq!(count("G0 X1\nX2 M30\nwhat ever"), 2);
    assert_eq!(count("%\nG0 X1\n%\nG0 X2"), 1);
    assert_eq!(count("G0 X1\n%\nG0 X2"), 1);
    assert_eq!(count(""), 0);
    assert_eq!(count("\n\n"), 0);
    assert_eq!(count("\u{feff}G0 X1"), 1);
}

#[test]
fn a_refusal_ends_the_path() {
    let fault = fault(b"G0 X1\nG0 X2 ?\nG0 X3", 1);
    assert_eq!((fault.line, fault.word.as_str()), (2, "?"));
}

#[test]
fn lines_that_are_no_text_or_too_long_are_refused() {
    for (text, line, words) in [
        (b"G0 X1\nG0 X\xff2\n".as_slice(), 2, "byte 0xFF at column 5"),
        (b"G0 X1\nG0 (\xfc) X1\xb5", 2, "byte 0xB5 at column 10"),
        (b"G0 X1\nG\x000 X2", 2, "byte 0x00"),
        (b"G0 X1\nM2\x1aG0 X5", 2, "Ctrl-Z"),
    ] {
        let fault = fault(text, 1);
        assert!(
            fault.line == line && fault.reason.contains(words),
            "{fault}"
        );
    }
    assert!(fault(b"\xff\xd8\xff\xe0", 0).reason.contains("no text"));
    for words in [1001, 2000, 100_000] {
        let fault = fault(&[b"G0 X1\n".as_slice(), &vec![b'c'; words]].concat(), 1);
        assert_eq!(fault.line, 2);
        assert!(
            fault.reason.contains("1,000") && fault.word.len() < 50,
            "{fault}"
        );
    }
}

/// Comments have any length, and any letters: those of eight-bit alphabets, too.
#[test]
fn comments_are_of_any_kind() {
    for bytes in [0, 199, 999, 1000, 5000, 100_000] {
        let long = vec![b'c'; bytes];
        for text in [
            [b"G0 X1\n;".as_slice(), &long, b"\nG0 X2"].concat(),
            [b"G0 X1\n(".as_slice(), &long, b") G0 X2"].concat(),
            [
                b"G0 X1 ; \xe4\xf6\xfc ".as_slice(),
                &long,
                b"\nG0 X2 (\xb5 \xc3\xbc)",
            ]
            .concat(),
        ] {
            assert_eq!(read(&text).into_iter().filter(Result::is_ok).count(), 2);
        }
    }
    // What the interpreter refuses stays refused.
    assert!(
        fault(&[b"(".as_slice(), &[b'c'; 5000], b"("].concat(), 0)
            .reason
            .contains("comment")
    );
}

/// Ends of lines of every system, and what transfers have made of them.
#[test]
fn lines_end_in_any_way() {
    for (end, third) in [
        ("\n", 3_u32),
        ("\r\n", 3),
        ("\r\r\n", 3),
        ("\r\r\r\n", 3),
        ("\r", 3),
        ("\r\r", 5),
        ("\n\n", 5),
    ] {
        let text = ["G0 X1", "X2 (a)", "X3"].join(end);
        for behind in ["", end, "\x1a", "\n\x1a\x1a\n", "\x1a\0\0"] {
            let all = read(format!("{text}{behind}").as_bytes());
            let lines: Vec<_> = all.into_iter().map(|each| each.unwrap().line).collect();
            assert_eq!(lines, [1, third.div_ceil(2), third], "{end:?} {behind:?}");
        }
    }
}

#[test]
fn utf_16_is_read_by_its_mark() {
    let text = "\u{feff}G0 X1 (\u{fc} \u{1f600})\r\nX2\r\n";
    let little: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let big: Vec<u8> = text.encode_utf16().flat_map(u16::to_be_bytes).collect();
    for bytes in [little, big] {
        assert_eq!(read(&bytes).into_iter().map(Result::unwrap).count(), 2);
        assert_eq!(read(&bytes[..bytes.len() - 1]).len(), 2);
    }
}

/// The one reason, once, with the line that told it.
#[test]
fn other_dialects_are_named() {
    for (text, line, name, told) in [
        (
            "%NEU G71 *\nN10 G30 G17 X+0 Y+0 Z-40*\n",
            1,
            "Heidenhain",
            "line 1",
        ),
        ("N10 G00 G40 G90 Z+250*\n", 1, "Heidenhain", "line 1"),
        ("G04 a layer*\nX0Y0D02*\n", 1, "Gerber", "line 1"),
        ("'SHOPBOT ROUTER FILE IN MM\nSA\n", 1, "ShopBot", "line 1"),
        ("M3,10,5,-2\n", 1, "ShopBot", "line 1"),
        ("IMF_PBL_V1.0\n", 1, "isel", "line 1"),
        (
            "; FLAVOR:Marlin\nG21\nM82\n",
            3,
            "Marlin",
            "\"FLAVOR:Marlin\" in line 1",
        ),
        ("G21\nM140 S60\n", 2, "Marlin", "\"M140\" in line 2"),
        ("G0 X0\nG1 X10 F600 E0.5", 2, "Marlin", "\"E0.5\" in line 2"),
        ("G21\nG4 S2\n", 2, "Marlin", "line 2"),
        ("N1 M110 N1\n", 1, "RepRap", "\"M110\""),
        ("SET_VELOCITY_LIMIT ACCEL=5\n", 1, "Klipper", "line 1"),
        ("0  BEGIN PGM 7 MM\n1 L X+10\n", 1, "Heidenhain", "line 1"),
        ("5 L X+10 Y+0 R0 F500\n", 1, "Heidenhain", "line 1"),
        ("IN;SP1;PU0,0;PD100,100;", 1, "HPGL", "\"IN;\""),
        ("PU100,200;\nPD300,400;\n", 1, "HPGL", "line 1"),
        (
            "%!PS-Adobe-3.0\n%%Title: a\n1 setlinewidth\n",
            3,
            "PostScript",
            "line 1",
        ),
        ("%FSLAX24Y24*%\nG01*\n", 1, "Gerber", "line 1"),
        ("M48\nMETRIC,TZ\n", 1, "Excellon", "line 1"),
        ("G21\nMSG(\"a\")\n", 2, "Sinumerik", "line 2"),
        ("<svg width='5'>\n", 1, "XML", "line 1"),
        ("GIF89a\x01\x02", 1, "image", "line 1"),
    ] {
        let found = read(text.as_bytes()).pop().unwrap().unwrap_err();
        let all = found.to_string();
        assert!(
            found.line == line && all.contains(name) && all.contains(told),
            "{text}: {all}"
        );
    }
    // A long line of a plotter is told by its beginning.
    let long = format!("IN;PU0,0;PD{}", "1,1,".repeat(9000));
    assert!(fault(long.as_bytes(), 0).reason.contains("HPGL"));
    // A fault of G-code is told as such.
    assert!(!fault(b"G0 X1,5", 0).reason.contains("file is"));
}

#[test]
fn faults_of_the_reader_are_refusals() {
    struct Broken;
    impl Read for Broken {
        fn read(&mut self, _: &mut [u8]) -> io::Result<usize> {
            Err(io::Error::other("the disk is gone"))
        }
    }
    let reader = BufReader::new(b"G0 X1\nG0 X2\nG0".chain(Broken));
    let items: Vec<_> = elements(reader, GcodeSetup::default()).collect();
    assert_eq!(items.len(), 3);
    let fault = items[2].clone().unwrap_err();
    assert!(
        fault.line == 3 && fault.reason.contains("the disk is gone"),
        "{fault}"
    );
}

/// Reader of an endless line, or of endless lines, that counts what is taken from it.
struct Endless {
    line: &'static [u8],
    taken: usize,
}

impl Read for Endless {
    fn read(&mut self, _: &mut [u8]) -> io::Result<usize> {
        unreachable!("lines are read through the buffer")
    }
}

impl BufRead for Endless {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        Ok(&self.line[self.taken % self.line.len()..])
    }

    fn consume(&mut self, amount: usize) {
        self.taken += amount;
    }
}

#[test]
fn a_line_without_end_is_not_read_to_its_end() {
    let mut reader = Endless {
        line: b"G0 X1 ",
        taken: 0,
    };
    let mut all = elements(&mut reader, GcodeSetup::default());
    assert!(all.next().unwrap().unwrap_err().reason.contains("1,000"));
    assert!(all.next().is_none());
    assert!(reader.taken < 1200);
}

#[test]
fn lines_are_read_as_elements_are_asked_for() {
    let mut reader = Endless {
        line: b"G91 G0 X1\n",
        taken: 0,
    };
    let mut all = elements(&mut reader, GcodeSetup::default());
    assert_eq!(
        all.by_ref()
            .take(100)
            .map(Result::unwrap)
            .last()
            .unwrap()
            .line,
        100
    );
    same(all.interpreter().place(), place(100.0, 0.0, 0.0));
    assert_eq!(reader.taken, 1000);
}

/// Prints the lines per second. `cargo test --release -p trirrr-toolpath --test gcode million -- --ignored --nocapture`
#[test]
#[ignore = "takes seconds"]
fn a_million_lines() {
    let mut text = String::from("G21 G90 M4 S0\nG1 F3000\n");
    for line in 0..1_000_000_u32 {
        let (x, y) = (line % 60_013, line / 1000);
        text += &format!(
            "G1 X{}.{:03} Y{}.{:03} S{}\n",
            x / 1000,
            x % 1000,
            y / 1000,
            y % 1000,
            line % 1000
        );
    }
    let start = std::time::Instant::now();
    let count = elements(text.as_bytes(), GcodeSetup::default())
        .map(Result::unwrap)
        .count();
    let seconds = start.elapsed().as_secs_f64();
    println!(
        "{count} elements of {} bytes in {seconds:.3} s: {:.0} lines/s",
        text.len(),
        1e6 / seconds
    );
    assert_eq!(count, 1_000_000 - 1, "the first line goes nowhere");
}
