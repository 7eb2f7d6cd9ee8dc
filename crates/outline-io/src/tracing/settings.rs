//! How pictures are traced.
use freeform_curve_fit::{PixelGrid, Rectangle};
use nalgebra::{Point2, Vector2};

use crate::picture_file::error::TraceError;
use crate::tracing::contrast::Contrast;
use crate::tracing::margins::Margins;
use crate::tracing::ring::Ring;
use crate::tracing::threshold::{Levels, Threshold};
use crate::tracing::transfer::Transfer;

/// Standard deviation of the smoothing of two-valued pictures where none is given, in pixels.
pub(crate) const MASK_SIGMA: f64 = 1.0;

/// Standard deviation of the smoothing of pictures with more grey values, in pixels.
const GREY_SIGMA: f64 = 0.5;

/// Largest standard deviation of the smoothing, in pixels.
const SIGMA_LIMIT: f64 = 100.0;

/// How much the picture is smoothed before its outline is traced.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Smoothing {
    /// By a Gaussian of 1 pixel for a picture of two grey values, whose edges are stairs; of half a pixel for others,
    /// whose grey values place the edge within a pixel but are seldom linear across it.
    #[default]
    Automatic,
    /// By a Gaussian of this standard deviation in pixels, 0 to 100; 0 for none. Pictures of more than two grey values are smoothed
    /// before objects are looked for in them.
    Gaussian(f64),
}

/// Where the outline is placed, in pictures of more than two grey values.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Edges {
    /// On the edge itself: the place of a blurred step between the grey values on both sides, fitted along the normal at every point.
    /// Neither the threshold nor the smoothing moves it.
    #[default]
    Refined,
    /// Where the smoothed grey value passes the threshold.
    Isoline,
}

/// Which contours of an object are traced.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Contours {
    /// The boundary alone; holes are filled.
    #[default]
    Boundary,
    /// The boundary, and holes and marks within it of at least 25 pixels.
    All,
}

/// What to make of an object that the edge of the picture clips.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Clipping {
    /// Close the outline along the edge of the picture.
    #[default]
    Close,
    /// Keep only what is seen of the object's own outline, as open arcs.
    Open,
}

/// How an outline is traced in a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TraceSettings {
    /// Light objects on dark ground, or the other way round.
    pub contrast: Contrast,
    /// The grey value on the outline.
    pub threshold: Threshold,
    /// Smoothing before tracing.
    pub smoothing: Smoothing,
    /// Whether the outline is moved onto the edge itself.
    pub edges: Edges,
    /// How grey values stand for light, of which blurred edges are a mean. For edges that are refined alone: not for masks and rings, and of no use
    /// for channels that are no light, such as the saturation. [`EdgeProfile`](crate::EdgeProfile) looks for edges in grey values.
    #[cfg_attr(feature = "serde", serde(default))]
    pub transfer: Transfer,
    /// Smallest object accepted, in pixels.
    pub minimum_area: u64,
    /// Which contours of an object are traced; of one in a ring always the boundary alone.
    pub contours: Contours,
    /// What to make of an object that the edge of the picture clips.
    pub clipping: Clipping,
    /// Whether y runs upwards from the lower edge of the picture, or downwards from its upper edge.
    pub y_up: bool,
    /// A line around the object, whose outer edge is traced. Replaces contrast and threshold; smoothing is by 1 pixel where automatic.
    pub ring: Option<Ring>,
    /// Height of a pixel in the length unit of the outline.
    pub pixel_size: f64,
    /// Width of a pixel over its height.
    pub pixel_aspect: f64,
    /// What of the pictures is not looked at; objects are clipped there as at the edge of a picture. `None`: nothing is left out, and where a way
    /// of tracing is chosen, even bars at the sides are.
    #[cfg_attr(feature = "serde", serde(default))]
    pub margins: Option<Margins>,
}

impl Default for TraceSettings {
    /// Light on dark, everything automatic, at least 9 pixels, closed along the edge, y upwards, pixels as unit.
    fn default() -> Self {
        Self {
            contrast: Contrast::default(),
            threshold: Threshold::default(),
            smoothing: Smoothing::default(),
            edges: Edges::default(),
            transfer: Transfer::default(),
            minimum_area: 9,
            contours: Contours::default(),
            clipping: Clipping::default(),
            y_up: true,
            ring: None,
            pixel_size: 1.0,
            pixel_aspect: 1.0,
            margins: None,
        }
    }
}

impl TraceSettings {
    /// Whether all settings are in their ranges.
    ///
    /// # Errors
    /// The first one that is not.
    pub fn check(&self) -> Result<(), TraceError> {
        let refuse = |name, value, expected| Err(TraceError::Setting { name, value, expected });
        let is_length = |value: f64| (1e-50..=1e50).contains(&value);
        match (self.threshold, self.smoothing) {
            (Threshold::Level(level), _) if !(level > 0.0 && level <= 255.0) => {
                refuse("threshold", level, "a grey value above 0 and up to 255")
            }
            (_, Smoothing::Gaussian(sigma)) if !(0.0..=SIGMA_LIMIT).contains(&sigma) => {
                refuse("smoothing", sigma, "0 to 100 pixels")
            }
            _ if self.ring.and_then(|ring| ring.width).is_some_and(|width| !(1.0..=100.0).contains(&width)) => {
                refuse("ring width", self.ring.and_then(|ring| ring.width).unwrap_or(f64::NAN), "1 to 100 pixels")
            }
            _ if !is_length(self.pixel_size) => refuse("pixel_size", self.pixel_size, "a positive length"),
            _ if !is_length(self.pixel_aspect) => refuse("pixel_aspect", self.pixel_aspect, "a positive ratio"),
            _ => Ok(()),
        }
    }

    pub(crate) fn sigma(&self, levels: &Levels) -> f64 {
        match self.smoothing {
            Smoothing::Automatic if levels.two_valued => MASK_SIGMA,
            Smoothing::Automatic => GREY_SIGMA,
            Smoothing::Gaussian(sigma) => sigma,
        }
    }

    /// The longer side of a pixel in the length unit of the outline.
    #[must_use]
    pub fn pixel(&self) -> f64 {
        self.pixel_grid(0).pixel_size().max()
    }

    /// What of a picture of this width and height is looked at, within its margins, in the plane of its outlines.
    #[must_use]
    pub fn extent(&self, (width, height): (u32, u32)) -> Rectangle {
        let Margins { left, top, right, bottom } = self.margins.unwrap_or_default();
        let grid = self.pixel_grid(height);
        let corner = |column: u32, row: u32| grid.to_plane(f64::from(column), f64::from(row));
        let (first, last) = (corner(left, top), corner(width.saturating_sub(right), height.saturating_sub(bottom)));
        Rectangle { low: first, high: first }.extended([&last])
    }

    /// How the pixels of a picture of this height lie in the plane of its outlines.
    #[must_use]
    pub fn pixel_grid(&self, height: u32) -> PixelGrid {
        let (width, size) = (self.pixel_size * self.pixel_aspect, self.pixel_size);
        let (row_of_zero, pitch) = if self.y_up { (f64::from(height), -size) } else { (0.0, size) };
        PixelGrid::new([0.0, row_of_zero], Point2::origin(), Vector2::new(width, pitch))
    }
}
