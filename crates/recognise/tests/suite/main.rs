//! One program for all of them, since each costs a link and its share of compiling.
mod bad_input;
mod evidence;
mod recognition;
mod support;
