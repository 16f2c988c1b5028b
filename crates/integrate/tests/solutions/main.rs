//! The integrators against solutions in closed form and published reference values.

mod events;
mod order;
mod problems;
mod refusals;
mod stability;
mod stiff;
