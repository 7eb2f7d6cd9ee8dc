//! What was identified, drawn on the pictures of an input.
use std::path::{Path, PathBuf};

use freeform_drawing::{CurveFitter, ObservedOverlay};

use crate::args::TrackOptions;
use crate::failure::Failure;
use crate::input::Input;
use crate::output::DrawnPictures;
use crate::reader::Event;
use crate::seen::Missing;

/// Draws what comes of reading an input on its pictures.
pub(crate) struct InputOverlay {
    overlay: ObservedOverlay,
    pictures: DrawnPictures,
}

impl InputOverlay {
    /// Drawings for a folder, a GIF or a video, if they are asked for. Refused where there is nothing to draw on.
    pub(crate) fn open(
        path: Option<&Path>,
        inputs: &[PathBuf],
        input: &Input,
        options: &TrackOptions,
    ) -> Result<Option<Self>, Failure> {
        let Some(path) = path else { return Ok(None) };
        if !input.has_pictures() {
            return Err(Failure::unusable(format_args!("{}: --overlay draws on pictures, this is CSV", input.name)));
        }
        let names = input.pictures().is_some_and(|pictures| pictures.options().follows_all());
        let pictures = DrawnPictures::open(path, inputs)?;
        let overlay = ObservedOverlay::new(curves(options)?, names);
        let overlay = overlay.with_scale(options.scale).with_plane(options.rectification());
        Ok(Some(Self { overlay, pictures }))
    }

    /// Draws one object, or a picture without any.
    pub(crate) fn take(&mut self, event: &Event) -> Result<(), Failure> {
        self.pictures.take(match event {
            Event::Object(observation, Some((frame, Some(source)))) => self.overlay.draw(observation, frame, source),
            Event::Gap(Missing { seen_in: Some(source), .. }) => self.overlay.draw_nothing(source),
            _ => None,
        })
    }

    /// Writes what has not been written.
    pub(crate) fn finish(self) -> Result<(), Failure> {
        self.pictures.finish(self.overlay.finish())
    }
}

/// The curves that are drawn where the method fits none.
pub(crate) fn curves(options: &TrackOptions) -> Result<CurveFitter, Failure> {
    CurveFitter::new(options.degree_drawn(), options.rectify.is_some()).map_err(Failure::unusable)
}
