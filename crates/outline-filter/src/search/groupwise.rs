//! Groupwise registration: several frames of a rigid body aligned together, so that the points of all of them lie on one contour.
//!
//! The chords between a dozen points of one frame are no outline that the next frame could be compared with: what they cut off is more than a turn
//! moves. Points of several frames tell the outline, once the frames are aligned; and they are aligned best where they make the smoothest contour.
use std::f64::consts::{FRAC_PI_2, TAU};

use freeform_riccati::map_point;
use nalgebra::{Matrix3, Matrix3x2, Point2, Rotation2, Vector2, Vector3};

use crate::{
    map::centroid_within,
    track::{turn_between, wrapped},
    tuning::groupwise as tuning,
};

/// Time and points of a frame, in their order around.
pub(crate) type TimedPoints = (f64, Vec<Point2<f64>>);

/// Frames that have been aligned.
#[derive(Debug, Clone)]
pub(crate) struct Aligned {
    /// From where the object was in the first frame to where it is in each.
    pub(crate) poses: Vec<Matrix3<f64>>,
    /// The points of all frames, where they were in the first, in their order around.
    pub(crate) contour: Vec<Point2<f64>>,
}

/// How the centroid moves.
#[derive(Debug, Clone, Copy)]
enum Path {
    /// With a constant acceleration.
    Bent(Vector2<f64>),
    /// Its velocity turns along with the body, as in a constant rigid motion.
    Arc,
}

/// A motion about the centroid, by its rates in the middle of the time: an angular velocity, anticlockwise where y points up, and a velocity.
#[derive(Debug, Clone, Copy)]
struct Motion {
    spin: f64,
    velocity: Vector2<f64>,
    path: Path,
}

/// Rates of a motion that are refined, along an axis.
#[derive(Debug, Clone, Copy)]
enum Rate {
    Spin,
    Velocity(usize),
    Acceleration(usize),
}

const RATES: [Rate; 5] =
    [Rate::Spin, Rate::Velocity(0), Rate::Velocity(1), Rate::Acceleration(0), Rate::Acceleration(1)];

impl Motion {
    /// With another rate, by a step that moves points of a body of such a radius by as much as it turns them, at the ends of the time for an
    /// acceleration; `None` where the path does not have it.
    fn stepped(mut self, rate: Rate, step: f64, (radius, span): (f64, f64)) -> Option<Self> {
        match (rate, &mut self.path) {
            (Rate::Spin, _) => self.spin += step,
            (Rate::Velocity(axis), _) => self.velocity[axis] += step * radius,
            (Rate::Acceleration(axis), Path::Bent(acceleration)) => acceleration[axis] += 4.0 * step * radius / span,
            (Rate::Acceleration(_), Path::Arc) => return None,
        }
        Some(self)
    }

    /// How far the centroid has moved since the middle of the time.
    fn displacement(&self, time: f64) -> Vector2<f64> {
        let turn = self.spin * time;
        match self.path {
            Path::Arc if turn.abs() > f64::EPSILON => {
                let across = Rotation2::new(FRAC_PI_2) * self.velocity;
                (turn.sin() * self.velocity + (1.0 - turn.cos()) * across) / self.spin
            }
            Path::Arc => time * self.velocity,
            Path::Bent(acceleration) => time * self.velocity + 0.5 * time * time * acceleration,
        }
    }
}

/// What is looked at: points of all frames, and the centroid of each.
struct Group<'a> {
    frames: &'a [TimedPoints],
    /// Since the middle of the time.
    times: Vec<f64>,
    /// From the first to the last.
    span: f64,
    centroids: Vec<Point2<f64>>,
    radius: f64,
    around: Vec<Place>,
}

/// A point about the centroid.
#[derive(Debug, Clone, Copy)]
struct Place {
    angle: f64,
    distance: f64,
    point: Point2<f64>,
}

