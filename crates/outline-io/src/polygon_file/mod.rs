//! Outlines that annotation programs have written: COCO, labelme, TrackMate.
pub(crate) mod bodies;
pub(crate) mod coco;
pub(crate) mod error;
pub(crate) mod labelme;
pub(crate) mod labelme_files;
pub(crate) mod polygons;
pub(crate) mod trackmate;
