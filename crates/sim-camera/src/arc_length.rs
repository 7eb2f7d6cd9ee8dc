use nalgebra::{Point2, Unit, Vector2};

use crate::curve::Segment;

/// Parameter steps that a curved segment is divided into.
const STEPS: u32 = 32;

/// Where along the curve a tabulated arc length is reached.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Node {
    arc_length: f64,
    segment: usize,
    t: f64,
}

/// A closed chain of segments walked by arc length.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ArcLengthCurve {
    segments: Vec<Segment>,
    nodes: Vec<Node>,
    perimeter: f64,
}

impl ArcLengthCurve {
    pub(crate) fn new(segments: Vec<Segment>) -> Self {
        let mut nodes = Vec::new();
        let mut arc_length = 0.0;
        for (segment, curve) in segments.iter().enumerate() {
            let steps = if curve.straight { 1 } else { STEPS };
            let step = 1.0 / f64::from(steps);
            for k in 0..steps {
                let t = f64::from(k) * step;
                nodes.push(Node { arc_length, segment, t });
                arc_length += curve.arc_length(t, t + step);
            }
        }
        Self { segments, nodes, perimeter: arc_length }
    }

    pub(crate) fn perimeter(&self) -> f64 {
        self.perimeter
    }

    pub(crate) fn segments(&self) -> &[Segment] {
        &self.segments
    }

    /// The point at each tabulated arc length: at least every end of a segment.
    pub(crate) fn node_points(&self) -> impl Iterator<Item = Point2<f64>> + '_ {
        self.nodes.iter().map(|node| self.segments[node.segment].point(node.t))
    }

    pub(crate) fn point(&self, fraction: f64) -> Point2<f64> {
        let (segment, t) = self.locate(fraction);
        segment.point(t)
    }

    pub(crate) fn tangent(&self, fraction: f64) -> Unit<Vector2<f64>> {
        let (segment, t) = self.locate(fraction);
        Unit::new_normalize(segment.derivative(t))
    }

    /// The segment and its parameter at a fraction of the perimeter, taken modulo 1. The parameter inverts the arc
    /// length between two nodes by the cubic that has the right slope `dt/ds = 1/|c'(t)|` at both; the point found is
    /// on the curve whatever the error of that.
    fn locate(&self, fraction: f64) -> (&Segment, f64) {
        let s = (fraction - fraction.floor()) * self.perimeter;
        let position = self.nodes.partition_point(|node| node.arc_length <= s).max(1) - 1;
        let node = self.nodes[position];
        let segment = &self.segments[node.segment];
        let (end, t_end) = match self.nodes.get(position + 1) {
            Some(next) if next.segment == node.segment => (next.arc_length, next.t),
            Some(next) => (next.arc_length, 1.0),
            None => (self.perimeter, 1.0),
        };
        let (length, width) = (end - node.arc_length, t_end - node.t);
        let r = (s - node.arc_length) / length;
        if segment.straight {
            return (segment, r);
        }
        let slope = |t: f64| length / segment.derivative(t).norm();
        let (first, last) = (slope(node.t), slope(t_end));
        let t = node.t + r * (first + r * (3.0 * width - 2.0 * first - last + r * (first + last - 2.0 * width)));
        (segment, t)
    }
}
