//! Writes eleven drawn shapes as masks, white on black, 512 x 512 pixels of two values: the silhouettes of the tables in docs/.
//!
//! ```text
//! cargo run --release --example drawn_shapes -- shapes
//! ```
//!
//! None is a built-in shape. With thin parts, notches, fingers and sharp dents they vary as silhouettes of real objects do.
use std::{error::Error, path::PathBuf};

use Vertex::{Corner as C, Smooth as S};
use freeform_motion::{
    curve_fit::{Outline, PixelGrid, Rectangle},
    sim_camera::Mask,
};
use nalgebra::{Point2, Vector2};

/// Columns and rows of a mask.
const SIZE: usize = 512;
/// Pixels of the longer side of the box around a shape; a margin of black lies round it.
const SIDE: f64 = 480.0;
/// Points on each piece of a curve: their chords leave it by less than a tenth of a pixel.
const POINTS: usize = 32;

/// A vertex of the control polygon of a drawing, in any unit; y is up.
#[derive(Debug, Clone, Copy)]
enum Vertex {
    /// Draws the curve towards it.
    Smooth(f64, f64),
    /// The curve has a corner there.
    Corner(f64, f64),
}

fn main() -> Result<(), Box<dyn Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).ok_or("give the folder to write the masks to")?);
    std::fs::create_dir_all(&folder)?;
    for (name, outline) in drawn_shapes() {
        let file = folder.join(name).with_extension("png");
        let mask = mask(&outline)?;
        image::save_buffer(&file, &mask.grey, SIZE as u32, SIZE as u32, image::ExtendedColorType::L8)?;
        println!("{}", file.display());
    }
    Ok(())
}

