use nalgebra::{Point2, Rotation2, Vector2};

/// Nodes and weights of the 5-point Gauss-Legendre rule on [0, 1]; exact for polynomials up to degree 9.
const GAUSS: [(f64, f64); 5] = [
    (0.046_910_077_030_668_0, 0.118_463_442_528_094_54),
    (0.230_765_344_947_158_45, 0.239_314_335_249_683_23),
    (0.5, 0.284_444_444_444_444_44),
    (0.769_234_655_052_841_5, 0.239_314_335_249_683_23),
    (0.953_089_922_969_332, 0.118_463_442_528_094_54),
];

/// A cubic Bezier segment; a straight one is stored with its inner control points at the thirds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Segment {
    control: [Point2<f64>; 4],
    pub(crate) straight: bool,
}

impl Segment {
    pub(crate) fn line(from: Point2<f64>, to: Point2<f64>) -> Self {
        let third = (to - from) / 3.0;
        Self { control: [from, from + third, to - third, to], straight: true }
    }

    /// From two points and the unit tangents there, with the handles that reproduce a circular arc where the data is
    /// one: `chord / (3 cos^2(turn / 4))`.
    fn between(from: &Knot, to: &Knot) -> Self {
        let chord = to.point - from.point;
        let turn = from.tangent.angle(&to.tangent);
        if turn < 1e-9 && from.tangent.angle(&chord) < 1e-9 {
            return Self::line(from.point, to.point);
        }
        let handle = chord.norm() / (3.0 * (0.25 * turn).cos().powi(2));
        let control = [from.point, from.point + handle * from.tangent, to.point - handle * to.tangent, to.point];
        Self { control, straight: false }
    }

    pub(crate) fn point(&self, t: f64) -> Point2<f64> {
        let [a, b, c, d] = self.control.map(|p| p.coords);
        let u = 1.0 - t;
        Point2::from(u * u * u * a + 3.0 * u * u * t * b + 3.0 * u * t * t * c + t * t * t * d)
    }

    /// Derivative with respect to the parameter t in [0, 1].
    pub(crate) fn derivative(&self, t: f64) -> Vector2<f64> {
        let [a, b, c, d] = self.control;
        let u = 1.0 - t;
        3.0 * (u * u * (b - a) + 2.0 * u * t * (c - b) + t * t * (d - c))
    }

    pub(crate) fn arc_length(&self, from: f64, to: f64) -> f64 {
        let width = to - from;
        GAUSS.iter().map(|(x, w)| w * width * self.derivative(from + x * width).norm()).sum()
    }

    /// Contribution to the area and to its first moments by Green's theorem, both exact:
    /// `area = 1/2 sum (x y' - y x')`, `moments = 1/3 sum (x, y) (x y' - y x')`.
    pub(crate) fn area_and_moments(&self) -> (f64, Vector2<f64>) {
        GAUSS.iter().fold((0.0, Vector2::zeros()), |(area, moments), (t, w)| {
            let p = self.point(*t);
            let swept = w * p.coords.perp(&self.derivative(*t));
            (area + 0.5 * swept, moments + swept * p.coords / 3.0)
        })
    }

    pub(crate) fn reversed(&self) -> Self {
        let [a, b, c, d] = self.control;
        Self { control: [d, c, b, a], ..*self }
    }

    /// Moved by `-centre`, then scaled.
    pub(crate) fn normalised(&self, centre: &Vector2<f64>, scale: f64) -> Self {
        Self { control: self.control.map(|p| Point2::from((p.coords - centre) * scale)), ..*self }
    }
}

/// One vertex of a drawing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Vertex {
    /// The curve passes smoothly through `(x, y)`.
    Smooth(f64, f64),
    /// A corner at `(x, y)`, cut back by the given length along both sides and rounded there.
    Corner(f64, f64, f64),
}

impl Vertex {
    fn position(self) -> Point2<f64> {
        match self {
            Self::Smooth(x, y) | Self::Corner(x, y, _) => Point2::new(x, y),
        }
    }
}

/// A point of the curve and its unit tangent.
struct Knot {
    point: Point2<f64>,
    tangent: Vector2<f64>,
}

