//! Kinds of programs.

use crate::program::Program;

/// Parameters of each kind.
pub(crate) const PARAMETERS: usize = 13;

/// Names of the kinds.
pub(crate) const KINDS: [&str; 13] = [
    "sharp-angles",
    "polygon-tolerances",
    "line-arc-line",
    "arc-arc",
    "circles",
    "short-lines",
    "growing-arcs",
    "raster",
    "star",
    "feeds",
    "radius-arcs",
    "turning",
    "mixed-modes",
];

/// Program of a kind with a parameter from 0 to 12.
pub(crate) fn program(kind: usize, parameter: usize) -> Program {
    let part = parameter as f64 / (PARAMETERS - 1) as f64;
    // From 0.001 mm to 1 mm, in equal factors.
    let tolerance = 1e-3 * 10f64.powf(3.0 * part);
    match kind {
        0 => sharp_angles(10.0 + 160.0 * part),
        1 => polygon(3 + parameter % 6, tolerance),
        2 => line_arc_line(0.3 + 14.0 * part),
        3 => arc_arc(
            1.0 + 12.0 * part,
            if parameter.is_multiple_of(2) {
                1.0
            } else {
                -1.0
            },
        ),
        4 => circles(0.5 + 19.0 * part, 600.0 + 9_000.0 * part),
        5 => short_lines(0.02 * 50f64.powf(part)),
        6 => growing_arcs(0.5 + 1.5 * part),
        7 => raster(0.3 + 2.0 * part, 1_000.0 + 8_000.0 * part),
        8 => star(5 + 2 * parameter),
        9 => feeds(1.0 + 9.0 * part),
        10 => radius_arcs(4.0 + 20.0 * part),
        11 => turning(part),
        _ => mixed_modes(parameter),
    }
}

fn polar(radius: f64, degrees: f64) -> [f64; 2] {
    let (sin, cos) = degrees.to_radians().sin_cos();
    [radius * cos, radius * sin]
}

/// To and fro, with the same angle at each corner.
fn sharp_angles(degrees: f64) -> Program {
    let mut program = Program::new([-25.0, 0.0], 6_000.0, 0.01);
    let (rise, run) = (0.5 * degrees).to_radians().sin_cos();
    let side = (45.0 / 8.0 / rise.max(0.3)).min(12.0);
    for index in 1..=8 {
        let y = if index % 2 == 1 { side * run } else { 0.0 };
        program.line([-25.0 + f64::from(index) * side * rise, y]);
    }
    program
}

fn polygon(corners: usize, tolerance: f64) -> Program {
    let mut program = Program::new([20.0, 0.0], 5_000.0, tolerance);
    for index in 1..=2 * corners {
        program.line(polar(20.0, 360.0 * index as f64 / corners as f64));
    }
    program
}

/// A slot with corners of a radius: lines and arcs are tangent.
fn line_arc_line(radius: f64) -> Program {
    let (x, y) = (22.0, 15.0);
    let mut program = Program::new([0.0, -y], 7_000.0, 0.0);
    let corners = [[x, -y], [x, y], [-x, y], [-x, -y]];
    let along = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]];
    for side in 0..4 {
        let ([cx, cy], [dx, dy]) = (corners[side], along[side]);
        program.line([cx - radius * dx, cy - radius * dy]);
        // The centre lies to the left.
        let [x, y] = program.at;
        program.arc([x - radius * dy, y + radius * dx], 90.0);
    }
    program.line([0.0, -y]);
    program
}

/// Arcs that go on into each other: waves, or bumps that meet at corners.
fn arc_arc(radius: f64, sense: f64) -> Program {
    let mut program = Program::new([-26.0, 0.0], 6_000.0, 0.02);
    let count = (52.0 / (2.0 * radius)).floor() as usize;
    for index in 0..count.clamp(2, 12) {
        let [x, y] = program.at;
        let turn = if index % 2 == 0 { 180.0 } else { 180.0 * sense };
        program.arc([x + radius, y], -turn);
    }
    program
}

fn circles(radius: f64, feed: f64) -> Program {
    let mut program = Program::new([radius, 0.0], feed, 0.01);
    program.arc([0.0, 0.0], 360.0);
    program.arc([2.0 * radius, 0.0], -360.0);
    program.arc([0.5 * radius, 0.0], 360.0);
    program
}

