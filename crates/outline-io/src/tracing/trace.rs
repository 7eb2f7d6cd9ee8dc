//! The outlines of the objects of one picture, to a fraction of a pixel.
use std::borrow::Cow;

use freeform_curve_fit::isoline::{Crossing, LargestLines, LineTooLong, WantedHoles};
use freeform_curve_fit::{ClosedOutline, OpenArc, OpenOutline, Outline, OutlineError};
use image::GrayImage;
use nalgebra::Point2;

use crate::edges::{EdgeFit, EdgeSource, OF_POINT, UNSEEN};
use crate::identity::affine_moment_invariants::{AffineMomentInvariants, AreaAndCentre};
use crate::picture_file::error::TraceError;
use crate::tracing::contrast::signal;
use crate::tracing::field::{Field, blur_reach};
use crate::tracing::input::TracingInput;
use crate::tracing::object_mask::{ObjectMask, Objects};
use crate::tracing::ring::{self, Ring};
use crate::tracing::settings::{Clipping, Contours, Edges, Smoothing, TraceSettings};
use crate::tracing::threshold::{Levels, level_in_picture};

/// Most points of all outlines of one picture: many times those of objects that have any, and few enough to be worked on. The
/// picture of a comb of 84 kB would have 34 million.
const POINT_LIMIT: usize = 1 << 19;

/// Smallest hole or mark that is traced, in pixels.
const SMALLEST_HOLE: f64 = 25.0;

/// Most holes and marks of an object.
const MOST_HOLES: usize = 32;

/// The outline of an object in a picture.
#[derive(Debug, Clone, PartialEq)]
pub struct TracedOutline {
    /// The outline, running counter-clockwise in its own coordinates (positive area). In pictures of more than two grey values its points
    /// have standard deviations: those of its edges, where it has been moved onto them, or those of edges that
    /// are not seen.
    pub outline: Outline,
    /// Whether the edge of the picture clips the object, so that part of its own outline is not seen.
    pub touches_border: bool,
    /// Pixels of the object; holes are not counted, but for an object in a ring.
    pub pixel_count: u64,
    /// Objects of at least the smallest area in the picture.
    pub object_count: usize,
    /// The grey value on the outline; for an object in a ring 0.5, the share of the strength of the ring.
    pub threshold: f64,
    /// Centre of the area seen, in the coordinates of the outline.
    pub centre: Point2<f64>,
    /// The area seen, in the squared unit of the outline.
    pub area: f64,
    /// What an affine map leaves of the area seen; `None` where it is too thin to tell.
    pub invariants: Option<AffineMomentInvariants>,
    /// What its edges are like, where the outline has been moved onto them.
    pub edges: Option<EdgeFit>,
}

/// Traces the outer outline of the largest object in a picture, to a fraction of a pixel.
///
/// Objects are 8-connected sets of pixels at or beyond the threshold; holes are filled. The outline is where the grey
/// value, smoothed if asked for and interpolated linearly between pixel centres, passes the threshold; in pictures of more than two
/// grey values it is then moved onto the edge itself ([`Edges::Refined`]). Column c and row
/// r, counted from 0 at the upper left, have their centre at `x = pixel_size * pixel_aspect * (c + 0.5)` and
/// `y = pixel_size * (height - r - 0.5)`, or `pixel_size * (r + 0.5)` with y downwards. There are about 1.3 points to a
/// pixel of outline, unevenly spaced.
///
/// Measured on discs of 10 to 60 pixels in radius with the automatic smoothing: drawn with grey edges, the mean radius
/// is right to 0.02 pixels and the points scatter by 0.04 pixels (root mean square); drawn as a two-valued mask, to
/// 0.06 and 0.15 pixels (0.24 without smoothing: the stairs themselves). Smoothing by s pixels moves an outline with
/// radius of curvature R by about `s^2 / (2 R)` towards its centre of curvature.
///
/// # Errors
/// A setting out of range; a picture without an object, with none of the area asked for, or none that stands out; an
/// object that smoothing removes, one with an outline of more than 2^19 points or, where arcs are asked for, one that fills
/// the picture.
pub fn trace_mask(picture: &GrayImage, settings: &TraceSettings) -> Result<TracedOutline, TraceError> {
    trace_objects(picture, settings, 1).and_then(|traced| traced.into_iter().next().ok_or(TraceError::NoPixels))
}

