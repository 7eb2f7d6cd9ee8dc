use freeform_curve_fit::Outline;
use nalgebra::{Matrix3, Point2};

#[cfg(feature = "serde")]
use super::settings::FilterSettings;
use super::{motion_change::MotionHistory, taken_ahead::TakenAhead};
#[cfg(feature = "serde")]
use crate::track::SavedCells;
use crate::{
    map::CellsInCommon,
    track::{PlacedFrame, Track},
    tuning::remapping as tuning,
};

/// Whether frames are still kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
enum Window {
    #[default]
    Open,
    Closed,
}

/// How far the map is cut anew: a stage in each frame that is taken.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) enum Remapping {
    #[default]
    Idle,
    /// The points of the frames kept, in order, to be cut: where rivals take most of the time that a frame has.
    Placed(Box<Placed>),
    /// Cut, and not measured yet.
    Drafted(Box<Draft>),
    /// The present track and its rivals take the frames kept on the new cells, a few in each step.
    Measured(Box<Measured>),
    /// To be cut again, after so many cuts, from frames that have these cells in common at least.
    Again { cuts: usize, in_common: CellsInCommon },
    /// A stage that is due before the next frame is looked at. It is made before the state is saved.
    #[cfg_attr(feature = "serde", serde(skip))]
    Due(Due),
}

/// What is to be done to the frames kept, without the one that comes next.
#[derive(Debug, Clone)]
pub(super) enum Due {
    /// Their points are to be put in order, for the hypothesis of a turn, after so many cuts, where they have these cells in common at least.
    Placing { turn: f64, cuts: usize, in_common: CellsInCommon },
    /// Cells are to be cut along their points.
    Cutting(Box<Placed>),
}

/// How far the frames kept have been taken on cells cut anew, between two frames.
#[derive(Debug, Clone)]
pub(super) enum Ahead {
    Taking(Box<Remapped>),
    /// All of them have been; `None` where the track that did so is none to be exchanged for.
    Taken(Option<Box<Remapped>>),
}

/// Points of the frames kept in the body frame, in their order along each piece of the outline, and whether that is closed.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Placed {
    pub(super) runs: Vec<(Vec<Point2<f64>>, bool)>,
    /// Of the hypothesis by which they have been placed.
    pub(super) turn: f64,
    /// Cuts before.
    pub(super) cuts: usize,
    /// What cells are cut along them: none in common where a constant motion has placed them.
    pub(super) in_common: CellsInCommon,
}

/// A track of cells cut anew.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Draft {
    pub(super) track: Track,
    /// Of the hypothesis that it was cut for.
    pub(super) turn: f64,
    /// Cuts one after the other, this one included.
    pub(super) cuts: usize,
    /// How it was cut.
    pub(super) in_common: CellsInCommon,
}

/// Hypotheses on cells cut anew.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Measured {
    /// The track that all are begun with, at the first of the frames kept.
    pub(super) begun: Draft,
    pub(super) present: Remapped,
    /// By their turns; none where a frame was not taken.
    pub(super) rivals: Vec<(f64, Option<Remapped>)>,
}

/// A track that has taken some of the frames kept on a map cut anew, how the motion changes in them, and their poses.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Remapped {
    pub(super) track: Track,
    pub(super) history: MotionHistory,
    pub(super) poses: Vec<Matrix3<f64>>,
}

impl Remapped {
    /// A track that stands at the first of the frames kept.
    pub(super) fn at_first(track: Track) -> Self {
        let poses = vec![*track.first_body_pose()];
        Self { track, history: MotionHistory::default(), poses }
    }

    /// Number of frames taken, the first included.
    pub(super) fn frames_taken(&self) -> usize {
        self.poses.len()
    }
}

#[cfg(feature = "serde")]
impl Draft {
    fn restore(&mut self, restore: impl Fn(&mut Track) -> bool) -> bool {
        self.turn.is_finite() && self.cuts <= tuning::MOST_CUTS && restore(&mut self.track)
    }
}

#[cfg(feature = "serde")]
impl Remapped {
    /// Whether it can be gone on with, `kept` being the number of frames kept.
    fn restore(&mut self, settings: &FilterSettings, kept: usize, restore: impl Fn(&mut Track) -> bool) -> bool {
        (1..=kept).contains(&self.frames_taken())
            && self.history.is_valid(settings)
            && self.poses.iter().flatten().all(|entry| entry.is_finite())
            && restore(&mut self.track)
    }
}

