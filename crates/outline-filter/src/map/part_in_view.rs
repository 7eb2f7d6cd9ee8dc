//! What a part of an outline shows of its pose: the whole of a bar shows how far it has gone along itself, its sides alone do not.
use freeform_riccati::{MAX_PARAMETERS, MotionModel};
use nalgebra::{Matrix3, SMatrix, SVector};

use super::{
    NullDirection, NullDirections, OutlineMap, levers::SumOfSquares, orthonormal::Orthonormal, rest::eigen_of_block,
    to_image::ToImage,
};
use crate::tuning::null_space as tuning;

impl OutlineMap {
    /// The directions, beside the null directions, that a frame does not show in a pose: no more than errors of the normals would make of their levers.
    /// `weights` says how much the points of each cell count that are in view.
    pub(crate) fn untold_directions(&self, model: MotionModel, pose: &Matrix3<f64>, weights: &[f64]) -> NullDirections {
        let (mut untold, k) = (NullDirections::default(), model.parameter_count());
        let Some(levers) = &self.levers else { return untold };
        let in_view = levers.of_cells.iter().zip(weights).filter(|(_, weight)| **weight > 0.0);
        let sum = SumOfSquares::of(in_view.map(|(lever, weight)| (lever, weight * lever.length)), k);
        let is_untold = |(value, vector): &(f64, SVector<f64, MAX_PARAMETERS>)| {
            *value < tuning::EXPLAINED * (vector.transpose() * sum.of_noise * vector)[(0, 0)]
        };
        let mut of_noise_alone = eigen_of_block(&sum.levers, k).filter(is_untold).peekable();
        // Most frames show all.
        if of_noise_alone.peek().is_none() {
            return untold;
        }
        let to_body = levers.centring.to_body();
        let (Some(to_image), Some(from_body)) = (ToImage::of(model, pose, &to_body), to_body.try_inverse()) else {
            return untold;
        };
        let mut left_out = self.hidden_directions(&to_image);
        for (_, vector) in of_noise_alone {
            let generator = levers.centring.unstretched(&model.generator(&vector.as_slice()[..k]));
            if let Some(unit) = left_out.add(&model.parameters_of(&generator)) {
                let in_body = to_body * model.generator(&unit[..k]) * from_body;
                untold.push(to_image.direction(&model.parameters_of(&in_body), &unit));
            }
        }
        untold
    }

    /// How far a deviation of a pose moves the cells at most, root mean square, in the body frame, by the covariance of its error there. Null directions are
    /// left out. `None` before there are cells.
    pub(crate) fn farthest_displacement(
        &self,
        model: MotionModel,
        covariance: &SMatrix<f64, MAX_PARAMETERS, MAX_PARAMETERS>,
    ) -> Option<f64> {
        let to_centred = self.to_centred(model)?;
        let hidden = self.hidden_directions(&to_centred);
        let shown = eigen_of_block(&to_centred.centred_covariance(covariance), model.parameter_count())
            .filter(|(_, direction)| hidden.beside(&(*direction).into()).is_some());
        let largest = shown.map(|(value, _)| value).fold(0.0, f64::max);
        Some(self.levers.as_ref()?.centring.spread() * largest.sqrt())
    }

    /// Whether cells from a number on show those of some directions, given in the body frame, that are no null directions any more: several of them,
    /// since one or two at a corner are bent.
    pub(crate) fn are_shown_by_new(&self, model: MotionModel, first_new: usize, directions: &[NullDirection]) -> bool {
        let Some((levers, to_centred)) = self.levers.as_ref().zip(self.to_centred(model)) else { return false };
        let hidden = self.hidden_directions(&to_centred);
        directions.iter().all(|null| {
            let direction = &null.direction;
            if hidden.beside(&to_centred.centred(direction)).is_none() {
                return true;
            }
            let Some(NullDirection { direction, .. }) = levers.stretched(model, null) else { return false };
            let length = direction.iter().map(|entry| entry * entry).sum::<f64>();
            let of_new = levers.of_cells[first_new..].iter().map(|lever| {
                let along = lever.across.iter().zip(&direction).map(|(a, b)| a * b).sum::<f64>();
                lever.length * along * along / length
            });
            of_new.sum::<f64>() >= tuning::FEWEST_TO_SHOW
        })
    }

