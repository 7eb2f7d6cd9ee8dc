//! One program for all of them, since each costs a link and its share of compiling.
mod bad_pictures;
mod choice;
mod cmyk;
mod columns;
mod contours;
mod csv_bad_input;
mod csv_bad_sources;
mod csv_cut_anywhere;
mod csv_round_trip;
mod edge_profiles;
mod edges;
mod identities;
mod labels;
mod light;
mod lists;
#[cfg(feature = "parquet")]
mod origin_warnings;
#[cfg(feature = "parquet")]
mod parquet;
#[cfg(feature = "parquet")]
mod parquet_deviations;
mod pictures_as_people_have_them;
mod polygons;
mod samples;
mod sequences;
mod side_by_side;
mod support;
mod tracing;
