//! Which object of a picture is which of the pictures before.
pub(crate) mod affine_moment_invariants;
pub(crate) mod assignment;
pub(crate) mod common_step;
pub(crate) mod contacts;
pub(crate) mod identities;
pub(crate) mod known_object;