    /// Takes directions of the body frame to centred coordinates.
    pub(super) fn to_centred(&self, model: MotionModel) -> Option<ToImage> {
        ToImage::of(model, &Matrix3::identity(), &self.levers.as_ref()?.centring.to_body())
    }

    /// The null directions in centred coordinates, made orthonormal.
    pub(super) fn hidden_directions(&self, to_centred: &ToImage) -> Orthonormal {
        Orthonormal::spanning(self.null_space.in_body.iter().map(|direction| to_centred.centred(direction)))
    }
}

#[cfg(test)]
mod tests {
    use freeform_curve_fit::{OpenArc, OpenOutline, Outline};
    use nalgebra::{Point2, Vector2};
    use rand::{RngExt as _, SeedableRng as _};
    use rand_chacha::ChaCha8Rng;
    use rand_distr::StandardNormal;

    use super::*;
    use crate::{
        measurement::{Frame, Measurement, Pass},
        track::{Comparison, Track},
        update::Gate,
    };

    /// Points along lines from each place to the next, with noise across these.
    fn points(places: &[[f64; 2]], random: &mut ChaCha8Rng) -> Vec<Point2<f64>> {
        const SPACING: f64 = 0.02;
        let mut points = Vec::new();
        for pair in places.windows(2) {
            let [from, to] = [pair[0], pair[1]].map(Point2::from);
            let along = (to - from).normalize();
            let normal = Vector2::new(along.y, -along.x);
            let count = ((to - from).norm() / SPACING) as u32;
            points.extend((0..count).map(|i| {
                let noise: f64 = 0.004 * random.sample::<f64, _>(StandardNormal);
                from + SPACING * f64::from(i) * along + noise * normal
            }));
        }
        points
    }

    fn arcs(list: &[&[[f64; 2]]]) -> Outline {
        let mut random = ChaCha8Rng::seed_from_u64(3);
        let arcs = list.iter().map(|places| OpenArc::new(points(places, &mut random)).expect("an arc"));
        Outline::Open(OpenOutline::new(arcs.collect()).expect("arcs"))
    }

    const LONG: f64 = 2.0;
    const UPPER: &[[f64; 2]] = &[[LONG, 0.3], [-LONG, 0.3]];
    const LOWER: &[[f64; 2]] = &[[-LONG, -0.3], [LONG, -0.3]];
    const WITH_END: &[[f64; 2]] = &[[-LONG, -0.3], [LONG, -0.3], [LONG, 0.3], [-LONG, 0.3]];
    const ROUND_CORNER: &[[f64; 2]] = &[[-LONG, -0.3], [LONG, -0.3], [LONG, -0.27]];

    fn begun(outline: &Outline) -> Track {
        Track::begin(MotionModel::Rigid, outline, 0.0, &mut Frame::default()).expect("a track")
    }

    /// What each cell counts for where those count that a condition holds of, by their places along and across the bar.
    fn weights(track: &Track, counts: impl Fn(Vector2<f64>) -> bool) -> Vec<f64> {
        let (reference, cells) = (track.reference(), track.map().cells());
        cells
            .iter()
            .map(|c| f64::from(u8::from(counts((reference.to_image() * c.centre.to_homogeneous()).xy()))))
            .collect()
    }

    #[test]
    fn the_sides_of_a_bar_do_not_tell_its_slide_and_one_of_its_ends_does() {
        let track = begun(&arcs(&[WITH_END]));
        let pose = MotionModel::Rigid.flow(&[0.4, 0.3, -0.2], 1.0).into_inner();
        let untold = |counts: fn(Vector2<f64>) -> bool| {
            track.map().untold_directions(MotionModel::Rigid, &pose, &weights(&track, counts))
        };
        assert!(track.null_directions().is_empty());
        assert_eq!(untold(|_| true).len(), 0);
        assert_eq!(untold(|p| p.x > 1.0).len(), 0);
        let of_sides = untold(|p| p.x < 1.9);
        assert_eq!(of_sides.len(), 1);
        // A shift along the bar as it is turned in the image, without a turn.
        let NullDirection { direction, dual } = of_sides[0];
        let along = pose * nalgebra::Vector3::x();
        assert!(
            direction[0].abs() < 0.02 && (direction[1] * along.y - direction[2] * along.x).abs() < 0.02,
            "{direction:?}"
        );
        assert!((direction.iter().zip(&dual).map(|(a, b)| a * b).sum::<f64>() - 1.0).abs() < 1e-9);
        // Of one side alone, the same.
        assert_eq!(untold(|p| p.x < 1.9 && p.y > 0.0).len(), 1);
    }

