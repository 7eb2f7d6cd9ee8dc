//! How pictures are read and traced, by the options.
use freeform_motion::outline_io::{
    Background, Clipping, Contours, Contrast, Difference, Edges, PicturePreview, PictureSettings, Ring,
    SequenceSettings, Smoothing, Threshold, TraceSettings, read_picture_channel,
};

use crate::args::{ChannelChoice, PictureOptions, TransferChoice};
use crate::failure::{Failure, plain};

/// Pictures that the running median is taken of where no other number is given.
const MEDIAN_SIZE: u8 = 25;

/// How the pictures are read.
pub(crate) fn sequence_settings(options: &PictureOptions) -> SequenceSettings {
    SequenceSettings { frames_per_second: options.fps, channel: options.channel().channel() }
}

/// How they are traced, with the aspect of pixels that the pictures tell and, to compare with all of them, what has been seen of them.
///
/// # Errors
/// If options contradict each other, or the picture of a background cannot be read.
pub(crate) fn picture_settings(
    options: &PictureOptions,
    aspect: Option<f64>,
    preview: Option<&PicturePreview>,
) -> Result<PictureSettings, Failure> {
    let channel = options.channel().channel();
    let is_median = options.background.as_ref().is_some_and(|path| path.as_os_str() == "median");
    if options.background_window.is_some() && !is_median {
        return Err(Failure::unusable(
            "--background-window: how many pictures the median is of, so only for --background median",
        ));
    }
    if options.transfer() == TransferChoice::Srgb && options.channel() == ChannelChoice::Saturation {
        return Err(Failure::unusable(
            "--transfer srgb: the saturation of colours is no light, so not with --channel saturation",
        ));
    }
    let background = match &options.background {
        Some(path) if path.as_os_str() == "median" => {
            Some(Background::RunningMedian(options.background_window.unwrap_or(MEDIAN_SIZE).into()))
        }
        Some(path) if path.as_os_str() == "surface" => Some(Background::Surface),
        Some(_) if options.compares_with_whole() => preview.and_then(|p| p.ground(channel)).map(Background::Picture),
        Some(path) => {
            let picture = read_picture_channel(path, channel);
            let failed = |error| Failure::unusable(format_args!("--background {}", plain(&error)));
            Some(Background::Picture(picture.map_err(failed)?.into()))
        }
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
        edges: Edges::Refined,
        transfer: options.transfer().transfer(),
        minimum_area: options.min_area,
        contours: if options.traces_contours() { Contours::All } else { Contours::Boundary },
        clipping: Clipping::Open,
        y_up: !options.y_down,
        ring: options.ring.map(|ring| Ring { contrast: ring.contrast(), width: options.ring_width }),
        pixel_size: options.pixel_size,
        pixel_aspect: options.pixel_aspect.or(aspect).unwrap_or(1.0),
        margins: options.margins,
    };
    Ok(PictureSettings { trace, selection: options.objects().selection(), background, difference })
}
