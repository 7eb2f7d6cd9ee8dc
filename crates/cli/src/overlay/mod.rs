//! What was found, drawn on the pictures.
mod canvas;
mod drawing;
mod observed;
mod target;

pub(crate) use drawing::{Drawn, Overlay};
pub(crate) use observed::{CurveFitter, ObservedOverlay};

use crate::failure::Failure;
use crate::input::Input;

/// Refuses drawings where there is nothing to draw on.
pub(crate) fn needs_pictures(input: &Input) -> Result<(), Failure> {
    if input.has_pictures() {
        return Ok(());
    }
    Err(Failure::unusable(format_args!("{}: --overlay draws on pictures, this is CSV", input.name)))
}
