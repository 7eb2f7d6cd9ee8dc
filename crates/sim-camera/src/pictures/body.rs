use std::f64::consts::TAU;

use nalgebra::{Matrix2, Point2, Rotation2, Vector2};

/// How far apart the corners of curved outlines are, in pixels.
const CHORD: f64 = 1.0;

/// A flat body: its boundary anticlockwise with y upwards, its holes the other way round, in pixels about its middle.
#[derive(Debug, Clone)]
pub(super) struct Body {
    pub(super) contours: Vec<Vec<Point2<f64>>>,
    pub(super) path: Path,
}

/// How a body goes. Angles turn as a positive omega does: clockwise with y upwards.
#[derive(Debug, Clone, Copy)]
pub(super) struct Path {
    /// Place of the middle at time 0, pixels, y upwards.
    pub(super) start: Point2<f64>,
    pub(super) velocity: Vector2<f64>,
    pub(super) acceleration: Vector2<f64>,
    pub(super) angle: f64,
    pub(super) omega: f64,
    /// Angular acceleration.
    pub(super) alpha: f64,
    /// Rate of a tumble about an axis in the plane, rad/s: the body seems narrower by its cosine.
    pub(super) tumble: f64,
}

impl Path {
    /// At rest.
    pub(super) fn at(start: Point2<f64>) -> Self {
        let still = Vector2::zeros();
        Self { start, velocity: still, acceleration: still, angle: 0.0, omega: 0.0, alpha: 0.0, tumble: 0.0 }
    }

    pub(super) fn middle(&self, time: f64) -> Point2<f64> {
        self.start + self.velocity * time + self.acceleration * (0.5 * time * time)
    }

    pub(super) fn velocity(&self, time: f64) -> Vector2<f64> {
        self.velocity + self.acceleration * time
    }

    pub(super) fn angle(&self, time: f64) -> f64 {
        self.angle + self.omega * time + 0.5 * self.alpha * time * time
    }

    pub(super) fn omega(&self, time: f64) -> f64 {
        self.omega + self.alpha * time
    }

    /// Largest of the speeds at two times, of the middle in pixels per second, and of turn and tumble in rad/s: between these times none is larger.
    fn fastest(&self, times: [f64; 2]) -> [f64; 2] {
        let speeds = times.map(|time| [self.velocity(time).norm(), self.omega(time).abs() + self.tumble.abs()]);
        let [first, last] = speeds;
        [first[0].max(last[0]), first[1].max(last[1])]
    }

    fn linear(&self, time: f64) -> Matrix2<f64> {
        let turn = Rotation2::new(-self.angle(time)).into_inner();
        turn * Matrix2::new((self.tumble * time).cos(), 0.0, 0.0, 1.0)
    }
}

impl Body {
    /// The contours at a time, moved by `shift`, as `[column, row]` of a picture of this height.
    pub(super) fn in_picture(&self, time: f64, shift: Vector2<f64>, height: f64) -> Vec<Vec<Point2<f64>>> {
        let (linear, middle) = (self.path.linear(time), self.path.middle(time) + shift);
        let place = |p: &Point2<f64>| {
            let p = middle + linear * p.coords;
            Point2::new(p.x, height - p.y)
        };
        self.contours.iter().map(|contour| contour.iter().map(place).collect()).collect()
    }

    /// A speed that no point of it is beyond between two times, in pixels per second.
    pub(super) fn fastest(&self, times: [f64; 2]) -> f64 {
        let reach = self.contours.iter().flatten().map(|p| p.coords.norm()).fold(0.0, f64::max);
        let [travel, turn] = self.path.fastest(times);
        travel + turn * reach
    }

    /// A hole with its middle at a place of the body.
    pub(super) fn with_hole(mut self, hole: &[Point2<f64>], at: Vector2<f64>) -> Self {
        self.contours.push(hole.iter().rev().map(|p| p + at).collect());
        self
    }
}

/// A disc.
pub(super) fn disc(radius: f64) -> Vec<Point2<f64>> {
    let count = (TAU * radius / CHORD).ceil().max(24.0) as usize;
    (0..count).map(|k| TAU * k as f64 / count as f64).map(|a| Point2::new(radius * a.cos(), radius * a.sin())).collect()
}

/// A disc with `teeth` trapezoidal teeth of height `depth`; `notch` of them have been filed down to a deeper gap.
pub(super) fn gear(radius: f64, teeth: u32, depth: f64, notch: u32) -> Vec<Point2<f64>> {
    let pitch = TAU / f64::from(teeth);
    let corner = |angle: f64, radius: f64| Point2::new(radius * angle.cos(), radius * angle.sin());
    let mut points = Vec::new();
    for tooth in 0..teeth {
        let angle = f64::from(tooth) * pitch;
        let (root, tip) = if tooth < notch { (radius - depth, radius - depth) } else { (radius, radius + depth) };
        for (at, radius) in [(0.0, root), (0.2, root), (0.35, tip), (0.7, tip), (0.85, root)] {
            points.push(corner(angle + at * pitch, radius));
        }
    }
    centred(&points)
}

/// A polygon about the middle of its area.
pub(super) fn polygon(corners: &[[f64; 2]], scale: f64) -> Vec<Point2<f64>> {
    let points: Vec<Point2<f64>> = corners.iter().map(|[x, y]| Point2::new(scale * x, scale * y)).collect();
    centred(&points)
}

/// Moved so that the middle of its area is at the origin.
fn centred(points: &[Point2<f64>]) -> Vec<Point2<f64>> {
    let edges = points.iter().zip(points.iter().cycle().skip(1));
    let (mut doubled, mut moment) = (0.0, Vector2::zeros());
    for (p, q) in edges {
        let cross = p.coords.perp(&q.coords);
        doubled += cross;
        moment += cross * (p.coords + q.coords);
    }
    let middle = moment / (3.0 * doubled);
    points.iter().map(|p| p - middle).collect()
}

/// An L with arms of different lengths.
pub(super) fn letter_l(size: f64) -> Vec<Point2<f64>> {
    polygon(&[[0.0, 0.0], [0.7, 0.0], [0.7, 0.28], [0.3, 0.28], [0.3, 1.0], [0.0, 1.0]], size)
}

/// An egg: a closed curve without a symmetry but one mirror axis.
pub(super) fn egg(size: f64) -> Vec<Point2<f64>> {
    let count = (4.0 * size / CHORD).ceil() as usize;
    let corners = (0..count).map(|k| TAU * k as f64 / count as f64);
    let points: Vec<[f64; 2]> =
        corners.map(|a| [0.62 * a.cos() * (1.0 + 0.2 * a.cos()), 0.4 * a.sin() * (1.0 - 0.2 * a.cos())]).collect();
    polygon(&points, size)
}

/// A star of five points.
pub(super) fn star(size: f64) -> Vec<Point2<f64>> {
    let corner = |k: u32| {
        let (angle, radius) = (TAU * f64::from(k) / 10.0, if k.is_multiple_of(2) { 0.5 } else { 0.24 });
        [radius * angle.cos(), radius * angle.sin()]
    };
    polygon(&(0..10).map(corner).collect::<Vec<_>>(), size)
}
