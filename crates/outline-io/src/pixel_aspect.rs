//! Whether the pixels of a camera are square, told by bodies that turn.
use freeform_curve_fit::Outline;
use nalgebra::{Complex, Point2};

use crate::edges::median;

/// Outlines kept at most; beyond, every second one goes, and fewer of those that come are taken.
const MOST_KEPT: usize = 256;

/// Fewest outlines that tell anything.
const FEWEST: usize = 12;

/// Aspects looked at: least, most, step.
const ASPECTS: [f64; 3] = [0.5, 2.0, 0.01];

/// The outlines must keep their shape so many times better than as they are, in squares.
const BETTER: f64 = 4.0;

/// A body that changes its shape by more than this at the best aspect, in the same squares, is not rigid in the plane.
const NOT_RIGID: f64 = 0.01;

/// Nearer to 1 than this an aspect is as it should be.
const SMALL: f64 = 0.015;

/// Size of a complex moment, in units of the size of the body, from which it has a direction.
const DIRECTED: f64 = 0.02;

/// A direction whose mean is shorter than this has turned: by about a radian.
const TURNED: f64 = 0.9;

/// Places and weights of the Gauss rule of three points on 0 to 1.
const GAUSS: [(f64, f64); 3] =
    [(0.112_701_665_379_258_31, 5.0 / 18.0), (0.5, 4.0 / 9.0), (0.887_298_334_620_741_7, 5.0 / 18.0)];

/// Tells the aspect of the pixels from outlines of a rigid body that turns: where pixels are not as wide as they are taken to be, the body
/// seems to change its shape as it turns. What a turn leaves of the moments of its area, up to the fourth degree, must stay the same.
#[derive(Debug, Clone)]
pub struct PixelAspectCheck {
    /// Central moments of each outline, see [`MOMENTS`].
    kept: Vec<[f64; 13]>,
    seen: usize,
    stride: usize,
}

/// Powers of x and y of the moments kept.
const MOMENTS: [(i32, i32); 13] =
    [(0, 0), (2, 0), (1, 1), (0, 2), (3, 0), (2, 1), (1, 2), (0, 3), (4, 0), (3, 1), (2, 2), (1, 3), (0, 4)];

impl Default for PixelAspectCheck {
    fn default() -> Self {
        Self { kept: Vec::new(), seen: 0, stride: 1 }
    }
}

impl PixelAspectCheck {
    /// Takes an outline; those that are not closed tell nothing.
    pub fn take(&mut self, outline: &Outline) {
        let Outline::Closed(closed) = outline else { return };
        self.seen += 1;
        if !(self.seen - 1).is_multiple_of(self.stride) {
            return;
        }
        if self.kept.len() == MOST_KEPT {
            let mut index = 0;
            self.kept.retain(|_| {
                index += 1;
                index % 2 == 1
            });
            self.stride *= 2;
        }
        self.kept.push(moments(closed.points()));
    }

    /// By how much x must be stretched so that the body keeps its shape, if that is beyond doubt and not by nothing.
    #[must_use]
    pub fn stretch(&self) -> Option<f64> {
        if self.kept.len() < FEWEST {
            return None;
        }
        let [least, most, step] = ASPECTS;
        let stretches = (0..).map(|k| least + step * f64::from(k)).take_while(|stretch| *stretch <= most);
        let tried: Vec<(f64, f64)> =
            stretches.filter_map(|stretch| Some((stretch, self.change_of_shape(stretch)?))).collect();
        let best = (0..tried.len()).min_by(|&a, &b| tried[a].1.total_cmp(&tried[b].1))?;
        if best == 0 || best + 1 == tried.len() {
            return None;
        }
        let [a, b, c] = [tried[best - 1].1, tried[best].1, tried[best + 1].1];
        let bend = a - 2.0 * b + c;
        let stretch = tried[best].0 + if bend > 0.0 { 0.5 * step * (a - c) / bend } else { 0.0 };
        let as_it_is = self.change_of_shape(1.0)?;
        let is_doubtless = (stretch - 1.0).abs() > SMALL && as_it_is > BETTER * b && b < NOT_RIGID;
        // A body that tilts may seem to turn once it is stretched, but not as it is.
        (is_doubtless && self.turns(stretch) && self.turns(1.0)).then_some(stretch)
    }