/// Unit tangents at the smooth vertices, zero at corners, from the cubic spline in chord-length parameters: with spans
/// h, chord slopes D and slopes m, `m0/h0 + 2 (1/h0 + 1/h1) m1 + m2/h1 = 3 (D0/h0 + D1/h1)`. The span next to a corner is
/// a parabola, `m0 = 2 D0 - m1`.
fn spline_tangents(vertices: &[Vertex]) -> Vec<Vector2<f64>> {
    /// The system is dominated by its diagonal 2 to 1, so that a sweep gains two bits or more.
    const SWEEPS: usize = 40;
    let count = vertices.len();
    let chord = |i: usize| vertices[(i + 1) % count].position() - vertices[i % count].position();
    let mut slopes = vec![Vector2::zeros(); count];
    for i in (0..SWEEPS * count).map(|k| k % count).filter(|i| matches!(vertices[*i], Vertex::Smooth(..))) {
        let (mut diagonal, mut right) = (0.0, Vector2::zeros());
        for (other, chord) in [((i + count - 1) % count, chord(i + count - 1)), ((i + 1) % count, chord(i))] {
            let h = chord.norm();
            let slope = chord / h;
            match vertices[other] {
                Vertex::Smooth(..) => {
                    diagonal += 2.0 / h;
                    right += (3.0 * slope - slopes[other]) / h;
                }
                Vertex::Corner(..) => {
                    diagonal += 1.0 / h;
                    right += slope / h;
                }
            }
        }
        slopes[i] = right / diagonal;
    }
    slopes.into_iter().map(|m| m.try_normalize(0.0).unwrap_or_default()).collect()
}

/// The closed curve with continuous tangent through the vertices of a drawing.
pub(crate) fn smooth_path(vertices: &[Vertex]) -> Vec<Segment> {
    let count = vertices.len();
    let at = |i: usize| vertices[i % count].position();
    let tangents = spline_tangents(vertices);
    // A corner's side runs straight to another corner, and to a smooth vertex along a circular arc.
    let side = |corner: usize, other: usize| {
        let chord = (at(other) - at(corner)).normalize();
        match vertices[other % count] {
            Vertex::Corner(..) => chord,
            Vertex::Smooth(..) => {
                let tangent = tangents[other % count];
                let along = if tangent.dot(&chord) < 0.0 { -tangent } else { tangent };
                2.0 * along.dot(&chord) * chord - along
            }
        }
    };
    let mut knots = Vec::with_capacity(2 * count);
    for (i, vertex) in vertices.iter().enumerate() {
        match *vertex {
            Vertex::Smooth(x, y) => knots.push(Knot { point: Point2::new(x, y), tangent: tangents[i] }),
            Vertex::Corner(x, y, cut) => {
                let (back, forward) = (side(i, i + count - 1), side(i, i + 1));
                let corner = Point2::new(x, y);
                knots.push(Knot { point: corner + cut * back, tangent: -back });
                knots.push(Knot { point: corner + cut * forward, tangent: forward });
            }
        }
    }
    let pairs = knots.iter().zip(knots.iter().cycle().skip(1));
    // A corner with no cut has its two knots in one place.
    pairs.filter(|(from, to)| from.point != to.point).map(|(from, to)| Segment::between(from, to)).collect()
}

/// An axis-parallel ellipse about the origin, from 32 arcs that leave it by less than 1e-9 of its size.
pub(crate) fn ellipse_path(a: f64, b: f64) -> Vec<Segment> {
    const ARCS: u32 = 32;
    let turn = std::f64::consts::TAU / f64::from(ARCS);
    let handle = 4.0 / 3.0 * (0.25 * turn).tan();
    let at = |k: u32| Rotation2::new(turn * f64::from(k % ARCS)) * Vector2::x();
    let quarter = Rotation2::new(std::f64::consts::FRAC_PI_2);
    (0..ARCS)
        .map(|k| {
            let (p, q) = (at(k), at(k + 1));
            let circle = [p, p + handle * (quarter * p), q - handle * (quarter * q), q];
            Segment { control: circle.map(|v| Point2::new(a * v.x, b * v.y)), straight: false }
        })
        .collect()
}
