//! Failures on purpose, for the tests of what follows them. Only images built with the feature
//! `fault-injection` hold them.
#![allow(unsafe_code)]

use crate::inputs::{Angle, Closed, Inputs, Interlocked};
use crate::scene::{Scalar, TICK_RATE_HZ};
use core::hint::black_box;
use trirrr_core::tick::Motor;
use trirrr_protocol::message::{Board, Start};

/// Failure to inject: `FAULT` when the image is built.
const FAULT: &str = match option_env!("FAULT") {
    Some(fault) => fault,
    None => "panic",
};

/// Failure that is none of the program: a person presses the emergency stop.
const STOP: &str = "emergency-stop";

/// Tick in which the image fails, counted from 0.
const TICK: u32 = 50;

/// Makes the image fail when the inputs are read in tick [`TICK`].
pub(crate) struct FaultInjection {
    ticks: u32,
    /// Cleared after the first failure: a board that fails after each start could not report its cause.
    is_armed: bool,
    /// Counts of the board's timer in a tick.
    period: u32,
}

impl FaultInjection {
    pub(crate) fn new(board: &Board) -> Self {
        Self {
            ticks: 0,
            is_armed: board.start == Start::Power,
            period: (f64::from(board.timer_hz) / TICK_RATE_HZ) as u32,
        }
    }

    pub(crate) fn read(&mut self, inputs: &mut impl Inputs, motors: &[Motor<Scalar>; 3]) -> Closed {
        if self.ticks == TICK && self.is_armed {
            self.is_armed = false;
            fail(self.period);
        }
        self.ticks = self.ticks.wrapping_add(1);
        inputs.read(motors)
    }

    /// Pressed from tick [`TICK`] on, whatever the pin says.
    pub(crate) fn interlocks(&mut self, read: Interlocked) -> Interlocked {
        Interlocked {
            emergency_stop: read.emergency_stop || (FAULT == STOP && self.ticks > TICK),
            ..read
        }
    }

    pub(crate) fn shift(&mut self, _: [Angle; 3]) {}
}

fn fail(period: u32) {
    match FAULT {
        "panic" => panic!("injected"),
        "hard-fault" => hard_fault(),
        "stack-overflow" => {
            black_box(overflow(black_box(0)));
        }
        // 1.2 periods at the full clock, more at any other.
        "overrun" => cortex_m::asm::delay(period + period / 5),
        _ => {}
    }
}

fn hard_fault() {
    // SAFETY: no memory has this address, on purpose: the read faults.
    black_box(unsafe { (0x6000_0000 as *const u32).read_volatile() });
}

#[allow(unconditional_recursion)]
fn overflow(depth: u32) -> u32 {
    let frame = black_box([depth; 64]);
    overflow(depth + 1) + frame[(depth % 64) as usize]
}
