//! Sequences of any length of which a bounded number is kept.

/// Values of a sequence, evenly spread over it: of every so many, a power of two, the first.
#[derive(Debug)]
pub(crate) struct Thinned<T> {
    kept: Vec<Kept<T>>,
    /// Of so many the first is kept.
    every: usize,
    /// Values seen so far, those included that were not known.
    seen: usize,
    is_broken: bool,
}

/// A value that was kept.
#[derive(Debug)]
pub(crate) struct Kept<T> {
    pub(crate) value: T,
    /// Whether everything since the value kept before it was known, so that a line may lead here from there.
    pub(crate) follows: bool,
    number: usize,
}

impl<T> Default for Thinned<T> {
    fn default() -> Self {
        Self { kept: Vec::new(), every: 1, seen: 0, is_broken: true }
    }
}

impl<T> Thinned<T> {
    /// What is kept, in order.
    pub(crate) fn kept(&self) -> &[Kept<T>] {
        &self.kept
    }

    /// Of so many values the first is kept.
    pub(crate) fn every(&self) -> usize {
        self.every
    }

    /// Whether the next value would be kept.
    pub(crate) fn keeps_next(&self) -> bool {
        self.seen.is_multiple_of(self.every)
    }

    /// Takes the next value.
    pub(crate) fn push(&mut self, value: T) {
        if self.keeps_next() {
            self.kept.push(Kept { value, follows: !self.is_broken, number: self.seen });
            self.is_broken = false;
        }
        self.seen += 1;
    }

    /// Passes over a value that is not kept, though it is known.
    pub(crate) fn pass(&mut self) {
        self.seen += 1;
    }

    /// Takes note that the next value is not known.
    pub(crate) fn skip(&mut self) {
        self.seen += 1;
        self.break_off();
    }

    /// Takes note that no line leads from the last value to the next.
    pub(crate) fn break_off(&mut self) {
        self.is_broken = true;
    }

    /// Keeps half as many.
    pub(crate) fn halve(&mut self) {
        self.every *= 2;
        let mut is_broken = false;
        self.kept.retain_mut(|kept| {
            let stays = kept.number.is_multiple_of(self.every);
            is_broken |= !kept.follows;
            if stays {
                kept.follows = !std::mem::take(&mut is_broken);
            }
            stays
        });
        self.is_broken |= is_broken;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn however_long_a_sequence_is_a_bounded_number_is_kept_and_no_line_bridges_what_was_not_known() {
        let mut thinned = Thinned::default();
        for value in 0..1000_usize {
            if value == 333 {
                thinned.skip();
            } else {
                thinned.push(value);
            }
            while thinned.kept().len() > 60 {
                thinned.halve();
            }
        }
        let (kept, every) = (thinned.kept(), thinned.every());
        assert!(every.is_power_of_two() && (30..=60).contains(&kept.len()), "{every} {}", kept.len());
        assert!(kept.iter().all(|kept| kept.value % every == 0 && kept.value == kept.number));
        let broken: Vec<usize> = kept.iter().filter(|kept| !kept.follows).map(|kept| kept.value).collect();
        assert_eq!(broken, [0, 333_usize.next_multiple_of(every)]);
    }
}
