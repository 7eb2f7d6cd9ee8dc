//! The frames of one run, and the truth.
use freeform_curve_fit::{OpenArc, OpenOutline, Outline, PixelGrid};
use freeform_motion::outline_io::{GrayImage, Threshold, TraceSettings, trace_mask};
use freeform_riccati::MotionModel;
use freeform_sim_camera::{Mask, Shape};
use nalgebra::{Matrix2, Point2, Rotation2, Vector2};
use rand::{Rng, RngExt as _};
use std::f64::consts::TAU;

use super::course::Motion;
use super::fault::{Fault, FaultInTime, add_noise};
use super::recipe::{Deformation, Depth, Recipe, Sampling, Sensing};
use super::rigid_poses::RigidPoses;
use super::stretch::Stretch;
use super::view::View;
use crate::ExperimentError;
use crate::monte_carlo::suite::SHAPES;

/// Points that stand for the whole contour.
const DENSE: usize = 720;

/// Pixels about an object in its picture.
const MARGIN: f64 = 6.0;

/// A frame of a run.
#[derive(Debug, Clone)]
pub(super) struct SeenFrame {
    pub(super) index: usize,
    /// In the unit of the recipe.
    pub(super) time: f64,
    /// `None` where what is seen is no outline.
    pub(super) outline: Option<Outline>,
}

/// The truth at the last frame, in the units of the recipe.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Truth {
    /// Of the turn in the plane of the object.
    pub(super) omega: f64,
    /// Rate of growth of the picture.
    pub(super) growth: f64,
    /// How the velocity in the picture of the plane of the object changes with the place, where the origin of the picture is.
    pub(super) linear: Matrix2<f64>,
    /// Velocity in the picture of the plane of the object where the origin of the picture is.
    pub(super) b: Vector2<f64>,
    /// Velocity of the middle of the object.
    pub(super) middle: Vector2<f64>,
}

/// One run of a kind.
#[derive(Debug)]
pub(super) struct Sequence<'a> {
    recipe: &'a Recipe,
    model: MotionModel,
    contour: Shape,
    motion: Motion,
    stretch: Stretch,
    view: View,
    /// Turn of the contour at time 0.
    first_turn: f64,
    faults: Vec<FaultInTime>,
    /// Where the edge of each fault lies that has one.
    edges: Vec<Option<f64>>,
}

impl<'a> Sequence<'a> {
    /// Draws what is a matter of chance, the motion from a family.
    pub(super) fn new(recipe: &'a Recipe, model: MotionModel, rng: &mut impl Rng) -> Result<Self, ExperimentError> {
        let contour = recipe.body.contour(rng)?;
        let motion = recipe.course.draw(rng)?;
        let stretch = Stretch::draw(model, motion.fixed_point().unwrap_or_else(Point2::origin), rng)?;
        let view = match recipe.view {
            View::Tilted { angle, distance, .. } => View::Tilted { angle, axis: rng.random_range(0.0..TAU), distance },
            other => other,
        };
        let first_turn = rng.random_range(0.0..TAU);
        let faults = recipe.faults.iter().map(|fault| FaultInTime::new(*fault, recipe.points, rng)).collect();
        let mut sequence =
            Self { recipe, model, contour, motion, stretch, view, first_turn, faults, edges: Vec::new() };
        let half_way = sequence.points(recipe.time(recipe.frames / 2), &dense_places(), None);
        sequence.edges = sequence.faults.iter().map(|fault| fault.edge(&half_way)).collect();
        Ok(sequence)
    }

