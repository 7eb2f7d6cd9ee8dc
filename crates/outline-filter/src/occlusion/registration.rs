//! The rigid motion between two contours, of which parts are left out.
use nalgebra::{Matrix3, Point2, Rotation2, Vector2, Vector3};

use super::places::{Foot, Places, clear_with_room, median};
use crate::tuning::{
    measurement::MEDIAN_TO_DEVIATION,
    occlusion::{AGREES, FEWEST_REGISTERED, MOST_PLACES, REGISTRATION_PRIOR, REGISTRATION_SETTLED, REGISTRATION_STEPS},
    registration::TUKEY,
};

/// A turn about the centre of the contour that is moved, and a shift.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Moved {
    turn: f64,
    shift: Vector2<f64>,
}

/// A contour moved onto another one.
#[derive(Debug)]
pub(super) struct Registered<'a> {
    pub(super) moved: Moved,
    /// Where its places lie then.
    pub(super) places: &'a [Point2<f64>],
    /// How far each of them is from the other contour.
    pub(super) distances: &'a [f64],
    /// Standard deviation of the distances, no less than the noise.
    pub(super) scale: f64,
    centre: Point2<f64>,
    size: f64,
    covariance: Matrix3<f64>,
}

/// What a registration fills, kept for the next one.
#[derive(Debug, Clone, Default)]
pub(super) struct RegistrationBuffers {
    /// Places that are moved, each with the one on the other contour that it meets.
    met: Vec<(Point2<f64>, Foot)>,
    /// Values that a median is taken of.
    values: Vec<f64>,
    places: Vec<Point2<f64>>,
    distances: Vec<f64>,
}

impl RegistrationBuffers {
    pub(super) fn make_room(&mut self) {
        let Self { met, values, places, distances } = self;
        clear_with_room(met, MOST_PLACES);
        clear_with_room(values, MOST_PLACES);
        clear_with_room(places, MOST_PLACES);
        clear_with_room(distances, MOST_PLACES);
    }
}

impl Registered<'_> {
    /// Share of some places that lie on the other contour.
    pub(super) fn agreement(&self, places: impl Iterator<Item = usize>) -> f64 {
        let (mut agreeing, mut all) = (0.0, 0.0);
        for i in places {
            all += 1.0;
            agreeing += if self.distances[i] < AGREES * self.scale { 1.0 } else { 0.0 };
        }
        if all > 0.0 { agreeing / all } else { 0.0 }
    }

    /// Standard deviation of where the motion takes a place, in the direction of a normal.
    pub(super) fn deviation_of(&self, i: usize, normal: &Vector2<f64>) -> f64 {
        let row = row(normal, &(self.places[i] - self.centre), self.size);
        self.scale * row.dot(&(self.covariance * row)).max(0.0).sqrt()
    }
}

fn row(normal: &Vector2<f64>, lever: &Vector2<f64>, size: f64) -> Vector3<f64> {
    Vector3::new(normal.x, normal.y, (normal.y * lever.x - normal.x * lever.y) / size)
}

/// Moves those places of a contour that are `taken` onto another one, of which the sides `left_out` tell nothing: the nearest motion to the one begun
/// with, by robust least squares of distances from sides. `None` where too few places are left.
pub(super) fn registered<'a>(
    (contour, taken): (&Places, impl Fn(usize) -> bool),
    (other, left_out): (&Places, impl Fn(usize) -> bool),
    noise: f64,
    begun_with: Moved,
    buffers: &'a mut RegistrationBuffers,
) -> Option<Registered<'a>> {
    let RegistrationBuffers { met, values, places, distances } = buffers;
    let (centre, size) = (contour.centre(), contour.size());
    let mut moved = begun_with;
    let (mut scale, mut information) = (noise, Matrix3::zeros());
    let place = |moved: &Moved, p: &Point2<f64>| centre + Rotation2::new(moved.turn) * (p - centre) + moved.shift;
    for _ in 0..REGISTRATION_STEPS {
        met.clear();
        for (_, p) in contour.iter().enumerate().filter(|(i, _)| taken(*i)) {
            let p = place(&moved, &p);
            let foot = other.nearest(&p);
            if !left_out(foot.side) {
                met.push((p, foot));
            }
        }
        if met.len() < FEWEST_REGISTERED {
            return None;
        }
        scale = noise.max(MEDIAN_TO_DEVIATION * median(met.iter().map(|(_, foot)| foot.distance), values));
        information = Matrix3::identity() * (REGISTRATION_PRIOR * met.len() as f64);
        let mut right = Vector3::zeros();
        for (p, foot) in met.iter() {
            let u = foot.distance / (TUKEY * scale);
            let normal = other.normal(foot.side);
            let row = row(&normal, &(p - centre - moved.shift), size);
            let weight = if u < 1.0 { (1.0 - u * u).powi(2) } else { 0.0 };
            information += row * row.transpose() * weight;
            right -= row * (weight * normal.dot(&(p - foot.point)));
        }
        let step = information.cholesky()?.solve(&right);
        moved.shift += step.xy();
        moved.turn += step.z / size;
        if step.norm() < REGISTRATION_SETTLED * scale {
            break;
        }
    }
    places.clear();
    places.extend(contour.iter().map(|p| place(&moved, &p)));
    distances.clear();
    distances.extend(places.iter().map(|p| other.nearest(p).distance));
    let covariance = information.try_inverse()?;
    Some(Registered { moved, places, distances, scale, centre: centre + moved.shift, size, covariance })
}

#[cfg(test)]
mod tests {
    use freeform_curve_fit::Outline;
    use nalgebra::Isometry2;

    use super::*;

    fn pebble(i: usize) -> Point2<f64> {
        let t = std::f64::consts::TAU * i as f64 / 100.0;
        let radius = 1.0 + 0.15 * (2.0 * t).cos() + 0.1 * (3.0 * t + 0.5).sin();
        Point2::new(radius * t.cos(), radius * t.sin())
    }

    fn places(points: impl Iterator<Item = Point2<f64>>) -> Places {
        let mut places = Places::default();
        assert!(places.refill_from(&Outline::closed(points.collect()).expect("an outline")), "places");
        places
    }

    #[test]
    fn a_part_of_a_contour_is_moved_back_whatever_the_part_left_out_does() {
        let moved = Isometry2::new(Vector2::new(0.03, -0.02), 0.05);
        // A fifth of the places has stayed.
        let now = places((0..100).map(|i| if i < 20 { pebble(i) } else { moved * pebble(i) }));
        let before = places((0..100).map(pebble));
        let mut buffers = RegistrationBuffers::default();
        let mut registered_of = |taken: fn(usize) -> bool| {
            registered((&now, taken), (&before, |i| i < 20), 0.003, Moved::default(), &mut buffers).map(|found| {
                let agreements = [found.agreement(20..100), found.agreement(5..15)];
                (found.places.to_vec(), agreements, found.deviation_of(50, &Vector2::x()))
            })
        };
        let (places, [of_rest, of_part], deviation) = registered_of(|i| i >= 20).expect("a motion");
        assert!((20..100).all(|i| (places[i] - pebble(i)).norm() < 0.01), "back where they were");
        assert!(of_rest > 0.99 && of_part < 0.5);
        assert!(deviation < 0.003);
        assert!(registered_of(|_| false).is_none());
    }
}
