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
    assert!(fault(b"G0 X1\nG0 X\xff2\n", 1).reason.contains("UTF-8"));
    let long = |bytes: usize| [b"G0 X1\n;".as_slice(), &vec![b'c'; bytes], b"\nG0 X2"].concat();
    assert_eq!(read(&long(999)).len(), 2);
    for bytes in [1000, 1004, 1005, 1006, 2000, 100_000] {
        let fault = fault(&long(bytes), 1);
        assert_eq!(fault.line, 2);
        assert!(fault.reason.contains("1,000"), "{fault}");
    }
    assert!(fault(&[b'c'; 3000], 0).reason.contains("1,000"));
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
    assert!(reader.taken < 1100);
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
