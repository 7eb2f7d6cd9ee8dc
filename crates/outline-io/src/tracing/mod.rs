//! From a picture to the closed curves around its objects.
pub(crate) mod basins;
pub(crate) mod connected_components;
pub(crate) mod contrast;
pub(crate) mod field;
pub(crate) mod flat_bodies;
pub(crate) mod input;
pub(crate) mod margins;
pub(crate) mod morphology;
pub(crate) mod object_mask;
pub(crate) mod ring;
pub(crate) mod settings;
pub(crate) mod threshold;
pub(crate) mod trace;
pub(crate) mod transfer;