    /// The truth at the time of a frame. Bending about the middle has no part in it, nor has growth about the middle in a rigid motion.
    pub(super) fn truth(&self, frame: usize) -> Truth {
        let time = self.recipe.time(frame);
        let per_time = 1.0 / self.recipe.time_unit;
        let per_velocity = self.recipe.length_unit * per_time;
        let velocity = |point: &Point2<f64>| self.motion.velocity_at(time, point);
        let (omega, middle) = (self.motion.trajectory.omega(time), self.motion.middle(time));
        let own_growth = match (self.model, self.recipe.deformation) {
            (MotionModel::Rigid, _) => 0.0,
            (_, Deformation::Growth(rate)) => rate,
            _ => 0.0,
        };
        let Stretch { linear, growth, centre } = self.stretch;
        let scale = self.stretch.scale(time);
        // x' = rates x + offset in the plane of the object, and y' = (rates + growth) y + offset of y = centre + scale (x - centre).
        let rates = Matrix2::new(own_growth, omega, -omega, own_growth);
        let grown = rates + Matrix2::identity() * growth;
        let offset_in_plane = velocity(&Point2::origin()) - own_growth * middle.coords;
        let offset = scale * (rates * centre.coords + offset_in_plane) - grown * centre.coords;
        let of_middle = growth * scale * (middle - centre) + scale * velocity(&middle);
        let to_picture = self.view.derivative_at_origin() * linear;
        let back = to_picture.try_inverse().unwrap_or_else(Matrix2::zeros);
        Truth {
            omega: omega * per_time,
            growth: (growth + own_growth) * per_time,
            linear: to_picture * grown * back * per_time,
            b: to_picture * offset * per_velocity,
            middle: to_picture * of_middle * per_velocity,
        }
    }

    /// The truth of its poses; `None` where the body has no rigid pose in the picture, or the picture as a whole is shifted.
    pub(super) fn poses(&self) -> Option<RigidPoses> {
        let is_rigid = self.model == MotionModel::Rigid && self.recipe.deformation == Deformation::None;
        let is_shifted = self.faults.iter().any(|fault| matches!(fault.fault, Fault::Shake { .. }));
        (is_rigid && self.recipe.view == View::Flat && !is_shifted).then(|| RigidPoses::new(self.recipe, self.motion))
    }

    /// Where the middle of the object is in the picture.
    #[cfg(test)]
    fn place_in_picture(&self, time: f64) -> Vector2<f64> {
        self.view.image(&self.stretch.image(time, &self.motion.middle(time))).coords
    }

    /// The first so many frames in order.
    pub(super) fn frames(mut self, count: usize, rng: &mut impl Rng) -> Vec<SeenFrame> {
        let mut frames = Vec::with_capacity(count);
        for index in 0..count {
            if index > 0 {
                self.faults.iter_mut().for_each(|fault| fault.advance(rng));
            }
            let is_dropped = self.chance(rng, |fault| match fault {
                Fault::DroppedFrames { share } => share,
                _ => 0.0,
            });
            // The truth is that at the last frame, which is always there.
            if is_dropped && index + 1 < count {
                continue;
            }
            let time = self.recipe.time(index);
            let outline = match self.recipe.sensing {
                Sensing::Points => self.by_points(time, rng),
                Sensing::Traced { pixels, depth } => self.by_picture(time, pixels, depth),
            };
            frames.push(SeenFrame { index, time: time * self.recipe.time_unit, outline });
        }
        frames
    }

    /// Whether something happens in this frame that a fault gives a probability.
    fn chance(&self, rng: &mut impl Rng, probability: impl Fn(Fault) -> f64) -> bool {
        let probability: f64 = self.faults.iter().map(|fault| probability(fault.fault)).sum();
        probability > 0.0 && rng.random::<f64>() < probability
    }

