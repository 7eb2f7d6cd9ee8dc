//! Errors of the library as Python exceptions.
use std::error::Error;

use freeform_motion::with_causes;
use pyo3::exceptions::{PyOverflowError, PyTypeError, PyValueError};
use pyo3::prelude::*;

/// A `ValueError` with the words of an error and of its causes.
pub(crate) fn value_error(error: impl Error) -> PyErr {
    PyValueError::new_err(with_causes(&error))
}

/// A `ValueError` for a name that is none of a list.
pub(crate) fn unknown_name(what: &str, found: &str, known: &[&str]) -> PyErr {
    PyValueError::new_err(format!("{what} {found:?} is none of {}", known.join(", ")))
}

/// A `TypeError`.
pub(crate) fn type_error(message: impl Into<String>) -> PyErr {
    PyTypeError::new_err(message.into())
}

/// A whole number from 0. Python's own conversion has an `OverflowError` for negative ones.
pub(crate) fn whole<T: for<'a, 'py> FromPyObject<'a, 'py, Error = PyErr>>(value: &Bound<'_, PyAny>) -> PyResult<T> {
    value.extract().map_err(|error: PyErr| {
        if error.is_instance_of::<PyOverflowError>(value.py()) {
            PyValueError::new_err(format!("a whole number from 0 is needed, this is {value}"))
        } else {
            error
        }
    })
}
