//! Outlines and times from arbitrary bytes, with a bias to what is hard: integer grids, repeated points, huge offsets and
//! units, raw bit patterns, and outlines that go on from the one before as those of a moving object do.
use freeform_motion::curve_fit::{OpenArc, OpenOutline, Outline};
use nalgebra::{Affine2, Point2, Rotation2, Vector2};

/// Reads values off bytes; zeros after the end.
#[derive(Debug)]
pub(crate) struct HostileInput<'a> {
    bytes: &'a [u8],
    last: Option<Outline>,
    time: f64,
}

impl<'a> HostileInput<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, last: None, time: 0.0 }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.bytes.is_empty()
    }

    pub(crate) fn byte(&mut self) -> u8 {
        let Some((&first, rest)) = self.bytes.split_first() else { return 0 };
        self.bytes = rest;
        first
    }

    fn signed(&mut self) -> f64 {
        f64::from(self.byte() as i8)
    }

    /// Any bit pattern.
    fn raw(&mut self) -> f64 {
        f64::from_le_bytes([(); 8].map(|()| self.byte()))
    }

    /// The time of the next frame: mostly later by a thirtieth of a second, sometimes anything.
    pub(crate) fn next_time(&mut self) -> f64 {
        self.time = match self.byte() {
            0 => self.raw(),
            1 => self.time,
            2 => self.time + 1e6,
            3 => self.time + 1e-9,
            step => self.time + f64::from(step % 8 + 1) / 30.0,
        };
        self.time
    }

    /// The next outline; `None` where the points make none.
    pub(crate) fn next_outline(&mut self) -> Option<Outline> {
        let kind = self.byte();
        if kind & 0b1100_0000 != 0
            && let Some(last) = self.last.take()
        {
            let moved = last.moved(&self.small_motion()).ok();
            self.last = Some(moved.clone().unwrap_or(last));
            return moved;
        }
        let count = usize::from(self.byte());
        let unit = [1.0, 1e-6, 1e6, 1e60][usize::from(kind >> 2 & 3)];
        let offset = if kind & 0b10_0000 == 0 { Vector2::zeros() } else { Vector2::new(1e6, -1e6) * unit };
        let points: Vec<Point2<f64>> = (0..count)
            .map(|index| match kind & 3 {
                0 => Point2::from(Vector2::new(self.signed(), self.signed()) * unit + offset),
                1 => Point2::new(self.raw(), self.raw()),
                2 => Point2::from(Vector2::new(self.signed().sin(), self.signed()) * unit + offset),
                _ => {
                    let angle = std::f64::consts::TAU * index as f64 / count as f64;
                    let radius = 1.0 + self.signed() / 256.0;
                    Point2::from(Vector2::new(angle.cos(), angle.sin()) * radius * unit + offset)
                }
            })
            .collect();
        let outline = if kind & 0b1_0000 == 0 { Outline::closed(points).ok() } else { open(points, self.byte()) };
        self.last.clone_from(&outline);
        outline
    }

    fn small_motion(&mut self) -> Affine2<f64> {
        let (turn, growth) = (self.signed() / 256.0, 1.0 + self.signed() / 2048.0);
        let size = self.last.as_ref().map_or(1.0, Outline::rms_radius);
        let shift = Vector2::new(self.signed(), self.signed()) / 256.0 * size;
        let matrix = (Rotation2::new(turn).into_inner() * growth).to_homogeneous().append_translation(&shift);
        Affine2::from_matrix_unchecked(matrix)
    }
}

/// Two arcs, split at a point.
fn open(mut points: Vec<Point2<f64>>, split: u8) -> Option<Outline> {
    let second = points.split_off(usize::from(split).min(points.len()));
    let arcs: Vec<OpenArc> = [points, second].into_iter().filter_map(|points| OpenArc::new(points).ok()).collect();
    OpenOutline::new(arcs).ok().map(Outline::Open)
}