    fn by_points(&self, time: f64, rng: &mut impl Rng) -> Option<Outline> {
        let hidden: f64 =
            self.faults.iter().map(|f| if let Fault::HiddenArc { share } = f.fault { share } else { 0.0 }).sum();
        let start: f64 = if self.recipe.sampling == Sampling::Same { 0.0 } else { rng.random() };
        let places = places(self.recipe.sampling, self.recipe.points, start, 1.0 - hidden, rng);
        let is_wrong = self.chance(rng, |fault| match fault {
            Fault::WrongFrames { share } => share,
            _ => 0.0,
        });
        let other = is_wrong.then(|| {
            let shape = SHAPES[rng.random_range(0..SHAPES.len())].shape();
            (shape, Rotation2::new(rng.random_range(0.0..TAU)))
        });
        let mut points = self.points(time, &places, other.as_ref());
        for (fault, edge) in self.faults.iter().zip(&self.edges) {
            if let Some(edge) = edge {
                fault.close_along_edge(&mut points, *edge);
            }
        }
        add_noise(&mut points, self.recipe.noise, rng);
        self.faults.iter().for_each(|fault| fault.disturb(&mut points, rng));
        points.iter_mut().for_each(|point| *point *= self.recipe.length_unit);
        if hidden > 0.0 {
            return Some(Outline::Open(OpenOutline::new(vec![OpenArc::new(points).ok()?]).ok()?));
        }
        Outline::closed(points).ok()
    }

    /// The outline traced in a picture whose pixels stay where they are from frame to frame.
    fn by_picture(&self, time: f64, pixels: f64, depth: Depth) -> Option<Outline> {
        let outline = Outline::closed(self.points(time, &dense_places(), None)).ok()?;
        let area = outline.bounding_box();
        let [left, bottom] = [area.low.x, area.low.y].map(|value| (value * pixels).floor() - MARGIN);
        let [right, top] = [area.high.x, area.high.y].map(|value| (value * pixels).ceil() + MARGIN);
        let corner = Vector2::new(left, bottom) / pixels;
        let (width, height) = ((right - left) as usize, (top - bottom) as usize);
        let grid = PixelGrid::new([0.0, height as f64], Point2::from(corner), Vector2::new(1.0, -1.0) / pixels);
        let mask = Mask::of_outline(&outline, [width, height], &grid).ok()?;
        let mask = if depth == Depth::Binary { mask.binary() } else { mask };
        let picture = GrayImage::from_raw(u32::try_from(width).ok()?, u32::try_from(height).ok()?, mask.grey)?;
        let threshold = match depth {
            Depth::Grey | Depth::Binary => Threshold::default(),
            Depth::GreyAt(level) => Threshold::Level(level),
        };
        let settings = TraceSettings { pixel_size: 1.0 / pixels, threshold, ..TraceSettings::default() };
        let traced = trace_mask(&picture, &settings).ok()?;
        let points = traced.outline.points().map(|p| (p + corner) * self.recipe.length_unit).collect();
        Outline::closed(points).ok()
    }

    /// Where places of the contour are in the picture at a time, with all that is off across the contour; of another object in the
    /// same place, if there is one.
    fn points(&self, time: f64, places: &[f64], other: Option<&(Shape, Rotation2<f64>)>) -> Vec<Point2<f64>> {
        let turned = Rotation2::new(self.first_turn);
        let point = |place: &f64| {
            let (shape, own) = other.map_or((&self.contour, turned), |(shape, own)| (shape, *own));
            let body = own * self.deformed(time, &shape.point_at(*place));
            let normal = own * shape.normal_at(*place).into_inner();
            let seen_at = |time: f64| self.in_picture(time, *place, &body, &normal);
            let image = seen_at(time);
            match self.view.delay(&image) {
                0.0 => image,
                delay => seen_at(time + delay),
            }
        };
        places.iter().map(point).collect()
    }

    /// A point of the body at a time.
    fn deformed(&self, time: f64, p: &Point2<f64>) -> Point2<f64> {
        match self.recipe.deformation {
            Deformation::None => *p,
            Deformation::Growth(rate) => p * (rate * time).exp(),
            Deformation::Bending { sag, period } => {
                p + Vector2::new(0.0, sag * (TAU * time / period).sin() * (2.0 * p.x).powi(2))
            }
        }
    }

