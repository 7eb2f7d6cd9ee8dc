//! Masks whose grey values are the numbers of objects.
pub(crate) mod evidence;
pub(crate) mod label_mask;
pub(crate) mod pictures;
pub(crate) mod void_border;
