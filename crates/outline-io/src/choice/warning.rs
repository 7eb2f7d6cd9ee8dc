//! What a user should know of a way of tracing that was chosen.
use std::fmt;

/// What a user should know of a way of tracing that was chosen: a [`code`](Self::code) for programs, a message for people.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TracingWarning {
    /// No way tells an object from the ground beyond doubt.
    Doubtful,
    /// What is traced rests, and the pictures change elsewhere.
    MovesBesideRest {
        /// Pictures in which they do.
        seen: usize,
        /// Pictures looked at.
        pictures: usize,
    },
    /// What is traced moves, and so does something else, which is not traced.
    MovesBeside {
        /// Pictures in which it is seen to move.
        seen: usize,
        /// Pictures looked at.
        pictures: usize,
    },
}

impl TracingWarning {
    /// A short name that stays the same: `tracing_doubtful`, `moves_beside_rest` or `moves_beside`.
    #[must_use]
    pub const fn code(&self) -> &'static str {
        match self {
            Self::Doubtful => "tracing_doubtful",
            Self::MovesBesideRest { .. } => "moves_beside_rest",
            Self::MovesBeside { .. } => "moves_beside",
        }
    }
}

impl fmt::Display for TracingWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Doubtful => f.write_str("no way of tracing tells an object from the ground beyond doubt"),
            Self::MovesBesideRest { seen, pictures } => {
                write!(f, "what is traced rests, and something else changes in {seen} of {pictures} pictures tried")
            }
            Self::MovesBeside { seen, pictures } => {
                write!(f, "something else than what is traced moves, seen in {seen} of {pictures} pictures tried")
            }
        }
    }
}