    /// Whether a direction of the body is seen to turn where x is stretched: a body that tilts changes its shape too, but in one direction.
    fn turns(&self, stretch: f64) -> bool {
        let all: Vec<[Complex<f64>; 5]> = self.kept.iter().map(|moments| directions(moments, stretch)).collect();
        (0..5).any(|k| {
            let sum: Complex<f64> = all.iter().map(|each| each[k]).sum();
            let sizes = || all.iter().map(|each| each[k].norm());
            let least = sizes().fold(f64::INFINITY, f64::min);
            least > DIRECTED && sum.norm() < TURNED * sizes().sum::<f64>()
        })
    }

    /// How much the shape changes where x is stretched: the sum of the squared spreads of what a turn leaves of the moments.
    fn change_of_shape(&self, stretch: f64) -> Option<f64> {
        let all: Vec<[f64; 7]> = self.kept.iter().map(|moments| left_by_turns(moments, stretch)).collect();
        let spread = |k: usize| {
            let middle = median(all.iter().map(|values| values[k]))?;
            median(all.iter().map(|values| (values[k] - middle).abs()))
        };
        (0..7).map(|k| spread(k).map(|spread| spread * spread)).sum()
    }
}

/// Area, the size, which is the root of the second moment over it, and the second moment of the fourth degree, where x is stretched.
fn sizes(moments: &[f64; 13], stretch: f64) -> [f64; 3] {
    let of = |p: i32, q: i32| moment(moments, stretch, (p, q));
    let area = of(0, 0);
    [area, ((of(2, 0) + of(0, 2)) / area).sqrt(), of(4, 0) + 2.0 * of(2, 2) + of(0, 4)]
}

fn moment(moments: &[f64; 13], stretch: f64, powers: (i32, i32)) -> f64 {
    let index = MOMENTS.iter().position(|others| *others == powers).unwrap_or(0);
    moments[index] * stretch.powi(powers.0 + 1)
}

/// Complex moments in units of the size: a turn of the body turns each of them by two, three, one, four and two times as much.
fn directions(moments: &[f64; 13], stretch: f64) -> [Complex<f64>; 5] {
    let of = |p: i32, q: i32| moment(moments, stretch, (p, q));
    let [area, size, _] = sizes(moments, stretch);
    let [second, third, fourth] = [2, 3, 4].map(|degree| 1.0 / (area * size.powi(degree)));
    [
        Complex::new(of(2, 0) - of(0, 2), 2.0 * of(1, 1)) * second,
        Complex::new(of(3, 0) - 3.0 * of(1, 2), 3.0 * of(2, 1) - of(0, 3)) * third,
        Complex::new(of(3, 0) + of(1, 2), of(2, 1) + of(0, 3)) * third,
        Complex::new(of(4, 0) - 6.0 * of(2, 2) + of(0, 4), 4.0 * (of(3, 1) - of(1, 3))) * fourth,
        Complex::new(of(4, 0) - of(0, 4), 2.0 * (of(3, 1) + of(1, 3))) * fourth,
    ]
}

/// What a turn leaves of the moments, in units of the size: the size over the root of the area, and the moduli of complex moments.
fn left_by_turns(moments: &[f64; 13], stretch: f64) -> [f64; 7] {
    let [area, size, fourth] = sizes(moments, stretch);
    let [a, b, c, d, e] = directions(moments, stretch).map(Complex::norm);
    [size / area.sqrt(), a, b, c, d, e, fourth / area / size.powi(4)]
}

