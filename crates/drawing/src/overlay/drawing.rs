use freeform_motion::CurveParts;
use freeform_motion::curve_fit::{Fit, Outline, PixelGrid, Rectangle};
use freeform_motion::outline_filter::KnownPiece;
use freeform_motion::outline_io::SourcePicture;
use freeform_motion::riccati::ProjectiveMotion;
use image::{Rgb, RgbImage};
use nalgebra::{Matrix3, Point2};

use super::canvas::Canvas;
use super::colours::{CURVE, MOTION, OUTLINE, REJECTED, RELATED};
use super::lettering::{write_words, write_words_below};

/// Most arrows of the motion field around an outline.
const ARROWS: usize = 24;

/// Pixels along the outline for each arrow, at least.
const PIXELS_PER_ARROW: f64 = 14.0;

/// Length of the longest arrow as a share of the size of the object, and at most, in pixels.
const LONGEST_ARROW: f64 = 0.35;
const MOST_PIXELS: f64 = 60.0;

/// An object of fewer pixels has one arrow alone, that of its middle, as long as the object is.
const SMALL_OBJECT: f64 = 32.0;

/// Half the size of the crosses at related points in pixels, and at most as a share of the size of the object.
const CROSS: f64 = 4.0;
const CROSS_SHARE: f64 = 0.06;

/// What is drawn of one object in one frame.
#[derive(Debug, Clone, Copy)]
pub struct Drawn<'a> {
    /// Its outline.
    pub outline: &'a Outline,
    /// Its name, where several are followed.
    pub name: Option<&'a str>,
    /// Whether the frame was used; an outline that was not is red.
    pub accepted: bool,
    /// What is known of its outline, where it is in this frame; empty where nothing is.
    pub known: &'a [KnownPiece],
    /// The curve fitted to the outline and what it consists of.
    pub fit: Option<(&'a Fit, Option<&'a CurveParts>)>,
    /// The generator of the motion in image lengths.
    pub generator: Option<Matrix3<f64>>,
}

/// A picture that all objects of a frame have been drawn on.
#[derive(Debug, Clone)]
pub struct DrawnPicture {
    /// Number of the frame.
    pub frame: u64,
    /// The picture, a little darker than it was, with the drawing.
    pub picture: RgbImage,
    /// Seconds that the picture stands for, where the times of the frames tell.
    pub seconds: Option<f64>,
}

/// Draws objects on the pictures that they were seen in, picture after picture. A picture is handed back as soon as the next one begins, as
/// no other object comes on it then.
///
/// ```
/// use std::sync::Arc;
///
/// use freeform_drawing::{Drawn, Overlay};
/// use freeform_motion::curve_fit::Outline;
/// use freeform_motion::outline_io::{GrayImage, SourcePicture, TraceSettings};
/// use nalgebra::Point2;
///
/// let outline = Outline::closed([[5.0, 5.0], [25.0, 5.0], [15.0, 20.0]].map(Point2::from).to_vec())?;
/// let drawn = Drawn { outline: &outline, name: None, accepted: true, known: &[], fit: None, generator: None };
/// let (mut overlay, mut done) = (Overlay::default(), Vec::new());
/// for frame in 0..3 {
///     let (picture, grid) = (Arc::new(GrayImage::new(30, 30)), TraceSettings::default().pixel_grid(30));
///     let source = SourcePicture { frame, time: 0.1 * frame as f64, picture, grid };
///     done.extend(overlay.draw(&source, &drawn));
/// }
/// done.extend(overlay.finish());
/// assert_eq!(done.iter().map(|drawn| drawn.frame).collect::<Vec<_>>(), [0, 1, 2]);
/// assert!(done[0].picture.pixels().any(|pixel| pixel.0 != [0; 3]));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Default)]
pub struct Overlay {
    present: Option<Present>,
    /// Seconds from the last picture to the one before it.
    interval: Option<f64>,
}

/// The picture that is drawn on.
#[derive(Debug)]
struct Present {
    frame: u64,
    /// In seconds.
    time: f64,
    canvas: Canvas,
}

