//! Label masks in files of pictures.
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use image::{DynamicImage, GenericImageView as _, GrayImage, RgbaImage};

use crate::frame::OutlineFrame;
use crate::labels::label_mask::{LabelMask, TracedLabel};
use crate::labels::void_border::without_void;
use crate::picture_file::error::{PictureError, PictureErrorKind, TraceError};
use crate::picture_file::palette::places_of_png;
use crate::picture_file::picture::read_picture_colours;
use crate::picture_file::sequence::DEFAULT_RATE;
use crate::picture_file::source_picture::SourcePicture;
use crate::traced_pictures::{TracedPicture, TracingSummary};
use crate::tracing::settings::TraceSettings;

/// Share of the pixels at the sides of a label mask that are ground.
const LEAST_GROUND: f64 = 0.5;

/// Share of the largest part of a label from which on the next largest is told of.
const LIKE_AN_OBJECT: f64 = 0.25;

/// What is wrong with a label that has the edge of the picture all around.
const AROUND_ALL: &str = "it lies around all others as ground does; the ground of label masks is 0, which is never an object: where this is the \
                          ground, give it the number 0, and objects numbers from 1 on";

/// Grey values that labels are drawn with: the darkest, and how many there are.
const DRAWN: [u64; 2] = [96, 160];

/// Step from one of these to that of the next label: neighbours are told apart.
const DRAWN_STEP: u64 = 61;

/// What the numbers of labels are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Numbering {
    /// Grey values.
    Grey,
    /// Those of colours of the palette of PASCAL VOC.
    Voc,
    /// Places in another palette, as drawings have it too.
    OwnPalette,
}

/// The labels of a picture.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct LabelPicture {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) labels: Vec<i64>,
    pub(crate) numbering: Numbering,
    /// Whether borders of objects were marked as void, and have been shared out among what they lie between.
    pub(crate) had_void: bool,
}

impl LabelPicture {
    pub(crate) fn read(path: &Path) -> Result<Self, PictureError> {
        let not_labels = || PictureError::of_file(path.display().to_string(), PictureErrorKind::NotLabels);
        let picture = read_picture_colours(path)?;
        Self::of(&picture, || places_of_png(path)).ok_or_else(not_labels)
    }

    /// Of a picture that has ground around it, as label masks have: nothing is taken from others, which may be large.
    pub(crate) fn read_with_ground_around(path: &Path) -> Option<Self> {
        let picture = read_picture_colours(path).ok()?;
        let (width, height) = picture.dimensions();
        // Of 16 bits the eight that are shown say too little.
        let is_ground = |x: u32, y: u32| match &picture {
            DynamicImage::ImageLuma16(grey) => grey.get_pixel(x, y).0 == [0],
            _ => picture.get_pixel(x, y).0[..3] == [0; 3],
        };
        let across = (0..width).flat_map(|x| [(x, 0), (x, height.saturating_sub(1))]);
        let along = (0..height).flat_map(|y| [(0, y), (width.saturating_sub(1), y)]);
        let ground = across.chain(along).filter(|(x, y)| *x < width && *y < height && is_ground(*x, *y)).count();
        let is_around = ground as f64 >= LEAST_GROUND * (2 * (u64::from(width) + u64::from(height))) as f64;
        if is_around { Self::of(&picture, || places_of_png(path)) } else { None }
    }

    /// The grey values, or the numbers of colours that label masks are painted with, those of PASCAL VOC or of a palette of the picture; nothing of
    /// other pictures. Borders that are marked as void are shared out.
    pub(crate) fn of(picture: &DynamicImage, places: impl FnOnce() -> Option<GrayImage>) -> Option<Self> {
        let (width, height) = (picture.width() as usize, picture.height() as usize);
        let mut numbering = Numbering::Grey;
        let labels = match picture {
            DynamicImage::ImageLuma8(grey) => grey.as_raw().iter().map(|value| i64::from(*value)).collect(),
            DynamicImage::ImageLuma16(grey) => grey.as_raw().iter().map(|value| i64::from(*value)).collect(),
            _ => {
                let colours = plain_colours(picture)?;
                let (pixels, _) = colours.as_raw().as_chunks::<4>();
                let is_of_picture = |places: &GrayImage| places.dimensions() == colours.dimensions();
                if let Some(labels) = labels_of_voc(pixels) {
                    numbering = Numbering::Voc;
                    labels
                } else if let Some(places) = places().filter(is_of_picture) {
                    numbering = Numbering::OwnPalette;
                    places.as_raw().iter().map(|place| i64::from(*place)).collect()
                } else {
                    grey_labels(pixels)?
                }
            }
        };
        let (labels, had_void) = match without_void(&labels, width, height) {
            Some(labels) => (labels, true),
            None => (labels, false),
        };
        Some(Self { width, height, labels, numbering, had_void })
    }