/// The frames that a map was begun from, kept until it has been cut from enough of them.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct InitialisationWindow {
    frames: Vec<(f64, Outline)>,
    /// What the map found of them.
    poses: Vec<Matrix3<f64>>,
    points: usize,
    state: Window,
    remapping: Remapping,
    /// Of a map that has been cut, for the next frame alone.
    #[cfg_attr(feature = "serde", serde(skip))]
    ahead: Option<Ahead>,
    /// Where there are rivals.
    #[cfg_attr(feature = "serde", serde(skip))]
    taken_ahead: TakenAhead,
}

impl InitialisationWindow {
    /// Begins with the first frame of a map.
    pub(super) fn begin(time: f64, outline: &Outline, track: &Track) -> Self {
        let mut frames = Self {
            frames: vec![(time, outline.clone())],
            poses: vec![*track.body_pose()],
            points: outline.point_count(),
            state: Window::Open,
            remapping: Remapping::Idle,
            ahead: None,
            taken_ahead: TakenAhead::default(),
        };
        frames.end_unless_few(track.cell_count());
        frames
    }

    /// Takes another unit of time.
    pub(super) fn divide_times(&mut self, unit: f64) {
        self.frames.iter_mut().for_each(|(time, _)| *time /= unit);
    }

    /// Forgets what is kept.
    pub(super) fn end(&mut self) {
        *self = Self { state: Window::Closed, ..Self::default() };
    }

    /// Begins anew with a frame, unless a map has been cut already, which knows more of the outline than frames yet to come.
    pub(super) fn begin_anew(&mut self, time: f64, outline: &Outline, track: &Track) {
        if self.frames.len() < tuning::OCCASIONS[0] && self.state == Window::Open {
            *self = Self::begin(time, outline, track);
        } else {
            self.end();
        }
    }

    /// Keeps a frame that follows the others, in the pose of the map; whether the map is to be cut from them now.
    pub(super) fn keep(&mut self, time: f64, outline: &Outline, track: &Track) -> bool {
        if self.state == Window::Closed {
            return false;
        }
        self.frames.push((time, outline.clone()));
        self.poses.push(*track.body_pose());
        self.points += outline.point_count();
        tuning::OCCASIONS.contains(&self.frames.len())
    }

    /// Number of frames kept.
    pub(super) fn len(&self) -> usize {
        self.frames.len()
    }

    /// The first frame kept.
    pub(super) fn first(&self) -> Option<&Outline> {
        self.frames.first().map(|(_, outline)| outline)
    }

    /// The frame kept last.
    pub(super) fn last(&self) -> Option<&Outline> {
        self.frames.last().map(|(_, outline)| outline)
    }

    /// Whether there are frames to cut a map from.
    pub(super) fn are_several(&self) -> bool {
        self.frames.len() > 1
    }

    /// A map that has been cut for a hypothesis of the turn, and has not been measured yet.
    pub(super) fn drafted_for(&self, turn: f64) -> Option<&Draft> {
        match &self.remapping {
            Remapping::Drafted(draft) if draft.turn == turn => Some(draft),
            _ => None,
        }
    }

    /// Hypotheses that are measured on a map cut anew for one of the turn.
    pub(super) fn measured_for(&self, turn: f64) -> Option<&Measured> {
        match &self.remapping {
            Remapping::Measured(measured) if measured.begun.turn == turn => Some(measured),
            _ => None,
        }
    }

    /// What becomes of these with further frames, as far as is known.
    pub(super) fn taken_ahead(&self) -> &TakenAhead {
        &self.taken_ahead
    }

    pub(super) fn taken_ahead_mut(&mut self) -> &mut TakenAhead {
        &mut self.taken_ahead
    }

    /// Whether a stage of cutting the map anew is due before the next frame.
    pub(super) fn is_due(&self) -> bool {
        matches!(self.remapping, Remapping::Due(_))
    }

    /// How far the frames kept have been taken on the new cells, as far as is known.
    pub(super) fn ahead(&self) -> Option<&Ahead> {
        self.ahead.as_ref()
    }