/// Central moments of the area within a polygon.
fn moments(points: &[Point2<f64>]) -> [f64; 13] {
    let edges = || points.iter().zip(points.iter().cycle().skip(1));
    let origin = points[0];
    let (mut doubled, mut moment) = (0.0, nalgebra::Vector2::zeros());
    for (p, q) in edges() {
        let (p, q) = (p - origin, q - origin);
        doubled += p.perp(&q);
        moment += p.perp(&q) * (p + q);
    }
    let centre = origin + moment / (3.0 * doubled);
    let mut found = [0.0; 13];
    for (p, q) in edges() {
        let (p, q) = (p - centre, q - centre);
        let cross = p.perp(&q);
        for (place, weight) in GAUSS {
            let r = p + (q - p) * place;
            for (value, (a, b)) in found.iter_mut().zip(MOMENTS) {
                *value += cross * weight * r.x.powi(a) * r.y.powi(b) / f64::from(a + b + 2);
            }
        }
    }
    if doubled < 0.0 {
        found.iter_mut().for_each(|value| *value = -*value);
    }
    found
}

#[cfg(test)]
mod tests {
    use nalgebra::{Rotation2, Vector2};

    use super::*;

    /// A shape that turns by 5 degrees from outline to outline, seen with pixels of an aspect, with noise of 0.3 % of its size.
    fn check(corners: &[[f64; 2]], aspect: f64, step: f64) -> Option<f64> {
        let mut check = PixelAspectCheck::default();
        let mut state = 7_u32;
        let mut noise = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            0.006 * (f64::from(state >> 8) / f64::from(1 << 24) - 0.5)
        };
        for frame in 0..60 {
            let turn = Rotation2::new((step * f64::from(frame)).to_radians());
            let mut points = Vec::new();
            for (from, to) in corners.iter().zip(corners.iter().cycle().skip(1)) {
                for k in 0..40 {
                    let at = |axis: usize| from[axis] + (to[axis] - from[axis]) * f64::from(k) / 40.0;
                    let p = turn * Vector2::new(at(0), at(1));
                    points.push(Point2::new(p.x / aspect + noise(), p.y + noise()));
                }
            }
            check.take(&Outline::closed(points).expect("an outline"));
        }
        check.stretch()
    }

    const SQUARE: [[f64; 2]; 4] = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]];
    const BAR: [[f64; 2]; 4] = [[-0.5, -0.2], [0.5, -0.2], [0.5, 0.2], [-0.5, 0.2]];
    const L: [[f64; 2]; 6] = [[0.0, 0.0], [0.7, 0.0], [0.7, 0.3], [0.3, 0.3], [0.3, 1.0], [0.0, 1.0]];

    #[test]
    fn the_aspect_is_told_by_bodies_that_turn() {
        for aspect in [0.8, 1.14, 1.3333] {
            for shape in [&SQUARE[..], &BAR, &L] {
                let stretch = check(shape, aspect, 5.0).expect("an aspect");
                assert!((stretch - aspect).abs() < 0.01, "{stretch} {aspect}");
            }
        }
    }

    #[test]
    fn a_disc_that_tumbles_says_nothing_of_the_pixels() {
        for axis in [0.0, 0.2_f64] {
            let mut check = PixelAspectCheck::default();
            let along = Rotation2::new(axis);
            for frame in 0..60 {
                let squeezed = (0.8 * f64::from(frame) / 59.0).cos();
                let at = |k: i32| {
                    let angle = std::f64::consts::TAU * f64::from(k) / 200.0;
                    Point2::from(along * Vector2::new(angle.cos(), squeezed * angle.sin()))
                };
                check.take(&Outline::closed((0..200).map(at).collect()).expect("an outline"));
            }
            assert_eq!(check.stretch(), None, "{axis}");
        }
    }

    #[test]
    fn nothing_is_said_of_square_pixels_nor_of_bodies_that_do_not_turn() {
        for shape in [&SQUARE[..], &BAR, &L] {
            assert_eq!(check(shape, 1.0, 5.0), None);
            assert_eq!(check(shape, 1.2, 0.0), None);
        }
    }
}
