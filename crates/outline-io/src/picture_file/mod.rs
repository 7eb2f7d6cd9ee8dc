//! Pictures from files: single ones, sequences, animations and video.
pub(crate) mod channel;
pub(crate) mod compressed_video;
pub(crate) mod error;
pub(crate) mod file_pattern;
pub(crate) mod files;
pub(crate) mod gif_animation;
pub(crate) mod gif_interval;
pub(crate) mod jpeg_end;
pub(crate) mod natural_order;
pub(crate) mod palette;
pub(crate) mod picture;
pub(crate) mod read_ahead;
pub(crate) mod sequence;
pub(crate) mod source_picture;
pub(crate) mod tiff_pages;
pub(crate) mod y4m;
