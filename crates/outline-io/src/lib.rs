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
mod affine_moment_invariants;
mod assignment;
mod background;
mod basins;
mod channel;
mod choice;
mod coco;
mod column;
mod common_step;
mod compressed_video;
mod contacts;
mod contrast;
mod csv_columns;
mod csv_comments;
mod csv_field;
mod csv_lines;
mod csv_reader;
mod csv_rows;
mod csv_writer;
mod edges;
mod error;
mod field;
mod file_name;
mod file_pattern;
mod flat_bodies;
mod foreign_format;
mod frame;
mod gif_animation;
mod gif_interval;
mod ground_picture;
mod ground_surface;
mod header_hint;
mod identity;
mod jpeg_end;
mod known_object;
mod label_evidence;
mod label_pictures;
mod labelme;
mod labelme_files;
mod labels;
mod latest_frames;
mod margins;
mod morphology;
mod natural_order;
mod not_csv;
mod object_mask;
mod origin_warning;
mod outline_columns;
mod outline_file;
mod outline_lists;
mod outline_rows;
mod palette;
#[cfg(feature = "parquet")]
mod parquet_batch;
#[cfg(feature = "parquet")]
mod parquet_columns;
#[cfg(feature = "parquet")]
mod parquet_leaf;
#[cfg(feature = "parquet")]
mod parquet_limit;
#[cfg(feature = "parquet")]
mod parquet_pages;
#[cfg(feature = "parquet")]
mod parquet_reader;
#[cfg(feature = "parquet")]
mod parquet_schema;
#[cfg(feature = "parquet")]
mod parquet_source;
#[cfg(feature = "parquet")]
mod parquet_table;
#[cfg(feature = "parquet")]
mod parquet_writer;
mod picture;
mod picture_error;
mod picture_files;
mod picture_outlines;
mod picture_preview;
mod picture_sequence;
mod pixel_aspect;
mod polygon_bodies;
mod polygon_error;
mod polygons;
mod read_ahead;
mod ring;
mod rounding;
mod segment;
mod shape;
mod source_picture;
mod table_keys;
mod threshold;
mod tiff_pages;
mod trace;
mod trace_settings;
mod traced_pictures;
mod tracing_input;
mod trackmate;
mod transfer;
mod void_border;
mod whole_pixels;
mod write_error;
mod y4m;

pub use affine_moment_invariants::AffineMomentInvariants;
pub use background::{Background, Difference, median_picture};
pub use channel::Channel;
pub use choice::{
    PictureSample, SamplePlan, Tracing, TracingChoice, TracingEvidence, TracingWarning, TracingWay, choose_tracing,
};
pub use column::Column;
pub use contacts::AfterContact;
pub use contrast::Contrast;
pub use csv_comments::read_comments;
pub use csv_reader::OutlineReader;
pub use csv_writer::{OutlineWriter, WriterOptions};
pub use edges::{EdgeFit, EdgeProfile, SoughtEdges};
pub use error::{Place, ReadError, ReadErrorKind, ReadShapeError, Span};
pub use file_name::readable;
pub use frame::{DEFAULT_OBJECT, OutlineFrame};
pub use ground_picture::ground_picture;
pub use identity::{AmongAlike, Identities, Selection};
pub use image::GrayImage;
pub use label_evidence::LabelEvidence;
pub use label_pictures::{LabelInParts, LabelLeftOut, LabelPictures};
pub use labelme_files::labelme_files;
pub use labels::{LabelMask, TracedLabel};
pub use margins::Margins;
pub use natural_order::out_of_number_order;
pub use origin_warning::{OriginWarning, OriginWarnings};
pub use outline_columns::{ColumnOutlines, OutlineColumns};
pub use outline_file::{FilePoints, OutlineFile, TableFormat, TableWriter};
pub use outline_lists::{ListChunk, ListOutlines, Lists, Marks, OutlineLists};
#[cfg(feature = "parquet")]
pub use parquet_reader::ParquetReader;
#[cfg(feature = "parquet")]
pub use parquet_writer::ParquetWriter;
pub use picture::{decode_picture, read_picture, read_picture_channel};
pub use picture_error::{PictureError, PictureErrorKind, TraceError};
pub use picture_files::{has_picture_extension, picture_files};
pub use picture_outlines::{PictureOutlines, PictureSettings, TracedFrame};
pub use picture_preview::{OutlineUncertainty, PicturePreview};
pub use picture_sequence::{PictureFrame, PictureSequence, SequenceSettings};
pub use pixel_aspect::PixelAspectCheck;
pub use polygon_error::PolygonError;
pub use polygons::{PolygonSettings, VerticalAxis};
pub use read_ahead::read_ahead;
pub use ring::Ring;
pub use shape::read_shape;
pub use source_picture::SourcePicture;
pub use table_keys::ColumnsError;
pub use threshold::Threshold;
pub use trace::{TracedOutline, is_two_valued, trace_mask, trace_objects};
pub use trace_settings::{Clipping, Contours, Edges, Smoothing, TraceSettings};
pub use traced_pictures::{TracedPicture, TracedPictures, TracingSummary};
pub use transfer::Transfer;
pub use write_error::WriteError;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDoctests;
