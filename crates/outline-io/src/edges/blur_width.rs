//! How wide the edges of a contour are: alike in all directions by the optics, wider across the path of a body that moves while the shutter is open.
use std::f64::consts::TAU;
use std::sync::LazyLock;

use nalgebra::{Matrix3, Point2, Vector2, Vector3};

use super::sampler::Sampler;
use super::step_fit::{Offsets, SPACING, normal_cdf};
use super::{Edge, SMALLEST_STEP, median};

/// Points whose profiles tell the width.
const PROFILES: usize = 96;

/// How far from the edge the profiles reach, in pixels: at first, and where edges are too wide for that.
const REACH: f64 = 7.0;
const FARTHER: f64 = 24.0;

/// Least and largest width told apart, and the step between widths tried, in pixels. Profiles that reach twice the width tell a place.
const WIDTHS: [f64; 3] = [0.5, 4.0, 0.1];
const WIDER: [f64; 3] = [3.0, 9.0, 0.5];

/// Directions of normals that are looked at apart, all the way round: a width changes little over 30 degrees. The fewest profiles of one whose median
/// leaves out one that shows something else, and the fewest directions, which leave one to check the three numbers of a blur by.
const DIRECTIONS: usize = 12;
const FEWEST_PROFILES: usize = 4;
const FEWEST_DIRECTIONS: usize = 4;

/// Variance of the cosine and sine of twice the direction, over the profiles, from which on directions tell a blur by direction: 1 of all directions,
/// or of the four sides of a square, next to none of the sides of a thin bar.
const SPREAD: f64 = 0.2;

/// The blur differs by direction where its variance does so by this share of its mean either way, so that the wider edges are 1.4 times as wide:
/// those of optics and grids differ by less. And by so many of its deviations, which are told by how well widths of all directions, opposite ones
/// among them, agree with one motion: shadows and light beside the body are seen on one side.
const DIFFERS: f64 = 0.35;
const CLEARLY: f64 = 4.0;

/// Share of a variance that widths of a direction are known to at best: a step of 0.1 between widths tried, by parabolas.
const KNOWN_TO: f64 = 0.03;

/// Share of the weight of all profiles that directions which none of them tells are held at no difference by.
const HELD_BY: f64 = 1e-3;

/// Profiles of edges that rise inwards, with their normals.
type Rising = Vec<(Vector2<f64>, Vec<f64>)>;

/// Profiles at first, and where edges are too wide for these.
static NEAR: LazyLock<Profiles> = LazyLock::new(|| Profiles::new(REACH, WIDTHS));
static FAR: LazyLock<Profiles> = LazyLock::new(|| Profiles::new(FARTHER, WIDER));

/// The blur of the edges of a contour.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct EdgeBlur {
    /// Its variance in all directions, in square pixels.
    variance: f64,
    /// What the motion adds along the path of the body: its direction, by the standard deviation in pixels.
    by_motion: Vector2<f64>,
}

impl EdgeBlur {
    /// That of the step which fits the median of the profiles best, by direction where they differ clearly. `None` where no profile rises.
    pub(super) fn of(
        source: &Sampler,
        points: &[Point2<f64>],
        normals: &[Option<Vector2<f64>>],
        edges: &[Edge],
    ) -> Option<Self> {
        let typical = median(edges.iter().map(|edge| edge.height))?;
        let rises: Vec<usize> = (0..points.len())
            .filter(|&i| normals[i].is_some() && edges[i].height > SMALLEST_STEP * typical.max(1e-9))
            .collect();
        let step = rises.len().div_ceil(PROFILES).max(1);
        let places: Vec<(Point2<f64>, Vector2<f64>)> = rises
            .iter()
            .step_by(step)
            .filter_map(|&i| normals[i].map(|normal| (points[i] + edges[i].place * normal, normal)))
            .collect();
        let mut values = Vec::new();
        let mut rising = Rising::default();
        for &(at, normal) in &places {
            rising.extend(NEAR.take(source, at, normal, &mut values).map(|profile| (normal, profile)));
        }
        let width = NEAR.width(rising.iter().map(|(_, profile)| profile.as_slice()))?;
        let alike = Self { variance: width * width, by_motion: Vector2::zeros() };
        Some(Self::by_direction(source, &places, &rising).unwrap_or(alike))
    }

