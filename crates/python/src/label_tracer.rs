use std::sync::{Mutex, PoisonError};

use freeform_motion::outline_io::{
    Clipping, Identities, LabelMask, Selection, Smoothing, TraceError, TraceSettings, TracedOutline,
};
use numpy::{PyReadonlyArray2, PyUntypedArrayMethods as _};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::errors::{unknown_name, value_error, whole};
use crate::outline::PyOutline;

/// Which names the objects of labelled masks get.
#[derive(Debug)]
enum Naming {
    /// Their labels.
    Labels,
    /// Names that they keep from frame to frame, whatever their labels.
    Places(Mutex<Identities>),
}

/// Traces the objects of labelled masks, one mask after the other.
#[pyclass(frozen, name = "LabelTracer", module = "freeform_motion")]
#[derive(Debug)]
pub(crate) struct PyLabelTracer {
    settings: TraceSettings,
    naming: Naming,
}

/// Objects with their outlines, and objects without one with the reason.
type Traced = (Vec<(i64, PyOutline)>, Vec<(i64, String)>);

#[pymethods]
impl PyLabelTracer {
    #[new]
    #[pyo3(signature = (*, link, y_up, pixel_size, pixel_aspect, minimum_area, smoothing, clipping))]
    fn new(
        link: &str,
        y_up: bool,
        pixel_size: f64,
        pixel_aspect: f64,
        #[pyo3(from_py_with = whole)] minimum_area: u64,
        smoothing: Option<f64>,
        clipping: &str,
    ) -> PyResult<Self> {
        let clipping = match clipping {
            "close" => Clipping::Close,
            "open" => Clipping::Open,
            _ => return Err(unknown_name("clipping", clipping, &["close", "open"])),
        };
        let smoothing = smoothing.map_or(Smoothing::Automatic, Smoothing::Gaussian);
        let settings = TraceSettings {
            y_up,
            pixel_size,
            pixel_aspect,
            minimum_area,
            smoothing,
            clipping,
            ..TraceSettings::default()
        };
        settings.check().map_err(value_error)?;
        let places = |selection| Naming::Places(Mutex::new(Identities::new(selection)));
        let naming = match link {
            "labels" => Naming::Labels,
            "places" => places(Selection::All),
            "nearest" => places(Selection::Nearest),
            "largest" => places(Selection::Largest),
            _ => return Err(unknown_name("link", link, &["labels", "places", "nearest", "largest"])),
        };
        Ok(Self { settings, naming })
    }

    /// The longer side of a pixel, in the unit of the outlines.
    #[getter]
    fn pixel(&self) -> f64 {
        self.settings.pixel()
    }

    /// The objects of a mask.
    fn trace(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = whole)] frame: u64,
        labels: PyReadonlyArray2<'_, i64>,
    ) -> PyResult<Traced> {
        let &[height, width] = labels.shape() else { return Ok((Vec::new(), Vec::new())) };
        if !labels.is_c_contiguous() {
            return Err(PyValueError::new_err("the rows of the labels do not follow each other"));
        }
        let labels = labels.as_slice()?;
        py.detach(|| self.objects(frame, LabelMask::new(labels, width, height)?)).map_err(value_error)
    }
}

impl PyLabelTracer {
    fn objects(&self, frame: u64, mask: LabelMask<'_>) -> Result<Traced, TraceError> {
        let mut found = Vec::new();
        let mut refused = Vec::new();
        for (label, traced) in mask.trace(&self.settings)? {
            match traced {
                Ok(traced) => found.push((label, traced)),
                // Specks are no objects.
                Err(TraceError::TooSmall { .. }) => {}
                Err(error) => refused.push((label, format!("frame {frame}, label {label}: {error}"))),
            }
        }
        match &self.naming {
            Naming::Labels => Ok((with_outlines(found), refused)),
            Naming::Places(identities) => {
                found.sort_by_key(|(_, traced)| std::cmp::Reverse(traced.pixel_count));
                let traced: Vec<TracedOutline> = found.into_iter().map(|(_, traced)| traced).collect();
                if traced.is_empty() {
                    return Ok((Vec::new(), Vec::new()));
                }
                let mut identities = identities.lock().unwrap_or_else(PoisonError::into_inner);
                match identities.assign(frame, traced) {
                    Ok(named) => {
                        Ok((with_outlines(named.into_iter().map(|(name, traced)| (name as i64, traced))), Vec::new()))
                    }
                    // Nobody is where the object should be: its frame is missing.
                    Err(_) => Ok((Vec::new(), Vec::new())),
                }
            }
        }
    }
}

fn with_outlines(traced: impl IntoIterator<Item = (i64, TracedOutline)>) -> Vec<(i64, PyOutline)> {
    traced.into_iter().map(|(name, traced)| (name, PyOutline { inner: traced.outline })).collect()
}
