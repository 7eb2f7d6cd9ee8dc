use std::sync::{Mutex, PoisonError};

use freeform_motion::VelocityUnit;
use freeform_motion::curve_fit::Rectangle;
use freeform_motion::outline_io::{
    Clipping, Identities, LabelMask, Selection, Smoothing, TraceError, TraceSettings, TracedLabel, TracedOutline,
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
    /// Share of the largest part of a label from which on the next is told of.
    told_from: f64,
}

/// Share of the largest part of a label from which on its next largest part may as well be an object.
const LIKE_AN_OBJECT: f64 = 0.25;

/// That share where the largest part is asked for: which of them it is may change from mask to mask.
const LIKE_SIZE: f64 = 0.5;

/// Objects with their outlines, objects without one with the reason, and what is to be said of labels in several parts.
type Traced = (Vec<(i64, PyOutline)>, Vec<(i64, String)>, Option<String>);

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
        let told_from = if matches!(link, "nearest" | "largest") { LIKE_SIZE } else { LIKE_AN_OBJECT };
        Ok(Self { settings, naming, told_from })
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
        let &[height, width] = labels.shape() else { return Ok((Vec::new(), Vec::new(), None)) };
        if !labels.is_c_contiguous() {
            return Err(PyValueError::new_err("the rows of the labels do not follow each other"));
        }
        let labels = labels.as_slice()?;
        py.detach(|| self.objects(frame, LabelMask::new(labels, width, height)?)).map_err(value_error)
    }
}

impl PyLabelTracer {
    /// The unit of velocities of what it traces.
    pub(crate) fn velocity_unit(&self, is_scaled: bool) -> VelocityUnit {
        VelocityUnit::in_pictures(self.settings.pixel_size, self.settings.pixel_aspect, is_scaled)
    }

    fn objects(&self, frame: u64, mask: LabelMask<'_>) -> Result<Traced, TraceError> {
        let mut found = Vec::new();
        let mut refused = Vec::new();
        let mut in_parts = None;
        for TracedLabel { label, outline, next_part } in mask.trace(&self.settings)? {
            match outline {
                Ok(traced) => {
                    let largest = traced.pixel_count;
                    if next_part as f64 > self.told_from * largest as f64 && in_parts.is_none() {
                        in_parts = Some(format!(
                            "frame {frame}, label {label}: the largest part, of {largest} pixels, is taken, and one of {next_part} pixels \
                             is not; for several objects give each a label of its own, as scipy.ndimage.label or skimage.measure.label do, \
                             and link=\"places\""
                        ));
                    }
                    found.push((label, traced));
                }
                // Specks are no objects.
                Err(TraceError::TooSmall { .. }) => {}
                Err(error) => refused.push((label, format!("frame {frame}, label {label}: {error}"))),
            }
        }
        Ok(match &self.naming {
            Naming::Labels => (with_outlines(found), refused, in_parts),
            Naming::Places(identities) => {
                let extent = self.settings.extent(mask.dimensions());
                (with_outlines(in_places(identities, extent, frame, found)), Vec::new(), in_parts)
            }
        })
    }
}

/// The objects by the names that they keep; none where nobody is where the object should be.
fn in_places(
    identities: &Mutex<Identities>,
    extent: Rectangle,
    frame: u64,
    mut found: Vec<(i64, TracedOutline)>,
) -> Vec<(i64, TracedOutline)> {
    found.sort_by_key(|(_, traced)| std::cmp::Reverse(traced.pixel_count));
    let traced: Vec<TracedOutline> = found.into_iter().map(|(_, traced)| traced).collect();
    if traced.is_empty() {
        return Vec::new();
    }
    let mut identities = identities.lock().unwrap_or_else(PoisonError::into_inner);
    identities.set_extent(extent);
    let named = identities.assign(frame, traced);
    named.map_or_else(|_| Vec::new(), |named| named.into_iter().map(|(name, traced)| (name as i64, traced)).collect())
}

fn with_outlines(traced: impl IntoIterator<Item = (i64, TracedOutline)>) -> Vec<(i64, PyOutline)> {
    traced.into_iter().map(|(name, traced)| (name, PyOutline { inner: traced.outline })).collect()
}