    /// As [`ahead`](Self::ahead), which is forgotten.
    pub(super) fn take_ahead(&mut self) -> Option<Ahead> {
        self.ahead.take()
    }

    pub(super) fn set_ahead(&mut self, ahead: Ahead) {
        self.ahead = Some(ahead);
    }

    /// What is being done to cut the map anew, which is then nothing.
    pub(super) fn take_remapping(&mut self) -> Remapping {
        std::mem::take(&mut self.remapping)
    }

    pub(super) fn set_remapping(&mut self, remapping: Remapping) {
        self.remapping = remapping;
    }

    /// Forgets what is kept unless it is in use, or more frames would make a map of so many cells better; whatever it is in use for, once there
    /// are too many frames: rivals that have come meanwhile have all of them before them.
    pub(super) fn end_unless_few(&mut self, cells: usize) {
        let count = self.frames.len().max(1);
        let next = tuning::OCCASIONS.into_iter().find(|occasion| *occasion > count);
        let each = self.points / count;
        let would_be_plenty = count > 1 && next.is_none_or(|next| next * each > tuning::PLENTY);
        let one_is_plenty = each as f64 > tuning::PLENTY_PER_CELL * cells as f64;
        let is_idle = matches!(self.remapping, Remapping::Idle);
        if is_idle && (would_be_plenty || one_is_plenty) || self.frames.len() > tuning::MOST_KEPT {
            self.end();
        }
    }

    /// Sets the poses that a map cut anew has found.
    pub(super) fn set_poses(&mut self, poses: Vec<Matrix3<f64>>) {
        self.poses = poses;
    }

    /// In the poses that they were found in.
    pub(super) fn as_found(&self) -> Vec<PlacedFrame<'_>> {
        let placed = self.frames.iter().zip(&self.poses);
        placed.map(|((time, outline), pose)| PlacedFrame { time: *time, outline, pose: *pose }).collect()
    }

    /// In the poses that the motion of a map puts them in: where they were if it has never changed.
    pub(super) fn by_motion(&self, track: &Track) -> Vec<PlacedFrame<'_>> {
        track.placed(self.frames.iter().map(|(time, outline)| (*time, outline)))
    }
}

#[cfg(feature = "serde")]
impl InitialisationWindow {
    /// Whether frames and poses belong together and times increase; `restore` makes a track usable, or tells that it cannot.
    pub(super) fn restore(
        &mut self,
        settings: &FilterSettings,
        restore: impl Fn(&mut Track, SavedCells) -> bool,
    ) -> bool {
        let of_measured = |track: &mut Track| restore(track, SavedCells::Measured);
        let is_usable = match &mut self.remapping {
            Remapping::Idle => true,
            Remapping::Placed(placed) => {
                let mut points = placed.runs.iter().flat_map(|(run, _)| run);
                placed.turn.is_finite()
                    && placed.cuts < tuning::MOST_CUTS
                    && points.all(|p| p.coords.iter().all(|coordinate| coordinate.is_finite()))
            }
            Remapping::Drafted(draft) => draft.restore(|track| restore(track, SavedCells::Drafted)),
            Remapping::Measured(measured) => {
                let Measured { begun, present, rivals } = &mut **measured;
                let turns_are_finite = rivals.iter().all(|(turn, _)| turn.is_finite());
                let rivals = rivals.iter_mut().filter_map(|(_, rival)| rival.as_mut());
                let kept = self.frames.len();
                let mut all = std::iter::once(present).chain(rivals);
                turns_are_finite
                    && begun.restore(of_measured)
                    && all.all(|remapped| remapped.restore(settings, kept, of_measured))
            }
            Remapping::Again { cuts, .. } => *cuts <= tuning::MOST_CUTS,
            // None is read.
            Remapping::Due(_) => false,
        };
        is_usable && self.is_valid()
    }

    fn is_valid(&self) -> bool {
        let points: usize = self.frames.iter().map(|(_, outline)| outline.point_count()).sum();
        let increases = self.frames.is_sorted_by(|(a, _), (b, _)| a < b);
        self.frames.len() == self.poses.len()
            && points == self.points
            && increases
            && self.frames.iter().all(|(time, _)| time.is_finite())
            && self.poses.iter().flatten().all(|entry| entry.is_finite())
    }
}