    /// By the widths of edges of several directions; `None` where they do not differ clearly.
    fn by_direction(source: &Sampler, places: &[(Point2<f64>, Vector2<f64>)], rising: &Rising) -> Option<Self> {
        let mut of_direction: [Vec<&(Vector2<f64>, Vec<f64>)>; DIRECTIONS] = Default::default();
        for edge in rising {
            of_direction[direction(&edge.0)].push(edge);
        }
        let enough = || (0..DIRECTIONS).filter(|&k| of_direction[k].len() >= FEWEST_PROFILES);
        if enough().count() < FEWEST_DIRECTIONS {
            return None;
        }
        let mut values = Vec::new();
        let mut widths: Vec<(Vector2<f64>, f64, f64)> = Vec::new();
        for k in enough() {
            let own = &of_direction[k];
            let mean = own.iter().map(|(normal, _)| *normal).sum::<Vector2<f64>>().normalize();
            let mut width = (NEAR.width(own.iter().map(|(_, profile)| profile.as_slice()))?, own.len());
            if width.0 >= WIDTHS[1] - WIDTHS[2] {
                let again = places.iter().filter(|(_, normal)| direction(normal) == k);
                let far: Vec<Vec<f64>> =
                    again.filter_map(|(at, normal)| FAR.take(source, *at, *normal, &mut values)).collect();
                if far.len() >= FEWEST_PROFILES {
                    width = (FAR.width(far.iter().map(Vec::as_slice))?, far.len());
                }
            }
            widths.push((mean, width.0, width.1 as f64));
        }
        Self::fitted(&widths)
    }

    /// The blur that widths across directions, with their weights, tell: `w^2 = n' S n`. `None` where it is about alike in all directions.
    fn fitted(widths: &[(Vector2<f64>, f64, f64)]) -> Option<Self> {
        // w^2 = a + b cos 2 phi + c sin 2 phi.
        let row =
            |normal: &Vector2<f64>| Vector3::new(1.0, normal.x.powi(2) - normal.y.powi(2), 2.0 * normal.x * normal.y);
        let total: f64 = widths.iter().map(|(.., weight)| weight).sum();
        let middle = widths.iter().map(|(normal, _, weight)| *weight * row(normal)).sum::<Vector3<f64>>() / total;
        let spread: f64 =
            widths.iter().map(|(normal, _, weight)| weight * (row(normal) - middle).norm_squared()).sum::<f64>()
                / total;
        let free = widths.len() as f64 - 3.0;
        if free < 1.0 || spread < SPREAD {
            return None;
        }
        let held = HELD_BY * total;
        let mut information = Matrix3::from_diagonal(&Vector3::new(0.0, held, held));
        let mut right = Vector3::zeros();
        for (normal, width, weight) in widths {
            information += *weight * row(normal) * row(normal).transpose();
            right += *weight * width.powi(2) * row(normal);
        }
        let inverse = information.try_inverse()?;
        let solution = inverse * right;
        let [mean, along, aslant] = [solution.x, solution.y, solution.z];
        let differs = along.hypot(aslant);
        if mean <= 0.0 || differs < DIFFERS * mean {
            return None;
        }
        let left: f64 = widths
            .iter()
            .map(|(normal, width, weight)| weight * (width.powi(2) - row(normal).dot(&solution)).powi(2))
            .sum();
        let unit = (left / free).sqrt().max(KNOWN_TO * mean * (total / widths.len() as f64).sqrt());
        let steepest = Vector3::new(0.0, along / differs, aslant / differs);
        let deviation = unit * steepest.dot(&(inverse * steepest)).max(0.0).sqrt();
        if differs < CLEARLY * deviation {
            return None;
        }
        let least = (mean - differs).max(WIDTHS[0].powi(2));
        let angle = 0.5 * aslant.atan2(along);
        let path = Vector2::new(angle.cos(), angle.sin());
        Some(Self { variance: least, by_motion: (mean + differs - least).max(0.0).sqrt() * path })
    }