/// Like [`trace_mask`], for up to `limit` objects, the largest first; those in rings, the clearest first. Of objects that lie
/// within each other in a picture of more than half a million pixels there may be fewer: the smallest are left out where the
/// rectangles around all have more than 2^27 pixels together. So they are where their outlines have more than 2^19 points
/// together.
///
/// # Errors
/// As [`trace_mask`]; an error of one object is returned only where there is no other.
pub fn trace_objects(
    picture: &GrayImage,
    settings: &TraceSettings,
    limit: usize,
) -> Result<Vec<TracedOutline>, TraceError> {
    let margins = settings.margins.unwrap_or_default();
    let left = margins.within(picture)?;
    trace_within(TracingInput::plain(&left), picture.height(), settings, limit)
}

/// Like [`trace_objects`], in what the margins leave of a picture of so many rows.
pub(crate) fn trace_within(
    input: TracingInput<'_>,
    rows: u32,
    settings: &TraceSettings,
    limit: usize,
) -> Result<Vec<TracedOutline>, TraceError> {
    settings.check()?;
    let traced = match settings.ring {
        Some(ring) => ring_outlines((input.picture, rows), settings, ring, limit)?,
        None => mask_outlines((input, rows), settings, limit)?,
    };
    let mut outlines = Vec::new();
    let (mut refused, mut points) = (None, 0);
    for traced in traced {
        match traced {
            Ok(traced) => {
                points += traced.outline.point_count();
                if points > POINT_LIMIT {
                    refused = refused.or(Some(TraceError::TooManyPoints { limit: POINT_LIMIT }));
                    break;
                }
                outlines.push(traced);
            }
            Err(error) => refused = refused.or(Some(error)),
        }
    }
    match refused {
        Some(error) if outlines.is_empty() => Err(error),
        _ => Ok(outlines),
    }
}

/// Objects one after the other, as they are asked for.
type Traced<'a> = Box<dyn Iterator<Item = Result<TracedOutline, TraceError>> + 'a>;

fn ring_outlines<'a>(
    (picture, rows): (&'a GrayImage, u32),
    settings: &'a TraceSettings,
    ring: Ring,
    limit: usize,
) -> Result<Traced<'a>, TraceError> {
    let objects = {
        let sigma = match settings.smoothing {
            Smoothing::Automatic => ring::SIGMA,
            Smoothing::Gaussian(sigma) => sigma,
        };
        ring.objects(picture, settings.minimum_area, limit, sigma)?
    };
    let object_count = objects.len();
    let traced = objects.into_iter().map(move |object| {
        let window = Window { left: object.left, top: object.top, field: &object.field, level: 0.5, edges: None };
        let seen = window.outline(rows, settings)?.ok_or(TraceError::NoRing)?;
        Ok(seen.traced(object.pixel_count, object_count, 0.5))
    });
    Ok(Box::new(traced))
}

