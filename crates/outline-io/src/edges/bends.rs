//! Where the edges of bent outlines are: blur moves the middle grey value inwards, and motion while the shutter is open does so along the path alone.
use nalgebra::{Point2, Vector2};

use super::blur_width::EdgeBlur;
use super::{EdgeFit, smoothed};
use crate::identity::affine_moment_invariants::AreaAndCentre;

/// Bends of more than this over the width of the edge move it by less than the first order says.
const MOST_BENT: f64 = 0.3;

/// Distance between two neighbouring crossings of a line with the grid, in the mean, in pixels.
const BETWEEN_CROSSINGS: f64 = 0.77;

/// Crossings to either side that a curvature is taken from: as many as lie within four widths of the edge, at least and at most so many.
const WIDTHS_OF_ARC: f64 = 4.0;
const CROSSINGS_OF_ARC: [usize; 2] = [5, 16];

/// Where an edge is seen among what the motion spreads, as a share of the mean, and how far that may be off: most of it is near one end. Measured on
/// discs that move by 0.3 to 0.9 of their radius.
const SEEN_OF_BEND: f64 = 0.55;
const BEND_UNSURE: f64 = 0.2;

/// Share of its extent along the path that a body may move by while the shutter is open for its shape to be told, of a disc 0.7 of the radius, and
/// from which on it is not told. There its edges may be off by this share of the way.
const LONGEST_WAY: [f64; 2] = [0.35, 0.42];
const OF_LONG_WAY: f64 = 0.2;

impl EdgeFit {
    /// How far edges of another contour of the object may lie off together as motion blurs them, in pixels of this size: what is too small for the
    /// way shows no edges of its own.
    pub(crate) fn off_by_motion(&self, contour: &[Point2<f64>], pixel_size: f64) -> f64 {
        if self.motion_blur == 0.0 {
            return 0.0;
        }
        let around: f64 = contour.iter().zip(contour.iter().cycle().skip(1)).map(|(a, b)| (b - a).norm()).sum();
        let area = AreaAndCentre::of(&contour.iter().copied()).signed_area.abs();
        // As wide as a disc of this area and circumference.
        of_long_way(self.motion_blur, 4.0 * area / (around * pixel_size))
    }
}

/// How far the edges of a contour may lie off together that is blurred by this way, of this extent along it, in pixels.
pub(super) fn of_long_way(way: f64, extent: f64) -> f64 {
    if way == 0.0 {
        return 0.0;
    }
    let [longest, hopeless] = LONGEST_WAY;
    let share = (way / extent - longest) / (hopeless - longest);
    OF_LONG_WAY * way * share.clamp(0.0, 1.0)
}

/// How far the edges of a bent outline lie outside of where the middle grey value is: half the variance of the blur along the edge times the
/// curvature; and how far the part of it that motion has may be off.
pub(super) fn bends(
    points: &[Point2<f64>],
    normals: &[Option<Vector2<f64>>],
    places: &[f64],
    blur: &EdgeBlur,
) -> (Vec<f64>, f64) {
    let count = points.len();
    let moved = |i: usize| points[i] + places[i] * normals[i].unwrap_or_default();
    let bend = |i: usize| {
        let normal = normals[i]?;
        let [variance, of_motion] = blur.along(&normal);
        let width = variance.sqrt();
        let [fewest, most] = CROSSINGS_OF_ARC;
        let reach =
            ((WIDTHS_OF_ARC * width / BETWEEN_CROSSINGS).ceil() as usize).clamp(fewest, most).min(count / 6).max(1);
        let (before, after) = ((i + count - reach) % count, (i + reach) % count);
        if normals[before].is_none() || normals[after].is_none() {
            return None;
        }
        let (a, b, p) = (moved(before), moved(after), moved(i));
        let half = 0.5 * (b - a).norm();
        let sagitta = (p - nalgebra::center(&a, &b)).dot(&normal);
        let curvature = 2.0 * sagitta / (half * half + sagitta * sagitta).max(1e-9);
        let mild = curvature.clamp(-MOST_BENT / width, MOST_BENT / width);
        let seen = variance - (1.0 - SEEN_OF_BEND) * of_motion;
        Some([0.5 * seen * mild, 0.5 * of_motion * (curvature.abs() - (1.0 - BEND_UNSURE) * mild.abs())])
    };
    let (bends, off): (Vec<f64>, Vec<f64>) =
        (0..count).map(|i| bend(i).unwrap_or_default()).map(|[bend, off]| (bend, off)).unzip();
    let mean_square = off.iter().map(|off| off * off).sum::<f64>() / count as f64;
    (smoothed(&bends, 2.0), mean_square.sqrt())
}
