//! Damaged lines: none panics, and each is elements of numbers or a refusal that leaves the state.
use crate::common::observable;
use trirrr_toolpath::gcode::{GcodeRefusal, GcodeSetup, Interpreter, ZWords, elements};
use trirrr_toolpath::{Act, ToolCurve, ToolPlace};

const LINES: [&str; 41] = [
    "G21 G90 G94",
    "N10 G0 X10.5 Y-3.25 A12",
    "G1 X1.000 Y2.000 F1500 S300",
    "X3.5Y4.25",
    "G2 X10 Y0 I5 J0 F600",
    "G3 X0 Y10 R10",
    "G2 I5 P3",
    "G3 X6 Y0 R-5 A90",
    "G4 P0.25",
    "G10 L2 P1 X1 Y2 A3",
    "G10 L20 P0 X0 Y0",
    "G53 G0 X1 Y2",
    "G54",
    "G59 G0 X1",
    "G61.1",
    "G64 P0.05",
    "G91 G1 X-1 Y1 F60",
    "G92 X0 Y0",
    "G92.1",
    "G93 G1 X5 F2",
    "G20 G0 X0.1",
    "M3 S1000",
    "M4 S500 (MSG, engrave)",
    "M5",
    "G90.1 G2 X1 Y1 I0.5 J0.5",
    "G28 X0 Y0",
    "M0",
    "M66 P0 L3 Q1",
    "N3 T0*57",
    "/G1 X5",
    "%",
    "M30",
    "G1 X1 ; comment (with) *all*",
    "G1 X4 Y3 Z-1.5 F600",
    "G2 X6 Y2 I3 J1 Z2 K4",
    "G0 Z3",
    "G92 Z1",
    "G18 G3 X4 Z1 R3 F600",
    "G19 G2 Y5 Z0 J2 K-1",
    "G17 G1 Z-2",
    "T2 M6 (pen)",
];

/// Generator of Marsaglia, `xorshift64*`.
struct Random(u64);

impl Random {
    fn below(&mut self, bound: usize) -> usize {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        ((self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 33) as usize) % bound
    }

    /// Byte that is likely to hurt, or any.
    fn byte(&mut self) -> u8 {
        const LIKELY: &[u8] = b"GMXYAFSPRIJLNTZK0123456789.-+*/%();#[]e \t\r\n,=\0\x80\xff";
        match self.below(8) {
            0 => self.below(256) as u8,
            _ => LIKELY[self.below(LIKELY.len())],
        }
    }

    fn damage(&mut self, line: &mut Vec<u8>) {
        for _ in 0..1 + self.below(3) / 2 {
            let at = self.below(line.len() + 1);
            match self.below(5) {
                0 if at < line.len() => line[at] ^= 1 << self.below(8),
                1 if at < line.len() => line[at] = self.byte(),
                2 if at < line.len() => drop(line.remove(at)),
                3 => {
                    let other = LINES[self.below(LINES.len())].as_bytes();
                    let end = self.below(other.len() + 1);
                    line.splice(at..at, other[..end].iter().copied());
                }
                _ => {
                    let byte = self.byte();
                    (0..1 + self.below(3) * self.below(5)).for_each(|_| line.insert(at, byte));
                }
            }
        }
    }
}

fn finite(place: ToolPlace) -> bool {
    place.position_m.iter().all(|value| value.is_finite()) && place.alpha_rad.is_finite()
}

/// Asserts that an act is of numbers, goes on from `at`, and is consistent. Returns its end.
fn check(act: Act, at: ToolPlace) -> ToolPlace {
    let motion = match act {
        Act::Motion(motion) => motion,
        Act::Dwell { seconds } => {
            assert!(seconds > 0.0 && seconds.is_finite());
            return at;
        }
        Act::Pause => return at,
        Act::Output(output) => {
            assert!(output.index < 8);
            return at;
        }
        Act::Input(wait) => {
            assert!(wait.index < 8 && wait.timeout_s > 0.0 && wait.timeout_s.is_finite());
            return at;
        }
    };
    assert!(finite(motion.to));
    assert!(
        motion
            .feed_m_s
            .is_none_or(|feed| feed > 0.0 && feed.is_finite())
    );
    if let ToolCurve::Arc {
        centre_m: [cx, cy],
        turn_rad,
    } = motion.curve
    {
        assert!(turn_rad != 0.0 && turn_rad.is_finite());
        let [x, y] = [at.position_m[0] - cx, at.position_m[1] - cy];
        let (sin, cos) = turn_rad.sin_cos();
        let end = [cx + x * cos - y * sin, cy + x * sin + y * cos];
        let off = (end[0] - motion.to.position_m[0]).hypot(end[1] - motion.to.position_m[1]);
        let scale = x.hypot(y) * (1.0 + turn_rad.abs()) + cx.hypot(cy);
        assert!(
            off <= 1e-12 * scale + 1e-12,
            "{motion:?} from {at:?} is {off} m off"
        );
    }
    motion.to
}

