//! Correctly rounded square roots: the machine's instruction where it has one, otherwise a digit
//! recurrence on integers. Both give the same bits.

mod hardware;
mod software;

pub(super) use hardware::{sqrt_f32, sqrt_f64};