/// Frames of a closed outline that is seen as a whole, aligned by the rigid motion that makes the smoothest contour of their points. `None` where no
/// turn is clearly better than all others, as of a circle, or of a symmetric body. A contour that runs to and fro as seen from the centroid makes no
/// smooth one, so that hardly any turn is.
pub(crate) fn aligned(frames: &[TimedPoints]) -> Option<Aligned> {
    let mut group = Group::new(frames)?;
    let (best, gain) = group.best_turn()?;
    if gain <= tuning::BETTER || group.is_symmetric(&best) {
        return None;
    }
    let [(arc, of_arc), (bent, of_bent)] = [Path::Arc, best.path].map(|path| group.refined(Motion { path, ..best }));
    group.placed(if of_arc <= of_bent { &arc } else { &bent })
}

impl<'a> Group<'a> {
    fn new(frames: &'a [TimedPoints]) -> Option<Self> {
        let (first, last) = (frames.first()?.0, frames.last()?.0);
        let middle = 0.5 * (first + last);
        let centroids: Vec<_> = frames.iter().map(|(_, points)| centroid_within(points)).collect::<Option<_>>()?;
        let all =
            frames.iter().zip(&centroids).flat_map(|((_, points), centre)| points.iter().map(move |p| p - centre));
        let squares: Vec<f64> = all.map(|from| from.norm_squared()).collect();
        let radius = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
        let times = frames.iter().map(|(time, _)| time - middle).collect();
        Some(Self { frames, times, span: last - first, centroids, radius, around: Vec::with_capacity(squares.len()) })
    }

    /// The turn that makes the smoothest contour, and the logarithm of the likelihood by which it is better than all others. A path that bends says
    /// nothing of it: the outline alone does.
    fn best_turn(&mut self) -> Option<(Motion, f64)> {
        let (velocity, path) = self.path()?;
        let largest = tuning::LARGEST_TURN * (self.frames.len() - 1) as f64;
        let steps = (largest / tuning::STEP).ceil() as i32;
        let span = self.span;
        let of_turn = |step: i32| Motion { spin: f64::from(step) * tuning::STEP / span, velocity, path };
        let tried: Vec<(Motion, f64)> =
            (-steps..=steps).map(of_turn).map(|motion| (motion, self.scatter(&motion))).collect();
        let finite = tried.iter().filter(|(_, scatter)| scatter.is_finite());
        let (best, scatter) = *finite.min_by(|(_, a), (_, b)| a.total_cmp(b))?;
        let others = tried.iter().filter(|(other, _)| (other.spin - best.spin).abs() * span > tuning::ANOTHER);
        let of_others = others.map(|(_, scatter)| *scatter).reduce(f64::min)?;
        // Without noise the scatter may be none, and the gain is infinite.
        (of_others > 0.0).then(|| (best, 0.5 * self.around.len() as f64 * (of_others / scatter).ln()))
    }

    /// Whether the contour that a motion makes is about the same after a part of a whole turn: turns faster by that from frame to frame explain it as
    /// well.
    fn is_symmetric(&mut self, motion: &Motion) -> bool {
        let scatter = self.scatter(motion);
        let count = self.around.len();
        let distance_at = |angle: f64| {
            let angle = wrapped(angle);
            let next = self.around.partition_point(|place| place.angle < angle);
            let [before, after] = [self.around[(next + count - 1) % count], self.around[next % count]];
            let [along, whole] = [angle - before.angle, after.angle - before.angle].map(|part| part.rem_euclid(TAU));
            let share = if whole > 0.0 { along / whole } else { 0.5 };
            before.distance + share * (after.distance - before.distance)
        };
        (2..=tuning::LARGEST_ORDER).any(|order| {
            let differs = |place: &Place| (place.distance - distance_at(place.angle + TAU / order as f64)).powi(2);
            let mean = self.around.iter().map(differs).sum::<f64>() / count as f64;
            mean < tuning::SYMMETRIC * scatter
        })
    }

    /// The velocity in the middle of the time, and the acceleration, by which the centroids move, in the least-squares sense.
    fn path(&self) -> Option<(Vector2<f64>, Path)> {
        let rows = self.times.iter().map(|time| Vector3::new(1.0, *time, 0.5 * time * time));
        let gram: Matrix3<f64> = rows.clone().map(|row| row * row.transpose()).sum();
        let moments: Matrix3x2<f64> =
            rows.zip(&self.centroids).map(|(row, centre)| row * centre.coords.transpose()).sum();
        let path = gram.cholesky()?.solve(&moments);
        Some((path.row(1).transpose(), Path::Bent(path.row(2).transpose())))
    }

