//! What was found, drawn on the pictures.
mod canvas;
mod drawing;
mod folder;
mod gif_file;
mod lettering;
mod observed;
mod palette;
mod target;
mod video_file;

pub(crate) use canvas::Canvas;
pub(crate) use drawing::{Drawn, Overlay};
pub(crate) use lettering::Label;
pub(crate) use observed::{CurveFitter, ObservedOverlay};
