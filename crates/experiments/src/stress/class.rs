use std::fmt;

/// What is unusual about the sequences of a kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Class {
    /// Nothing: independent errors and a constant generator.
    Plain,
    /// Errors that depend on each other, along the contour or from frame to frame.
    Noise,
    /// The outlines change in a way that the family of motions does not contain.
    Family,
    /// The motion is not a constant generator.
    Dynamics,
    /// Outlines that show their turn hardly or not at all.
    Round,
    /// Outlines that look the same after a part of a turn.
    Symmetry,
}

impl Class {
    /// All of them, in the order of the report.
    pub const ALL: [Self; 6] = [Self::Plain, Self::Noise, Self::Family, Self::Dynamics, Self::Round, Self::Symmetry];

    /// The word that stands for it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Plain => "plain",
            Self::Noise => "noise",
            Self::Family => "family",
            Self::Dynamics => "dynamics",
            Self::Round => "round",
            Self::Symmetry => "symmetry",
        }
    }

    /// What it is, in a line.
    #[must_use]
    pub const fn description(self) -> &'static str {
        match self {
            Self::Plain => "independent errors and a constant generator: what the motion filter assumes",
            Self::Noise => "errors that depend on each other, along the contour or from frame to frame",
            Self::Family => "rigid motion is asked for, and the outlines change in other ways as well",
            Self::Dynamics => "the motion is not a constant generator",
            Self::Round => "outlines that show their turn hardly or not at all",
            Self::Symmetry => "outlines that look the same after a part of a turn, turning in their place",
        }
    }
}

impl fmt::Display for Class {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}
