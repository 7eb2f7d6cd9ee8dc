//! The edges on the normals of points, each by the widest profile that shows it alone.
use nalgebra::{Point2, Vector2};

use super::blur_width::EdgeBlur;
use super::sampler::Sampler;
use super::step_fit::{SPACING, StepFit};
use super::{Edge, FIRST_WIDTH, LEAST_RESIDUAL, median};

/// How far narrow profiles reach, in widths of the edge and pixels: near enough for thin parts.
const NARROW: [f64; 2] = [2.2, 1.2];

/// How far wide ones do, where nothing else is in the way, the farther of the two: as far as the grey values of both sides are known well. Of the
/// information on a place, 0.28 over the width, what is not known of them takes 0.5 over the reach. Four widths and the pixels beyond leave a
/// deviation of up to 1.25 times what it would be for edges up to 1.5 pixels wide, but 1.34 times for wider ones. Farther than need be
/// the light of one side changes.
const WIDE: [[f64; 2]; 2] = [[4.0, 1.5], [6.0, -1.5]];

/// Least and greatest reach of both, in pixels.
const REACH_OF_NARROW: [f64; 2] = [2.5, 12.0];
const REACH_OF_WIDE: [f64; 2] = [3.0, 18.0];

/// Reach of the first profiles, before the width is known, in pixels.
const FIRST_REACH: f64 = 4.0;

/// A wide fit that leaves so many times what narrow ones leave is of more than one edge.
const NOT_ALONE: f64 = 1.3;

/// Farthest that one fit moves an edge, and all of them, in pixels and in widths of it: what is farther off is not seen well by the profile.
const MOST_MOVED: [f64; 2] = [1.0, 0.5];
const FARTHEST_FOUND: [f64; 2] = [8.0, 2.0];

/// Farthest that the wide profile may move an edge, in widths of it, the least share of its height that it must leave, and the most times the typical
/// residual that the fit may leave.
const SAME_EDGE: f64 = 0.4;
const SAME_HEIGHT: f64 = 0.7;
const GOOD_FIT: f64 = 1.5;

/// An edge that a round moves by less has settled, in pixels: well below what the fit is good for.
const SETTLED: f64 = 0.004;

/// Light that differs from that of its side of the step by more than so large a share of the step, and so many times what the fits leave, is another
/// edge. A fifth of a step is reached 0.85 widths before its middle, so that this many widths nearer a hundredth of it is left.
const ANOTHER_EDGE: [f64; 2] = [0.2, 4.0];
const BEFORE_ANOTHER: f64 = 1.4;

/// Shortest profile, in widths of the edge and pixels: 1.8 widths tell a place no more where the grey values of both sides are not known.
const SHORTEST: [f64; 2] = [2.0, 0.0];

/// Edges are fitted with the width of their own to within this factor, either way, of which a place is independent to first order.
const SAME_WIDTH: f64 = 1.07;

/// Wide edges are fitted again, so many times at most, as long as they are found to be wider than before by this factor.
const MOST_ROUNDS: usize = 5;
const WIDER_AGAIN: f64 = 1.1;

/// How far profiles reach, in pixels, by widths of the edge and pixels.
fn reach([widths, pixels]: [f64; 2], width: f64) -> f64 {
    widths * width + pixels
}

/// Widths of edges with these normals, each of about as wide ones, and which of them is that of each edge: any, of one without a normal.
fn classes(blur: &EdgeBlur, normals: &[Option<Vector2<f64>>]) -> (Vec<f64>, Vec<usize>) {
    let step = 2.0 * SAME_WIDTH.ln();
    let number = |normal: &Vector2<f64>| (blur.across(normal).ln() / step).round() as i64;
    let mut numbers: Vec<i64> = normals.iter().flatten().map(number).collect();
    numbers.sort_unstable();
    numbers.dedup();
    let class = |normal: &Option<Vector2<f64>>| {
        normal.map_or(0, |normal| numbers.partition_point(|other| *other < number(&normal)))
    };
    (numbers.iter().map(|number| (*number as f64 * step).exp()).collect(), normals.iter().map(class).collect())
}

/// Edges that were fitted, with how wide they are.
pub(super) struct Fitted {
    pub(super) edges: Vec<Edge>,
    pub(super) blur: EdgeBlur,
    /// The widest fits, one for edges of about one width each.
    pub(super) fits: Vec<StepFit>,
    /// Which of them is that of each edge.
    pub(super) fit_of: Vec<usize>,
}

