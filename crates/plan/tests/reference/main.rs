//! Seven problems with known least times: plans of whole paths, paths through a window, and a service that plans.

mod judge;
mod least_times;
mod problems;
mod programs;
mod service;
mod window;
