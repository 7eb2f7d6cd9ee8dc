//! Frame and time of the latest outline of every object, so that both increase.
use std::collections::HashMap;

use crate::error::ReadErrorKind;
use crate::table::column::Column;

/// Names kept at least, those of the latest outlines.
const KEPT: usize = 1 << 14;

/// Frame number and time of the latest outline of every object; of more objects than 32768 at most those seen last.
#[derive(Debug, Default)]
pub(crate) struct LatestFrames {
    latest: HashMap<String, Latest>,
    /// Outlines so far.
    outlines: u64,
}

#[derive(Debug)]
struct Latest {
    frame: u64,
    time: f64,
    /// Number of the outline.
    outline: u64,
}

/// Refuses an outline whose frame or time, given as a pair, does not come after those of the outline before of its object; tells in which column.
pub(crate) fn check_order(
    object: &str,
    (frame, time): (u64, f64),
    (previous_frame, previous): (u64, f64),
) -> Result<(), (Column, ReadErrorKind)> {
    let object = || object.to_owned();
    if frame == previous_frame {
        return Err((Column::Frame, ReadErrorKind::SecondOutline { object: object(), frame }));
    }
    if frame < previous_frame {
        let kind = ReadErrorKind::FrameNotIncreasing { object: object(), frame, previous: previous_frame };
        return Err((Column::Frame, kind));
    }
    if time <= previous {
        return Err((Column::Time, ReadErrorKind::TimeNotIncreasing { object: object(), frame, previous, time }));
    }
    Ok(())
}

impl LatestFrames {
    /// As [`check_order`], after the latest outline of the object.
    pub(crate) fn check(&self, object: &str, outline: (u64, f64)) -> Result<(), (Column, ReadErrorKind)> {
        self.of(object).map_or(Ok(()), |latest| check_order(object, outline, latest))
    }

    /// Frame number and time of the latest outline of an object.
    pub(crate) fn of(&self, object: &str) -> Option<(u64, f64)> {
        self.latest.get(object).map(|latest| (latest.frame, latest.time))
    }

    /// Remembers an outline; forgets half of the objects where there are very many, so that memory does not grow without end.
    pub(crate) fn set(&mut self, object: &str, (frame, time): (u64, f64)) {
        let new = Latest { frame, time, outline: self.outlines };
        self.outlines += 1;
        match self.latest.get_mut(object) {
            Some(latest) => *latest = new,
            None => {
                self.latest.insert(object.to_owned(), new);
            }
        }
        if self.latest.len() > 2 * KEPT {
            let mut numbers: Vec<u64> = self.latest.values().map(|latest| latest.outline).collect();
            let (_, &mut oldest_kept, _) = numbers.select_nth_unstable(KEPT);
            self.latest.retain(|_, latest| latest.outline > oldest_kept);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_very_many_objects_those_seen_last_are_known() {
        let mut latest = LatestFrames::default();
        for object in 0..10 * KEPT as u64 {
            latest.set("always", (object, 0.5));
            latest.set(&object.to_string(), (object, 0.25));
            assert!(latest.latest.len() <= 2 * KEPT);
        }
        let last = 10 * KEPT as u64 - 1;
        assert_eq!((latest.of("always"), latest.of(&last.to_string())), (Some((last, 0.5)), Some((last, 0.25))));
        assert_eq!(latest.of("0"), None);
    }
}