    #[test]
    fn a_bar_of_which_no_end_is_in_view_is_found_nowhere_along_itself() {
        let displacement = |track: &Track, counts: fn(Vector2<f64>) -> bool| {
            let mut information = SMatrix::<f64, MAX_PARAMETERS, MAX_PARAMETERS>::identity() * 1e-3;
            for (cell, weight) in track.map().cells().iter().zip(weights(track, counts)) {
                let h = SVector::from(MotionModel::Rigid.normal_velocities(&cell.centre, &cell.normal));
                information += 1e6 * weight * h * h.transpose();
            }
            let covariance = information.try_inverse().expect("regular");
            track.map().farthest_displacement(MotionModel::Rigid, &covariance).expect("a displacement")
        };
        let with_end = begun(&arcs(&[WITH_END]));
        let (all, sides) = (displacement(&with_end, |_| true), displacement(&with_end, |p| p.x < 1.9));
        assert!(all < 1e-3 && sides > 3.0 * all, "{all} {sides}");
        // Where the slide is a null direction nobody asks for it.
        let without = begun(&arcs(&[LOWER, UPPER]));
        let known = displacement(&without, |_| true);
        assert_eq!(without.null_directions().len(), 1);
        assert!(known < 1e-3, "{known}");
    }

    /// A track of the sides of a bar that has been shown something else; how many cells it has grown by.
    fn grown_by(second: &Outline) -> (Track, usize) {
        let mut frame = Frame::default();
        let mut track = begun(&arcs(&[LOWER, UPPER]));
        let before = track.cell_count();
        assert!(track.predict(0.1));
        frame.load(second, track.reference());
        let gate = Gate { smallest_agreement: 0.7, largest_innovation: None, largest_noise: None };
        let outcome = track.update(&mut frame, &gate, Comparison::NotAsked);
        assert!(outcome.is_accepted());
        let grown = track.cell_count() - before;
        (track, grown)
    }

    #[test]
    fn two_cells_round_a_corner_do_not_show_a_slide_and_an_end_does() {
        let (track, grown) = grown_by(&arcs(&[ROUND_CORNER, UPPER]));
        assert_eq!((grown, track.null_directions().len()), (0, 1));
        let (track, grown) = grown_by(&arcs(&[WITH_END]));
        assert!(grown > 5 && track.null_directions().is_empty(), "{grown}");
    }

    #[test]
    fn sides_that_were_there_before_an_end_tell_no_slide_after_it() {
        let (track, grown) = grown_by(&arcs(&[WITH_END]));
        let (map, pose) = (track.map(), track.body_pose());
        let unshown: Vec<_> = map.unshown_by_first(MotionModel::Rigid, pose).collect();
        let [(count, slide)] = unshown[..] else { panic!("{unshown:?}") };
        assert_eq!(count, track.cell_count() - grown);
        let mut frame = Frame::default();
        frame.load(&arcs(&[WITH_END]), track.reference());
        frame.clear_shifts(track.cell_count());
        track.view().measure_by_columns(&mut frame, pose, &[], Pass::First);
        track.view().leave_out_untold(&mut frame, pose, &[]);
        let along = |jacobian: &freeform_riccati::ParameterVector| {
            jacobian.iter().zip(&slide.direction).map(|(a, b)| a * b).sum::<f64>().abs()
        };
        let (of_first, of_new): (Vec<&Measurement>, Vec<_>) =
            frame.measurements.iter().filter(|m| m.weight > 0.0).partition(|m| m.cell < count);
        assert!(of_first.len() > 300 && of_first.iter().all(|m| along(&m.jacobian) < 1e-12));
        assert!(of_new.iter().filter(|m| along(&m.jacobian) > 0.3).count() > 15);
        // Nobody knows how far the sides had gone before: a radius.
        let covariance = track.summary_in_body_frame().expect("finite").covariance;
        let dual = slide.dual.iter().enumerate();
        let variance: f64 = dual
            .flat_map(|(i, a)| slide.dual.iter().enumerate().map(move |(j, b)| (i, j, a * b)))
            .map(|(i, j, product)| product * covariance[(i, j)])
            .sum();
        assert!((variance - 1.0).abs() < 0.1, "{variance}");
    }
}
