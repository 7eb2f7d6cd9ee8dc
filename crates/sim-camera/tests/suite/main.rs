//! One program for all of them, since each costs a link and its share of compiling.
mod pictures;
mod raster;
mod scene;
mod shapes;
mod simulation;
mod trajectory;
