//! Why polygons of an annotation program could not be read.
use thiserror::Error;

use crate::file_name::readable;

/// Why polygons of an annotation program could not be read.
#[derive(Debug, Error)]
pub enum PolygonError {
    /// Text that is no JSON, or is other than a field should be.
    #[error("{}", readable(&.0.to_string()))]
    Json(#[from] serde_json::Error),
    /// Text that is no XML.
    #[error("byte {position}: {}", readable(&source.to_string()))]
    Xml {
        /// Where in the file.
        position: u64,
        /// The reason.
        source: quick_xml::Error,
    },
    /// JSON or XML of another kind.
    #[error("no polygons: expected COCO (images and annotations), labelme (shapes) or TrackMate (XML)")]
    Unknown,
    /// Files of different kinds, or several where one holds all frames.
    #[error("several files: only those of labelme, one a picture, are read together")]
    SeveralFiles,
    /// Larger than is read.
    #[error("larger than {limit} bytes")]
    TooLarge {
        /// Bytes that are read.
        limit: u64,
    },
    /// An annotation of a picture that is not listed.
    #[error("annotation {annotation} is of image {image}, which is not among the images")]
    NoImage {
        /// The annotation.
        annotation: String,
        /// The image that it names.
        image: String,
    },
    /// Pictures of several videos.
    #[error("images of the videos {first} and {second}: one video is read at a time")]
    SeveralVideos {
        /// One of them.
        first: String,
        /// Another.
        second: String,
    },
    /// A mask where polygons are needed.
    #[error("annotation {annotation} is a run-length mask, polygons are read")]
    RunLength {
        /// The annotation.
        annotation: String,
    },
    /// An annotation or spot without a polygon.
    #[error("{item} has no polygon")]
    NoPolygon {
        /// What has none.
        item: String,
    },
    /// A list of coordinates that ends with an x.
    #[error("{item}: {count} coordinates, expected pairs")]
    OddCoordinates {
        /// Of what.
        item: String,
        /// Their number.
        count: usize,
    },
    /// Two outlines that cannot be told apart.
    #[error("two outlines of {object:?} in {picture}: {remedy}")]
    SameName {
        /// The name of both.
        object: String,
        /// The picture.
        picture: String,
        /// What would tell them apart.
        remedy: &'static str,
    },
    /// A name that every outline of a track or category would have a copy of.
    #[error("a name of {length} bytes, up to {limit} are read")]
    LongName {
        /// Its length.
        length: usize,
        /// The longest that is read.
        limit: usize,
    },
    /// Something that should be there.
    #[error("{element} lacks {attribute}")]
    Missing {
        /// The element.
        element: &'static str,
        /// What it lacks.
        attribute: &'static str,
    },
    /// Text where a number should be.
    #[error("{attribute} of {element}: {text:?} is not a finite number")]
    NotANumber {
        /// The element.
        element: &'static str,
        /// The attribute or its text.
        attribute: &'static str,
        /// What is there, shortened.
        text: String,
    },
    /// Spots that were not linked.
    #[error("no tracks: link the spots in TrackMate before saving")]
    NoTracks,
}