impl Overlay {
    /// Draws an object on the picture that it was seen in. Returns the picture before, if this one is another.
    #[must_use]
    pub fn draw(&mut self, source: &SourcePicture, drawn: &Drawn<'_>) -> Option<DrawnPicture> {
        let before = self.begin(source);
        draw(self.canvas(source), &source.grid, drawn);
        before
    }

    /// Says on a picture that it gave no outline. Returns the picture before, if this one is another.
    #[must_use]
    pub fn draw_nothing(&mut self, source: &SourcePicture) -> Option<DrawnPicture> {
        let before = self.begin(source);
        write_words(self.canvas(source), [0.0; 2], "no outline", REJECTED);
        before
    }

    /// The last picture, if there was any.
    #[must_use]
    pub fn finish(mut self) -> Option<DrawnPicture> {
        self.present.take().map(|last| self.done(last))
    }

    /// The picture before, when a new one begins.
    fn begin(&mut self, source: &SourcePicture) -> Option<DrawnPicture> {
        let before = self.present.take_if(|present| present.frame != source.frame)?;
        let seconds = source.time - before.time;
        self.interval = (seconds > 0.0 && seconds.is_finite()).then_some(seconds);
        Some(self.done(before))
    }

    /// The picture to draw on.
    fn canvas(&mut self, source: &SourcePicture) -> &mut Canvas {
        let begin = || Present { frame: source.frame, time: source.time, canvas: Canvas::of(&source.picture) };
        &mut self.present.get_or_insert_with(begin).canvas
    }

    fn done(&self, Present { frame, canvas, .. }: Present) -> DrawnPicture {
        DrawnPicture { frame, picture: canvas.into_picture(), seconds: self.interval }
    }
}

fn draw(canvas: &mut Canvas, grid: &PixelGrid, drawn: &Drawn<'_>) {
    let pixel = |point: &Point2<f64>| grid.to_pixels(point);
    let area = drawn.outline.bounding_box();
    if let Some((fit, _)) = drawn.fit {
        for run in fit.curve_within(&area.widened(0.15)) {
            canvas.polyline(run.iter().map(pixel), CURVE);
        }
    }
    // Below the outline, so that it is seen where the outline is not, or is elsewhere.
    drawn.known.iter().for_each(|piece| draw_piece(canvas, grid, &piece.points, piece.closed, CURVE));
    let colour = if drawn.accepted { OUTLINE } else { REJECTED };
    drawn.outline.pieces().for_each(|piece| draw_piece(canvas, grid, piece.points, piece.closed, colour));
    let words: Vec<&str> = drawn.name.into_iter().chain((!drawn.accepted).then_some("rejected")).collect();
    let corners = [area.low, area.high].map(|corner| pixel(&corner));
    let upper_left = [0, 1].map(|axis| corners[0][axis].min(corners[1][axis]));
    write_words(canvas, upper_left, &words.join(" "), colour);
    if let Some((_, Some(parts))) = drawn.fit {
        let related = parts.related_points.as_slice().iter().map(|related| related.point);
        let size = CROSS.min(CROSS_SHARE * size_in_pixels(corners)).max(1.0);
        related.filter(|point| area.widened(1.0).contains(point)).for_each(|p| canvas.cross(pixel(&p), size, RELATED));
    }
    if let Some(generator) = drawn.generator {
        draw_motion(canvas, grid, drawn.outline, &area, &generator);
    }
}

/// A line along a piece of an outline, back to its beginning where it is closed.
fn draw_piece(canvas: &mut Canvas, grid: &PixelGrid, points: &[Point2<f64>], closed: bool, colour: Rgb<u8>) {
    let closing = points.first().filter(|_| closed);
    canvas.polyline(points.iter().chain(closing).map(|point| grid.to_pixels(point)), colour);
}

/// The longer side of a box, of which two opposite corners are given.
fn size_in_pixels([a, b]: [[f64; 2]; 2]) -> f64 {
    (a[0] - b[0]).abs().max((a[1] - b[1]).abs())
}

