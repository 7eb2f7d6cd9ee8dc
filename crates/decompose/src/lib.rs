//! Implicit polynomials as sums of products of complex lines.
mod companion;
mod condition;
mod decomposition;
mod error;
mod line;
mod line_product;
mod roots;
mod rotation_chart;

pub use companion::companion_roots;
pub use condition::Condition;
pub use decomposition::Decomposition;
pub use error::{CorrespondenceError, DecompositionError, RootError};
pub use line::Line;
pub use roots::{Roots, binary_form_roots};
pub use rotation_chart::{from_rotation_chart, rotation_chart};
