//! One outline of one object, with its frame and time.
use freeform_curve_fit::Outline;

/// Name of the object where a file has no `object` column.
pub const DEFAULT_OBJECT: &str = "0";

/// Longest name of an object that a file gives once for many outlines, in bytes: each outline has its own copy.
pub(crate) const NAME_LIMIT: usize = 1 << 12;

/// What one frame of a sequence shows of one object.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct OutlineFrame {
    /// Number of the frame; numbers may have gaps.
    pub frame: u64,
    /// Time of the frame in seconds.
    pub time: f64,
    /// Name of the object, [`DEFAULT_OBJECT`] where the file does not tell objects apart.
    pub object: String,
    /// The outline, in the length unit of the file.
    pub outline: Outline,
}
