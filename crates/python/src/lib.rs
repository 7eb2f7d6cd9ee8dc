//! The native part of the Python package `freeform_motion`: thin classes over the crate `freeform-motion`, one file per class. Tables,
//! masks and plots are handled in Python.
//!
//! Whatever takes long runs without the interpreter. Objects that change are behind a lock, which no thread holds while it waits for the
//! interpreter.
mod arrays;
mod bound;
mod decomposition;
mod errors;
mod estimate;
mod fit;
mod label_tracer;
mod line_identifier;
mod motion_filter;
mod names;
mod object_result;
mod observation;
mod outline;
mod pickled;
mod pipeline;
mod plane;
mod polynomial;
mod recogniser;
mod recording;
mod result_warning;
mod simulation;
mod table_arrays;
mod tracker;

use pyo3::prelude::*;

/// The native part of `freeform_motion`.
#[pymodule]
mod _native {
    #[pymodule_export]
    use crate::bound::PyCramerRaoBound;
    #[pymodule_export]
    use crate::decomposition::{PyCorrespondence, PyDecomposition};
    #[pymodule_export]
    use crate::estimate::{PyEstimate, PyMotionState, PyParameter, PyPointVelocity};
    #[pymodule_export]
    use crate::fit::{PyFit, fit};
    #[pymodule_export]
    use crate::label_tracer::PyLabelTracer;
    #[pymodule_export]
    use crate::line_identifier::PyAdaptiveIdentifier;
    #[pymodule_export]
    use crate::motion_filter::{PyFilterStep, PyMotionFilter};
    #[pymodule_export]
    use crate::object_result::PyObjectResult;
    #[pymodule_export]
    use crate::observation::PyObservation;
    #[pymodule_export]
    use crate::outline::PyOutline;
    #[pymodule_export]
    use crate::pipeline::PyPipeline;
    #[pymodule_export]
    use crate::plane::homography;
    #[pymodule_export]
    use crate::polynomial::PyImplicitPolynomial;
    #[pymodule_export]
    use crate::recogniser::{PyEvidence, PyRecogniser, PyRecognition};
    #[pymodule_export]
    use crate::recording::{PyRecorder, identify_table, outlines_of_table, track_table};
    #[pymodule_export]
    use crate::result_warning::{PyResultWarning, origin_warnings};
    #[pymodule_export]
    use crate::simulation::{PySimulatedFrame, PySimulation, simulate};
    #[pymodule_export]
    use crate::tracker::{PyTracker, results_of};
}
