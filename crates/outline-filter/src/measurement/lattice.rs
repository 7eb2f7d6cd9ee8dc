//! Lattice of pixels that the points of an outline lie on, found from the points themselves.
//!
//! Tracers of masks give points at pixels, at their corners, or half way between two of them. Tracers of grey pictures interpolate along a row
//! or a column (marching squares), so that one coordinate of every point is that of a row or a column.
use freeform_curve_fit::Outline;
use nalgebra::Point2;

use crate::tuning::lattice as tuning;

/// How points lie on a lattice of pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Place {
    /// At its nodes, one after another along rows, columns, or diagonals, as those of a mask do.
    Chain,
    /// At its nodes, in any order, as rounded coordinates do.
    Nodes,
    /// On its lines, interpolated between two nodes.
    Lines,
}

/// A lattice of square pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PixelLattice {
    /// Size of a pixel, image lengths.
    pub(crate) pixel: f64,
    pub(crate) place: Place,
}

impl PixelLattice {
    /// That of an outline; `None` where its points lie on none, or are too few to tell.
    pub(crate) fn of(outline: &Outline) -> Option<Self> {
        let points: Vec<_> = outline.pieces().flat_map(|piece| piece.points.iter().copied()).collect();
        let axes = [0, 1].map(|axis| points.iter().map(|point| point[axis]).collect::<Vec<f64>>());
        let shared = axes.each_ref().map(|values| shared_values(values));
        let pitches = shared.iter().flat_map(|values| usual_gaps(values));
        let mut pitches: Vec<f64> = pitches.collect();
        pitches.sort_unstable_by(|a, b| b.total_cmp(a));
        pitches.into_iter().find_map(|pitch| {
            let origins = shared.each_ref().map(|values| origin(values, pitch));
            Self::with_pitch(outline, &points, pitch, origins)
        })
    }

    /// That of lines at a pitch, if the points lie on them.
    fn with_pitch(outline: &Outline, points: &[Point2<f64>], pitch: f64, origins: [Option<f64>; 2]) -> Option<Self> {
        let number = |value: f64, origin: Option<f64>| {
            let number = (value - origin?) / pitch;
            ((number - number.round()).abs() < tuning::ON_LINE).then(|| number.round() as i64)
        };
        let numbers = |point: &Point2<f64>| [number(point.x, origins[0]), number(point.y, origins[1])];
        let enough = |count: usize| count as f64 >= tuning::NEARLY_ALL * points.len() as f64;
        let count = |holds: &dyn Fn([Option<i64>; 2]) -> bool| points.iter().filter(|p| holds(numbers(p))).count();
        if enough(count(&|[x, y]| x.is_some() && y.is_some())) {
            let sums = |odd: i64| count(&|[x, y]| x.zip(y).is_some_and(|(x, y)| (x + y).rem_euclid(2) == odd));
            // Points half way between pixels lie on every second node of a lattice of half pixels.
            let is_half = enough(sums(0)) || enough(sums(1));
            let place = if is_chain(outline, pitch) { Place::Chain } else { Place::Nodes };
            return Some(Self { pixel: if is_half { 2.0 * pitch } else { pitch }, place });
        }
        let on_lines = enough(count(&|[x, y]| x.is_some() || y.is_some()));
        on_lines.then_some(Self { pixel: pitch, place: Place::Lines })
    }
}

/// The values that occur more than once, in order.
fn shared_values(values: &[f64]) -> Vec<f64> {
    let mut values = values.to_vec();
    values.sort_unstable_by(f64::total_cmp);
    let extent = values.last().zip(values.first()).map_or(0.0, |(last, first)| last - first);
    let same = |a: &f64, b: &f64| b - a <= tuning::SAME * extent;
    values.chunk_by(same).filter(|group| group.len() > 1).map(|group| group[0]).collect()
}

/// Distances between neighbours among values in order that are the most usual.
fn usual_gaps(values: &[f64]) -> Vec<f64> {
    if values.len() < tuning::FEWEST_LINES {
        return Vec::new();
    }
    let mut gaps: Vec<f64> = values.windows(2).map(|pair| pair[1] - pair[0]).collect();
    gaps.sort_unstable_by(f64::total_cmp);
    let mut groups: Vec<&[f64]> = gaps.chunk_by(|a, b| b - a <= tuning::ON_LINE * b).collect();
    groups.sort_by_key(|group| std::cmp::Reverse(group.len()));
    groups.truncate(tuning::PITCHES_TRIED);
    groups.iter().map(|group| group.iter().sum::<f64>() / group.len() as f64).collect()
}

/// Place of one of the lines at a pitch that most of the values lie on.
fn origin(values: &[f64], pitch: f64) -> Option<f64> {
    let mut remainders: Vec<f64> = values.iter().map(|value| value.rem_euclid(pitch)).collect();
    remainders.sort_unstable_by(f64::total_cmp);
    // A line at the end of the range is seen at its beginning too.
    let wrapped = remainders.clone();
    remainders.extend(wrapped.iter().map(|remainder| remainder + pitch));
    let groups = remainders.chunk_by(|a, b| b - a <= tuning::ON_LINE * pitch);
    let largest = groups.max_by_key(|group| group.len())?;
    Some(largest[largest.len() / 2])
}

/// Whether points at nodes follow each other along rows, columns, and diagonals, none of them twice.
fn is_chain(outline: &Outline, pitch: f64) -> bool {
    let (mut steps, mut straight) = (0, 0);
    for piece in outline.pieces() {
        for pair in piece.points.windows(2) {
            let step = (pair[1] - pair[0]).abs();
            let near = tuning::ON_LINE * pitch;
            let along = step.min() < near || (step.x - step.y).abs() < near;
            straight += usize::from(along && step.max() > near);
            steps += 1;
        }
    }
    straight as f64 >= tuning::STRAIGHT_STEPS * steps as f64
}
