//! Writes a sheet with all built-in shapes as SVG to standard output, or to the file named.
//!
//! `cargo run -p freeform-sim-camera --example shape_sheet -- shapes.svg`
use std::fmt::Write as _;

use freeform_curve_fit::Rectangle;
use freeform_sim_camera::BuiltInShape;
use nalgebra::Point2;

const CELL: f64 = 220.0;
const COLUMNS: usize = 5;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let rows = BuiltInShape::ALL.len().div_ceil(COLUMNS);
    let (width, height) = (CELL * COLUMNS as f64, CELL * rows as f64);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\">\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"white\"/>\n"
    );
    for (place, built_in) in BuiltInShape::ALL.into_iter().enumerate() {
        let x = CELL * ((place % COLUMNS) as f64 + 0.5);
        let y = CELL * ((place / COLUMNS) as f64 + 0.45);
        let points = built_in.shape().sample(800, 0.0);
        // The middle of the box around the shape goes to the middle of the cell.
        let middle = Rectangle::around(points.iter()).map_or_else(Point2::origin, |around| around.centre());
        let offsets = points.iter().map(|p| 0.75 * CELL * (p - middle));
        let path: Vec<String> = offsets.map(|v| format!("{:.2},{:.2}", x + v.x, y - v.y)).collect();
        writeln!(
            svg,
            "<polygon points=\"{}\" fill=\"#d8e2ee\" stroke=\"#234\" stroke-width=\"1.5\"/>",
            path.join(" ")
        )?;
        writeln!(svg, "<text x=\"{x}\" y=\"{}\" text-anchor=\"middle\">{built_in}</text>", y + 0.52 * CELL)?;
    }
    svg.push_str("</svg>\n");
    match std::env::args().nth(1) {
        Some(file) => std::fs::write(file, svg)?,
        None => print!("{svg}"),
    }
    Ok(())
}
