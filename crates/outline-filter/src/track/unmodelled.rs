//! What the motion model of a track leaves out.
use freeform_estimate::velocity_at;
use freeform_riccati::{ParameterKind, map_point};

use super::Track;
use crate::{
    belief::StateMatrix,
    dynamics::{UnmodelledEstimate, WrongFamily},
    measurement::Frame,
    tuning::family as tuning,
    update::{PoseMeasurement, Proposal, displacement_in_picture, with_hold},
};

impl Track {
    /// Looks at what a solved frame, which has not been committed, says of motions that the model leaves out: all of the first frames, and
    /// then one that stands for several, fewer where more is known, unless the motion is known from so few frames that each of them corrects
    /// much of it. `variance` is
    /// that of the noise.
    pub(super) fn look_for_unmodelled_motions(
        &mut self,
        frame: &mut Frame,
        (proposal, hold): (&Proposal, Option<&StateMatrix>),
        measured: &PoseMeasurement,
        variance: f64,
    ) {
        let repeats = self.frames_stood_for();
        if !self.frames.is_multiple_of(repeats) {
            return;
        }
        let repeats = repeats as f64;
        let marginal = with_hold(&proposal.marginal, hold);
        let at = (&self.belief, &*self.map);
        let score = self.sensitivity.update(at, frame, (&proposal.pose, &marginal), measured, repeats);
        if let Some(score) = score.filter(|_| self.frames > tuning::MAP_KNOWN) {
            let centroid = self.map.centroid();
            let distance = (map_point(&self.belief.pose, &centroid) - centroid).norm();
            self.family.add(&score, (distance, self.belief.memory.step), (self.noise.sigma, variance));
        }
    }

    /// How many frames one stands for that is looked at.
    fn frames_stood_for(&self) -> usize {
        let memory = &self.belief.memory;
        let remembered = memory.shortest(self.belief.parameter_count());
        let are_known = |frames: usize| self.frames > frames && remembered >= frames as f64 * memory.step;
        if !are_known(tuning::ALL_OF_THE_FIRST) {
            1
        } else if !are_known(tuning::MANY) {
            tuning::EVERY
        } else {
            tuning::EVERY_LATER
        }
    }

    /// What the outlines do beside their motion, as far as it is told, and the second moments of what it makes of the errors of pose and
    /// motion.
    pub(crate) fn unmodelled_motions(&self) -> (UnmodelledEstimate, StateMatrix) {
        let estimate = self.unmodelled_estimate();
        let mut by_size = self.sensitivity.state;
        // Place and velocity are those in the picture, wherever that puts the object.
        let (model, k) = (self.belief.model, self.belief.parameter_count());
        let centre = self.centred_pose().centre();
        let velocity = velocity_at(&model.generator(&self.belief.motion[..k]), &centre);
        let velocities = (0..k).filter(|j| model.parameter_kinds()[*j] == ParameterKind::Velocity);
        for (l, [moved, rate]) in displacement_in_picture(&centre.coords, &velocity).iter().enumerate() {
            for (axis, j) in velocities.clone().enumerate() {
                by_size[(j, l)] -= moved[axis];
                by_size[(k + j, l)] -= rate[axis];
            }
        }
        (estimate, by_size * estimate.moments * by_size.transpose())
    }

    /// What the outlines do beside their motion, as far as it is told.
    pub(super) fn unmodelled_estimate(&self) -> UnmodelledEstimate {
        let of_side = self.noise.rounding().of_side();
        let mut estimate = *self.family.estimate(self.belief.model, of_side);
        if let Some(displacement) = self.change_of_shape() {
            estimate.change_of_shape = displacement;
            if !estimate.is_beyond_doubt {
                estimate.add_change_of_shape((displacement, displacement > of_side));
            }
        }
        // An outline that is hardly out of round changes by as much as that as it turns, which is not followed where it is not seen.
        let may_be_turn = estimate.family.is_some_and(|family| family != WrongFamily::Growth) && self.turn_is_unseen();
        if may_be_turn && estimate.displacement < tuning::TURNED_UNSEEN * self.out_of_round() {
            estimate.family = None;
        }
        estimate
    }