/// The names of the shapes, and points of their outlines in order, in the units of the drawings.
pub(crate) fn drawn_shapes() -> [(&'static str, Vec<Point2<f64>>); 11] {
    [
        ("bat", curve(&BAT)),
        ("boot", curve(&BOOT)),
        ("cloud", curve(&CLOUD)),
        ("comma", curve(&COMMA)),
        ("fish", curve(&FISH)),
        ("flask", curve(&FLASK)),
        ("glove", curve(&GLOVE)),
        ("key", curve(&KEY)),
        ("leaf", curve(&LEAF)),
        ("pickup", curve(&PICKUP)),
        ("wrench", curve(&WRENCH)),
    ]
}

/// The mask of a shape, in the middle of the picture.
pub(crate) fn mask(points: &[Point2<f64>]) -> Result<Mask, Box<dyn Error>> {
    let around = Rectangle::around(points.iter()).ok_or("a shape without points")?;
    let pitch = around.size().max() / SIDE;
    let middle = 0.5 * SIZE as f64;
    let grid = PixelGrid::new([middle, middle], around.centre(), Vector2::new(pitch, -pitch));
    Ok(Mask::of_outline(&Outline::closed(points.to_vec())?, [SIZE, SIZE], &grid)?.binary())
}

/// Points along the closed quadratic B-spline of a control polygon: parabolas from middle to middle of its sides. A vertex taken
/// twice is a corner.
fn curve(vertices: &[Vertex]) -> Vec<Point2<f64>> {
    let mut control = Vec::new();
    for vertex in vertices {
        match *vertex {
            S(x, y) => control.push(Point2::new(x, y)),
            C(x, y) => control.extend([Point2::new(x, y); 2]),
        }
    }
    let count = control.len();
    let mut points = Vec::with_capacity(POINTS * count);
    for (i, vertex) in control.iter().enumerate() {
        let from = nalgebra::center(&control[(i + count - 1) % count], vertex);
        let to = nalgebra::center(vertex, &control[(i + 1) % count]);
        for k in 0..POINTS {
            let t = k as f64 / POINTS as f64;
            points.push(from.lerp(vertex, t).lerp(&vertex.lerp(&to, t), t));
        }
    }
    points.dedup();
    points
}

/// Wings spread, seen from below.
#[rustfmt::skip]
const BAT: [Vertex; 29] = [
    C(0.0, -1.9), S(0.45, -1.0), C(1.3, -1.5), S(1.9, -0.5), C(3.2, -1.1), S(3.6, 0.1), C(5.2, -0.6), S(5.0, 0.9),
    S(3.9, 1.7), C(3.2, 2.0), S(2.2, 1.2), S(1.1, 0.8), S(0.5, 0.9), C(0.7, 2.0), S(0.2, 1.5), S(-0.2, 1.5),
    C(-0.6, 2.05), S(-0.5, 0.9), S(-1.2, 0.75), S(-2.4, 1.3), C(-3.5, 1.75), S(-4.3, 1.2), S(-5.0, 0.1),
    C(-5.1, -1.1), S(-3.8, -0.2), C(-3.1, -1.4), S(-2.0, -0.6), C(-1.3, -1.6), S(-0.5, -1.0),
];

/// Toe to the right.
#[rustfmt::skip]
const BOOT: [Vertex; 17] = [
    C(-1.7, 0.0), C(-0.5, 0.0), C(-0.4, 0.5), S(0.7, 0.5), S(1.8, 0.0), S(3.8, -0.05), S(4.4, 0.6), S(3.7, 1.5),
    S(2.0, 1.6), S(0.9, 2.3), S(0.9, 3.6), C(1.3, 5.7), S(-0.3, 5.3), C(-1.5, 5.8), S(-1.2, 3.5), S(-1.8, 2.0),
    S(-1.6, 1.0),
];

/// Lobes that meet in sharp dents.
#[rustfmt::skip]
const CLOUD: [Vertex; 22] = [
    S(-3.2, -1.0), S(3.4, -1.0), S(6.2, -1.1), S(7.5, 0.7), S(6.3, 2.9), C(3.9, 2.1), S(5.3, 3.2), S(5.0, 5.2),
    S(3.1, 5.7), C(2.0, 4.3), S(2.3, 6.3), S(0.6, 7.7), S(-1.7, 7.4), S(-2.9, 5.9), C(-2.3, 4.2), S(-3.5, 5.5),
    S(-5.5, 5.0), S(-5.6, 3.1), C(-4.2, 2.2), S(-6.3, 3.0), S(-7.6, 1.1), S(-6.6, -1.0),
];

#[rustfmt::skip]
const COMMA: [Vertex; 12] = [
    S(1.8, 1.4), S(0.4, 2.2), S(-1.3, 1.9), S(-2.0, 0.4), S(-1.3, -1.1), S(0.2, -1.3), S(0.9, -1.1), S(0.7, -2.4),
    C(-0.9, -3.6), S(1.4, -3.1), S(2.5, -1.2), S(2.6, 0.4),
];

/// Swimming to the left.
#[rustfmt::skip]
const FISH: [Vertex; 23] = [
    S(-4.9, 0.2), S(-4.0, -1.0), S(-2.5, -1.5), C(-1.2, -1.5), C(-0.6, -2.4), C(0.2, -1.3), S(1.8, -0.9),
    S(2.9, -0.3), S(3.5, -0.6), C(4.8, -2.0), S(4.2, -0.2), S(4.3, 0.5), C(5.1, 2.1), S(3.5, 0.8), S(2.8, 0.3),
    S(2.0, 0.8), C(1.4, 1.0), C(1.7, 1.9), S(0.3, 2.4), S(-1.0, 2.3), C(-1.9, 1.5), S(-3.4, 1.4), S(-4.4, 0.8),
];

/// Mirror-symmetric.
#[rustfmt::skip]
const FLASK: [Vertex; 14] = [
    S(-2.6, 0.0), S(2.6, 0.0), S(2.6, 0.7), S(0.7, 3.3), S(0.7, 4.0), C(0.7, 4.8), C(1.05, 4.85), C(1.05, 5.25),
    C(-1.05, 5.25), C(-1.05, 4.85), C(-0.7, 4.8), S(-0.7, 4.0), S(-0.7, 3.3), S(-2.6, 0.7),
];

/// Five fingers.
#[rustfmt::skip]
const GLOVE: [Vertex; 29] = [
    C(-1.2, -3.2), C(1.2, -3.2), S(1.2, -1.6), S(1.8, -0.4), S(2.8, 0.8), S(3.2, 1.8), S(2.4, 2.1), S(1.9, 1.2),
    S(1.4, 0.3), S(1.8, 2.3), S(1.9, 3.6), S(1.0, 3.7), S(0.9, 2.4), S(0.6, 0.5), S(0.6, 3.0), S(0.5, 4.4),
    S(-0.4, 4.4), S(-0.3, 2.9), S(-0.2, 0.5), S(-0.8, 2.4), S(-1.1, 3.8), S(-2.0, 3.5), S(-1.6, 2.2), S(-1.3, -0.4),
    S(-2.2, 0.8), S(-3.2, 1.6), S(-3.5, 0.6), S(-2.4, -0.7), S(-1.3, -1.8),
];

#[rustfmt::skip]
const KEY: [Vertex; 21] = [
    C(-1.75, -0.4), C(1.6, -0.4), C(1.6, -1.0), C(2.1, -1.0), C(2.1, -0.7), C(2.6, -0.7), C(2.6, -1.25),
    C(3.3, -1.25), C(3.3, -0.4), S(4.3, -0.4), S(4.7, 0.0), S(4.3, 0.4), C(-1.75, 0.4), S(-1.8, 1.3), S(-2.8, 1.9),
    S(-4.2, 1.8), S(-5.1, 0.9), S(-5.1, -0.9), S(-4.2, -1.8), S(-2.8, -1.9), S(-1.8, -1.3),
];

/// Thin, bent, with a stalk.
#[rustfmt::skip]
const LEAF: [Vertex; 13] = [
    C(-5.4, -1.5), S(-4.0, -0.9), S(-2.6, -1.4), S(0.0, -1.2), S(2.5, 0.1), S(4.3, 1.5), C(5.4, 3.4), S(3.8, 2.6),
    S(1.5, 1.6), S(-1.0, 0.9), S(-2.8, 0.3), S(-4.1, -0.55), C(-5.5, -1.2),
];

/// Driving to the right.
#[rustfmt::skip]
const PICKUP: [Vertex; 20] = [
    C(-3.1, 0.0), S(-3.0, -0.6), S(-2.3, -0.95), S(-1.6, -0.6), C(-1.5, 0.0), C(1.5, 0.0), S(1.6, -0.6),
    S(2.3, -0.95), S(3.0, -0.6), C(3.1, 0.0), S(4.1, 0.0), S(4.2, 0.6), S(4.0, 1.1), S(2.3, 1.2), S(1.5, 1.3),
    S(1.0, 2.5), S(-0.7, 2.5), C(-0.8, 1.25), C(-4.1, 1.25), C(-4.1, 0.0),
];

/// Its jaw open to the right.
#[rustfmt::skip]
const WRENCH: [Vertex; 22] = [
    S(-2.8, -0.5), S(1.7, -0.6), S(2.4, -1.8), S(3.8, -2.4), C(5.6, -1.8), C(5.3, -0.95), S(3.8, -1.0), S(3.4, 0.0),
    S(3.7, 0.95), C(5.0, 1.1), C(5.0, 2.0), S(3.4, 2.4), S(2.3, 1.5), S(1.7, 0.55), S(-2.8, 0.5), S(-3.3, 1.2),
    S(-4.5, 1.4), S(-5.5, 0.8), S(-5.7, 0.0), S(-5.5, -0.9), S(-4.5, -1.3), S(-3.3, -1.1),
];
