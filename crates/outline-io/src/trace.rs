use freeform_curve_fit::{OpenArc, OpenOutline, Outline};
use image::GrayImage;
use nalgebra::Point2;

use crate::error::TraceError;
use crate::field::{Field, blur_reach};
use crate::isoline::{Crossing, area, isolines};
use crate::object_mask::ObjectMask;
use crate::threshold::{Levels, level_in_picture, signal};

/// Standard deviation of the smoothing of two-valued pictures where none is given, in pixels.
const MASK_SIGMA: f64 = 1.0;

/// The same for pictures of more grey values, in pixels.
const GREY_SIGMA: f64 = 0.5;

/// Largest standard deviation of the smoothing, in pixels.
const SIGMA_LIMIT: f64 = 100.0;

/// Whether objects are lighter or darker than the ground.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Contrast {
    /// Light objects, as in masks.
    #[default]
    LightOnDark,
    /// Dark objects.
    DarkOnLight,
}

/// The grey value that parts objects from the ground.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Threshold {
    /// Half-way between the median grey values of the two classes that Otsu's method finds; for a mask, half-way between
    /// its two values.
    #[default]
    Automatic,
    /// A grey value of the picture, above 0 and up to 255.
    Level(f64),
}

/// How much the picture is smoothed before its outline is traced.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Smoothing {
    /// By a Gaussian of 1 pixel for a picture of two grey values, whose edges are stairs; of half a pixel for others,
    /// whose grey values place the edge within a pixel but are seldom linear across it.
    #[default]
    Automatic,
    /// By a Gaussian of this standard deviation in pixels, 0 to 100; 0 for none.
    Gaussian(f64),
}

/// What to make of an object that the edge of the picture clips.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Clipping {
    /// Close the outline along the edge of the picture.
    #[default]
    Close,
    /// Keep only what is seen of the object's own outline, as open arcs.
    Open,
}

/// How an outline is traced in a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TraceSettings {
    /// Light objects on dark ground, or the other way round.
    pub contrast: Contrast,
    /// The grey value on the outline.
    pub threshold: Threshold,
    /// Smoothing before tracing.
    pub smoothing: Smoothing,
    /// Smallest object accepted, in pixels.
    pub minimum_area: u64,
    /// What to make of an object that the edge of the picture clips.
    pub clipping: Clipping,
    /// Whether y runs upwards from the lower edge of the picture, or downwards from its upper edge.
    pub y_up: bool,
    /// Height of a pixel in the length unit of the outline.
    pub pixel_size: f64,
    /// Width of a pixel over its height.
    pub pixel_aspect: f64,
}

impl Default for TraceSettings {
    /// Light on dark, everything automatic, at least 9 pixels, closed along the edge, y upwards, pixels as unit.
    fn default() -> Self {
        Self {
            contrast: Contrast::default(),
            threshold: Threshold::default(),
            smoothing: Smoothing::default(),
            minimum_area: 9,
            clipping: Clipping::default(),
            y_up: true,
            pixel_size: 1.0,
            pixel_aspect: 1.0,
        }
    }
}

impl TraceSettings {
    fn check(&self) -> Result<(), TraceError> {
        let refuse = |name, value, expected| Err(TraceError::Setting { name, value, expected });
        let is_length = |value: f64| (1e-50..=1e50).contains(&value);
        match (self.threshold, self.smoothing) {
            (Threshold::Level(level), _) if !(level > 0.0 && level <= 255.0) => {
                refuse("threshold", level, "a grey value above 0 and up to 255")
            }
            (_, Smoothing::Gaussian(sigma)) if !(0.0..=SIGMA_LIMIT).contains(&sigma) => {
                refuse("smoothing", sigma, "0 to 100 pixels")
            }
            _ if !is_length(self.pixel_size) => refuse("pixel_size", self.pixel_size, "a positive length"),
            _ if !is_length(self.pixel_aspect) => refuse("pixel_aspect", self.pixel_aspect, "a positive ratio"),
            _ => Ok(()),
        }
    }

    fn sigma(&self, levels: &Levels) -> f64 {
        match self.smoothing {
            Smoothing::Automatic if levels.two_valued => MASK_SIGMA,
            Smoothing::Automatic => GREY_SIGMA,
            Smoothing::Gaussian(sigma) => sigma,
        }
    }
}

/// The outline of the largest object in a picture.
#[derive(Debug, Clone, PartialEq)]
pub struct TracedOutline {
    /// The outline, running counter-clockwise in its own coordinates (positive area).
    pub outline: Outline,
    /// Whether the edge of the picture clips the object, so that part of its own outline is not seen.
    pub touches_border: bool,
    /// Pixels of the object, holes not counted.
    pub pixel_count: u64,
    /// Objects of at least the smallest area in the picture; one was traced.
    pub object_count: usize,
    /// The grey value on the outline.
    pub threshold: f64,
}

