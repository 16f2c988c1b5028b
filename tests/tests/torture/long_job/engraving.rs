//! A job of any length, made move by move: rows of a picture that a tool engraves.

use trirrr_bench::device::TICK_RATE_HZ;
use trirrr_core::setpoint::Pose;
use trirrr_protocol::message::{AnyMove, Move};

/// Speed along a row, m/s.
const SPEED_M_S: f64 = 0.05;

/// Durations of the moves of a row: speed up, dots and lines at speed, slow down, then over to the next row.
const TICKS: [u32; 13] = [60, 1, 40, 2, 17, 64, 3, 70, 5, 90, 8, 60, 40];

const ROW_MOVES: u32 = TICKS.len() as u32;

/// Moves of a row at speed are those before this one.
const SLOW_DOWN: usize = TICKS.len() - 2;
const NEXT_ROW: usize = TICKS.len() - 1;

/// Ticks of a row.
const ROW_TICKS: u32 = {
    let (mut sum, mut index) = (0, 0);
    while index < TICKS.len() {
        sum += TICKS[index];
        index += 1;
    }
    sum
};

/// Rows from the one side of the picture to the other; then the machine goes back row by row.
const FIELD_ROWS: u32 = 32;
const ROW_M: f64 = 0.00025;

/// Begin of the first row.
const CORNER_M: [f64; 2] = [0.205, 0.215];
const ANGLE_RAD: f64 = 0.157;

/// So many rows.
#[derive(Clone, Copy, Debug)]
pub(super) struct Engraving {
    rows: u32,
}

impl Engraving {
    /// As many whole rows as `ticks` take, at least.
    pub(super) fn lasting(ticks: u64) -> Self {
        Self {
            rows: ticks.div_ceil(u64::from(ROW_TICKS)) as u32,
        }
    }

    /// Number of moves.
    pub(super) fn moves(&self) -> u32 {
        self.rows * ROW_MOVES
    }

    /// Ticks of all moves.
    pub(super) fn ticks(&self) -> u64 {
        self.before(self.moves())
    }

    /// Ticks before the move `index`.
    pub(super) fn before(&self, index: u32) -> u64 {
        let (row, part) = (index / ROW_MOVES, index % ROW_MOVES);
        let of_row: u32 = TICKS.iter().take(part as usize).sum();
        u64::from(row) * u64::from(ROW_TICKS) + u64::from(of_row)
    }

    /// All moves.
    pub(super) fn all(&self) -> Vec<AnyMove<f32>> {
        (0..self.moves()).map(|index| self.get(index)).collect()
    }

    /// The move `index`. Rows begin and end at rest; every other one speeds up and slows down in quintics.
    pub(super) fn get(&self, index: u32) -> AnyMove<f32> {
        let (row, part) = (index / ROW_MOVES, (index % ROW_MOVES) as usize);
        let (from, to) = (at(row, part), at(row, part + 1));
        let speed = match row % 2 {
            0 => SPEED_M_S,
            _ => -SPEED_M_S,
        } as f32;
        let is_moving = |knot: usize| (1..=SLOW_DOWN).contains(&knot);
        let velocity = |knot| [if is_moving(knot) { speed } else { 0.0 }, 0.0, 0.0];
        let is_line = is_moving(part) && is_moving(part + 1);
        let (tool_power, tool_speed) = if is_line { tool(index) } else { (0.0, 0.0) };
        let common = Move {
            number: index,
            from,
            to,
            start_velocity: velocity(part),
            end_velocity: velocity(part + 1),
            ticks: TICKS[part],
            tool_power,
            tool_speed,
        };
        let is_ramp = part != NEXT_ROW && !is_line;
        let accelerations = (is_ramp && row % 2 == 1).then_some([[0.0; 3]; 2]);
        AnyMove::new(common, accelerations)
    }
}

/// Pose before the move `part` of a row; behind the last it is that before the first of the next row.
fn at(row: u32, part: usize) -> Pose<f32> {
    if part > NEXT_ROW {
        return at(row + 1, 0);
    }
    // On its ramps the machine is half as fast.
    let way = |(index, ticks): (usize, &u32)| match index {
        0 | SLOW_DOWN => f64::from(*ticks) / 2.0,
        _ => f64::from(*ticks),
    };
    let way_m = |part: usize| {
        let ticks: f64 = TICKS[..part].iter().enumerate().map(way).sum();
        ticks * SPEED_M_S / TICK_RATE_HZ
    };
    let along = match row % 2 {
        0 => way_m(part),
        _ => way_m(NEXT_ROW) - way_m(part),
    };
    let line = FIELD_ROWS.abs_diff(row % (2 * FIELD_ROWS));
    Pose::from_f64(
        CORNER_M[0] + along,
        CORNER_M[1] + ROW_M * f64::from(line),
        ANGLE_RAD,
    )
}

/// Power and speed of the tool in a move: off, or in proportion to the speed, or the same at every speed.
fn tool(index: u32) -> (f32, f32) {
    // A number that looks drawn, and is always that of the move.
    let drawn = (u64::from(index) + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 32;
    let power = 0.1 + 0.9 * (drawn >> 8 & 0xFF) as f32 / 255.0;
    match drawn % 4 {
        0 => (0.0, 0.0),
        1 => (power, 0.0),
        _ => (power, SPEED_M_S as f32 * 1.25),
    }
}