/// The velocity at points around the outline: the way in a time that is written below the object, and so long that the longest arrow has at most a
/// share of the object, and no more than [`MOST_PIXELS`].
fn draw_motion(canvas: &mut Canvas, grid: &PixelGrid, outline: &Outline, area: &Rectangle, generator: &Matrix3<f64>) {
    let motion = ProjectiveMotion::of_generator(generator);
    let velocity = |p: &Point2<f64>| motion.velocity(p);
    let corners = [area.low, area.high].map(|corner| grid.to_pixels(&corner));
    let size = size_in_pixels(corners);
    let places = arrow_places(outline, size);
    let fastest = places.iter().map(|p| velocity(p).norm()).fold(0.0, f64::max);
    let longest = if size < SMALL_OBJECT { 1.0 } else { LONGEST_ARROW.min(MOST_PIXELS / size) };
    let Some(seconds) = round_time(longest * area.size().max() / fastest) else { return };
    for p in places {
        canvas.arrow(grid.to_pixels(&p), grid.to_pixels(&(p + seconds * velocity(&p))), MOTION);
    }
    let lower_left = [corners[0][0].min(corners[1][0]), corners[0][1].max(corners[1][1])];
    write_words_below(canvas, lower_left, &format!("{seconds} s"), MOTION);
}

/// The longest of 1, 2 or 5 times a power of ten seconds that is no longer than a time, so that arrows of neighbouring pictures are alike; `None`
/// where nothing moves.
fn round_time(seconds: f64) -> Option<f64> {
    if !(seconds.is_normal() && seconds > 0.0) {
        return None;
    }
    let power = seconds.log10().floor() as i32;
    let steps = (power - 1..=power).flat_map(|power: i32| [1_u32, 2, 5].map(|step| (power, f64::from(step))));
    // Quotients of whole numbers are those that are written.
    let times =
        steps.map(|(power, step)| if power < 0 { step / 10_f64.powi(-power) } else { step * 10_f64.powi(power) });
    times.take_while(|time| *time <= seconds).last()
}

/// Where arrows begin on an outline of some size in pixels: at points evenly spread along it, or in its middle.
fn arrow_places(outline: &Outline, size: f64) -> Vec<Point2<f64>> {
    if size < SMALL_OBJECT {
        return vec![outline.centroid()];
    }
    let points: Vec<Point2<f64>> = outline.points().copied().collect();
    // The length is about that of a square.
    let arrows = ((4.0 * size / PIXELS_PER_ARROW) as usize).min(ARROWS).min(points.len());
    (0..arrows).map(|k| points[k * points.len() / arrows]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrows_show_the_way_in_a_round_time_no_longer_than_they_may_be() {
        let rounded = [2.5e-9, 0.00012, 0.03, 0.0999, 0.2, 7.0, 49.9, 1e9].map(round_time);
        let expected = [2e-9, 0.0001, 0.02, 0.05, 0.2, 5.0, 20.0, 1e9];
        assert_eq!(rounded, expected.map(Some));
        // Nothing moves, or nobody knows.
        assert_eq!([0.0, f64::INFINITY, f64::NAN].map(round_time), [None; 3]);
    }

    #[test]
    fn a_small_object_has_few_arrows_and_a_large_one_no_more_than_can_be_told_apart() {
        let circle = |t: usize| {
            let (sin, cos) = (std::f64::consts::TAU * t as f64 / 200.0).sin_cos();
            Point2::new(cos, sin)
        };
        let outline = Outline::closed((0..200).map(circle).collect()).expect("an outline");
        let counts = [5.0, 31.0, 40.0, 60.0, 1000.0].map(|size| arrow_places(&outline, size).len());
        assert_eq!(counts, [1, 1, 11, 17, 24]);
        let few = Outline::closed(vec![Point2::new(0.0, 0.0), Point2::new(1.0, 0.0), Point2::new(0.0, 1.0)]);
        assert_eq!(arrow_places(&few.expect("an outline"), 1000.0).len(), 3);
    }
}