impl Sampler<'_> {
    /// The edges on the normals of points. `None` where there are none.
    pub(super) fn fitted(&self, points: &[Point2<f64>], normals: &[Option<Vector2<f64>>]) -> Option<Fitted> {
        let mut edges = vec![Edge::default(); points.len()];
        self.fit_all(points, normals, &mut edges, &StepFit::new(FIRST_WIDTH, FIRST_REACH), 2);
        let mut blur = EdgeBlur::of(self, points, normals, &edges)?;
        let mut fits = self.fit_blurred(points, normals, &mut edges, &blur)?;
        if blur.motion_blur() > 0.0 {
            // Profiles that are not about wide edges yet seem narrower.
            for _ in 0..MOST_ROUNDS {
                let before = std::mem::replace(&mut blur, EdgeBlur::of(self, points, normals, &edges)?);
                fits = self.fit_blurred(points, normals, &mut edges, &blur)?;
                if blur.motion_blur() < WIDER_AGAIN * before.motion_blur() {
                    break;
                }
            }
        }
        let (fits, fit_of) = fits;
        Some(Fitted { edges, blur, fits, fit_of })
    }

    /// Edges of a blur, each by the width that it has, from where they were found roughly: the widest fits, and which of them is that of each
    /// edge. `None` where there are none.
    fn fit_blurred(
        &self,
        points: &[Point2<f64>],
        normals: &[Option<Vector2<f64>>],
        edges: &mut [Edge],
        blur: &EdgeBlur,
    ) -> Option<(Vec<StepFit>, Vec<usize>)> {
        if blur.motion_blur() == 0.0 {
            let fit = self.fit_width(points, normals, edges, blur.mean_width())?;
            return Some((vec![fit], vec![0; points.len()]));
        }
        let (widths, fit_of) = classes(blur, normals);
        let mut fits = Vec::new();
        for (class, width) in widths.into_iter().enumerate() {
            let own: Vec<usize> = (0..points.len()).filter(|&i| fit_of[i] == class).collect();
            let points: Vec<Point2<f64>> = own.iter().map(|&i| points[i]).collect();
            let normals: Vec<Option<Vector2<f64>>> = own.iter().map(|&i| normals[i]).collect();
            let mut of_width: Vec<Edge> = own.iter().map(|&i| edges[i]).collect();
            fits.push(self.fit_width(&points, &normals, &mut of_width, width)?);
            own.into_iter().zip(of_width).for_each(|(i, edge)| edges[i] = edge);
        }
        Some((fits, fit_of))
    }

    /// Edges of one width, from where they were found roughly; the widest fit. `None` where there are none.
    fn fit_width(
        &self,
        points: &[Point2<f64>],
        normals: &[Option<Vector2<f64>>],
        edges: &mut [Edge],
        width: f64,
    ) -> Option<StepFit> {
        let narrow = StepFit::new(width, reach(NARROW, width).clamp(REACH_OF_NARROW[0], REACH_OF_NARROW[1]));
        self.fit_all(points, normals, edges, &narrow, 3);
        let far = WIDE.map(|of| reach(of, width)).into_iter().fold(REACH_OF_WIDE[0], f64::max);
        let fit = StepFit::new(width, far.min(REACH_OF_WIDE[1]));
        let mut wide = edges.to_vec();
        self.fit_all(points, normals, &mut wide, &fit, 2);
        let typical_of = |edges: &[Edge]| {
            let with_normal = edges.iter().zip(normals).filter(|(_, normal)| normal.is_some());
            median(with_normal.map(|(edge, _)| edge.residual))
        };
        // Of a thin body most wide profiles reach its other side.
        let [of_wide, of_narrow] = [typical_of(&wide)?, NOT_ALONE * typical_of(edges)?];
        let is_thin = of_narrow < of_wide;
        let typical = of_wide.min(of_narrow);
        let mut shorter = Shorter { fit: &fit, typical, fits: Vec::new(), values: Vec::new() };
        for (index, (edge, wide)) in edges.iter_mut().zip(wide).enumerate() {
            let is_same_edge =
                (wide.place - edge.place).abs() <= SAME_EDGE * width && wide.height >= SAME_HEIGHT * edge.height;
            let is_wide = is_same_edge && wide.residual <= GOOD_FIT * typical.max(LEAST_RESIDUAL);
            let found = match normals[index] {
                Some(normal) if is_thin || !is_wide => shorter.refitted(self, (points[index], normal), edge),
                _ => None,
            };
            if let Some(found) = found {
                *edge = found;
            } else if is_wide {
                *edge = wide;
            }
        }
        Some(fit)
    }

    fn fit_all(
        &self,
        points: &[Point2<f64>],
        normals: &[Option<Vector2<f64>>],
        edges: &mut [Edge],
        fit: &StepFit,
        rounds: usize,
    ) {
        let (mut values, deviation) = (Vec::new(), fit.deviation_of_place());
        for ((point, normal), edge) in points.iter().zip(normals).zip(edges) {
            edge.deviation = deviation;
            let Some(normal) = *normal else { continue };
            self.fit_one(*point, normal, edge, fit, (rounds, &mut values));
        }
    }

    /// Moves an edge to where a fit has it, in so many rounds.
    #[inline]
    fn fit_one(
        &self,
        point: Point2<f64>,
        normal: Vector2<f64>,
        edge: &mut Edge,
        fit: &StepFit,
        (rounds, values): (usize, &mut Vec<f64>),
    ) {
        let mut last = None;
        for _ in 0..rounds {
            self.profile(point + edge.place * normal, normal, fit.offsets(), values);
            let found = last.insert(fit.of(values));
            // Outwards the signal falls.
            edge.height = -found.height;
            edge.one_sided = Some(found.one_sided);
            let most = MOST_MOVED[0].max(MOST_MOVED[1] * fit.width());
            let moved = if edge.height > 0.0 { found.place.clamp(-most, most) } else { 0.0 };
            let farthest = FARTHEST_FOUND[0].max(FARTHEST_FOUND[1] * fit.width());
            edge.place = (edge.place + moved).clamp(-farthest, farthest);
            if moved.abs() < SETTLED {
                break;
            }
        }
        edge.residual = last.map_or(edge.residual, |found| fit.residual(values, &found));
    }
}

