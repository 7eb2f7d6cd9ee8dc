//! What the program `freeform` measures and reproduces: baselines, Monte Carlo studies, and the figures of the paper.
pub mod baseline;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDoctests;
