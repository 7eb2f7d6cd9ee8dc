/// How far the outlines of a sequence may lie off, in their unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum OutlineError {
    /// As far as their edges say.
    Edges(f64),
    /// As the rounding of masks whose pixels have this size.
    MaskPixel(f64),
}