    /// As it is drawn upon.
    fn drawn(&self) -> GrayImage {
        let [darkest, count] = DRAWN;
        let grey = |label: &i64| match u64::try_from(*label) {
            Ok(label) if label > 0 => u8::try_from(darkest + label.wrapping_mul(DRAWN_STEP) % count).unwrap_or(u8::MAX),
            _ => 0,
        };
        let greys = self.labels.iter().map(grey).collect();
        GrayImage::from_raw(self.width as u32, self.height as u32, greys).unwrap_or_default()
    }
}

/// The colours of a picture of 8 bits without transparency.
fn plain_colours(picture: &DynamicImage) -> Option<RgbaImage> {
    let is_plain =
        matches!(picture, DynamicImage::ImageRgb8(_) | DynamicImage::ImageRgba8(_) | DynamicImage::ImageLumaA8(_));
    let colours = is_plain.then(|| picture.to_rgba8())?;
    colours.pixels().all(|pixel| pixel.0[3] == u8::MAX).then_some(colours)
}

/// Labels by the palette of PASCAL VOC and DAVIS, whose first 256 numbers are spread over the bits of red, green and blue. Some of its colours are
/// grey, and may be all that a picture of it shows.
fn labels_of_voc(pixels: &[[u8; 4]]) -> Option<Vec<i64>> {
    numbers_in(&(0..256).map(palette_colour).collect::<Vec<_>>(), pixels)
}

fn grey_labels(pixels: &[[u8; 4]]) -> Option<Vec<i64>> {
    let are_grey = pixels.iter().all(|[red, green, blue, _]| red == green && green == blue);
    are_grey.then(|| pixels.iter().map(|[grey, ..]| i64::from(*grey)).collect())
}

/// The numbers of colours that all are of a palette.
fn numbers_in(palette: &[[u8; 3]], pixels: &[[u8; 4]]) -> Option<Vec<i64>> {
    let numbers: BTreeMap<[u8; 3], i64> =
        palette.iter().enumerate().map(|(number, colour)| (*colour, number as i64)).collect();
    let mut latest = (*palette.first()?, 0);
    let number = |[red, green, blue, _]: &[u8; 4]| {
        let colour = [*red, *green, *blue];
        if colour != latest.0 {
            latest = (colour, *numbers.get(&colour)?);
        }
        Some(latest.1)
    };
    pixels.iter().map(number).collect()
}

/// The colour that the palette of PASCAL VOC gives a number: its bits three by three, the lowest into the highest of red, green and blue.
fn palette_colour(number: i64) -> [u8; 3] {
    let channel = |first: i64| {
        (0..3).fold(0, |colour, digit| colour | (((number >> (3 * digit + first)) & 1) as u8) << (7 - digit))
    };
    [channel(0), channel(1), channel(2)]
}

/// The outlines of every label in a sequence of label masks, one picture after the other, under the labels as names: of grey pictures of 8 or 16
/// bits their values, of those with a palette, that of PASCAL VOC and DAVIS or one of the file (PNG), the numbers of the colours. 0 is the ground.
#[derive(Debug)]
pub struct LabelPictures {
    files: Vec<PathBuf>,
    next: usize,
    rate: f64,
    trace: TraceSettings,
    summary: TracingSummary,
    in_parts: Option<LabelInParts>,
    left_out: Option<LabelLeftOut>,
    void_in: Option<u64>,
}

/// A label that no outline was found of, beside others.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LabelLeftOut {
    /// Number of the picture.
    pub frame: u64,
    /// The label.
    pub label: i64,
    /// What is wrong with it.
    pub reason: String,
}

/// A label in several parts, of which the largest is taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LabelInParts {
    /// Number of the picture.
    pub frame: u64,
    /// The label.
    pub label: i64,
    /// Pixels of the part that is taken.
    pub largest: u64,
    /// Pixels of the next largest.
    pub next: u64,
}

impl LabelPictures {
    /// The masks in these files, with so many frames per second, 30 if none are given; margins are not looked at.
    ///
    /// # Errors
    /// A setting out of range.
    pub fn new(files: Vec<PathBuf>, frames_per_second: Option<f64>, trace: TraceSettings) -> Result<Self, TraceError> {
        trace.check()?;
        let rate = frames_per_second.unwrap_or(DEFAULT_RATE);
        let (in_parts, left_out, void_in) = (None, None, None);
        Ok(Self { files, next: 0, rate, trace, summary: TracingSummary::default(), in_parts, left_out, void_in })
    }