    /// How far the cells lie from a circle about their middle, root mean square, normalised: as they were cut, since a map whose turn is not followed
    /// becomes round.
    fn out_of_round(&self) -> f64 {
        let (cells, centroid) = (self.map.cells(), self.map.centroid());
        let count = cells.len().max(1) as f64;
        let distances = cells.iter().map(|cell| (cell.centre - centroid).norm());
        let mean = distances.clone().sum::<f64>() / count;
        (distances.map(|distance| (distance - mean).powi(2)).sum::<f64>() / count).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use freeform_riccati::{MotionModel, map_point};
    use nalgebra::{Point2, Vector2};

    use super::*;
    use crate::drawn_curves::{lobed, outline, polar};
    use crate::prediction::TimeOfChange;
    use crate::track::Comparison;
    use crate::tuning::noise::{LARGEST, LARGEST_RATIO};
    use crate::update::{FrameMeasurement, Gate, LENS, PERSPECTIVE, SHEAR, UNMODELLED};

    const STEP: f64 = 0.05;
    const MOTION: [f64; 3] = [1.3, 0.4, -0.7];

    /// Points of a body at rest, by the angle about its centroid.
    fn body(t: f64) -> Point2<f64> {
        let p = polar(lobed(t, &[(3.0, [0.25, 0.0]), (2.0, [0.0, 0.15]), (5.0, [0.1, 0.0])]), t);
        Point2::new(0.3 + p.x, -0.2 + 0.8 * p.y)
    }

    /// Where a point of a frame with its unit normal is moved to by a unit of each motion that is left out, in the normalised coordinates of a track.
    fn displaced(
        l: usize,
        (p, normal): (&Point2<f64>, &Vector2<f64>),
        (centre, elapsed, velocity): (&Point2<f64>, f64, &Vector2<f64>),
    ) -> Vector2<f64> {
        let square = p.coords.norm_squared();
        match l {
            0 => elapsed * (p - centre),
            1 => Vector2::new(p.x, -p.y),
            2 => Vector2::new(p.y, p.x),
            3 => p.x * p.coords,
            4 => p.y * p.coords,
            5 => p.y * velocity,
            6 => square * p.coords,
            7 => 2.0 * p.x * p.coords + Vector2::new(square, 0.0),
            8 => 2.0 * p.y * p.coords + Vector2::new(0.0, square),
            9 => (normal.x * normal.x - normal.y * normal.y) * normal,
            _ => 2.0 * normal.x * normal.y * normal,
        }
    }

    /// A track of a body in rigid motion, displaced by some of a motion that is left out, that may change by variances per second.
    fn tracked(size: f64, l: usize, (frames, change): (u8, [f64; 2])) -> Track {
        let model = MotionModel::Rigid;
        let at_rest = outline(600, body);
        let mut buffers = Frame::default();
        let plain = Track::begin(model, &at_rest, 0.0, &mut buffers).expect("a track");
        let reference = plain.reference();
        let (to, centroid) = (reference.to_image(), plain.map.centroid());
        let from = to.try_inverse().expect("a radius");
        let mut track: Option<Track> = None;
        for frame in 0..frames {
            let elapsed = STEP * f64::from(frame);
            let flow = model.flow(&MOTION, elapsed).into_inner();
            let centre = map_point(&(from * flow * to), &centroid);
            let generator = from * model.generator(&MOTION) * to;
            let outline = outline(600, |t| {
                let at = |t: f64| map_point(&(from * flow), &body(t));
                let (p, along) = (at(t), at(t + 1e-5) - at(t - 1e-5));
                let normal = Vector2::new(along.y, -along.x).normalize();
                let velocity = (generator * p.to_homogeneous()).xy();
                let moved = p + size * displaced(l, (&p, &normal), (&centre, elapsed, &velocity));
                map_point(&to, &moved)
            });
            match &mut track {
                None => track = Track::begin(model, &outline, 0.0, &mut buffers),
                Some(track) => {
                    assert!(track.predict(STEP));
                    if change != [0.0; 2] {
                        track.add_change(change, TimeOfChange::Beginning);
                    }
                    buffers.load(&outline, track.reference());
                    let gate = Gate { smallest_agreement: 0.5, largest_innovation: None, largest_noise: None };
                    assert!(track.update(&mut buffers, &gate, Comparison::NotAsked).is_accepted(), "{l} {frame}");
                }
            }
        }
        track.expect("frames")
    }

    #[test]
    fn a_point_is_displaced_in_the_picture_as_cells_are_and_as_fast_as_it_moves() {
        let (p, v, normal) = (Point2::new(0.7, -1.3), Vector2::new(-0.4, 0.9), Vector2::x());
        let at = |l: usize, seconds: f64| displaced(l, (&(p + v * seconds), &normal), (&Point2::origin(), 0.0, &v));
        for (l, [moved, rate]) in displacement_in_picture(&p.coords, &v).iter().enumerate() {
            if SHEAR.contains(&l) || PERSPECTIVE.contains(&l) || LENS.contains(&l) {
                let difference = (at(l, 1e-5) - at(l, -1e-5)) / 2e-5;
                assert!((moved - at(l, 0.0)).norm() < 1e-12 && (rate - difference).norm() < 1e-8, "{l}");
            } else {
                assert_eq!((moved.norm(), rate.norm()), (0.0, 0.0), "{l}");
            }
        }
    }

    #[test]
    fn a_motion_that_is_left_out_moves_the_estimates_by_its_size_times_their_sensitivity() {
        let size = 1e-5;
        for l in 0..UNMODELLED {
            let [moved, as_it_is] = [size, 0.0].map(|size| tracked(size, l, (14, [0.0; 2])));
            let to_image = as_it_is.reference().to_image();
            let by_size = as_it_is.belief.model.adjoint(&to_image, &to_image.try_inverse().expect("a radius"));
            let normalised = |i: usize| as_it_is.sensitivity.state[(3 + i, l)];
            let expected: [f64; 3] = std::array::from_fn(|i| (0..3).map(|j| by_size[i][j] * normalised(j)).sum());
            let scale = expected.iter().fold(1e-3_f64, |most, e| most.max(e.abs()));
            let [moved, as_it_is] = [moved, as_it_is].map(|track| {
                let estimate = track.estimate().expect("an estimate");
                estimate.parameters().map(|p| p.value.expect("a value")).collect::<Vec<_>>()
            });
            let found: [f64; 3] = std::array::from_fn(|i| (moved[i] - as_it_is[i]) / size);
            // What a first frame owes to its motion is not known yet.
            let tolerance = if l == 5 { 0.1 } else { 0.02 };
            let is_near = (0..3).all(|i| (found[i] - expected[i]).abs() < tolerance * scale);
            assert!(is_near, "{l}: {found:?} {expected:?}");
        }
    }

    #[test]
    fn sensitivities_stay_bounded_while_the_motion_is_known_from_few_frames() {
        // Variances that make every frame correct all, most, and some of the motion.
        for variance in [1.0, 1e-3, 1e-6, 1e-8] {
            let track = tracked(0.0, 0, (120, [variance; 2]));
            let largest = track.sensitivity.state.amax();
            // A unit of growth moves points by about their distance times the six seconds that have passed.
            println!("{variance}: {largest}");
            assert!(largest < 20.0, "{variance}: {largest}");
        }
    }

    /// Whether a frame that agrees passes with a noise, where so much is the limit; image lengths.
    fn accepts(track: &Track, noise: f64, largest: f64) -> bool {
        let gate = Gate { smallest_agreement: 0.5, largest_innovation: None, largest_noise: Some(largest) };
        let unsolved = FrameMeasurement::unsolved(1);
        let of_frame = FrameMeasurement { agreement: 1.0, innovation: 0.0, noise: Some(noise), ..unsolved };
        track.verdict(&gate, &of_frame).is_ok()
    }

    #[test]
    fn points_may_scatter_more_where_outlines_do_what_the_motion_model_leaves_out() {
        let [sheared, plain] = [0.02, 0.0].map(|size| tracked(size, 1, (40, [1e-4; 2])));
        let displacement = sheared.unmodelled_estimate().displacement_of_points();
        assert!(displacement > 0.5 * sheared.noise.sigma, "{displacement} {}", sheared.noise.sigma);
        for (track, is_more_accepted) in [(&sheared, true), (&plain, false)] {
            let largest = track.largest_noise();
            let outline_of_another = 1.01 * LARGEST * track.reference().radius / largest;
            let found = [0.99, 1.1, outline_of_another].map(|ratio| accepts(track, ratio * largest, largest));
            assert_eq!(found, [true, is_more_accepted, false]);
        }
    }

    #[test]
    fn a_limit_that_allows_for_more_than_the_noise_is_widened_by_the_displacement_alone() {
        let track = tracked(0.02, 1, (40, [1e-4; 2]));
        let (radius, sigma) = (track.reference().radius, track.noise.sigma);
        let displacement = track.unmodelled_estimate().displacement_of_points();
        let largest = 3.0 * LARGEST_RATIO * sigma;
        let widened = largest.hypot(LARGEST_RATIO * displacement);
        assert!(1.01 * widened < LARGEST, "{widened}");
        for (noise, is_accepted) in [(0.99 * widened, true), (1.01 * widened, false)] {
            let found = accepts(&track, noise * radius, largest * radius);
            assert_eq!(found, is_accepted, "{noise} {largest} {displacement}");
        }
    }
}