fn mask_outlines<'a>(
    (input, rows): (TracingInput<'a>, u32),
    settings: &'a TraceSettings,
    limit: usize,
) -> Result<Traced<'a>, TraceError> {
    let TracingInput { picture, comparison } = input;
    // Two-valued pictures are smoothed where the outline is traced, others before objects are looked for in them.
    let smooth = match settings.smoothing {
        Smoothing::Gaussian(sigma) if sigma > 0.0 && !is_two_valued(picture) => Some(blurred(picture, sigma)),
        _ => None,
    };
    let (raw, picture) = (picture, smooth.map_or(Cow::Borrowed(picture), Cow::Owned));
    let levels = Levels::of(&picture, settings.contrast, settings.threshold)?;
    let sigma = match (settings.smoothing, levels.two_valued) {
        (Smoothing::Gaussian(_), false) => 0.0,
        _ => settings.sigma(&levels),
    };
    let edges = (settings.edges == Edges::Refined && !levels.two_valued).then_some(EdgeSource {
        picture: raw,
        comparison,
        contrast: settings.contrast,
        transfer: settings.transfer,
        along: match settings.smoothing {
            Smoothing::Gaussian(sigma) if sigma > 1.0 => sigma,
            _ => 0.0,
        },
    });
    let set = move |value: u8| f64::from(signal(value, settings.contrast)) >= levels.threshold;
    let threshold = level_in_picture(levels.threshold, settings.contrast);
    let objects = Objects::of(&picture, set, settings.minimum_area, limit)?;
    let object_count = objects.count;
    if object_count == 0 {
        return Err(TraceError::NoObject { threshold });
    }
    let traced = objects.into_masks(blur_reach(sigma) + 2).map(move |mask| {
        let mut field = object_field(&picture, &mask, &levels, settings, set);
        if sigma > 0.0 {
            field.blur(sigma);
        }
        let window = Window { left: mask.left, top: mask.top, field: &field, level: levels.threshold, edges };
        let seen = window.outline(rows, settings)?.ok_or(TraceError::SmoothedAway { sigma })?;
        Ok(seen.traced(mask.pixel_count, object_count, threshold))
    });
    Ok(Box::new(traced))
}

/// Whether a picture has no more than two grey values, as masks do.
#[must_use]
pub fn is_two_valued(picture: &GrayImage) -> bool {
    let mut seen = [false; 256];
    picture.as_raw().iter().for_each(|value| seen[usize::from(*value)] = true);
    seen.iter().filter(|seen| **seen).count() <= 2
}

/// A picture blurred by a Gaussian, rounded to grey values.
pub(crate) fn blurred(picture: &GrayImage, sigma: f64) -> GrayImage {
    let (width, height) = picture.dimensions();
    let values = picture.as_raw().iter().map(|value| f32::from(*value)).collect();
    let mut field = Field { width: width as usize, height: height as usize, values };
    field.blur(sigma);
    GrayImage::from_raw(width, height, field.nearest_grey_values()).unwrap_or_default()
}

/// A part of a picture with an object in it.
pub(crate) struct Window<'a> {
    pub(crate) left: usize,
    pub(crate) top: usize,
    pub(crate) field: &'a Field,
    /// Value on the outline.
    pub(crate) level: f64,
    /// Where the edges themselves are looked for, if they are.
    pub(crate) edges: Option<EdgeSource<'a>>,
}

/// What is seen of an object.
pub(crate) struct Seen {
    outline: Outline,
    touches_border: bool,
    centre: Point2<f64>,
    area: f64,
    invariants: Option<AffineMomentInvariants>,
    edges: Option<EdgeFit>,
}

impl Seen {
    pub(crate) fn traced(self, pixel_count: u64, object_count: usize, threshold: f64) -> TracedOutline {
        let Self { outline, touches_border, centre, area, invariants, edges } = self;
        TracedOutline { outline, touches_border, pixel_count, object_count, threshold, centre, area, invariants, edges }
    }
}

