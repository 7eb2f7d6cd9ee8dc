//! Outlines that are worked on side by side.
use crate::input::Input;

/// Outlines that are worked on side by side at most.
const OUTLINES_AT_ONCE: usize = 64;

/// Points of these outlines from which on no more are waited for.
const POINTS_AT_ONCE: usize = 1 << 18;

/// What waits until there is enough of it to be worked on side by side.
pub(super) struct SideBySide<T> {
    items: Vec<T>,
    /// Points of the outlines among them.
    points: usize,
    at_once: usize,
}

impl<T> SideBySide<T> {
    /// Of an input, as many as need not be waited for.
    pub(super) fn of(input: &Input) -> Self {
        // A stream may stand still: what has come is not kept waiting.
        let at_once = if input.is_stream() { 1 } else { OUTLINES_AT_ONCE };
        Self { items: Vec::new(), points: 0, at_once }
    }

    /// Adds one with so many points.
    pub(super) fn add(&mut self, item: T, points: usize) {
        self.items.push(item);
        self.points += points;
    }

    pub(super) fn are_enough(&self) -> bool {
        self.items.len() >= self.at_once || self.points >= POINTS_AT_ONCE
    }

    /// All of them; none waits after that.
    pub(super) fn take(&mut self) -> Vec<T> {
        self.points = 0;
        std::mem::take(&mut self.items)
    }
}
