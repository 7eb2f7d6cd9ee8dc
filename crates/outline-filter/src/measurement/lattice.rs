//! Lattice of pixels that the points of an outline lie on, found from the points themselves.
//!
//! Tracers of masks give points at pixels, at their corners, or half way between two of them. Tracers of grey pictures interpolate along a row
//! or a column (marching squares), so that one coordinate of every point is that of a row or a column.
use freeform_curve_fit::Outline;
use nalgebra::Point2;

use crate::tuning::lattice as tuning;

/// How points lie on a lattice of pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum PlaceOnLattice {
    /// At its nodes, one after another along rows, columns, or diagonals, as those of a mask do.
    Chain,
    /// At its nodes, in any order, as rounded coordinates do.
    Nodes,
    /// On its lines, interpolated between two nodes.
    Lines,
    /// On its lines, but where a side lies along them at the nodes of one twice as fine, as that of a mask does which was smoothed and then interpolated.
    LinesOfMask,
}

/// A lattice of square pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PixelLattice {
    /// Size of a pixel, image lengths.
    pub(crate) pixel: f64,
    pub(crate) place: PlaceOnLattice,
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
        let lines = |pitch: f64| Lines { pitch, origins: shared.each_ref().map(|values| origin(values, pitch)) };
        let on_lines = |lines: &Lines| nearly_all(&points, |p| lines.numbers(p).iter().any(Option::is_some));
        let found = pitches.into_iter().map(lines).find(on_lines)?;
        // Points half way between pixels lie on the lines of a lattice as interpolated ones do, and on every second node of one twice as fine.
        let finer = lines(found.pitch / 2.0);
        let place =
            |lines: &Lines| if is_chain(outline, lines.pitch) { PlaceOnLattice::Chain } else { PlaceOnLattice::Nodes };
        let of_nodes = [&found, &finer].into_iter().find_map(|lines| {
            let pixel = lines.pixel_of_nodes(&points)?;
            Some(Self { pixel, place: place(lines) })
        });
        of_nodes.or_else(|| {
            let at_nodes = share(&points, |p| finer.numbers(p).iter().all(Option::is_some));
            let is_mask = at_nodes > tuning::SIDES_AT_NODES;
            let place = if is_mask { PlaceOnLattice::LinesOfMask } else { PlaceOnLattice::Lines };
            Some(Self { pixel: found.pitch, place })
        })
    }
}

/// Lines at a pitch in both axes.
struct Lines {
    pitch: f64,
    /// Place of one of them in each axis, where there are any.
    origins: [Option<f64>; 2],
}

impl Lines {
    /// Numbers of the lines that a point lies on, in x and in y.
    fn numbers(&self, point: &Point2<f64>) -> [Option<i64>; 2] {
        let number = |value: f64, origin: Option<f64>| {
            let number = (value - origin?) / self.pitch;
            ((number - number.round()).abs() < tuning::ON_LINE).then(|| number.round() as i64)
        };
        [number(point.x, self.origins[0]), number(point.y, self.origins[1])]
    }

    /// Size of a pixel if the points lie on nodes: twice the pitch where they keep to every second one.
    fn pixel_of_nodes(&self, points: &[Point2<f64>]) -> Option<f64> {
        let sum = |p: &Point2<f64>| match self.numbers(p) {
            [Some(x), Some(y)] => Some((x + y).rem_euclid(2)),
            _ => None,
        };
        let is_half = || (0..2).any(|odd| nearly_all(points, |p| sum(p) == Some(odd)));
        nearly_all(points, |p| sum(p).is_some()).then(|| if is_half() { 2.0 * self.pitch } else { self.pitch })
    }
}

fn nearly_all(points: &[Point2<f64>], holds: impl Fn(&Point2<f64>) -> bool) -> bool {
    share(points, holds) >= tuning::NEARLY_ALL
}

/// Share of points of which something holds.
fn share(points: &[Point2<f64>], holds: impl Fn(&Point2<f64>) -> bool) -> f64 {
    points.iter().filter(|point| holds(point)).count() as f64 / points.len().max(1) as f64
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

/// Whether points at nodes follow each other along rows, columns, and diagonals, those left out that repeat the point before, as rounded coordinates may.
/// Points that go to and fro have noise of their own, which the pixels of a mask do not.
fn is_chain(outline: &Outline, pitch: f64) -> bool {
    let (mut steps, mut straight) = (0_usize, 0_usize);
    for piece in outline.pieces() {
        let mut nodes = piece.points.to_vec();
        nodes.dedup();
        let before = std::iter::once(None).chain(nodes.iter().map(Some));
        for (pair, before) in nodes.windows(2).zip(before) {
            let step = (pair[1] - pair[0]).abs();
            let near = tuning::ON_LINE * pitch;
            let along = step.min() < near || (step.x - step.y).abs() < near;
            straight += usize::from(along && step.max() > near && before != Some(&pair[1]));
            steps += 1;
        }
    }
    steps > 0 && straight as f64 >= tuning::STRAIGHT_STEPS * steps as f64
}