/// Traces the outer outline of the largest object in a picture, to a fraction of a pixel.
///
/// Objects are 8-connected sets of pixels at or beyond the threshold; holes are filled. The outline is where the grey
/// value, smoothed if asked for and interpolated linearly between pixel centres, passes the threshold. Column c and row
/// r, counted from 0 at the upper left, have their centre at `x = pixel_size * pixel_aspect * (c + 0.5)` and
/// `y = pixel_size * (height - r - 0.5)`, or `pixel_size * (r + 0.5)` with y downwards. There are about 1.3 points to a
/// pixel of outline, unevenly spaced.
///
/// Measured on discs of 10 to 60 pixels in radius with the automatic smoothing: drawn with grey edges, the mean radius
/// is right to 0.015 pixels and the points scatter by 0.04 pixels (root mean square); drawn as a two-valued mask, to
/// 0.06 and 0.15 pixels (0.24 without smoothing: the stairs themselves). Smoothing by s pixels moves an outline with
/// radius of curvature R by about `s^2 / (2 R)` towards its centre of curvature.
///
/// # Errors
/// A setting out of range; a picture without an object or with none of the area asked for; an object that smoothing
/// removes or, where arcs are asked for, one that fills the picture.
pub fn trace_mask(picture: &GrayImage, settings: &TraceSettings) -> Result<TracedOutline, TraceError> {
    settings.check()?;
    let levels = Levels::of(picture, settings.contrast, settings.threshold)?;
    let sigma = settings.sigma(&levels);
    let set = |value: u8| f64::from(signal(value, settings.contrast)) >= levels.threshold;
    let mask = ObjectMask::largest(picture, set, settings.minimum_area, blur_reach(sigma) + 2)?
        .ok_or(TraceError::NoObject { threshold: level_in_picture(levels.threshold, settings.contrast) })?;

    let mut field = object_field(picture, &mask, &levels, settings.contrast, set);
    if sigma > 0.0 {
        field.blur(sigma);
    }
    let lines = isolines(&field, levels.threshold);
    let outer = lines.into_iter().max_by(|a, b| area(a).total_cmp(&area(b)));
    let line = outer.ok_or(TraceError::SmoothedAway { sigma })?;

    let touches_border = line.iter().any(|crossing| crossing.at_edge);
    let to_point = |crossing: &Crossing| {
        let x = mask.left as f64 + crossing.x + 0.5;
        let y = mask.top as f64 + crossing.y + 0.5;
        let y = if settings.y_up { f64::from(picture.height()) - y } else { y };
        Point2::new(settings.pixel_size * settings.pixel_aspect * x, settings.pixel_size * y)
    };
    let mut points: Vec<(Point2<f64>, bool)> =
        line.iter().map(|crossing| (to_point(crossing), crossing.at_edge)).collect();
    if !settings.y_up {
        points.reverse();
    }
    let outline = match settings.clipping {
        Clipping::Open if touches_border => visible_arcs(points)?,
        _ => Outline::closed(points.into_iter().map(|(point, _)| point).collect())?,
    };
    Ok(TracedOutline {
        outline,
        touches_border,
        pixel_count: mask.pixel_count,
        object_count: mask.object_count,
        threshold: level_in_picture(levels.threshold, settings.contrast),
    })
}

/// The grey values around the object, with other objects and its own holes painted over.
fn object_field(
    picture: &GrayImage,
    mask: &ObjectMask,
    levels: &Levels,
    contrast: Contrast,
    set: impl Fn(u8) -> bool,
) -> Field {
    let stride = picture.width() as usize;
    let mut values = Vec::with_capacity(mask.width * mask.height);
    for row in 0..mask.height {
        let from = (mask.top + row) * stride + mask.left;
        let pixels = &picture.as_raw()[from..from + mask.width];
        let filled = &mask.filled[row * mask.width..(row + 1) * mask.width];
        values.extend(pixels.iter().zip(filled).map(|(&value, &filled)| match (filled, set(value)) {
            (true, false) => levels.object as f32,
            (false, true) => levels.ground as f32,
            _ => f32::from(signal(value, contrast)),
        }));
    }
    Field { width: mask.width, height: mask.height, values }
}

/// The arcs between the stretches along the edge of the picture.
fn visible_arcs(mut points: Vec<(Point2<f64>, bool)>) -> Result<Outline, TraceError> {
    let on_edge = points.iter().position(|(_, at_edge)| *at_edge).unwrap_or(0);
    points.rotate_left(on_edge);
    let arcs = points.split(|(_, at_edge)| *at_edge).filter(|arc| arc.len() > 1);
    let arcs: Vec<OpenArc> =
        arcs.map(|arc| OpenArc::new(arc.iter().map(|(point, _)| *point).collect())).collect::<Result<_, _>>()?;
    if arcs.is_empty() {
        return Err(TraceError::FillsPicture);
    }
    Ok(OpenOutline::new(arcs)?.into())
}
