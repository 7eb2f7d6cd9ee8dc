//! What a way of tracing finds in one picture.
use image::GrayImage;
use nalgebra::{Point2, Vector2};

use crate::edges::median;
use crate::identity::affine_moment_invariants::AffineMomentInvariants;
use crate::tracing::contrast::{Contrast, signal};
use crate::tracing::trace::TracedOutline;

/// Points of an outline where the contrast is looked at.
const PLACES: usize = 64;

/// Holes and marks within an object.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Inner {
    /// Their area together, over that of the object.
    pub(super) share: f64,
    /// That of the largest.
    pub(super) largest: f64,
    pub(super) count: usize,
}

/// What was found in a picture.
#[derive(Clone)]
pub(super) struct Sight {
    pub(super) frame: u64,
    pub(super) centre: Point2<f64>,
    pub(super) area: f64,
    pub(super) invariants: Option<AffineMomentInvariants>,
    pub(super) is_clipped: bool,
    pub(super) points: Vec<Point2<f64>>,
    pub(super) contrast: f64,
    /// Objects of at least half the area, and all.
    pub(super) objects: [usize; 2],
    pub(super) inner: Inner,
    /// Area of the largest other one, over its own.
    pub(super) second: f64,
}

impl Sight {
    /// Of the largest object, or of that which is most like the one in the picture before.
    pub(super) fn of(
        frame: u64,
        traced: &[TracedOutline],
        picture: &GrayImage,
        contrast: Contrast,
        reach: f64,
        before: Option<&Self>,
    ) -> Option<Self> {
        let before = before.filter(|before| before.frame + 1 == frame);
        let nearest = before.and_then(|before| {
            let far = |t: &&TracedOutline| (t.centre - before.centre).norm() / before.size();
            let alike = traced.iter().filter(|t| (t.area / before.area).ln().abs() < 0.4 && far(t) < 1.5);
            alike.min_by(|a, b| far(a).total_cmp(&far(b)))
        });
        let chosen = nearest.or_else(|| traced.iter().find(|t| !t.touches_border)).or(traced.first())?;
        Some(Self::of_one(frame, chosen, traced, picture, contrast, reach))
    }

    /// Of one of the objects of a picture.
    pub(super) fn of_one(
        frame: u64,
        chosen: &TracedOutline,
        traced: &[TracedOutline],
        picture: &GrayImage,
        contrast: Contrast,
        reach: f64,
    ) -> Self {
        let boundary = chosen.outline.pieces().next().map_or(&[][..], |piece| piece.points);
        let points: Vec<Point2<f64>> = boundary.to_vec();
        let shares: Vec<f64> =
            chosen.outline.pieces().skip(1).map(|piece| area_of(piece.points) / chosen.area).collect();
        let largest = shares.iter().copied().fold(0.0, f64::max);
        let inner = Inner { share: shares.iter().sum(), largest, count: shares.len() };
        Self {
            frame,
            centre: chosen.centre,
            area: chosen.area,
            invariants: chosen.invariants,
            is_clipped: chosen.touches_border,
            contrast: contrast_along(&points, picture, contrast, reach),
            inner,
            second: traced
                .iter()
                .filter(|t| t.centre != chosen.centre)
                .map(|t| t.area / chosen.area)
                .fold(0.0, f64::max),
            objects: [traced.iter().filter(|t| 2.0 * t.area > chosen.area).count(), chosen.object_count],
            points,
        }
    }

    /// Its size, the root of its area.
    pub(super) fn size(&self) -> f64 {
        self.area.sqrt()
    }

    /// Mean distance of some points of this outline from another, the middles laid on each other.
    pub(super) fn unlike(&self, other: &Self) -> f64 {
        let shift = other.centre - self.centre;
        let step = (self.points.len() / 32).max(1);
        let distances: Vec<f64> = self
            .points
            .iter()
            .step_by(step)
            .map(|p| other.points.iter().map(|q| (q - (p + shift)).norm_squared()).fold(f64::INFINITY, f64::min).sqrt())
            .collect();
        distances.iter().sum::<f64>() / distances.len().max(1) as f64
    }
}

/// How clearly grey values change along an outline, from 0 to 1: by the share of the places where they do in the way expected, and by
/// the change over the spread of the grey values on either side.
fn contrast_along(points: &[Point2<f64>], picture: &GrayImage, contrast: Contrast, reach: f64) -> f64 {
    let (width, height) = (f64::from(picture.width()), f64::from(picture.height()));
    let count = points.len();
    // Polygons run counter-clockwise in their own coordinates, here with rows downwards: outwards is to the right of the way.
    let doubled: f64 = (0..count).map(|i| points[i].coords.perp(&points[(i + 1) % count].coords)).sum();
    let side = doubled.signum();
    let grey = |p: Point2<f64>| {
        let is_within = (0.0..width).contains(&p.x) && (0.0..height).contains(&p.y);
        is_within.then(|| f64::from(signal(picture.get_pixel(p.x as u32, p.y as u32).0[0], contrast)))
    };
    let mean = |p: Point2<f64>, n: Vector2<f64>, from: f64| -> Option<f64> {
        let values: Option<Vec<f64>> = (0..3).map(|k| grey(p + n * (from + f64::from(k) - 1.0))).collect();
        values.map(|values| values.iter().sum::<f64>() / 3.0)
    };
    let step = (count / PLACES).max(1);
    let sides: Vec<(f64, f64)> = (0..count)
        .step_by(step)
        .filter_map(|i| {
            let way = points[(i + 3) % count] - points[(i + count - 3 % count) % count];
            let out = Vector2::new(way.y, -way.x).try_normalize(1e-9)? * side;
            Some((mean(points[i], -out, reach)?, mean(points[i], out, reach + 1.5)?))
        })
        .collect();
    let Some(typical) = median(sides.iter().map(|(inner, outer)| inner - outer)) else { return 0.0 };
    if typical <= 0.0 {
        return 0.0;
    }
    let clear = sides.iter().filter(|(inner, outer)| inner - outer > 0.3 * typical).count() as f64 / sides.len() as f64;
    let spread = |of: &dyn Fn(&(f64, f64)) -> f64| {
        let middle = median(sides.iter().map(of)).unwrap_or(0.0);
        1.4826 * median(sides.iter().map(|side| (of(side) - middle).abs())).unwrap_or(0.0)
    };
    let ratio = typical / (spread(&|side| side.0).min(spread(&|side| side.1)) + spread(&|side| side.0 - side.1) + 1.0);
    clear * clear * ratio / (ratio + 1.5)
}

/// Area within a closed line.
fn area_of(points: &[Point2<f64>]) -> f64 {
    let edges = points.iter().zip(points.iter().cycle().skip(1));
    0.5 * edges.map(|(p, q)| p.coords.perp(&q.coords)).sum::<f64>().abs()
}