impl Window<'_> {
    /// The longest outer outline in the window of what the margins leave of a picture of this height; `None` where nothing passes the level.
    pub(crate) fn outline(&self, picture_height: u32, settings: &TraceSettings) -> Result<Option<Seen>, TraceError> {
        let count = match settings.contours {
            Contours::Boundary => 0,
            Contours::All => MOST_HOLES,
        };
        let lines = self.field.isolines(self.level, WantedHoles { smallest: SMALLEST_HOLE, count }, POINT_LIMIT);
        let lines = lines.map_err(|LineTooLong { most }| TraceError::TooManyPoints { limit: most })?;
        let Some(LargestLines { outer: mut line, holes: mut inner }) = lines else { return Ok(None) };
        let place = [self.left, self.top];
        let mut edges = self.edges.and_then(|source| source.refine(&mut line, place));
        let of_inner: Vec<Option<EdgeFit>> =
            inner.iter_mut().map(|line| self.edges.and_then(|source| source.refine(line, place))).collect();
        let grid = settings.pixel_grid(picture_height);
        let touches_border = line.iter().any(|crossing| crossing.at_edge);
        // Whole numbers, so that a sum has them exactly.
        let margins = settings.margins.unwrap_or_default();
        let left = (self.left + margins.left as usize) as f64;
        let top = (self.top + margins.top as usize) as f64;
        let to_point = |crossing: &Crossing| grid.to_plane(left + crossing.x + 0.5, top + crossing.y + 0.5);
        let mut points: Vec<(Point2<f64>, bool)> =
            line.iter().map(|crossing| (to_point(crossing), crossing.at_edge)).collect();
        let mut inner: Vec<Vec<Point2<f64>>> = inner.iter().map(|line| line.iter().map(to_point).collect()).collect();
        if !settings.y_up {
            points.reverse();
            inner.iter_mut().for_each(|contour| contour.reverse());
        }
        if let Some(edges) = &mut edges {
            edges.systematic *= settings.pixel_size;
            edges.systematic_by_motion *= settings.pixel_size;
            if !settings.y_up {
                edges.deviations.reverse();
            }
        }
        let polygon = points.iter().map(|(point, _)| *point);
        let AreaAndCentre { signed_area: area, centre } = AreaAndCentre::of(&polygon);
        let invariants = AffineMomentInvariants::of(&polygon);
        let is_open = settings.clipping == Clipping::Open && touches_border;
        if let Some(edges) = &mut edges {
            if is_open {
                edges.deviations = of_visible_arcs(&points, &edges.deviations);
            }
            for (contour, fit) in inner.iter().zip(of_inner) {
                edges.append(fit, contour, settings, is_open);
            }
            edges.deviations.iter_mut().for_each(|deviation| *deviation *= settings.pixel_size);
        }
        let outline = if is_open {
            visible_arcs(points, inner)?
        } else {
            ClosedOutline::new(points.into_iter().map(|(point, _)| point).collect())?.with_inner(inner)?.into()
        };
        let outline = self.with_deviations(outline, edges.as_ref(), settings.pixel_size)?;
        Ok(Some(Seen { outline, touches_border, centre, area, invariants, edges }))
    }

    /// An outline with the standard deviations of its points, where edges were looked for.
    fn with_deviations(
        &self,
        outline: Outline,
        edges: Option<&EdgeFit>,
        pixel_size: f64,
    ) -> Result<Outline, OutlineError> {
        match (edges, self.edges) {
            (Some(fit), _) => {
                let of_point = OF_POINT * pixel_size;
                let deviations = fit.deviations.iter().map(|random| three_digits(random.hypot(of_point)));
                outline.with_deviations(deviations.collect())
            }
            (None, Some(_)) => {
                let unseen = three_digits(UNSEEN * pixel_size);
                let count = outline.point_count();
                outline.with_deviations(vec![unseen; count])
            }
            (None, None) => Ok(outline),
        }
    }
}

impl EdgeFit {
    /// Appends the deviations of the points of another contour by its own fit, if any. Smaller contours are off by more where motion blurs them.
    fn append(&mut self, fit: Option<EdgeFit>, contour: &[Point2<f64>], settings: &TraceSettings, is_open: bool) {
        let unknown = self.deviations.iter().copied().fold(0.0, f64::max);
        let by_motion = self.off_by_motion(contour, settings.pixel_size);
        let of_fit = fit.as_ref().map_or(0.0, |fit| fit.systematic_by_motion);
        self.systematic_by_motion = self.systematic_by_motion.max(settings.pixel_size * of_fit.max(by_motion));
        let mut deviations = fit.map_or_else(|| vec![unknown; contour.len()], |fit| fit.deviations);
        if !settings.y_up {
            deviations.reverse();
        }
        // An arc that is a whole contour repeats its first point.
        deviations.extend(deviations.first().copied().filter(|_| is_open));
        self.deviations.append(&mut deviations);
    }
}

