//! What a picture shows where no object is.
pub(crate) mod background;
pub(crate) mod ground_picture;
pub(crate) mod ground_surface;
