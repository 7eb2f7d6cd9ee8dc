//! Outlines from and to files: streamed CSV, and the outlines of objects in pictures, animations and video.
//!
//! ```
//! use freeform_outline_io::{OutlineReader, read_shape};
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let csv = "frame,time,x,y\n0,0.00,0,0\n0,0.00,2,0\n0,0.00,0,1\n1,0.04,1,0\n1,0.04,3,0\n1,0.04,1,1\n";
//! for frame in OutlineReader::new(csv.as_bytes(), "<memory>")? {
//!     let frame = frame?;
//!     println!("{} s: area {}", frame.time, frame.outline.signed_area());
//! }
//!
//! let error = read_shape("/nowhere/shape.csv").expect_err("no such file");
//! assert!(error.to_string().starts_with("/nowhere/shape.csv: "));
//! # Ok(())
//! # }
//! ```
//!
//! - [`OutlineReader`] and [`OutlineWriter`] stream outlines as CSV.
//! - `ParquetReader` and `ParquetWriter` (feature `parquet`) do so as Parquet; [`TableWriter`] writes either.
//! - [`OutlineFile`] reads Parquet, and polygons of COCO, labelme and TrackMate.
//! - [`read_picture`] reads a picture; [`trace_mask`] finds the outline of its largest object to a fraction of a pixel.
//! - [`PictureSequence`] reads pictures, animations and video; [`PictureOutlines`] finds the objects in them and follows them.
//! - [`TracedPictures`] gives outlines with their pictures, as a tracker takes them.
//! - [`PicturePreview`] looks at pictures before they are read, and [`choose_tracing`] chooses how they are traced.
//! - [`LabelMask::trace`] finds the outlines of the objects of a labelled mask.
//! - [`OutlineColumns`] are outlines as columns of a table in memory with one row per point, [`OutlineLists`] with one row per outline.
//! - [`read_shape`] reads one closed outline from either.
//!
//! Pictures are PNG, BMP, GIF or y4m; also JPEG, TIFF and WebP with the feature `all-pictures`, which is on by default.
mod choice;
mod csv_file;
mod edges;
mod error;
mod file_name;
mod foreign_format;
mod frame;
mod ground;
mod identity;
mod labels;
mod origin_warning;
mod outline_file;
#[cfg(feature = "parquet")]
mod parquet_file;
mod picture_file;
mod picture_outlines;
mod picture_preview;
mod pixel_aspect;
mod polygon_file;
mod shape;
mod table;
mod traced_pictures;
mod tracing;
mod whole_pixels;
mod write_error;

pub use choice::{
    PictureSample, SamplePlan, Tracing, TracingChoice, TracingEvidence, TracingWarning, TracingWay, choose_tracing,
};
pub use csv_file::comments::read_comments;
pub use csv_file::reader::OutlineReader;
pub use csv_file::writer::{OutlineWriter, WriterOptions};
pub use edges::{EdgeFit, EdgeProfile, SoughtEdges};
pub use error::{Place, ReadError, ReadErrorKind, ReadShapeError, Span};
pub use file_name::readable;
pub use frame::{DEFAULT_OBJECT, OutlineFrame};
pub use ground::background::{Background, Difference, median_picture};
pub use ground::ground_picture::ground_picture;
pub use identity::affine_moment_invariants::AffineMomentInvariants;
pub use identity::contacts::AfterContact;
pub use identity::identities::{AmongAlike, Identities, Selection};
pub use image::GrayImage;
pub use labels::evidence::LabelEvidence;
pub use labels::label_mask::{LabelMask, TracedLabel};
pub use labels::pictures::{LabelInParts, LabelLeftOut, LabelPictures};
pub use origin_warning::{OriginWarning, OriginWarnings};
pub use outline_file::{FilePoints, OutlineFile, TableFormat, TableWriter};
#[cfg(feature = "parquet")]
pub use parquet_file::reader::ParquetReader;
#[cfg(feature = "parquet")]
pub use parquet_file::writer::ParquetWriter;
pub use picture_file::channel::Channel;
pub use picture_file::error::{PictureError, PictureErrorKind, TraceError};
pub use picture_file::files::{has_picture_extension, picture_files};
pub use picture_file::natural_order::out_of_number_order;
pub use picture_file::picture::{decode_picture, read_picture, read_picture_channel};
pub use picture_file::read_ahead::read_ahead;
pub use picture_file::sequence::{PictureFrame, PictureSequence, SequenceSettings};
pub use picture_file::source_picture::SourcePicture;
pub use picture_outlines::{PictureOutlines, PictureSettings, TracedFrame};
pub use picture_preview::{OutlineUncertainty, PicturePreview};
pub use pixel_aspect::PixelAspectCheck;
pub use polygon_file::error::PolygonError;
pub use polygon_file::labelme_files::labelme_files;
pub use polygon_file::polygons::{PolygonSettings, VerticalAxis};
pub use shape::read_shape;
pub use table::column::Column;
pub use table::keys::ColumnsError;
pub use table::outline_columns::{ColumnOutlines, OutlineColumns};
pub use table::outline_lists::{ListChunk, ListOutlines, Lists, Marks, OutlineLists};
pub use traced_pictures::{TracedPicture, TracedPictures, TracingSummary};
pub use tracing::contrast::Contrast;
pub use tracing::margins::Margins;
pub use tracing::ring::Ring;
pub use tracing::settings::{Clipping, Contours, Edges, Smoothing, TraceSettings};
pub use tracing::threshold::Threshold;
pub use tracing::trace::{TracedOutline, is_two_valued, trace_mask, trace_objects};
pub use tracing::transfer::Transfer;
pub use write_error::WriteError;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDoctests;