/// The grey values around the object, with other objects painted over, and its own holes where they are not traced.
fn object_field(
    picture: &GrayImage,
    mask: &ObjectMask,
    levels: &Levels,
    settings: &TraceSettings,
    set: impl Fn(u8) -> bool,
) -> Field {
    let fills = settings.contours == Contours::Boundary;
    let stride = picture.width() as usize;
    let value_of = |filled: bool, value: u8| match (filled, set(value)) {
        (true, false) if fills => levels.object as f32,
        (false, true) => levels.ground as f32,
        _ => f32::from(signal(value, settings.contrast)),
    };
    // For all grey values at once, of which there are fewer than pixels.
    let [elsewhere, within]: [[f32; 256]; 2] =
        [false, true].map(|filled| std::array::from_fn(|value| value_of(filled, value as u8)));
    let mut values = Vec::with_capacity(mask.width * mask.height);
    for row in 0..mask.height {
        let from = (mask.top + row) * stride + mask.left;
        let pixels = &picture.as_raw()[from..from + mask.width];
        let filled = &mask.filled[row * mask.width..(row + 1) * mask.width];
        let table = |filled: bool| if filled { &within } else { &elsewhere };
        values.extend(pixels.iter().zip(filled).map(|(&value, &filled)| table(filled)[usize::from(value)]));
    }
    Field { width: mask.width, height: mask.height, values }
}

/// A positive number to three digits: no deviation is known better, and tables stay short.
fn three_digits(value: f64) -> f64 {
    let exponent = 2 - value.log10().floor() as i32;
    let rounded = match exponent {
        ..0 => (value / 10_f64.powi(-exponent)).round() * 10_f64.powi(-exponent),
        _ => (value * 10_f64.powi(exponent)).round() / 10_f64.powi(exponent),
    };
    if rounded.is_finite() && rounded > 0.0 { rounded } else { value }
}

/// The values of the points of the arcs that [`visible_arcs`] makes of these, in their order.
fn of_visible_arcs(points: &[(Point2<f64>, bool)], values: &[f64]) -> Vec<f64> {
    let on_edge = points.iter().position(|(_, at_edge)| *at_edge).unwrap_or(0);
    let mut seen: Vec<(f64, bool)> =
        values.iter().zip(points).map(|(value, (_, at_edge))| (*value, *at_edge)).collect();
    seen.rotate_left(on_edge);
    let arcs = seen.split(|(_, at_edge)| *at_edge).filter(|arc| arc.len() > 1);
    arcs.flatten().map(|(value, _)| *value).collect()
}

/// The arcs between the stretches along the edge of the picture, and whole contours within as arcs that end where they begin.
fn visible_arcs(mut points: Vec<(Point2<f64>, bool)>, inner: Vec<Vec<Point2<f64>>>) -> Result<Outline, TraceError> {
    let on_edge = points.iter().position(|(_, at_edge)| *at_edge).unwrap_or(0);
    points.rotate_left(on_edge);
    let arcs = points.split(|(_, at_edge)| *at_edge).filter(|arc| arc.len() > 1);
    let mut arcs: Vec<OpenArc> =
        arcs.map(|arc| OpenArc::new(arc.iter().map(|(point, _)| *point).collect())).collect::<Result<_, _>>()?;
    if arcs.is_empty() {
        return Err(TraceError::FillsPicture);
    }
    for mut contour in inner {
        contour.extend(contour.first().copied());
        arcs.push(OpenArc::new(contour)?);
    }
    match OpenOutline::in_sequence(arcs) {
        Ok(outline) => Ok(outline.into()),
        Err(OutlineError::Collinear { count }) => Err(TraceError::VisiblePartStraight { points: count }),
        Err(other) => Err(other.into()),
    }
}
