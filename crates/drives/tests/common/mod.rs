//! Fakes: pins that write down their edges, and outputs of a tick.

#![allow(dead_code, unreachable_pub)]

pub mod frame;

use embedded_hal::digital::{ErrorType, OutputPin};
use std::cell::{Cell, RefCell};
use std::convert::Infallible;
use std::rc::Rc;
use trirrr_core::number::Number;
use trirrr_core::tick::Motor;
use trirrr_service::{Output, Power};

/// Recorded changes of pins, with their times.
#[derive(Clone, Debug, Default)]
pub struct Scope {
    pub now: Rc<Cell<i64>>,
    pub edges: Rc<RefCell<Vec<Edge>>>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Edge {
    pub at: i64,
    pub pin: &'static str,
    pub high: bool,
}

impl Scope {
    pub fn pin(&self, name: &'static str) -> Pin {
        Pin {
            scope: self.clone(),
            name,
            level: None,
        }
    }

    /// Takes the record, and starts a new one.
    pub fn take(&self) -> Vec<Edge> {
        self.edges.borrow_mut().split_off(0)
    }
}

/// A pin that is written down when its level changes.
#[derive(Clone, Debug)]
pub struct Pin {
    scope: Scope,
    name: &'static str,
    level: Option<bool>,
}

impl Pin {
    fn set(&mut self, high: bool) {
        if self.level != Some(high) {
            self.level = Some(high);
            self.scope.edges.borrow_mut().push(Edge {
                at: self.scope.now.get(),
                pin: self.name,
                high,
            });
        }
    }
}

impl ErrorType for Pin {
    type Error = Infallible;
}

impl OutputPin for Pin {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.set(false);
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.set(true);
        Ok(())
    }
}

/// Output of a tick: angle, rate and torque of each motor, in SI units.
pub fn output<N: Number>(wanted: [[f64; 3]; 3], enabled: bool) -> Output<N> {
    let power = if enabled { Power::On } else { Power::Off };
    powered(wanted, power)
}

/// Output of a tick with this power.
pub fn powered<N: Number>(wanted: [[f64; 3]; 3], power: Power) -> Output<N> {
    Output {
        motors: wanted.map(|[angle, rate, torque]| Motor {
            angle: N::angle_from_f64(angle),
            rate: N::from_f64(rate),
            acceleration: N::ZERO,
            torque: N::from_f64(torque),
        }),
        tool: N::ZERO,
        power,
        brake_released: power == Power::On,
    }
}

/// An angle in (-pi, pi], as a tick gives it.
pub fn wrapped(angle: f64) -> f64 {
    angle.sin().atan2(angle.cos())
}

/// Numbers without a pattern (splitmix64).
pub struct Random(pub u64);

impl Random {
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// From -1 to 1.
    pub fn signed(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    pub fn below(&mut self, bound: u64) -> u64 {
        self.bits() % bound
    }
}
