//! Outlines of the objects in pictures.
use std::collections::VecDeque;
use std::io::BufRead;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use freeform_motion::outline_io::{
    Background, Clipping, Contrast, Difference, OutlineFrame, PictureError, PictureFrame, PictureOutlines,
    PictureSequence, PictureSettings, Ring, SequenceSettings, Smoothing, Threshold, TraceSettings, read_picture,
};

use crate::args::PictureOptions;
use crate::failure::Failure;
use crate::input::{Item, Missing, SeenIn};

/// Pictures that the running median is taken of.
const MEDIAN_SIZE: usize = 25;

/// The outlines in pictures, one object after the other.
pub(crate) struct PictureInput {
    outlines: PictureOutlines<PictureSequence>,
    trace: TraceSettings,
    /// Objects of the present picture that have not been handed on.
    waiting: VecDeque<Item>,
    /// Pictures read and pictures that gave an outline.
    pub(crate) frames: u64,
    pub(crate) frames_traced: u64,
}

impl PictureInput {
    /// Pictures in files, folders and patterns.
    pub(crate) fn open(paths: &[PathBuf], options: &PictureOptions) -> Result<Self, Failure> {
        let sequence = PictureSequence::open(paths, sequence_settings(options)).map_err(|error| unreadable(&error))?;
        Self::of(sequence, options)
    }

    /// Pictures in a stream.
    pub(crate) fn from_stream(
        source: impl BufRead + 'static,
        name: &str,
        options: &PictureOptions,
    ) -> Result<Self, Failure> {
        let sequence = PictureSequence::from_stream(source, name, sequence_settings(options));
        Self::of(sequence.map_err(|error| unreadable(&error))?, options)
    }

    fn of(sequence: PictureSequence, options: &PictureOptions) -> Result<Self, Failure> {
        let settings = picture_settings(options, sequence.pixel_aspect())?;
        let trace = settings.trace;
        let outlines = PictureOutlines::new(sequence, settings).map_err(Failure::unusable)?;
        Ok(Self { outlines, trace, waiting: VecDeque::new(), frames: 0, frames_traced: 0 })
    }

    /// Number of pictures, where it is known.
    pub(crate) fn frame_count(&self) -> Option<u64> {
        self.outlines.source().frame_count()
    }

    fn read_picture(&mut self) -> Option<()> {
        let traced = self.outlines.next()?;
        self.frames += 1;
        match traced {
            Err(error) => {
                self.waiting.push_back(Item::Missing(Missing { reason: error.to_string(), seen_in: None }));
            }
            Ok(traced) => {
                let PictureFrame { frame, time, file, picture } = traced.frame;
                let seen_in = Rc::new(SeenIn { frame, grid: self.trace.pixel_grid(picture.height()), picture });
                match traced.objects {
                    Err(error) => {
                        let reason = format!("{file}: frame {frame}: {error}");
                        self.waiting.push_back(Item::Missing(Missing { reason, seen_in: Some(seen_in) }));
                    }
                    Ok(objects) => {
                        self.frames_traced += 1;
                        self.waiting.extend(objects.into_iter().map(|(name, traced)| {
                            let outline = traced.outline;
                            let outline = OutlineFrame { frame, time, object: name.to_string(), outline };
                            Item::Outline(outline, Some(Rc::clone(&seen_in)))
                        }));
                    }
                }
            }
        }
        Some(())
    }
}

impl Iterator for PictureInput {
    type Item = Item;

    fn next(&mut self) -> Option<Item> {
        while self.waiting.is_empty() {
            self.read_picture()?;
        }
        self.waiting.pop_front()
    }
}

fn unreadable(error: &PictureError) -> Failure {
    Failure::unusable(error)
}

fn sequence_settings(options: &PictureOptions) -> SequenceSettings {
    SequenceSettings { frames_per_second: options.fps, channel: options.channel.channel() }
}

fn picture_settings(options: &PictureOptions, aspect: Option<f64>) -> Result<PictureSettings, Failure> {
    let background = match &options.background {
        Some(path) if path.as_os_str() == "median" => Some(Background::RunningMedian(MEDIAN_SIZE)),
        Some(path) => Some(Background::Picture(background_picture(path, options)?)),
        None => None,
    };
    let difference = match (options.light, options.dark) {
        (true, _) => Difference::Lighter,
        (_, true) => Difference::Darker,
        _ => Difference::Either,
    };
    let trace = TraceSettings {
        contrast: if options.dark { Contrast::DarkOnLight } else { Contrast::LightOnDark },
        threshold: options.threshold.map_or(Threshold::Automatic, Threshold::Level),
        smoothing: options.smoothing.map_or(Smoothing::Automatic, Smoothing::Gaussian),
        minimum_area: options.min_area,
        clipping: Clipping::Open,
        y_up: !options.y_down,
        ring: options.ring.map(|ring| Ring { contrast: ring.contrast(), width: options.ring_width }),
        pixel_size: options.pixel_size,
        pixel_aspect: options.pixel_aspect.or(aspect).unwrap_or(1.0),
    };
    Ok(PictureSettings { trace, selection: options.objects.selection(), background, difference })
}

fn background_picture(
    path: &Path,
    options: &PictureOptions,
) -> Result<freeform_motion::outline_io::GrayImage, Failure> {
    if options.channel == crate::args::ChannelChoice::Luminance {
        return read_picture(path).map_err(|error| unreadable(&error));
    }
    let mut single = PictureSequence::open(&[path.to_owned()], sequence_settings(options));
    let first = single.as_mut().map_err(|error| Failure::unusable(&*error))?.next();
    match first {
        Some(Ok(frame)) => Ok(frame.picture),
        Some(Err(error)) => Err(unreadable(&error)),
        None => Err(Failure::unusable(format_args!("{}: no picture", path.display()))),
    }
}