/// Runs so many damaged lines through one interpreter. Returns the number of those that hold.
fn run(count: u32, seed: u64, z: ZWords) -> u32 {
    println!("seed {seed}");
    let mut random = Random(seed);
    let setup = GcodeSetup {
        z,
        outputs: 8,
        inputs: 8,
        home: Some(ToolPlace::default()),
        ..GcodeSetup::default()
    };
    let mut interpreter = Interpreter::new(setup);
    let mut held = 0;
    for number in 1..=count {
        if number % 64 == 1 {
            // Without a feed, or far away, little holds.
            interpreter.reset();
            interpreter.set_place(ToolPlace::default());
            interpreter.line(number, "G1 F600").unwrap();
        }
        let mut bytes = LINES[random.below(LINES.len())].as_bytes().to_vec();
        random.damage(&mut bytes);
        let line = String::from_utf8_lossy(&bytes);
        let at = interpreter.place();
        // Comparing all of the state takes longer than the line.
        let before = (number % 16 == 0).then(|| observable(&interpreter));
        match interpreter.line(number, &line) {
            Ok(work) => {
                held += 1;
                let end = work.elements.iter().fold(at, |at, element| {
                    assert_eq!(element.line, number);
                    assert!(
                        element
                            .tool
                            .is_none_or(|tool| tool.power > 0.0 && tool.power <= 1.0)
                    );
                    check(element.act, at)
                });
                assert_eq!(end, interpreter.place(), "{line:?}");
            }
            Err(GcodeRefusal { fault, .. }) => {
                assert!(
                    // A tool that was lit at a height is told where it was.
                    (fault.line == number || fault.reason.contains("lowers it"))
                        && !fault.reason.is_empty(),
                    "{line:?}: {fault}"
                );
                assert_eq!(at, interpreter.place(), "{line:?}");
                if let Some(before) = before {
                    assert_eq!(before, observable(&interpreter), "{line:?}");
                }
            }
        }
    }
    held
}

const SENSES: [ZWords; 3] = [
    ZWords::Refused,
    ZWords::Ignored,
    ZWords::Tool { on_at_m: 0.0005 },
];

#[test]
fn damaged_lines_hold_or_are_refused() {
    for z in SENSES {
        let held = run(40_000, 20_261_124, z);
        // Both happen often: neither all nor nothing is refused.
        assert!((4_000..36_000).contains(&held), "{held} lines hold");
    }
}

/// Files of any bytes end in elements or in one refusal, with a short text.
fn read_files(count: u32, seed: u64) {
    println!("seed {seed}");
    let mut random = Random(seed);
    let marks: [&[u8]; 6] = [b"", b"", b"", b"\xef\xbb\xbf", b"\xff\xfe", b"\xfe\xff"];
    let ends: [&[u8]; 6] = [b"\n", b"\r\n", b"\r", b"\r\r\n", b"\n\x1a", b"; \xfc\n"];
    for _ in 0..count {
        let mut file = marks[random.below(marks.len())].to_vec();
        for _ in 0..random.below(12) {
            let mut line = LINES[random.below(LINES.len())].as_bytes().to_vec();
            if random.below(4) == 0 {
                random.damage(&mut line);
            }
            file.extend(line);
            file.extend(ends[random.below(ends.len())]);
        }
        let setup = GcodeSetup {
            z: SENSES[random.below(3)],
            ..GcodeSetup::default()
        };
        let shown = String::from_utf8_lossy(&file).into_owned();
        let items: Vec<_> = elements(file.as_slice(), setup).collect();
        let refused = items.iter().position(Result::is_err);
        assert!(refused.is_none_or(|at| at + 1 == items.len()), "{shown:?}");
        if let Some(Err(fault)) = items.last() {
            let text = fault.to_string();
            assert!(
                text.len() < 600 && !text.contains('\n'),
                "{shown:?}: {text}"
            );
        }
    }
}

#[test]
fn damaged_files_end_in_elements_or_in_one_refusal() {
    read_files(20_000, 7);
}

#[test]
#[ignore = "takes seconds"]
fn a_million_damaged_lines_hold_or_are_refused() {
    for z in SENSES {
        run(1_000_000, 4711, z);
    }
    read_files(1_000_000, 4711);
}
