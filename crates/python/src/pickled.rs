//! Results as bytes, for pickle.
use freeform_motion::estimate::StateFormat;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyType};
use serde::{Serialize, de::DeserializeOwned};

use crate::errors::value_error;

/// Another one for every change of what is saved of a result.
const VERSION: u32 = 2;

/// What `__reduce__` returns: a function and its argument.
pub(crate) type Reduced<'py> = (Bound<'py, PyAny>, (Bound<'py, PyBytes>,));

/// A class whose objects are pickled as bytes. It has a static method `_restored` that takes them.
pub(crate) trait Pickled: Serialize + DeserializeOwned {
    /// What the bytes hold, and its name in messages.
    const KIND: ([u8; 4], &'static str);

    fn reduced<'py>(&self, class: &Bound<'py, PyType>) -> PyResult<Reduced<'py>> {
        Ok((class.getattr("_restored")?, (PyBytes::new(class.py(), &self.to_bytes()?),)))
    }

    fn to_bytes(&self) -> PyResult<Vec<u8>> {
        Self::format().encoded(self).map_err(value_error)
    }

    fn of_bytes(bytes: &[u8]) -> PyResult<Self> {
        Self::format().decoded(bytes).map_err(value_error)
    }

    fn format() -> StateFormat {
        let (kind, name) = Self::KIND;
        StateFormat { version: VERSION, kind, name }
    }
}
