use nalgebra::{Point2, Vector2};

use super::sampler::Sampler;
use super::step_fit::{StepFit, normal_distribution};
use super::{Edge, median};

/// Points whose profiles tell the width.
const PROFILES: usize = 96;

/// How far from the edge the profiles reach, in pixels.
const REACH: f64 = 7.0;

/// Least and largest width told apart, and the step between widths tried, in pixels.
const WIDTHS: [f64; 3] = [0.5, 4.0, 0.1];

/// Width of the edges of a contour: that of the step which fits the median of their profiles best. `None` where no profile rises.
pub(super) fn of(
    source: &Sampler,
    points: &[Point2<f64>],
    normals: &[Option<Vector2<f64>>],
    edges: &[Edge],
) -> Option<f64> {
    let wide = StepFit::new(1.0, REACH);
    let typical = median(edges.iter().map(|edge| edge.step))?;
    let rises: Vec<usize> =
        (0..points.len()).filter(|&i| normals[i].is_some() && edges[i].step > 0.3 * typical.max(1e-9)).collect();
    let step = rises.len().div_ceil(PROFILES).max(1);
    let (mut profiles, mut values) = (Vec::new(), Vec::new());
    for &i in rises.iter().step_by(step) {
        let normal = normals[i]?;
        source.profile(points[i] + edges[i].place * normal, normal, wide.offsets(), &mut values);
        // Levels by what lies beyond the edge, near enough to be of the same two sides.
        let middle = values.len() / 2;
        let level = |range: std::ops::Range<usize>| values[range.clone()].iter().sum::<f64>() / range.len() as f64;
        let (inner, outer) = (level(middle - 7..middle - 3), level(middle + 4..middle + 8));
        if inner > outer {
            profiles.push(values.iter().map(|v| (v - outer) / (inner - outer)).collect::<Vec<f64>>());
        }
    }
    let count = wide.offsets().count();
    let profile: Option<Vec<f64>> = (0..count).map(|k| median(profiles.iter().map(|profile| profile[k]))).collect();
    let profile = profile?;
    let [least, most, step] = WIDTHS;
    let misfit = |width: f64| {
        let near = |s: f64| s.abs() <= (2.0 * width + 1.0).min(REACH);
        let shape = |s: f64| 0.5 - normal_distribution(s / width);
        // What the step is there, and what the profile shows.
        let samples: Vec<(f64, f64)> =
            wide.offsets().iter().zip(&profile).filter(|(s, _)| near(*s)).map(|(s, v)| (shape(s), *v)).collect();
        let n = samples.len() as f64;
        let mean = samples.iter().map(|(_, v)| v).sum::<f64>() / n;
        let square: f64 = samples.iter().map(|(shape, _)| shape.powi(2)).sum();
        let height = samples.iter().map(|(shape, v)| shape * v).sum::<f64>() / square;
        samples.iter().map(|(shape, v)| (v - mean - height * shape).powi(2)).sum::<f64>()
            / (n - 2.5)
            / (height * height)
    };
    let widths = (0..).map(|k| least + step * f64::from(k)).take_while(|width| *width <= most);
    let tried: Vec<(f64, f64)> = widths.map(|width| (width, misfit(width))).collect();
    let best = (0..tried.len()).min_by(|&a, &b| tried[a].1.total_cmp(&tried[b].1))?;
    if best == 0 || best + 1 == tried.len() {
        return Some(tried[best].0);
    }
    // The lowest point of the parabola through the best and its neighbours.
    let [a, b, c] = [tried[best - 1].1, tried[best].1, tried[best + 1].1];
    let bend = a - 2.0 * b + c;
    let shift = if bend > 0.0 { 0.5 * (a - c) / bend } else { 0.0 };
    Some(tried[best].0 + step * shift.clamp(-0.5, 0.5))
}