    /// The centroid in the middle of the time.
    fn centre(&self, motion: &Motion) -> Vector2<f64> {
        let at = self.times.iter().zip(&self.centroids).map(|(time, c)| c.coords - motion.displacement(*time));
        at.sum::<Vector2<f64>>() / self.times.len() as f64
    }

    /// Puts all points where they are about the centroid in the middle of the time, in order around.
    fn merge(&mut self, motion: &Motion) {
        let centre = self.centre(motion);
        self.around.clear();
        for ((_, points), time) in self.frames.iter().zip(&self.times) {
            let (back, moved) = (Rotation2::new(-motion.spin * time), centre + motion.displacement(*time));
            self.around.extend(points.iter().map(|p| {
                let point = back * Point2::from(p.coords - moved);
                Place { angle: point.y.atan2(point.x), distance: point.coords.norm(), point }
            }));
        }
        self.around.sort_unstable_by(|a, b| a.angle.total_cmp(&b.angle));
    }

    /// How much farther out points are than a line through their neighbours has it, over the angle: the mean of the squares, each divided by the
    /// variance that unit noise of the points gives it. Distances from a chord would fall where two neighbours are nearly one, as its direction is
    /// noise then.
    fn scatter(&mut self, motion: &Motion) -> f64 {
        self.merge(motion);
        let (count, far) = (self.around.len(), (tuning::FAR * self.radius).powi(2));
        let at = |i: usize| {
            let Place { angle, distance, .. } = self.around[i % count];
            (if i < count { angle } else { angle + TAU }, distance)
        };
        let square = |i: usize| {
            let [(from, before), (angle, here), (to, after)] = [at(i), at(i + 1), at(i + 2)];
            let along = if to > from { (angle - from) / (to - from) } else { 0.5 };
            let farther = here - (1.0 - along) * before - along * after;
            farther.powi(2) / (1.0 + along.powi(2) + (1.0 - along).powi(2))
        };
        (0..count).map(|i| square(i).min(far)).sum::<f64>() / count as f64
    }

    /// A motion near another which makes the smoothest contour, and its scatter: by steps in each rate that are halved where none is better.
    fn refined(&mut self, mut motion: Motion) -> (Motion, f64) {
        let span = self.span;
        let mut least = self.scatter(&motion);
        let mut size = tuning::STEP / span;
        for _ in 0..tuning::HALVINGS {
            for _ in 0..tuning::STEPS_OF_A_SIZE {
                let before = least;
                for (rate, step) in RATES.iter().flat_map(|rate| [(*rate, size), (*rate, -size)]) {
                    let Some(other) = motion.stepped(rate, step, (self.radius, span)) else { continue };
                    let scatter = self.scatter(&other);
                    if scatter < least {
                        (motion, least) = (other, scatter);
                    }
                }
                if least >= before {
                    break;
                }
            }
            size *= 0.5;
        }
        (motion, least)
    }

    /// Poses and contour, as a motion places them.
    fn placed(&mut self, motion: &Motion) -> Option<Aligned> {
        self.merge(motion);
        let centre = self.centre(motion);
        let pose = |time: &f64| {
            let moved = centre + motion.displacement(*time);
            turn_between(motion.spin * time, &Vector2::zeros(), &moved)
        };
        let poses: Vec<Matrix3<f64>> = self.times.iter().map(pose).collect();
        let to_first = *poses.first()?;
        let from_first = to_first.try_inverse()?;
        let contour = self.around.iter().map(|place| map_point(&to_first, &place.point)).collect();
        Some(Aligned { poses: poses.iter().map(|pose| pose * from_first).collect(), contour })
    }
}

#[cfg(test)]
mod tests {
    use rand::{RngExt as _, SeedableRng as _};
    use rand_chacha::ChaCha8Rng;
    use rand_distr::StandardNormal;

    use super::*;
    use crate::drawn_curves::{lobed, polar};

    const NOISE: f64 = 0.004;

