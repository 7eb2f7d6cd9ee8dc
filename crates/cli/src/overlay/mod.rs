//! What was found, drawn on the pictures.
mod canvas;
mod drawing;
mod folder;
mod lettering;
mod observed;
mod target;

pub(crate) use drawing::{Drawn, Overlay};
pub(crate) use observed::{CurveFitter, ObservedOverlay};
