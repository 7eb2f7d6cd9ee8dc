use std::path::{Path, PathBuf};

use freeform_motion::curve_fit::{Fit, Outline, PixelGrid, Rectangle};
use freeform_motion::riccati::ProjectiveMotion;
use image::Rgb;
use nalgebra::{Matrix3, Point2};

use super::canvas::Canvas;
use super::lettering::write_words;
use super::target::Target;
use crate::failure::Failure;
use crate::fitted_outline::Parts;
use crate::output::refuse_drawing_beside;
use crate::seen::SeenIn;

const OUTLINE: Rgb<u8> = Rgb([255, 230, 60]);
const REJECTED: Rgb<u8> = Rgb([255, 80, 80]);
const CURVE: Rgb<u8> = Rgb([86, 180, 233]);
const RELATED: Rgb<u8> = Rgb([240, 120, 220]);
const MOTION: Rgb<u8> = Rgb([0, 220, 150]);

/// Arrows of the motion field around an outline.
const ARROWS: usize = 24;

/// Length of the longest arrow in the first field drawn of a frame, as a share of the size of the object.
const LONGEST_ARROW: f64 = 0.35;

/// Half the size of the crosses at related points, in pixels.
const CROSS: f64 = 4.0;

/// What is drawn of one object in one frame.
pub(crate) struct Drawn<'a> {
    pub(crate) outline: &'a Outline,
    /// Its name, where several are followed.
    pub(crate) name: Option<&'a str>,
    pub(crate) accepted: bool,
    /// The curve fitted to the outline and what it is made of.
    pub(crate) fit: Option<(&'a Fit, Option<&'a Parts>)>,
    /// The generator of the motion in image lengths.
    pub(crate) generator: Option<Matrix3<f64>>,
}

/// Draws frame after frame and writes each when the next one begins.
pub(crate) struct Overlay {
    target: Target,
    present: Option<(u64, Canvas)>,
}

impl Overlay {
    /// Drawings for a folder or a GIF. A folder that pictures of the input stand in is refused.
    pub(crate) fn open(path: &Path, inputs: &[PathBuf]) -> Result<Self, Failure> {
        refuse_drawing_beside(inputs, path)?;
        Ok(Self { target: Target::open(path)?, present: None })
    }

    /// Draws an object on the picture that it was seen in.
    pub(crate) fn draw(&mut self, seen_in: &SeenIn, drawn: &Drawn<'_>) -> Result<(), Failure> {
        draw(self.canvas(seen_in)?, &seen_in.grid, drawn);
        Ok(())
    }

    /// Says on a picture that it gave no outline.
    pub(crate) fn draw_nothing(&mut self, seen_in: &SeenIn) -> Result<(), Failure> {
        write_words(self.canvas(seen_in)?, [0.0; 2], "no outline", REJECTED);
        Ok(())
    }

    /// The picture to draw on; the one before it is written when a new one begins.
    fn canvas(&mut self, seen_in: &SeenIn) -> Result<&mut Canvas, Failure> {
        if self.present.as_ref().is_some_and(|(frame, _)| *frame != seen_in.frame) {
            self.write_present()?;
        }
        Ok(&mut self.present.get_or_insert_with(|| (seen_in.frame, Canvas::of(&seen_in.picture))).1)
    }

    /// Writes what has not been written.
    pub(crate) fn finish(mut self) -> Result<(), Failure> {
        self.write_present()?;
        self.target.finish()
    }

    fn write_present(&mut self) -> Result<(), Failure> {
        match self.present.take() {
            Some((frame, canvas)) => self.target.write(frame, canvas.into_picture()),
            None => Ok(()),
        }
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
    let colour = if drawn.accepted { OUTLINE } else { REJECTED };
    for piece in drawn.outline.pieces() {
        canvas.polyline(piece.points.iter().map(pixel), colour);
        if let (true, Some(first), Some(last)) = (piece.closed, piece.points.first(), piece.points.last()) {
            canvas.line(pixel(last), pixel(first), colour);
        }
    }
    let words: Vec<&str> = drawn.name.into_iter().chain((!drawn.accepted).then_some("rejected")).collect();
    let corners = [area.low, area.high].map(|corner| pixel(&corner));
    let upper_left = [0, 1].map(|axis| corners[0][axis].min(corners[1][axis]));
    write_words(canvas, upper_left, &words.join(" "), colour);
    if let Some((_, Some(parts))) = drawn.fit {
        let related = parts.related_points.as_slice().iter().map(|related| related.point);
        related.filter(|point| area.widened(1.0).contains(point)).for_each(|p| canvas.cross(pixel(&p), CROSS, RELATED));
    }
    if let Some(generator) = drawn.generator {
        draw_motion(canvas, grid, drawn.outline, &area, &generator);
    }
}

/// The velocity at points around the outline, the longest arrow a fixed share of the object.
fn draw_motion(canvas: &mut Canvas, grid: &PixelGrid, outline: &Outline, area: &Rectangle, generator: &Matrix3<f64>) {
    let motion = ProjectiveMotion::of_generator(generator);
    let velocity = |p: &Point2<f64>| motion.velocity(p);
    let count = outline.points().count();
    let chosen: Vec<&Point2<f64>> = outline.points().step_by((count / ARROWS).max(1)).collect();
    let fastest = chosen.iter().map(|p| velocity(p).norm()).fold(0.0, f64::max);
    let seconds = LONGEST_ARROW * area.size().max() / fastest;
    if seconds.is_finite() {
        for p in chosen {
            canvas.arrow(grid.to_pixels(p), grid.to_pixels(&(p + seconds * velocity(p))), MOTION);
        }
    }
}
