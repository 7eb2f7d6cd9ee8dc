//! How the sequences of a kind are made.
use super::body::Body;
use super::course::{Course, Path};
use super::fault::Fault;
use super::view::View;

/// Everything that the sequences of a kind have in common. Lengths are in sizes: the diameter of the object is 1.
#[derive(Debug, Clone)]
pub(super) struct Recipe {
    pub(super) body: Body,
    pub(super) course: Course,
    pub(super) frames: usize,
    /// Frames per second.
    pub(super) fps: f64,
    /// Points on the whole contour.
    pub(super) points: usize,
    pub(super) sampling: Sampling,
    /// Standard deviation of independent errors of both coordinates.
    pub(super) noise: f64,
    pub(super) faults: Vec<Fault>,
    pub(super) deformation: Deformation,
    pub(super) view: View,
    pub(super) sensing: Sensing,
    /// Units of time in a second, as the times of the frames are told.
    pub(super) time_unit: f64,
    /// Units of length in a size, as the coordinates are told.
    pub(super) length_unit: f64,
}

/// Where on the contour the points of a frame are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Sampling {
    /// One anywhere in each of equal stretches.
    Stratified,
    /// Each anywhere.
    Independent,
    /// Equally spaced and the same in every frame.
    Same,
}

/// How the body itself changes with time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Deformation {
    None,
    /// It grows about its middle by this rate in 1/s.
    Growth(f64),
    /// It bends like a banana, to and fro: points are moved across the long axis by up to `sag` at the ends.
    Bending {
        sag: f64,
        period: f64,
    },
}

/// How the outline comes out of the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Sensing {
    /// Points of the contour with errors.
    Points,
    /// It is traced in a picture of a grid of pixels, so many to a size.
    Traced { pixels: f64, depth: Depth },
}

/// What the pixels of a picture tell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Depth {
    /// The share of the pixel that is covered, in 256 steps; the outline is where half of it is.
    Grey,
    /// The same, with the outline at another grey value.
    GreyAt(f64),
    /// Whether at least half of it is covered.
    Binary,
}

impl Recipe {
    /// Three seconds of an object that moves by a constant generator, seen by 300 points with independent errors of 0.5 %.
    pub(super) fn plain() -> Self {
        Self {
            body: Body::Object,
            course: Course { omega: (0.5, 2.0), speed: (0.1, 0.5), start: 1.0, path: Path::Generator },
            frames: 90,
            fps: 30.0,
            points: 300,
            sampling: Sampling::Stratified,
            noise: 0.005,
            faults: Vec::new(),
            deformation: Deformation::None,
            view: View::Flat,
            sensing: Sensing::Points,
            time_unit: 1.0,
            length_unit: 1.0,
        }
    }

    /// Time of a frame in seconds.
    pub(super) fn time(&self, frame: usize) -> f64 {
        frame as f64 / self.fps
    }
}