    /// Width of an edge with this normal: the standard deviation of its Gaussian, in pixels.
    pub(super) fn across(&self, normal: &Vector2<f64>) -> f64 {
        (self.variance + normal.dot(&self.by_motion).powi(2)).sqrt()
    }

    /// Variance of the blur along an edge with this normal: all of it, and what the motion has of it.
    pub(super) fn along(&self, normal: &Vector2<f64>) -> [f64; 2] {
        let tangent = Vector2::new(-normal.y, normal.x);
        let of_motion = tangent.dot(&self.by_motion).powi(2);
        [self.variance + of_motion, of_motion]
    }

    /// How far the body moves while the shutter is open, in pixels: 0 where edges are alike in all directions.
    pub(super) fn motion_blur(&self) -> f64 {
        // The variance of what lies evenly along a way is a twelfth of its square.
        12.0_f64.sqrt() * self.by_motion.norm()
    }

    /// Extent of points along the path of the body.
    pub(super) fn extent_along(&self, points: &[Point2<f64>]) -> f64 {
        let Some(path) = self.by_motion.try_normalize(0.0) else { return f64::INFINITY };
        let along = points.iter().map(|point| point.coords.dot(&path));
        let [least, most] = along.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], s| [low.min(s), high.max(s)]);
        most - least
    }

    /// The width in the mean over all directions.
    pub(super) fn mean_width(&self) -> f64 {
        (self.variance + 0.5 * self.by_motion.norm_squared()).sqrt()
    }
}

/// Of the directions that are looked at apart, that of a normal.
fn direction(normal: &Vector2<f64>) -> usize {
    let turns = normal.y.atan2(normal.x).rem_euclid(TAU) / TAU;
    (turns * DIRECTIONS as f64) as usize % DIRECTIONS
}

/// How profiles across edges are taken, between the grey values of the two sides, and the steps that they are compared with.
struct Profiles {
    offsets: Offsets,
    /// Samples from the middle to those that tell the grey values of a side, and to the end of these.
    side: [usize; 2],
    steps: Vec<StepOfWidth>,
    between_widths: f64,
}

/// A step of some width.
struct StepOfWidth {
    width: f64,
    /// Its samples, from the first on that is near enough.
    first: usize,
    samples: Vec<f64>,
    /// Sum of their squares.
    square: f64,
}

impl Profiles {
    /// Of this reach, for these widths.
    fn new(reach: f64, [least, most, between]: [f64; 3]) -> Self {
        let offsets = Offsets::within((reach / SPACING) as usize);
        // Levels by what lies beyond the edge, near enough to be of the same two sides.
        let side = [3.0 * reach / REACH, 7.0 * reach / REACH].map(|samples: f64| samples.round() as usize);
        let widths = (0..).map(|k| least + between * f64::from(k)).take_while(|width| *width <= most);
        let step = |width: f64| {
            let is_near = |s: f64| s.abs() <= (2.0 * width + 1.0).min(reach);
            let first = offsets.iter().take_while(|s| !is_near(*s)).count();
            let near = offsets.iter().filter(|s| is_near(*s));
            let samples: Vec<f64> = near.map(|s| 0.5 - normal_cdf(s / width)).collect();
            StepOfWidth { width, first, square: samples.iter().map(|shape| shape.powi(2)).sum(), samples }
        };
        let steps = widths.map(step).collect();
        Self { offsets, side, steps, between_widths: between }
    }

    /// That of an edge; `None` where it does not rise inwards. Its grey values are put into `values`.
    fn take(
        &self,
        source: &Sampler,
        place: Point2<f64>,
        normal: Vector2<f64>,
        values: &mut Vec<f64>,
    ) -> Option<Vec<f64>> {
        let [near, far] = self.side;
        source.profile(place, normal, &self.offsets, values);
        let middle = values.len() / 2;
        let level = |range: std::ops::Range<usize>| values[range.clone()].iter().sum::<f64>() / range.len() as f64;
        let inner = level(middle - far..middle - near);
        let outer = level(middle + near + 1..middle + far + 1);
        (inner > outer).then(|| values.iter().map(|v| (v - outer) / (inner - outer)).collect())
    }

