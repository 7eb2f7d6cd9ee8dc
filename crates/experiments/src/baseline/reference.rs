use freeform_curve_fit::{Outline, outward_normals};
use nalgebra::{Point2, Vector2};

use super::outlier_removal::without_outliers;

/// Arc length to either side that the direction of a line is taken from, a share of the outline.
const WINDOW: f64 = 0.02;
/// Most neighbours to either side that the place of a line is taken from: more would cut bends and hardly take off noise.
const NEIGHBOURS: usize = 3;

/// The points of the first frame, each moved onto the line through its neighbours, found by place.
#[derive(Debug, Clone)]
pub(super) struct Reference {
    /// In the order of x.
    places: Vec<Place>,
}

/// One point of the first frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    pub(super) point: Point2<f64>,
    pub(super) normal: Vector2<f64>,
    /// Whether it is the end of an open arc: what is nearest to it may lie beyond.
    pub(super) is_end: bool,
}

impl Reference {
    /// Of an outline, its points far from their neighbours left out, in coordinates that `map` takes its points to.
    pub(super) fn new(outline: &Outline, map: impl Fn(&Point2<f64>) -> Point2<f64>) -> Self {
        let cleaned = without_outliers(outline);
        let normals = outward_normals(&cleaned, WINDOW);
        let most = ((WINDOW * cleaned.point_count() as f64).round() as usize).clamp(1, NEIGHBOURS);
        let (mut places, mut normals) = (Vec::new(), normals.into_iter());
        for piece in cleaned.pieces() {
            let points: Vec<_> = piece.points.iter().map(&map).collect();
            let count = points.len();
            for (i, normal) in (0..count).zip(normals.by_ref()) {
                let from_end = if piece.closed { (count - 1) / 2 } else { i.min(count - 1 - i) };
                // As far to one side as to the other: a mean of points on one side lies beside the line.
                let reach = most.min(from_end);
                let around = (1..=reach).flat_map(|step| [i + count - step, i + step]).map(|k| points[k % count]);
                let off = around.map(|p| normal.dot(&(p - points[i]))).sum::<f64>() / (2 * reach + 1) as f64;
                places.push(Place { point: points[i] + off * normal, normal, is_end: !piece.closed && from_end == 0 });
            }
        }
        places.sort_by(|a, b| a.point.x.total_cmp(&b.point.x));
        Self { places }
    }

    /// The place nearest to a point; none for a point that is not finite.
    pub(super) fn nearest(&self, p: &Point2<f64>) -> Option<&Place> {
        let middle = self.places.partition_point(|place| place.point.x < p.x);
        let (left, right) = self.places.split_at(middle);
        let (mut best, mut found) = (f64::INFINITY, None);
        // Outwards from the x of the point, as long as x alone does not rule the rest out.
        let (mut left, mut right) = (left.iter().rev().peekable(), right.iter().peekable());
        loop {
            let gap = |place: Option<&&Place>| place.map_or(f64::INFINITY, |place| (place.point.x - p.x).abs());
            let (to_left, to_right) = (gap(left.peek()), gap(right.peek()));
            if to_left.min(to_right).powi(2) >= best {
                return found;
            }
            let place = if to_left < to_right { left.next() } else { right.next() };
            let distance = place.map_or(f64::INFINITY, |place| (place.point - p).norm_squared());
            if distance < best {
                (best, found) = (distance, place);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reference(count: u32, noise: f64) -> Reference {
        let points: Vec<_> = (0..count)
            .map(|i| {
                let t = std::f64::consts::TAU * f64::from(i) / f64::from(count);
                // Up and down at no period of the outline, with this standard deviation.
                let off = noise * std::f64::consts::SQRT_2 * (2.4 * f64::from(i) * f64::from(i)).sin();
                Point2::new((1.0 + off) * t.cos(), (0.9 + off) * t.sin())
            })
            .collect();
        Reference::new(&Outline::closed(points).expect("closed"), |p| *p)
    }

    #[test]
    fn the_place_found_is_the_nearest_of_all() {
        let reference = reference(77, 0.1);
        for i in 0..400 {
            let t = f64::from(i);
            let p = Point2::new(2.0 * (1.7 * t).sin(), 1.5 * (0.9 * t).cos());
            let found = reference.nearest(&p).expect("finite");
            let nearest = reference.places.iter().map(|place| (place.point - p).norm()).fold(f64::INFINITY, f64::min);
            assert_eq!((found.point - p).norm(), nearest, "{p}");
        }
        assert!(reference.nearest(&Point2::new(f64::NAN, 0.0)).is_none());
    }

    #[test]
    fn the_lines_are_much_less_noisy_than_the_points() {
        let offs = reference(1000, 0.01).places.into_iter().map(|place| {
            let t = (place.point.y / 0.9).atan2(place.point.x);
            place.point - Point2::new(t.cos(), 0.9 * t.sin())
        });
        let rms = (offs.map(|off| off.norm_squared()).sum::<f64>() / 1000.0).sqrt();
        assert!(rms < 0.006, "{rms}");
    }
}