    /// A point of the body with its normal, both turned as at time 0, in the picture.
    fn in_picture(&self, time: f64, place: f64, body: &Point2<f64>, normal: &Vector2<f64>) -> Point2<f64> {
        let pose = self.motion.trajectory.pose(time);
        let normal = self.stretch.normal(&(pose.matrix().fixed_view::<2, 2>(0, 0) * normal));
        let across: f64 = self.faults.iter().map(|fault| fault.across(place, &normal)).sum();
        let plane = pose * (self.motion.place + body.coords);
        self.view.image(&(self.stretch.image(time, &plane) + across * normal))
    }
}

/// The whole contour.
fn dense_places() -> Vec<f64> {
    (0..DENSE).map(|k| k as f64 / DENSE as f64).collect()
}

/// Increasing places on the visible part of a contour, which begins at `start`, fractions of the perimeter.
fn places(sampling: Sampling, points: usize, start: f64, visible: f64, rng: &mut impl Rng) -> Vec<f64> {
    let count = (visible * points as f64).round() as usize;
    let mut places: Vec<f64> = match sampling {
        Sampling::Same => (0..count).map(|k| k as f64 / count as f64).collect(),
        Sampling::Stratified => (0..count).map(|k| (k as f64 + rng.random::<f64>()) / count as f64).collect(),
        Sampling::Independent => (0..count).map(|_| rng.random()).collect(),
    };
    places.sort_by(f64::total_cmp);
    places.into_iter().map(|place| start + visible * place).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stress::course::{Course, Path};
    use crate::stress::{Kind, all_kinds, kinds_containing};
    use rand::SeedableRng as _;
    use rand_chacha::ChaCha8Rng;

    fn frames(recipe: &Recipe, seed: u64) -> (Truth, Vec<SeenFrame>) {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let sequence = Sequence::new(recipe, MotionModel::Rigid, &mut rng).expect("a sequence");
        (sequence.truth(recipe.frames - 1), sequence.frames(recipe.frames, &mut rng))
    }

    fn kind(path: &str) -> Kind {
        kinds_containing(path).expect("a kind").into_iter().next().expect("a kind")
    }

    #[test]
    fn every_kind_makes_outlines_from_the_first_frame_to_the_last() {
        for kind in all_kinds() {
            let last = kind.recipe.frames.min(6);
            let recipe = Recipe { frames: last, ..kind.recipe.clone() };
            let (truth, seen) = frames(&recipe, 4);
            assert!(truth.omega.is_finite() && truth.b.iter().all(|b| b.is_finite()), "{}", kind.path());
            assert_eq!(seen.last().map(|frame| frame.index), Some(last - 1), "{}", kind.path());
            assert!(seen.iter().all(|frame| frame.outline.is_some()), "{}", kind.path());
        }
    }

    #[test]
    fn the_truth_is_what_exact_outlines_do_at_the_last_frame() {
        // A disc by dense points: the mean of its points is its middle.
        let course = Course {
            omega: (1.0, 2.0),
            speed: (0.3, 0.5),
            start: 1.0,
            path: Path::Accelerating { spin: 0.5, middle: 0.3 },
        };
        let disc = Recipe {
            body: super::super::body::Body::Circle,
            course,
            noise: 0.0,
            points: 2000,
            sampling: Sampling::Same,
            ..Recipe::plain()
        };
        let recipe = Recipe { frames: 400, fps: 400.0, length_unit: 10.0, time_unit: 0.1, ..disc };
        let (truth, seen) = frames(&recipe, 9);
        let middle = |frame: &SeenFrame| frame.outline.as_ref().expect("an outline").centroid();
        let [.., before, last] = &seen[..] else { panic!("frames") };
        let velocity = (middle(last) - middle(before)) / (last.time - before.time);
        assert!((velocity - truth.middle).norm() < 0.01 * truth.middle.norm(), "{velocity} {}", truth.middle);
        let there = middle(last);
        let by_generator = truth.b + truth.omega * Vector2::new(there.y, -there.x);
        assert!((by_generator - truth.middle).norm() < 1e-2 * truth.middle.norm());
    }

    #[test]
    fn a_point_of_a_contour_without_symmetry_turns_by_the_true_omega() {
        let recipe =
            Recipe { noise: 0.0, sampling: Sampling::Same, frames: 30, ..kind("dynamics/spin grows by 3").recipe };
        let (truth, seen) = frames(&recipe, 2);
        let heading = |frame: &SeenFrame| {
            let outline = frame.outline.as_ref().expect("an outline");
            let first = outline.points().next().expect("a point");
            let d = first - outline.centroid();
            d.y.atan2(d.x)
        };
        let [.., before, last] = &seen[..] else { panic!("frames") };
        let turn = (heading(before) - heading(last) + TAU / 2.0).rem_euclid(TAU) - TAU / 2.0;
        // The mean over the last step is half a step before its end.
        let omega = turn / (last.time - before.time) + 0.5 * 3.0 * truth.omega.signum() / 30.0;
        assert!((omega - truth.omega).abs() < 1e-6, "{omega} {}", truth.omega);
    }

    #[test]
    fn the_truth_of_every_family_is_what_points_of_an_exact_outline_do() {
        let own =
            Recipe { noise: 0.0, sampling: Sampling::Same, points: 600, frames: 401, fps: 400.0, ..Recipe::plain() };
        let straight = Course { path: Path::Velocity, ..own.course };
        let recipes = [
            own.clone(),
            Recipe { course: straight, ..own.clone() },
            Recipe { length_unit: 10.0, time_unit: 0.1, ..own.clone() },
            Recipe { deformation: Deformation::Growth(-0.2), ..own },
        ];
        let aspect = Recipe { view: View::Aspect(0.1), ..recipes[0].clone() };
        for (model, recipes) in [
            (MotionModel::Similarity, &recipes[..]),
            (MotionModel::Affine, &recipes[..]),
            (MotionModel::Affine, std::slice::from_ref(&aspect)),
        ] {
            for recipe in recipes {
                let mut rng = ChaCha8Rng::seed_from_u64(8);
                let sequence = Sequence::new(recipe, model, &mut rng).expect("a sequence");
                // Central differences about the last frame but one.
                let truth = sequence.truth(recipe.frames - 2);
                let middle = sequence.place_in_picture(recipe.time(recipe.frames - 2)) * recipe.length_unit;
                let seen = sequence.frames(recipe.frames, &mut rng);
                let [.., before, between, last] = &seen[..] else { panic!("frames") };
                let points = |frame: &SeenFrame| {
                    frame.outline.as_ref().expect("an outline").points().copied().collect::<Vec<_>>()
                };
                let [first, second, third] = [before, between, last].map(points);
                for ((p, q), r) in first.iter().zip(&second).zip(&third) {
                    let velocity = (r - p) / (last.time - before.time);
                    let by_truth = truth.linear * q.coords + truth.b;
                    assert!((velocity - by_truth).norm() < 1e-4 * by_truth.norm(), "{model} {velocity} {by_truth}");
                }
                let of_middle = truth.linear * middle + truth.b;
                let own_growth = match recipe.deformation {
                    Deformation::Growth(rate) => rate,
                    _ => 0.0,
                };
                assert!((of_middle - truth.middle).norm() < 1e-9 * of_middle.norm(), "{model} {of_middle}");
                let is_growing = truth.growth * recipe.time_unit - own_growth;
                assert!(is_growing.abs() > 0.009 && is_growing.abs() < 0.11, "{model} {}", truth.growth);
                if model == MotionModel::Similarity {
                    let [half_trace, turn] = [truth.linear.trace() / 2.0, truth.linear.m12];
                    assert!((half_trace - truth.growth).abs() < 1e-12 && (turn - truth.omega).abs() < 1e-12);
                }
            }
        }
    }

    #[test]
    fn the_same_seed_makes_the_same_frames_and_another_one_others() {
        let recipe = kind("plain/everything").recipe;
        let points = |seed| frames(&recipe, seed).1[20].outline.as_ref().expect("an outline").centroid();
        assert_eq!(points(1), points(1));
        assert_ne!(points(1), points(2));
    }
}