    /// Number of pictures.
    #[must_use]
    pub fn frame_count(&self) -> u64 {
        self.files.len() as u64
    }

    /// How outlines are traced.
    #[must_use]
    pub const fn trace(&self) -> &TraceSettings {
        &self.trace
    }

    /// Size of the pictures, and the last of them.
    #[must_use]
    pub const fn summary(&self) -> TracingSummary {
        self.summary
    }

    /// The first label of the masks so far whose next largest part has a quarter of the area of its largest, or more.
    #[must_use]
    pub const fn in_parts(&self) -> Option<LabelInParts> {
        self.in_parts
    }

    /// The first label of the masks so far that no outline was found of, beside others.
    #[must_use]
    pub const fn left_out(&self) -> Option<&LabelLeftOut> {
        self.left_out.as_ref()
    }

    /// The number of the first mask so far that marks borders of its objects as void, with 255: half of such a border, from the middle on, is taken
    /// for the object.
    #[must_use]
    pub const fn void_in(&self) -> Option<u64> {
        self.void_in
    }

    fn read(&mut self, path: &Path) -> Result<LabelPicture, PictureError> {
        let failed = |kind| PictureError::of_file(path.display().to_string(), kind);
        // To open a pipe is to wait for somebody who writes to it.
        if !path.is_file() && path.exists() {
            return Err(failed(PictureErrorKind::NotAFile));
        }
        let picture = LabelPicture::read(path)?;
        let size = (picture.width as u32, picture.height as u32);
        PictureErrorKind::check_size(&mut self.summary.size, size).map_err(failed)?;
        Ok(picture)
    }

    /// The outlines of a mask; labels of less than the smallest area are specks, and no objects.
    fn outlines(&mut self, picture: &LabelPicture, frame: u64, time: f64) -> Result<Vec<OutlineFrame>, TraceError> {
        let mask = LabelMask::new(&picture.labels, picture.width, picture.height)?;
        let traced = mask.trace(&self.trace)?;
        let (mut outlines, mut refused) = (Vec::new(), None);
        for TracedLabel { label, outline, next_part: next } in traced {
            match outline {
                Ok(traced) => {
                    let largest = traced.pixel_count;
                    if next as f64 >= LIKE_AN_OBJECT * largest as f64 {
                        self.in_parts.get_or_insert(LabelInParts { frame, label, largest, next });
                    }
                    outlines.push(OutlineFrame { frame, time, object: label.to_string(), outline: traced.outline });
                }
                Err(error) => refused = refused.or(Some((label, error))),
            }
        }
        match refused {
            Some((_, error)) if outlines.is_empty() => Err(error),
            None if outlines.is_empty() => Err(TraceError::Uniform { value: 0 }),
            refused => {
                let reason = |error| match error {
                    TraceError::FillsPicture => AROUND_ALL.to_owned(),
                    error => error.to_string(),
                };
                let left_out = refused.map(|(label, error)| LabelLeftOut { frame, label, reason: reason(error) });
                self.left_out = self.left_out.take().or(left_out);
                Ok(outlines)
            }
        }
    }
}

impl Iterator for LabelPictures {
    type Item = Result<TracedPicture, PictureError>;

    fn next(&mut self) -> Option<Self::Item> {
        let path = self.files.get(self.next)?.clone();
        let frame = self.next as u64;
        self.next += 1;
        let time = frame as f64 / self.rate;
        let picture = match self.read(&path) {
            Ok(picture) => picture,
            Err(error) => return Some(Err(error)),
        };
        self.summary.last = Some((frame, time));
        if picture.had_void {
            self.void_in.get_or_insert(frame);
        }
        let outlines = self.outlines(&picture, frame, time);
        let grid = self.trace.pixel_grid(picture.height as u32);
        let source = SourcePicture { frame, time, picture: Arc::new(picture.drawn()), grid };
        Some(Ok(TracedPicture { source, file: path.display().to_string(), outlines }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_palette_is_that_of_pascal_voc() {
        let known = [(0, [0, 0, 0]), (1, [128, 0, 0]), (2, [0, 128, 0]), (3, [128, 128, 0]), (15, [192, 128, 128])];
        known.into_iter().for_each(|(number, colour)| assert_eq!(palette_colour(number), colour, "{number}"));
    }
}
