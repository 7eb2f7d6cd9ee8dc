//! How much a Parquet file may unpack to. Its columns can say very often the same in a few bytes, which CSV cannot.
use crate::error::ReadErrorKind;

/// Outlines that a file may hold however short it is: nine minutes of one object at rest at 30 frames a second.
const OUTLINES: u64 = 1 << 14;

/// Bytes of a file for each further outline. Eight points that differ from outline to outline take about as many: two bytes for each
/// coordinate that is rounded to a hundredth of a pixel.
const BYTES_OF_OUTLINE: u64 = 32;

/// Points that a file may hold however short it is: four megabytes of coordinates for each of x and y would not be shorter as they are.
const POINTS: u64 = 1 << 22;

/// Further points for each byte of a file: half a bit for each point, less than any that is not a copy.
const POINTS_OF_BYTE: u64 = 16;

/// What has been unpacked of a file so far, and how much may be.
#[derive(Debug)]
pub(crate) struct Unpacked {
    outlines: u64,
    points: u64,
    length: u64,
}

impl Unpacked {
    /// Nothing yet of a file of so many bytes.
    pub(crate) const fn of_file(length: u64) -> Self {
        Self { outlines: 0, points: 0, length }
    }

    /// Counts an outline.
    pub(crate) fn add_outline(&mut self) -> Result<(), ReadErrorKind> {
        self.outlines += 1;
        self.check()
    }

    /// Counts points.
    pub(crate) fn add_points(&mut self, count: usize) -> Result<(), ReadErrorKind> {
        self.points += count as u64;
        self.check()
    }

    fn check(&self) -> Result<(), ReadErrorKind> {
        let length = self.length;
        let outlines = OUTLINES + length / BYTES_OF_OUTLINE;
        let points = POINTS.saturating_add(length.saturating_mul(POINTS_OF_BYTE));
        if self.outlines > outlines || self.points > points {
            return Err(ReadErrorKind::UnpacksToTooMuch { outlines, points, length });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_longer_file_may_hold_more() {
        let limit = |length| {
            let mut unpacked = Unpacked::of_file(length);
            (0..).find(|_| unpacked.add_outline().is_err())
        };
        assert_eq!(limit(0), Some(1 << 14));
        assert_eq!(limit(1 << 20), Some((1 << 14) + (1 << 15)));
        let mut unpacked = Unpacked::of_file(0);
        assert!(unpacked.add_points(1 << 22).is_ok());
        assert!(unpacked.add_points(1).is_err());
        assert!(Unpacked::of_file(u64::MAX).add_points(usize::MAX).is_ok());
    }
}