/// A spiral of chords.
fn short_lines(chord: f64) -> Program {
    let mut program = Program::new([4.0, 0.0], 6_000.0, 0.01);
    let mut degrees: f64 = 0.0;
    for _ in 0..400 {
        let radius = 4.0 + degrees / 360.0;
        degrees += (chord / radius).to_degrees();
        program.line(polar(4.0 + degrees / 360.0, degrees));
    }
    program
}

/// A spiral of half circles.
fn growing_arcs(step: f64) -> Program {
    let mut program = Program::new([0.0, 0.0], 8_000.0, 0.0);
    for index in 1..=12 {
        let radius = step * f64::from(index) * 0.8;
        let side = if index % 2 == 1 { -1.0 } else { 1.0 };
        let [x, y] = program.at;
        program.arc([x + side * radius, y], 180.0);
    }
    program
}

fn raster(pitch: f64, feed: f64) -> Program {
    let mut program = Program::new([-15.0, -8.0], feed, 0.01);
    for row in 0..8 {
        let end = if row % 2 == 0 { 15.0 } else { -15.0 };
        let y = program.at[1];
        program.line([end, y]);
        if row < 7 {
            program.line([end, y + pitch]);
        }
    }
    program
}

fn star(points: usize) -> Program {
    let mut program = Program::new([18.0, 0.0], 9_000.0, 0.005);
    for index in 1..=2 * points {
        let radius = if index % 2 == 0 { 18.0 } else { 8.0 };
        program.line(polar(radius, 180.0 * index as f64 / points as f64));
    }
    program
}

/// The feed changes from stretch to stretch of one line.
fn feeds(stretch: f64) -> Program {
    let mut program = Program::new([-25.0, 5.0], 100.0, 0.01);
    for feed in [3_000.0, 200.0, 12_000.0, 6_000.0, 60_000.0] {
        program.feed(feed);
        let [x, y] = program.at;
        program.line([x + stretch, y]);
    }
    program
}

fn radius_arcs(radius: f64) -> Program {
    let mut program = Program::new([-8.0, -8.0], 4_000.0, 0.02);
    let radius = radius.max(6.0);
    for (to, is_left) in [
        ([0.0, -8.0], true),
        ([0.0, 3.0], false),
        ([8.0, 3.0], true),
        ([8.0, -5.0], true),
        ([-2.0, -5.0], false),
    ] {
        program.arc_of_radius(to, radius, is_left);
    }
    program
}

/// The platform turns along lines, along arcs, and in place.
fn turning(part: f64) -> Program {
    let mut program = Program::new([-12.0, 0.0], 4_000.0, 0.01);
    let degrees = 1.0 + 12.0 * part;
    let start = 0.4_f64.to_degrees();
    let angle = |by: f64| (1e5 * (start + by)).round() / 1e5;
    for (index, x) in [-4.0, 4.0, 12.0].into_iter().enumerate() {
        let by = if index % 2 == 0 { degrees } else { -degrees };
        program.add(&format!("A{}", angle(by)));
        program.line([x, 3.0 * f64::from(index as u32)]);
    }
    program.add(&format!("G0 A{}", angle(0.5 * degrees)));
    program.turned_deg = angle(0.5 * degrees) - start;
    program
}

/// Dwells, rapids, stops, inches, steps from where the tool is.
fn mixed_modes(parameter: usize) -> Program {
    let mut program = Program::new([0.0, 0.0], 3_000.0, 0.01);
    for step in 0..4 + parameter {
        let [x, y] = program.at;
        match (step + parameter) % 5 {
            0 => program.line([x + 2.0, y]),
            1 => program.dwell(0.05),
            2 => program.rapid([x - 1.0, y + 1.5]),
            3 => {
                program.add("G91 G61");
                program.add("G1 X0.5 Y-0.25");
                program.cut_relative([0.5, -0.25]);
                program.add("G90 G64 P0.01");
            }
            _ => {
                program.add("G20 G91");
                program.add("G1 X-0.1 F100");
                program.cut_relative([-2.54, 0.0]);
                program.add("G21 G90 F3000");
            }
        }
    }
    program
}