    /// Width of the step that fits the median of profiles best; `None` of none.
    fn width<'a>(&self, profiles: impl Iterator<Item = &'a [f64]>) -> Option<f64> {
        let profiles: Vec<&[f64]> = profiles.collect();
        let count = self.offsets.count();
        let typical: Option<Vec<f64>> = (0..count).map(|k| median(profiles.iter().map(|profile| profile[k]))).collect();
        let profile = typical?;
        let tried: Vec<f64> = self.steps.iter().map(|step| step.misfit(&profile)).collect();
        let best = (0..tried.len()).min_by(|&a, &b| tried[a].total_cmp(&tried[b]))?;
        let width = self.steps[best].width;
        if best == 0 || best + 1 == tried.len() {
            return Some(width);
        }
        // The lowest point of the parabola through the best and its neighbours.
        let [a, b, c] = [tried[best - 1], tried[best], tried[best + 1]];
        let bend = a - 2.0 * b + c;
        let shift = if bend > 0.0 { 0.5 * (a - c) / bend } else { 0.0 };
        Some(width + self.between_widths * shift.clamp(-0.5, 0.5))
    }
}

impl StepOfWidth {
    /// Mean square of what it leaves of a profile, in shares of its height.
    fn misfit(&self, profile: &[f64]) -> f64 {
        let samples = || self.samples.iter().zip(&profile[self.first..]);
        let n = self.samples.len() as f64;
        let mean = samples().map(|(_, v)| v).sum::<f64>() / n;
        let height = samples().map(|(shape, v)| shape * v).sum::<f64>() / self.square;
        samples().map(|(shape, v)| (v - mean - height * shape).powi(2)).sum::<f64>() / (n - 2.5) / (height * height)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Widths in so many directions all the way round, by a function of the normal.
    fn widths(count: u32, width: impl Fn(&Vector2<f64>) -> f64) -> Vec<(Vector2<f64>, f64, f64)> {
        let normals = (0..count).map(|k| TAU * (f64::from(k) + 0.3) / f64::from(count));
        normals.map(|angle| Vector2::new(angle.cos(), angle.sin())).map(|n| (n, width(&n), 8.0)).collect()
    }

    #[test]
    fn a_blur_along_a_path_is_told_with_its_way() {
        let path = Vector2::new(0.6, -0.8);
        let blur = EdgeBlur::fitted(&widths(12, |n| (0.64 + 4.0 * n.dot(&path).powi(2)).sqrt())).expect("a blur");
        assert!((blur.motion_blur() - 48_f64.sqrt()).abs() < 0.02, "{blur:?}");
        assert!((blur.across(&path) - 4.64_f64.sqrt()).abs() < 0.01, "{blur:?}");
        let [all, of_motion] = blur.along(&path);
        assert!((all - 0.64).abs() < 0.01 && of_motion < 1e-6, "{blur:?}");
        let square = [Point2::new(0.0, 0.0), Point2::new(3.0, -4.0), Point2::new(7.0, -1.0), Point2::new(4.0, 3.0)];
        assert!((blur.extent_along(&square) - 5.0).abs() < 0.01, "{blur:?}");
    }

    #[test]
    fn edges_that_are_wide_on_one_side_or_alike_or_of_one_direction_tell_no_motion() {
        let of_shadow = widths(12, |n| if n.x > 0.7 { 3.0 } else { 0.8 });
        let alike = widths(12, |n| 1.0 + 0.1 * n.x.powi(2));
        let of_bar: Vec<_> = widths(180, |n| 0.8 + n.y).into_iter().filter(|(n, ..)| n.x.abs() > 0.99).collect();
        let few = widths(3, |n| 1.0 + n.x.abs());
        for widths in [of_shadow, alike, of_bar, few] {
            assert_eq!(EdgeBlur::fitted(&widths), None, "{widths:?}");
        }
    }
}
