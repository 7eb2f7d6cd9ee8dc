use nalgebra::Affine2;

/// How one known outline compares with one that was seen.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Comparison {
    /// Position of the known outline in the order in which they were added.
    pub known: usize,
    /// Mahalanobis distance of the invariants: `sqrt(d' C^-1 d)`. `None` where either curve has none.
    pub invariant_distance: Option<f64>,
    /// How the outlines lie on each other; `None` where the invariants left it out.
    pub fit: Option<OutlineFit>,
}

/// A known outline brought onto one that was seen.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct OutlineFit {
    /// From the coordinates of the known outline to those of the one seen.
    pub map: Affine2<f64>,
    /// Root mean square distance of the outlines from each other, in radii of the disc that has their inertia.
    pub distance: f64,
    /// What that would be by noise alone, in the same unit: of both outlines, and of tracing.
    pub expected: f64,
}
