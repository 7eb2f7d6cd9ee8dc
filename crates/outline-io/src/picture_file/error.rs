//! Why a picture could not be read or traced.
use std::fmt;
use std::io;

use freeform_curve_fit::OutlineError;
use image::ImageError;
use thiserror::Error;

use crate::file_name::readable;
use crate::tracing::margins::Margins;

/// A picture could not be read. Displays as one line: file, frame where the file has several, and reason.
#[derive(Debug, Error)]
pub struct PictureError {
    /// The file's name.
    pub file: String,
    /// Number of the frame where the file holds several, counted from 0.
    pub frame: Option<u64>,
    /// The reason.
    #[source]
    pub kind: PictureErrorKind,
}

impl PictureError {
    pub(crate) fn of_file(file: impl Into<String>, kind: PictureErrorKind) -> Self {
        Self { file: file.into(), frame: None, kind }
    }
}

impl fmt::Display for PictureError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", readable(&self.file))?;
        match self.frame {
            Some(frame) => write!(f, ": frame {frame}: {}", self.kind),
            None => write!(f, ": {}", self.kind),
        }
    }
}

/// Why a picture could not be read.
#[derive(Debug, Error)]
pub enum PictureErrorKind {
    /// The file could not be opened or read.
    #[error("{0}")]
    Io(#[from] io::Error),
    /// A file of no bytes.
    #[error("the file is empty")]
    Empty,
    /// A folder without pictures, or a pattern that matches no file.
    #[error("no pictures found")]
    NoPictures,
    /// A file pattern that cannot be understood.
    #[error("not a pattern of file names")]
    WrongPattern,
    /// The content is that of no picture format.
    #[error("not a picture")]
    NotAPicture,
    /// A picture format that is not built in; three are with the feature `all-pictures` alone.
    #[error(
        "pictures of type {format} are not supported: convert them to PNG, such as with ImageMagick: mogrify -format png FILES"
    )]
    Unsupported {
        /// Its media type.
        format: &'static str,
    },
    /// A file of another kind.
    #[error("{format}: {advice}")]
    ForeignFormat {
        /// What it is.
        format: &'static str,
        /// What to do.
        advice: &'static str,
    },
    /// Colours that are none of labels.
    #[error(
        "no label mask: its colours are neither grey nor those of a palette of labels, or parts of it are transparent"
    )]
    NotLabels,
    /// Video that has to be decoded first.
    #[error("{format} video is not decoded here, only uncompressed video (y4m) is")]
    CompressedVideo {
        /// Name of the format.
        format: &'static str,
    },
    /// A file of several pictures in a format that is read one picture a file.
    #[error("{format} holds several pictures: save them one a file, or as an animated GIF")]
    SeveralPictures {
        /// What kind of file it is.
        format: &'static str,
    },
    /// Something other than a file, such as a named pipe, in a folder or where a pattern matches: it might never end.
    #[error("not a file")]
    NotAFile,
    /// An animation of few bytes that unpacks to very many pixels.
    #[error("the animation unpacks to more than {limit} pixels, which is too much for its length")]
    TooMuchWork {
        /// Most pixels that are unpacked, all frames together.
        limit: u64,
    },
    /// More pixels than are accepted.
    #[error("{width} x {height} pixels, more than {limit} in all")]
    TooLarge {
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
        /// Largest number of pixels accepted.
        limit: u64,
    },
    /// Another size than that of the first picture of the sequence.
    #[error("{width} x {height} pixels, the frames before it have {first_width} x {first_height}")]
    SizeChanged {
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
        /// Columns of the first picture.
        first_width: u32,
        /// Rows of the first picture.
        first_height: u32,
    },
    /// A header of a y4m video without width or height.
    #[error("the video header {header:?} lacks the size")]
    VideoWithoutSize {
        /// The header, shortened.
        header: String,
    },
    /// A parameter in the header of a y4m video that is wrong or not supported.
    #[error("the video parameter {name}{value} is wrong or not supported")]
    VideoParameter {
        /// Its letter.
        name: char,
        /// Its value, shortened.
        value: String,
    },
    /// Something else where a frame of a y4m video should begin.
    #[error("{found:?} where a frame of the video should begin")]
    NotAVideoFrame {
        /// What is there, shortened.
        found: String,
    },
    /// A y4m video ends within a frame.
    #[error("the video ends within a frame, after {found} of {expected} bytes")]
    FrameCutShort {
        /// Bytes of the frame that are there.
        found: usize,
        /// Bytes of a frame.
        expected: usize,
    },
    /// The file ends within the picture.
    #[error("the picture is damaged: the file ends within it")]
    CutShort,
    /// A picture that is whole, of a kind that its format allows but that is not read here, such as a CMYK TIFF with a plane for
    /// each ink.
    #[error("a picture of this kind is not read here, save it as PNG: {0}")]
    UnsupportedKind(#[source] ImageError),
    /// A TIFF whose grey values have another number of bits than those that are read.
    #[error(
        "a grey TIFF of {bits} bits a pixel is not read here, those of 1, 8 and 16 bits are: convert it, such as in Python with \
         picture.astype('uint16'), grey values scaled to 0 to 65535 and labels as they are"
    )]
    TiffBits {
        /// Its bits a pixel, whole numbers or floats.
        bits: u64,
    },
    /// The file ends early or contradicts itself.
    #[error("the picture is damaged: {0}")]
    Damaged(#[source] ImageError),
}

