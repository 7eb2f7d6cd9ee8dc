//! What the rounding of points to pixels does to a pose.
use freeform_curve_fit::{Outline, Piece};
use freeform_riccati::{ProjectiveMotion, map_point};
use nalgebra::Vector2;

use super::Track;
use crate::{
    belief::Belief,
    dynamics::CentredDeviations,
    map::Contour,
    measurement::{PixelLattice, Rounding},
    tuning::{lattice::RAGGED_OVER, statement::ALONG_PIXELS},
};

impl Track {
    /// Rounding of the points of an outline, whose contours are normalised by a radius: to pixels of a given size, image lengths, or, where
    /// that is 0, to those of the lattice that they lie on. Points that state deviations of their own have said what they are off by.
    pub(super) fn rounding_of(outline: &Outline, mask_pixel: f64, contours: &[Contour], radius: f64) -> Rounding {
        let length = |piece: Piece<'_>| piece.points.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum::<f64>();
        let extent = (outline.pieces().map(length).sum::<f64>() / radius, outline.point_count());
        if mask_pixel > 0.0 {
            return Rounding::of_mask(mask_pixel / radius, extent);
        }
        if outline.deviations().is_some() {
            return Rounding::NONE;
        }
        let Some(PixelLattice { pixel, place }) = PixelLattice::of(outline) else { return Rounding::NONE };
        let pixel = pixel / radius;
        let scatter = contours.iter().filter_map(|contour| contour.scatter_over(RAGGED_OVER * pixel));
        Rounding::on_lattice(pixel, place, scatter.fold(0.0, f64::max), extent)
    }

    /// Size of a pixel, and deviation of a side along the rows or columns, image lengths; zeros where points are not rounded.
    pub(crate) fn rounding_of_side(&self) -> [f64; 2] {
        let rounding = self.noise.rounding();
        [rounding.pixel(), rounding.of_side()].map(|length| length * self.reference.radius)
    }

    /// How far a pose is off as its points are rounded to pixels: deviations about the centroid, normalised, and none where points are not
    /// rounded. All points of a side that lies along the rows or columns are off together; others count as noise.
    pub(super) fn rounding_of_pose(&self) -> CentredDeviations {
        let side = self.noise.rounding().of_side();
        if side == 0.0 {
            return CentredDeviations::zeros();
        }
        let linear = self.belief.pose.fixed_view::<2, 2>(0, 0).into_owned();
        let along = |normal: &Vector2<f64>| {
            let tangent = linear * Vector2::new(normal.y, -normal.x);
            tangent.amin() < ALONG_PIXELS * tangent.amax()
        };
        let cells = self.map.cells();
        let share = cells.iter().filter(|cell| along(&cell.normal)).count() as f64 / cells.len().max(1) as f64;
        let [pose, _] = self.systematic([side * share * self.reference.radius; 2], self.span_of_motion(None));
        pose
    }

    /// How many saw teeth the rounding of the points to pixels of a size, image lengths, has gone through in the time `span` that the motion is
    /// known from, as far as frames show them ([`teeth_seen`]): root mean square over the points and both axes.
    pub(crate) fn rounding_teeth_seen(&self, span: f64, pixel: f64) -> f64 {
        let Belief { model, pose, motion, memory, .. } = &self.belief;
        let motion = ProjectiveMotion::of_generator(&model.generator(&motion[..model.parameter_count()]));
        let step = if memory.step > 0.0 { memory.step } else { span };
        let pixels = step * self.reference.radius / pixel;
        let cells = self.map.cells();
        let seen = |velocity: Vector2<f64>| (velocity * pixels).map(|along| teeth_seen(along, span / step));
        let squares = cells.iter().map(|cell| seen(motion.velocity(&map_point(pose, &cell.centre))).norm_squared());
        (squares.sum::<f64>() / cells.len().max(1) as f64).sqrt()
    }
}

/// How many saw teeth of its rounding to pixels a coordinate shows in frames between which it moves on by `step` pixels, in so many `steps`: the
/// mean of the rounding over the frames is that of one frame over this number.
///
/// By `p / q` pixels a frame, frames show `q` phases of a tooth, however many there are, and none but the first by whole pixels. Their mean is a saw
/// tooth itself, a `q`-th as high and as long; by a step that is off `p / q` by `d`, it goes through `steps d q` of these. What is left of the
/// rounding is the most that any fraction leaves. Those that leave more than whole numbers do are convergents of the continued fraction of the step.
fn teeth_seen(step: f64, steps: f64) -> f64 {
    // The distance of `q` steps from a whole number, of two convergents that follow each other.
    let (mut before, mut rest) = (1.0, (step - step.round()).abs());
    let (mut denominator_before, mut denominator) = (0.0, 1.0);
    let mut seen = steps * rest;
    // Where the phases stay within one tooth of the finer saw, or there are more phases than teeth seen already, no other fraction leaves more.
    while steps * rest > 1.0 && denominator < seen {
        let whole = (before / rest).floor();
        (before, rest) = (rest, before - whole * rest);
        (denominator_before, denominator) = (denominator, whole * denominator + denominator_before);
        seen = seen.min(denominator.max(denominator * steps * rest));
    }
    seen
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Root mean square, over all places of the first frame in a pixel, of the mean rounding of a coordinate over frames, in that of one frame.
    fn mean_rounding(step: f64, frames: u32) -> f64 {
        const PLACES: u32 = 200;
        let rounding = |place: f64| place - place.round();
        let mean = |place: u32| {
            let first = (f64::from(place) + 0.5) / f64::from(PLACES);
            let sum: f64 = (0..frames).map(|frame| rounding(first + step * f64::from(frame))).sum();
            sum / f64::from(frames)
        };
        (12.0 * (0..PLACES).map(|place| mean(place).powi(2)).sum::<f64>() / f64::from(PLACES)).sqrt()
    }

    #[test]
    fn steps_of_a_fraction_of_a_pixel_leave_as_much_of_the_rounding_as_they_show_phases_however_many_frames_there_are()
    {
        for (step, phases) in [(1.0, 1.0), (0.5, 2.0), (1.0 / 3.0, 3.0), (0.4, 5.0), (7.4, 5.0), (-2.5, 2.0)] {
            for frames in [30, 120, 1000] {
                let seen = teeth_seen(step, f64::from(frames)).max(1.0);
                assert!((seen / phases - 1.0).abs() < 1e-9, "{step} {frames}: {seen}");
                assert!((seen * mean_rounding(step, frames) - 1.0).abs() < 0.1, "{step} {frames}: {seen}");
            }
        }
    }

    #[test]
    fn of_steps_near_a_fraction_or_far_from_any_no_more_of_the_rounding_is_left_than_stated() {
        let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
        for frames in [30, 120, 1000] {
            for step in (1..100).map(|k| f64::from(k) * golden / 3.0).chain([0.504, 0.497, 0.335, 3.02, golden]) {
                let left = mean_rounding(step, frames) * teeth_seen(step, f64::from(frames)).max(1.0);
                assert!(left < 1.1, "{step} {frames}: {left}");
            }
            // What shows a new phase in every frame loses its rounding with their number.
            let seen = teeth_seen(golden, f64::from(frames)) / f64::from(frames);
            assert!((0.3..0.5).contains(&seen), "{frames}: {seen}");
        }
    }
}
