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
    New,
    /// As [`New`](Self::New), and the last frame has not shown it again.
    NewAndHidden,
    /// Frames together have not told it as well as the normals promise: it is not asked for any more.
    Refuted,
}

/// What frames or cells say of the turn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum TurnEvent {
    /// The map was begun anew with a frame that shows the turn.
    Begun,
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
            (TurnEvent::Begun, Self::Hidden | Self::NewAndHidden) => Self::NewAndHidden,
            (TurnEvent::Begun, _) => Self::New,
            (TurnEvent::Confirmed, Self::New) => Self::AsTheNormals,
            (TurnEvent::NotSeen, Self::New | Self::NewAndHidden) => Self::NewAndHidden,
            (TurnEvent::NotSeen, _) => Self::Hidden,
            (TurnEvent::AskedAnew, Self::Hidden) => Self::AsTheNormals,
            (TurnEvent::AskedAnew, Self::NewAndHidden) => Self::New,
            (TurnEvent::ShownByGrowth, _) => Self::AtLast,
            (TurnEvent::NotShownByGrowth, Self::AtLast) => Self::AsTheNormals,
            (TurnEvent::Confirmed | TurnEvent::AskedAnew | TurnEvent::NotShownByGrowth, _) => self,
        }
    }

    /// Whether one frame alone has shown it so far.
    pub(crate) fn is_new(self) -> bool {
        matches!(self, Self::New | Self::NewAndHidden)
    }

    /// Whether frames have not shown it, so that it is a null direction whatever the normals promise.
    pub(crate) fn is_hidden(self) -> bool {
        matches!(self, Self::Hidden | Self::NewAndHidden | Self::Refuted)
    }
}
