use freeform_curve_fit::Degree;
use serde::{Deserialize, Serialize};

use crate::{decomposition::Decomposition, error::DecompositionError, line::Line};

/// The parts of a decomposition as they are saved. They come back to the last bit.
#[derive(Serialize, Deserialize)]
pub(crate) struct SavedDecomposition {
    degree: Degree,
    lines: Vec<Line>,
    coefficients: Vec<f64>,
}

impl From<Decomposition> for SavedDecomposition {
    fn from(decomposition: Decomposition) -> Self {
        let levels = decomposition.levels();
        Self {
            degree: decomposition.degree(),
            lines: levels.clone().flat_map(|level| decomposition.level(level)).copied().collect(),
            coefficients: levels.chain([0]).map(|level| decomposition.coefficient(level)).collect(),
        }
    }
}

impl TryFrom<SavedDecomposition> for Decomposition {
    type Error = DecompositionError;

    fn try_from(SavedDecomposition { degree, lines, coefficients }: SavedDecomposition) -> Result<Self, Self::Error> {
        // Lines that a map has brought close to each other stay a decomposition.
        Self::assembled(degree, &lines, &coefficients)
    }
}
