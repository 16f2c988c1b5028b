//! Arrays of numpy as slices of rows, and slices as arrays.

use numpy::{
    IntoPyArray, PyArray1, PyArrayDyn, PyArrayMethods, PyReadonlyArray2, PyUntypedArrayMethods,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Rows of three numbers.
pub(crate) type Rows<'py> = PyReadonlyArray2<'py, f64>;

/// The rows of `array`, which the package has made contiguous.
pub(crate) fn rows<'a>(array: &'a Rows<'_>) -> PyResult<&'a [[f64; 3]]> {
    let refused = || PyValueError::new_err("expected a contiguous array of shape (n, 3)");
    if array.shape()[1] != 3 {
        return Err(refused());
    }
    let numbers = array.as_slice().map_err(|_| refused())?;
    Ok(numbers.as_chunks().0)
}

/// An array of `shape`.
pub(crate) fn array<'py, T: numpy::Element>(
    py: Python<'py>,
    numbers: Vec<T>,
    shape: &[usize],
) -> PyResult<Bound<'py, PyArrayDyn<T>>> {
    let flat: Bound<'py, PyArray1<T>> = numbers.into_pyarray(py);
    flat.reshape(shape)
}

/// An array of shape (n, `COUNT`).
pub(crate) fn table<'py, const COUNT: usize>(
    py: Python<'py>,
    rows: Vec<[f64; COUNT]>,
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let shape = [rows.len(), COUNT];
    array(py, rows.into_flattened(), &shape)
}
