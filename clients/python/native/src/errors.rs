//! Errors as the exceptions of `trirrr.errors`.

use pyo3::prelude::*;
use pyo3::types::PyTuple;
use trirrr_scene::SceneError;

/// Exception `name` of the package, made of `arguments`. An import that fails is the exception then.
pub(crate) fn exception<'py, A>(py: Python<'py>, name: &str, arguments: A) -> PyErr
where
    A: IntoPyObject<'py, Target = PyTuple, Output = Bound<'py, PyTuple>>,
    PyErr: From<A::Error>,
{
    let made = || -> PyResult<Bound<'py, PyAny>> {
        let arguments = arguments.into_pyobject(py)?;
        py.import("trirrr.errors")?.getattr(name)?.call1(arguments)
    };
    made().map_or_else(|error| error, PyErr::from_value)
}

/// `SceneError` with the text of the reader and each problem apart.
pub(crate) fn of_scene(py: Python<'_>, error: &SceneError) -> PyErr {
    type Fields<'a> = (&'a str, usize, &'a str, Option<&'a str>, &'a str);
    let fields: Vec<Fields> = match error {
        SceneError::Unreadable { .. } => Vec::new(),
        SceneError::Refused { file, problems } => {
            let of_problem = problems.iter().map(|problem| {
                let file = problem.source.as_deref().unwrap_or(file);
                let value = problem.value.as_deref();
                (file, problem.line, &*problem.key, value, &*problem.reason)
            });
            of_problem.collect()
        }
    };
    exception(py, "SceneError", (error.to_string(), fields))
}