/// Fits to profiles that end before another edge.
struct Shorter<'a> {
    /// The widest.
    fit: &'a StepFit,
    /// What fits leave of an edge alone.
    typical: f64,
    /// By half pixels from the shortest on, made where one is needed.
    fits: Vec<StepFit>,
    values: Vec<f64>,
}

impl Shorter<'_> {
    /// An edge that the narrow profile has found, by one that reaches as far as it is alone; `None` where the widest shows it alone.
    fn refitted(
        &mut self,
        source: &Sampler,
        (point, normal): (Point2<f64>, Vector2<f64>),
        edge: &Edge,
    ) -> Option<Edge> {
        let width = self.fit.width();
        source.profile(point + edge.place * normal, normal, self.fit.offsets(), &mut self.values);
        let least = reach(SHORTEST, width);
        let alone = (self.alone(edge)? - BEFORE_ANOTHER * width).max(least);
        if self.fits.is_empty() {
            let [_, most] = self.fit.offsets().ends();
            let reaches = (0..).map(|k| least + SPACING * f64::from(k)).take_while(|reach| *reach < most);
            self.fits.extend(reaches.map(|reach| StepFit::new(width, reach)));
        }
        let index = (((alone - least) / SPACING) as usize).min(self.fits.len().saturating_sub(1));
        let fit = self.fits.get(index)?;
        let mut shorter = *edge;
        source.fit_one(point, normal, &mut shorter, fit, (2, &mut self.values));
        let is_same_edge = (shorter.place - edge.place).abs() <= SAME_EDGE * width && shorter.height > 0.0;
        Some(match is_same_edge {
            true => Edge { one_sided: None, deviation: fit.deviation_of_place(), ..shorter },
            false => Edge { one_sided: None, ..*edge },
        })
    }

    /// How far the widest profile, which has been taken about an edge, shows it alone to both sides, in pixels; `None` if it does to its ends.
    fn alone(&self, edge: &Edge) -> Option<f64> {
        let (values, width) = (&self.values, self.fit.width());
        let middle = values.len() / 2;
        let near = ((2.0 * width / SPACING) as usize).min(middle);
        let level = values[middle - near..=middle + near].iter().sum::<f64>() / (2 * near + 1) as f64;
        let most = (ANOTHER_EDGE[0] * edge.height).max(ANOTHER_EDGE[1] * self.typical);
        let differs = |k: usize| {
            let [inner, outer] = [values[middle - k], values[middle + k]];
            inner < level + 0.5 * edge.height - most || outer > level - 0.5 * edge.height + most
        };
        (near..=middle).find(|k| differs(*k)).map(|k| SPACING * k as f64)
    }
}
