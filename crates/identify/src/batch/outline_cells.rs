//! The outline of an object in the body frame as straight pieces, from the points of all frames together.
use std::collections::HashMap;

use nalgebra::{Point2, Vector2};

use crate::filter::median;

/// Cosine of the angle that the normal of a point may make with that of its cell: the two sides of a thin part are apart.
const SAME_SIDE: f64 = -0.3;
/// Times that gaps are filled.
const PASSES: usize = 3;
/// Fewest points of a cell, and as a share of the median: fewer are strays.
const FEWEST_POINTS: usize = 3;
const FEWEST_SHARE: f64 = 0.2;

/// A point of one frame in the body frame, with the unit normal of the outline there.
#[derive(Debug, Clone, Copy)]
pub(super) struct BodyPoint {
    pub(super) place: Point2<f64>,
    pub(super) normal: Vector2<f64>,
}

/// A straight piece of the outline: all points with `n . (q - c) = offset + slope t`, t being the distance along it in cell lengths.
#[derive(Debug, Clone, Copy)]
pub(super) struct OutlineCell {
    pub(super) centre: Point2<f64>,
    pub(super) normal: Vector2<f64>,
    pub(super) offset: f64,
    pub(super) slope: f64,
}

impl OutlineCell {
    /// Distance of a point from the piece along its normal, and its place along it in cell lengths.
    pub(super) fn read(&self, q: &Point2<f64>, length: f64) -> (f64, f64) {
        let d = q - self.centre;
        let along = (self.normal.x * d.y - self.normal.y * d.x) / length;
        (self.normal.dot(&d) - self.offset - self.slope * along, along)
    }
}

/// Cells of about one length that cover an outline, found by place.
#[derive(Debug, Clone)]
pub(super) struct OutlineCells {
    pub(super) list: Vec<OutlineCell>,
    pub(super) length: f64,
    /// Points further off along the normal belong to no cell.
    reach: f64,
    buckets: HashMap<(i64, i64), Vec<usize>>,
}

impl OutlineCells {
    /// Cells of the given length wherever enough points lie, of which a point belongs to one up to `reach` along the normal.
    pub(super) fn covering(points: &[BodyPoint], length: f64, reach: f64) -> Self {
        let mut cells = Self { list: Vec::new(), length, reach, buckets: HashMap::new() };
        // A seed that is an outlier covers what it does not describe: what its refined cell leaves open is filled again.
        for _ in 0..PASSES {
            for point in points {
                if cells.nearest(point).is_none() {
                    cells.push(OutlineCell { centre: point.place, normal: point.normal, offset: 0.0, slope: 0.0 });
                }
            }
            cells = cells.refined(points);
        }
        cells
    }

    /// Every cell in the middle of its points, without those that have few.
    fn refined(&self, points: &[BodyPoint]) -> Self {
        let mut members: Vec<Vec<usize>> = vec![Vec::new(); self.list.len()];
        for (i, point) in points.iter().enumerate() {
            if let Some(number) = self.nearest(point) {
                members[number].push(i);
            }
        }
        // Over points, not cells: outliers make many cells of one.
        let mut counts: Vec<f64> = members.iter().flat_map(|m| m.iter().map(|_| m.len() as f64)).collect();
        let fewest = (FEWEST_SHARE * median(&mut counts).unwrap_or(0.0)).max(FEWEST_POINTS as f64);
        let mut refined = Self { list: Vec::new(), length: self.length, reach: self.reach, buckets: HashMap::new() };
        for (seed, members) in self.list.iter().zip(&members).filter(|(_, m)| m.len() as f64 >= fewest) {
            let own = || members.iter().map(|i| &points[*i]);
            let normal = own().map(|p| p.normal).sum::<Vector2<f64>>().try_normalize(1e-9).unwrap_or(seed.normal);
            let tangent = Vector2::new(-normal.y, normal.x);
            let middle = |axis: Vector2<f64>| {
                let mut values: Vec<f64> = own().map(|p| axis.dot(&(p.place - seed.centre))).collect();
                median(&mut values).unwrap_or(0.0)
            };
            let centre = seed.centre + middle(tangent) * tangent + middle(normal) * normal;
            refined.push(OutlineCell { centre, normal, offset: 0.0, slope: 0.0 });
        }
        refined
    }

    /// The cell whose centre is nearest to a point, of those within a length along the outline and within reach across it, on the same
    /// side of the object.
    pub(super) fn nearest(&self, point: &BodyPoint) -> Option<usize> {
        let (i, j) = self.bucket(&point.place);
        let mut best = None;
        let mut distance = f64::INFINITY;
        for key in (i - 1..=i + 1).flat_map(|i| (j - 1..=j + 1).map(move |j| (i, j))) {
            for &number in self.buckets.get(&key).map_or(&[][..], Vec::as_slice) {
                let cell = &self.list[number];
                let from = point.place - cell.centre;
                let (across, along) = (cell.normal.dot(&from).abs(), cell.normal.perp(&from).abs());
                let beside = across <= self.reach && along <= self.length;
                if beside && from.norm_squared() < distance && cell.normal.dot(&point.normal) > SAME_SIDE {
                    (best, distance) = (Some(number), from.norm_squared());
                }
            }
        }
        best
    }

    /// Normal of the outline at a point as its cell has it, the slope included.
    pub(super) fn normal_at(&self, point: &BodyPoint) -> Option<Vector2<f64>> {
        let cell = &self.list[self.nearest(point)?];
        let tangent = Vector2::new(-cell.normal.y, cell.normal.x);
        (cell.normal - cell.slope / self.length * tangent).try_normalize(0.0)
    }

    fn push(&mut self, cell: OutlineCell) {
        let key = self.bucket(&cell.centre);
        self.buckets.entry(key).or_default().push(self.list.len());
        self.list.push(cell);
    }

    fn bucket(&self, p: &Point2<f64>) -> (i64, i64) {
        // A point within length and reach of a centre is at most one bucket away.
        let size = self.length.hypot(self.reach);
        ((p.x / size).floor() as i64, (p.y / size).floor() as i64)
    }
}