    /// Frames, 30 a second, of points of a body in constant motion, one anywhere in each of so many parts of it; and its poses.
    fn frames_of(
        (count, points): (u8, u8),
        lobes: &[(f64, [f64; 2])],
        (spin, velocity): (f64, Vector2<f64>),
        seed: u64,
    ) -> (Vec<TimedPoints>, Vec<Matrix3<f64>>) {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let seen = |frame: u8| {
            let time = f64::from(frame) / 30.0;
            let pose = turn_between(spin * time, &Vector2::zeros(), &(time * velocity));
            let point = |i: u8| {
                let t = TAU * (f64::from(i) + random.random::<f64>()) / f64::from(points);
                let noise = Vector2::from_fn(|_, _| NOISE * random.sample::<f64, _>(StandardNormal));
                map_point(&pose, &polar(lobed(t, lobes), t)) + noise
            };
            ((time, (0..points).map(point).collect()), pose)
        };
        (0..count).map(seen).unzip()
    }

    #[test]
    fn frames_of_a_dozen_points_each_are_aligned_as_the_body_has_moved() {
        let lobes = [(2.0, [0.1, 0.05]), (3.0, [0.0, 0.1]), (5.0, [0.04, 0.0])];
        for (seed, spin) in [-6.0, -1.2, 0.0, 0.4, 2.5, 9.0].into_iter().enumerate() {
            let (frames, truth) = frames_of((8, 12), &lobes, (spin, Vector2::new(0.7, -0.4)), seed as u64);
            let Aligned { poses, contour } = aligned(&frames).expect("a clear turn");
            assert_eq!((poses.len(), contour.len()), (8, 96));
            for (pose, truth) in poses.iter().zip(&truth) {
                let off = pose - truth;
                assert!(off.amax() < 0.05, "{spin}: {off}");
            }
            // On the curve, by its distance from the middle.
            let distance = |p: &Point2<f64>| p.coords.norm() - lobed(p.y.atan2(p.x), &lobes);
            let mean = (contour.iter().map(|p| distance(p).powi(2)).sum::<f64>() / 96.0).sqrt();
            assert!(mean < 4.0 * NOISE, "{spin}: {mean}");
        }
    }

    #[test]
    fn frames_of_a_symmetric_body_are_not_aligned_as_a_faster_turn_does_it_as_well() {
        for order in [2, 3, 4, 6] {
            let lobes = [(f64::from(order), [0.15, 0.0])];
            for seed in 0..4 {
                let spin = 30.0 * TAU / f64::from(order) - 6.0;
                let (frames, _) = frames_of((8, 12), &lobes, (spin, Vector2::new(0.7, -0.4)), seed);
                assert!(aligned(&frames).is_none(), "{order} {seed}");
            }
        }
    }

    #[test]
    fn outlines_that_repeat_each_other_to_the_last_digit_are_aligned_at_rest() {
        let lobes = [(2.0, [0.1, 0.05]), (3.0, [0.0, 0.1])];
        let (mut frames, _) = frames_of((8, 12), &lobes, (0.0, Vector2::zeros()), 1);
        let first = frames[0].1.clone();
        frames.iter_mut().for_each(|(_, points)| points.clone_from(&first));
        let aligned = aligned(&frames).expect("a clear turn");
        assert!(aligned.poses.iter().all(|pose| (pose - Matrix3::identity()).amax() < 1e-9));
    }

    #[test]
    fn the_frames_of_a_circle_are_not_aligned_by_chance() {
        let gains = (0..200_u64).map(|seed| {
            let (points, frames) = ([8, 12, 20][seed as usize % 3], tuning::OCCASIONS[seed as usize % 2] as u8);
            let (frames, _) = frames_of((frames, points), &[], (1.0, Vector2::new(0.7, -0.4)), seed);
            assert!(aligned(&frames).is_none(), "{seed}");
            Group::new(&frames).and_then(|mut group| group.best_turn()).map_or(0.0, |(_, gain)| gain)
        });
        let largest = gains.fold(0.0, f64::max);
        println!("{largest}");
        assert!(largest < 0.6 * tuning::BETTER, "{largest}");
    }
}
