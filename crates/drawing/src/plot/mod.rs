//! Figures as SVG: panels with axes, ticks at round numbers and a legend above the data.
mod curve_marks;
mod legend;
mod panel;
mod style;
mod text;
mod ticks;

pub use style::Svg;
pub(crate) use style::{panel_svg, stacked_svg};
pub(crate) use text::escape;
