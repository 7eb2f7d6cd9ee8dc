//! Whether objects are lighter or darker than the ground.
/// Whether objects are lighter or darker than the ground.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Contrast {
    /// Light objects, as in masks.
    #[default]
    LightOnDark,
    /// Dark objects.
    DarkOnLight,
}

/// Grey value on a scale where the object is lighter.
pub(crate) fn signal(value: u8, contrast: Contrast) -> u8 {
    match contrast {
        Contrast::LightOnDark => value,
        Contrast::DarkOnLight => u8::MAX - value,
    }
}
