//! Native core of the Python package `trirrr`: scenes, arrays of states, plans and runs.
//!
//! The module is private to the package. `clients/python/trirrr/machine.py` gives arrays their shapes, and documents what users call.
//! Arrays here have rows of three `f64`, one behind the other. The interpreter's lock is released while a function computes.

mod arrays;
mod errors;
mod machine;
mod plan;
mod play;
mod pool;

/// Functions and types of the extension module.
#[pyo3::pymodule]
mod _native {
    #[pymodule_export]
    use crate::machine::NativeMachine;
}
