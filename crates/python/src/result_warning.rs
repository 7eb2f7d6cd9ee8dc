use freeform_motion::Warning;
use freeform_motion::outline_io::{OriginWarning, OriginWarnings};
use pyo3::prelude::*;
use serde::{Deserialize, Serialize};

use crate::pickled::{Pickled, Reduced};

/// Something that a user should know of a result.
#[pyclass(frozen, name = "ResultWarning", module = "freeform_motion", get_all)]
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct PyResultWarning {
    /// A name that is the same in every version.
    code: String,
    /// A sentence for people.
    message: String,
}

impl From<&Warning> for PyResultWarning {
    fn from(warning: &Warning) -> Self {
        Self { code: warning.code().to_owned(), message: warning.to_string() }
    }
}

impl From<OriginWarning> for PyResultWarning {
    fn from(warning: OriginWarning) -> Self {
        Self { code: warning.code().to_owned(), message: warning.to_string() }
    }
}

/// What texts of the column `warning` of a table say of how its outlines were found.
#[pyfunction]
#[expect(clippy::needless_pass_by_value, reason = "an argument from Python")]
pub(crate) fn origin_warnings(texts: Vec<String>) -> Vec<PyResultWarning> {
    OriginWarnings::of_text(&texts.join(" ")).iter().map(Into::into).collect()
}

impl PyResultWarning {
    pub(crate) fn code(&self) -> &str {
        &self.code
    }
}

impl Pickled for PyResultWarning {
    const KIND: ([u8; 4], &'static str) = (*b"warn", "ResultWarning");
}

#[pymethods]
impl PyResultWarning {
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Reduced<'py>> {
        slf.get().reduced(&slf.get_type())
    }

    #[staticmethod]
    fn _restored(bytes: &[u8]) -> PyResult<Self> {
        Self::of_bytes(bytes)
    }

    fn __str__(&self) -> &str {
        &self.message
    }

    fn __repr__(&self) -> String {
        format!("ResultWarning({}: {})", self.code, self.message)
    }
}
