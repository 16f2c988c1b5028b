//! The plant: its forward dynamics against independent ones, its energy, its closed loop.

mod bus;
mod dynamics;
mod ends;
mod energy;
mod loops;
mod methods;
mod moved;
mod reference;
mod scenes;
mod singularities;
mod sweep;