impl PictureErrorKind {
    /// Refuses a picture of other columns and rows than the first, which sets them.
    pub(crate) fn check_size(first: &mut Option<(u32, u32)>, (width, height): (u32, u32)) -> Result<(), Self> {
        let (first_width, first_height) = *first.get_or_insert((width, height));
        if (width, height) != (first_width, first_height) {
            return Err(Self::SizeChanged { width, height, first_width, first_height });
        }
        Ok(())
    }
}

/// Why no outline could be traced in a picture.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum TraceError {
    /// A setting is out of range.
    #[error("the setting {name} is {value}, expected {expected}")]
    Setting {
        /// Name of the setting.
        name: &'static str,
        /// Its value.
        value: f64,
        /// The range accepted.
        expected: &'static str,
    },
    /// Margins that take all of a picture.
    #[error("the margins leave nothing of a picture of {columns}x{rows} pixels")]
    NothingLeft {
        /// What is not looked at.
        margins: Margins,
        /// Columns of the picture.
        columns: u32,
        /// Its rows.
        rows: u32,
    },
    /// A picture of no pixels.
    #[error("the picture has no pixels")]
    NoPixels,
    /// Labels that change from pixel to pixel.
    #[error(
        "{scattered} of {labels} labels are scattered pixels: these are grey values and no labels; make a mask of the picture first, such as \
         picture > level"
    )]
    GreyValues {
        /// Labels of which hardly two pixels are side by side.
        scattered: usize,
        /// All labels.
        labels: usize,
    },
    /// All pixels have one grey value.
    #[error("no object: every pixel has the grey value {value}")]
    Uniform {
        /// The grey value.
        value: u8,
    },
    /// No pixel passes the threshold.
    #[error("no object: no pixel passes the threshold {threshold}")]
    NoObject {
        /// The threshold as a grey value of the picture.
        threshold: f64,
    },
    /// The largest object is too small.
    #[error("no object: the largest has {pixels} pixel(s), at least {needed} are needed")]
    TooSmall {
        /// Pixels of the largest object.
        pixels: u64,
        /// Smallest number accepted.
        needed: u64,
    },
    /// Light and dark pixels are no further apart than the ground itself varies.
    #[error(
        "no object stands out from the ground: object and ground differ by {difference:.1} grey values, the ground itself varies by {spread:.1}"
    )]
    NoContrast {
        /// Difference of the median grey values of the two classes.
        difference: f64,
        /// Robust standard deviation of the darker or lighter class taken for the ground.
        spread: f64,
    },
    /// The background picture has another size.
    #[error("{width} x {height} pixels, the background has {background_width} x {background_height}")]
    BackgroundSize {
        /// Columns of the picture.
        width: u32,
        /// Rows of the picture.
        height: u32,
        /// Columns of the background.
        background_width: u32,
        /// Rows of the background.
        background_height: u32,
    },
    /// No closed line stands out from the picture.
    #[error("no object: no closed ring stands out from the ground")]
    NoRing,
    /// No object is where the one of the frames before it should be.
    #[error("no object at the predicted place: the nearest is {distance:.1} object sizes away")]
    NotNear {
        /// Distance from the place expected, in diameters of the object.
        distance: f64,
    },
    /// What is where the object of the frames before it should be differs too much in size.
    #[error("the object at the predicted place has {ratio:.2} times the area of the one followed")]
    OtherSize {
        /// Its area over that of the object.
        ratio: f64,
    },
    /// Objects that were apart before are one in the picture.
    #[error("{objects} objects touch and are one in the picture")]
    Touching {
        /// How many.
        objects: usize,
    },
    /// All objects are where they were first seen.
    #[error("no object has left the place where it was first seen")]
    NothingMoved,
    /// The outline is longer than that of any object.
    #[error("no outline: it would have more than {limit} points")]
    TooManyPoints {
        /// Most points accepted.
        limit: usize,
    },
    /// A picture that is too large to look for rings in.
    #[error("{width} x {height} pixels, rings are looked for in up to {limit}")]
    TooLargeForRings {
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
        /// Largest number of pixels accepted.
        limit: u64,
    },
    /// The object is so thin that smoothing takes it below the threshold.
    #[error("smoothing by {sigma} pixels leaves nothing of the object")]
    SmoothedAway {
        /// Standard deviation of the smoothing, in pixels.
        sigma: f64,
    },
    /// No part of the outline is within the picture.
    #[error("the object fills the picture: nothing of its outline is visible")]
    FillsPicture,
    /// The part of the outline that is within the picture is straight, and says nothing of the object.
    #[error("only {points} points of the outline are within the picture, and they lie on one line")]
    VisiblePartStraight {
        /// Points within the picture.
        points: usize,
    },
    /// The points are no outline.
    #[error("the traced points are no outline: {0}")]
    Degenerate(#[from] OutlineError),
}
