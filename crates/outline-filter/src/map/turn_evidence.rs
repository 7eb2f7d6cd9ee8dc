/// What frames have said of the turn about the object's centroid.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) enum TurnEvidence {
    /// As much as the normals of the cells promise.
    #[default]
    AsTheNormals,
    /// Frames have not shown it, whatever the normals promise.
    Hidden,
    /// What a frame has shown for the first time shows it, by the normals.
    AtLast,
    /// The map was begun anew with a frame that shows it, and no other frame has told it since.
    New(TimesBegun),
    /// As [`New`](Self::New), and the last frame has not shown it again.
    NewAndHidden(TimesBegun),
    /// Frames together have not told it as well as the normals promise: it is not asked for any more.
    Refuted,
}

/// How often maps have been begun anew, one after the other, each with a frame that seemed to show the turn, and none after it that showed it again.
/// Zero times where one was to be, and the frame did not show the turn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct TimesBegun(pub(crate) usize);

/// What frames or cells say of the turn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum TurnEvent {
    /// The map was begun anew with a frame that shows the turn, after so many others that no frame has confirmed.
    Begun { before: TimesBegun },
    /// The map was to be begun anew, and the frame does not show the turn.
    NotBegun,
    /// A frame has shown the turn.
    Confirmed,
    /// A frame has not shown the turn.
    NotSeen,
    /// Frames together have not told the turn as well as the normals promise.
    Refuted,
    /// Whether it is seen is asked anew: of another frame, or of other cells.
    AskedAnew,
    /// New cells show it by their normals, where those before did not.
    ShownByGrowth,
    /// New cells show no more of it than those before.
    NotShownByGrowth,
}

impl TurnEvidence {
    pub(crate) fn after(self, event: TurnEvent) -> Self {
        match (event, self) {
            (TurnEvent::Refuted, _) | (_, Self::Refuted) => Self::Refuted,
            (TurnEvent::Begun { before }, _) => Self::New(TimesBegun(before.0.saturating_add(1))),
            (TurnEvent::NotBegun, Self::Hidden) => Self::NewAndHidden(TimesBegun(0)),
            (TurnEvent::NotBegun, Self::New(_) | Self::NewAndHidden(_)) => self,
            (TurnEvent::NotBegun, _) => Self::New(TimesBegun(0)),
            (TurnEvent::Confirmed, Self::New(_)) => Self::AsTheNormals,
            (TurnEvent::NotSeen, Self::New(begun) | Self::NewAndHidden(begun)) => Self::NewAndHidden(begun),
            (TurnEvent::NotSeen, _) => Self::Hidden,
            (TurnEvent::AskedAnew, Self::Hidden) => Self::AsTheNormals,
            (TurnEvent::AskedAnew, Self::NewAndHidden(begun)) => Self::New(begun),
            (TurnEvent::ShownByGrowth, _) => Self::AtLast,
            (TurnEvent::NotShownByGrowth, Self::AtLast) => Self::AsTheNormals,
            (TurnEvent::Confirmed | TurnEvent::AskedAnew | TurnEvent::NotShownByGrowth, _) => self,
        }
    }

    /// Whether one frame alone has shown it so far.
    pub(crate) fn is_new(self) -> bool {
        matches!(self, Self::New(_) | Self::NewAndHidden(_))
    }

    /// Whether frames have not shown it, so that it is a null direction whatever the normals promise.
    pub(crate) fn is_hidden(self) -> bool {
        matches!(self, Self::Hidden | Self::NewAndHidden(_) | Self::Refuted)
    }

    /// How often maps have been begun in vain, this one included as long as no frame has confirmed it.
    pub(crate) fn times_begun(self) -> TimesBegun {
        match self {
            Self::New(begun) | Self::NewAndHidden(begun) => begun,
            Self::AsTheNormals | Self::Hidden | Self::AtLast | Self::Refuted => TimesBegun(0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// After a map that was begun with a frame, and another that has not shown the turn.
    fn begun_in_vain(before: TurnEvidence) -> TurnEvidence {
        let begun = TurnEvidence::default().after(TurnEvent::Begun { before: before.times_begun() });
        begun.after(TurnEvent::NotSeen)
    }

    #[test]
    fn maps_begun_in_vain_are_counted_until_a_frame_confirms_the_turn() {
        let twice = begun_in_vain(begun_in_vain(TurnEvidence::Hidden));
        assert_eq!(twice, TurnEvidence::NewAndHidden(TimesBegun(2)));
        let asked = twice.after(TurnEvent::AskedAnew);
        assert_eq!((asked, asked.after(TurnEvent::NotSeen)), (TurnEvidence::New(TimesBegun(2)), twice));
        assert_eq!(asked.after(TurnEvent::Confirmed).times_begun(), TimesBegun(0));
        assert_eq!(twice.after(TurnEvent::NotBegun), twice);
        assert_eq!(twice.after(TurnEvent::Refuted).after(TurnEvent::AskedAnew), TurnEvidence::Refuted);
        assert!(twice.is_hidden() && twice.is_new() && !asked.is_hidden() && asked.is_new());
    }

    #[test]
    fn a_map_that_was_to_be_begun_and_was_not_counts_for_none() {
        assert_eq!(TurnEvidence::Hidden.after(TurnEvent::NotBegun), TurnEvidence::NewAndHidden(TimesBegun(0)));
        assert_eq!(TurnEvidence::AsTheNormals.after(TurnEvent::NotBegun), TurnEvidence::New(TimesBegun(0)));
    }
}
