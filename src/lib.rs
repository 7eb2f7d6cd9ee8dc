//! Finds how a flat free-form object moves from nothing but its outlines.
mod pipeline;

pub use freeform_curve_fit as curve_fit;
pub use freeform_decompose as decompose;
pub use freeform_identify as identify;
pub use freeform_outline_io as outline_io;
pub use freeform_riccati as riccati;
pub use freeform_sim_camera as sim_camera;
pub use pipeline::{FrameResult, Pipeline, PipelineError, PipelineSettings};
