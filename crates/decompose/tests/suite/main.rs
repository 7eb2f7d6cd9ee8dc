//! One program for all of them, since each costs a link and its share of compiling.
mod common;
mod decomposition;
mod hostile_curves;
mod invariants;
mod related_points;
mod roots;
