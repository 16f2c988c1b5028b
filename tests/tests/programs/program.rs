//! Programs under construction: their text, and what is known of the motion without reading it.

use std::f64::consts::TAU;
use std::fmt::Write;

/// Distance by which the motion may leave the path, and so be within a curve, m.
const TOLERANCE_M: f64 = 1e-5;

/// Program of G-code in millimetres and absolute coordinates.
pub(crate) struct Program {
    pub(crate) text: String,
    /// Place of the tool point, mm.
    pub(crate) at: [f64; 2],
    /// Angle by which the platform has turned, degrees.
    pub(crate) turned_deg: f64,
    /// Length along which the tool is on, mm.
    pub(crate) cut_mm: f64,
    /// Fastest feed, m/s.
    pub(crate) fastest_m_s: f64,
    /// Duration at the feeds, with dwells, s.
    pub(crate) least_s: f64,
    /// Length by which rounding shortens corners at most, m.
    pub(crate) rounded_m: f64,
    /// Distance by which corners are rounded, mm.
    corner_mm: f64,
    feed_mm_min: f64,
}

impl Program {
    /// A program that begins at `at`, mm, with corners rounded within `corner_mm`, 0 for none.
    pub(crate) fn new(at: [f64; 2], feed_mm_min: f64, corner_mm: f64) -> Self {
        let mode = match corner_mm > 0.0 {
            true => format!("G64 P{corner_mm}"),
            false => "G61".into(),
        };
        let text = format!(
            "G21 G90 {mode}\nG0 X{} Y{}\nM4 S500 F{feed_mm_min}\n",
            at[0], at[1]
        );
        Self {
            text,
            at,
            turned_deg: 0.0,
            cut_mm: 0.0,
            fastest_m_s: feed_mm_min / 6e4,
            least_s: 0.0,
            rounded_m: 1e-6,
            corner_mm,
            feed_mm_min,
        }
    }

    /// Adds a line of text.
    pub(crate) fn add(&mut self, line: &str) {
        self.text += line;
        self.text.push('\n');
    }

    fn cut(&mut self, length_mm: f64) {
        self.cut_mm += length_mm;
        self.least_s += length_mm / self.feed_mm_min * 60.0;
        // A corner that is left out by h is shorter by at most 2 (sqrt 2 + 1) h for right angles, and more for sharper ones,
        // where the machine stops in place of it.
        self.rounded_m += 40e-3 * self.corner_mm + TOLERANCE_M;
    }

    /// Takes note of a line that the text goes by from where the tool is, at the feed or slower.
    pub(crate) fn cut_relative(&mut self, by: [f64; 2]) {
        self.cut(by[0].hypot(by[1]));
        self.at = [0, 1].map(|axis| digits(self.at[axis] + by[axis]));
    }

    pub(crate) fn feed(&mut self, mm_min: f64) {
        self.feed_mm_min = mm_min;
        self.fastest_m_s = self.fastest_m_s.max(mm_min / 6e4);
        self.add(&format!("F{mm_min}"));
    }

    /// Goes straight to a place, in the digits of the file.
    pub(crate) fn line(&mut self, to: [f64; 2]) {
        let to = to.map(digits);
        let _ = writeln!(self.text, "G1 X{} Y{}", to[0], to[1]);
        self.cut((to[0] - self.at[0]).hypot(to[1] - self.at[1]));
        self.at = to;
    }

    /// Goes round `centre` by an angle, degrees, counter-clockwise positive.
    pub(crate) fn arc(&mut self, centre: [f64; 2], degrees: f64) {
        let [i, j] = [0, 1].map(|axis| digits(centre[axis] - self.at[axis]));
        let centre = [self.at[0] + i, self.at[1] + j];
        let (sin, cos) = degrees.to_radians().sin_cos();
        let [x, y] = [-i, -j];
        let to = [centre[0] + x * cos - y * sin, centre[1] + x * sin + y * cos];
        // A whole turn ends where it begins, to the digit.
        let to = if degrees.abs() == 360.0 {
            self.at
        } else {
            to.map(digits)
        };
        let word = if degrees > 0.0 { "G3" } else { "G2" };
        let _ = writeln!(self.text, "{word} X{} Y{} I{i} J{j}", to[0], to[1]);
        self.cut(x.hypot(y) * degrees.abs() / 360.0 * TAU);
        self.rounded_m += TOLERANCE_M * degrees.abs().to_radians();
        self.at = to;
    }

    /// Goes round with a radius in place of the centre; at most half a turn.
    pub(crate) fn arc_of_radius(&mut self, to: [f64; 2], radius: f64, is_left: bool) {
        let to = to.map(digits);
        let word = if is_left { "G3" } else { "G2" };
        let _ = writeln!(self.text, "{word} X{} Y{} R{radius}", to[0], to[1]);
        let chord = (to[0] - self.at[0]).hypot(to[1] - self.at[1]);
        self.cut(2.0 * radius * (0.5 * chord / radius).asin());
        self.at = to;
    }

    /// Stands for some seconds.
    pub(crate) fn dwell(&mut self, seconds: f64) {
        self.least_s += seconds;
        self.add(&format!("G4 P{seconds}"));
    }

    /// Goes as fast as the machine may, with the tool off.
    pub(crate) fn rapid(&mut self, to: [f64; 2]) {
        self.at = to.map(digits);
        let line = format!("G0 X{} Y{}", self.at[0], self.at[1]);
        self.add(&line);
    }
}

/// A number with the digits of the file.
fn digits(value: f64) -> f64 {
    (1e5 * value).round() / 1e5
}
