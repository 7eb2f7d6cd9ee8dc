//! Recorded frames, which may be read ahead.
use std::{
    collections::{HashMap, VecDeque},
    convert::Infallible,
    num::NonZero,
    thread::{self, available_parallelism},
};

use freeform_outline_io::OutlineFrame;

use super::{
    Objects, Tracker,
    observation::Observation,
    queues::{NextFrame, Queues},
};

/// Points of all outlines read ahead at most: four megabytes. Enough to have work while an object is waited for.
const POINTS_AHEAD: usize = 1 << 18;
/// Outlines read ahead, however small.
const OUTLINES_AHEAD: NonZero<usize> = NonZero::new(4096).expect("positive");

/// An item of a recording. `P` is data that accompanies an outline to the observer, such as its picture. `G` describes a gap.
#[derive(Debug, Clone, PartialEq)]
pub enum Recorded<P, G> {
    /// An outline of an object.
    Outline(OutlineFrame, P),
    /// Points that are not an outline; the frame counts as rejected.
    NoOutline {
        /// Name of the object.
        object: String,
        /// Number of the frame.
        frame: u64,
        /// The reason; should name the frame.
        reason: String,
    },
    /// An item without an object, such as a picture without an outline. It is passed on in order.
    Gap(G),
}

/// The result of an item of a recording, in the order of the recording.
#[derive(Debug, Clone, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "hardly any item is a gap, and items are not stored")]
pub enum Followed<P, G> {
    /// A frame of an object, with its outline and the accompanying data, if it has an outline.
    Object(Observation, Option<(OutlineFrame, P)>),
    /// A gap of the recording.
    Gap(G),
}

/// How far a recording is read ahead, and the number of threads that follow its objects.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ReadAhead {
    /// Number of threads, including the one that reads. Each object is followed by one thread at a time.
    pub threads: NonZero<usize>,
    /// Largest number of outlines that are read and not yet passed on.
    pub outlines: NonZero<usize>,
    /// Number of points of these outlines at which reading pauses.
    pub points: usize,
}

impl ReadAhead {
    /// Passes every frame on before the next one is read, on one thread.
    pub const FRAME_BY_FRAME: Self =
        Self { threads: NonZero::<usize>::MIN, outlines: NonZero::<usize>::MIN, points: 1 };
}

impl Default for ReadAhead {
    /// One thread per core of this machine, and up to 4096 outlines with 262144 points (four megabytes).
    fn default() -> Self {
        let threads = available_parallelism().unwrap_or(NonZero::<usize>::MIN);
        Self { threads, outlines: OUTLINES_AHEAD, points: POINTS_AHEAD }
    }
}

impl Tracker {
    /// Follows all outlines of a recording, with different objects on different threads. Calls `observe` for each outline on this thread, in
    /// the order of the recording. The results are bit-identical to those of [`push`](Self::push).
    ///
    /// ```
    /// use freeform_motion::{Tracker, TrackerSettings};
    /// use freeform_motion::outline_io::OutlineFrame;
    /// use freeform_motion::riccati::RigidMotion;
    /// use freeform_motion::sim_camera::{BuiltInShape, Camera, Scene, SequenceLength, Settings, Simulator};
    ///
    /// let mut tracker = Tracker::new(TrackerSettings::default())?;
    /// let motion = RigidMotion { omega: 1.0, b1: 0.5, b2: 0.0 };
    /// let scene = Scene::new(BuiltInShape::Bird, motion, Camera::default());
    /// let settings = Settings { length: SequenceLength::Frames(20), ..Settings::default() };
    /// let simulator = Simulator::new(scene, settings)?;
    /// let outlines = simulator.frames().zip(0..).flat_map(|(seen, frame)| {
    ///     // The same bird under two names.
    ///     ["left", "right"].map(|object| OutlineFrame { frame, time: seen.time, object: object.into(), outline: seen.outline.clone() })
    /// });
    /// let mut accepted = 0;
    /// tracker.follow(outlines, |observation| accepted += usize::from(observation.is_accepted()));
    /// assert_eq!((accepted, tracker.results().len()), (40, 2));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn follow(&mut self, outlines: impl IntoIterator<Item = OutlineFrame>, mut observe: impl FnMut(Observation)) {
        let recording = outlines.into_iter().map(|frame| Recorded::Outline(frame, ()));
        let observe = |followed: Followed<(), Infallible>| -> Result<(), Infallible> {
            let Followed::Object(observation, _) = followed;
            observe(observation);
            Ok(())
        };
        let Ok(()) = self.follow_recording(recording, ReadAhead::default(), observe);
    }

    /// Follows a recording in which outlines may be missing. Calls `observe` for each item on this thread, in the order of the recording.
    ///
    /// # Errors
    /// The first error of `observe`, which ends the reading. Objects may already have taken some of the frames read ahead.
    ///
    /// # Panics
    /// If `recording` or `observe` panics. The tracker is then empty.
    pub fn follow_recording<P, G, E>(
        &mut self,
        recording: impl IntoIterator<Item = Recorded<P, G>>,
        ahead: ReadAhead,
        mut observe: impl FnMut(Followed<P, G>) -> Result<(), E>,
    ) -> Result<(), E> {
        let mut recording = recording.into_iter().fuse();
        let Objects { list, mut positions } = std::mem::take(&mut self.objects);
        let (list, result) = thread::scope(|scope| {
            let mut queues = Queues::new(list);
            #[cfg(feature = "serde")]
            queues.let_rest(self.rest.clone());
            let mut window = Window::new(ahead);
            let mut threads = 1;
            let result = loop {
                if window.has_room()
                    && let Some(recorded) = recording.next()
                {
                    window.push(self.enqueue(recorded, &mut queues, &mut positions));
                    // This thread and as many as there may be work for.
                    if threads <= queues.len() && threads < ahead.threads.get() {
                        queues.add_thread(scope);
                        threads += 1;
                    }
                } else if window.is_empty() {
                    break Ok(());
                } else {
                    queues.help();
                }
                if let Err(error) = window.hand_on(&mut queues, &mut observe) {
                    break Err(error);
                }
            };
            (queues.into_objects(), result)
        });
        self.objects = Objects { list, positions };
        result
    }

    /// Hands what was read to its object, which may be new.
    fn enqueue<P, G>(
        &self,
        recorded: Recorded<P, G>,
        queues: &mut Queues,
        positions: &mut HashMap<String, usize>,
    ) -> Pending<P, G> {
        let mut push = |object: &str, frame: NextFrame| {
            let position = positions.get(object).copied().unwrap_or_else(|| {
                let position = queues.len();
                positions.insert(object.to_owned(), position);
                queues.add(self.new_object(object, position));
                position
            });
            queues.push(position, frame);
            position
        };
        match recorded {
            Recorded::Outline(frame, with) => {
                let (object, points) = (frame.object.clone(), frame.outline.point_count());
                let position = push(&object, NextFrame::Outline(frame));
                Pending::Frame { position, points, with: Some(with) }
            }
            Recorded::NoOutline { object, frame, reason } => {
                let position = push(&object, NextFrame::NoOutline { frame, reason });
                Pending::Frame { position, points: 0, with: None }
            }
            Recorded::Gap(gap) => Pending::Gap(gap),
        }
    }
}

/// What has been read and not been handed on, in the order of the recording.
struct Window<P, G> {
    pending: VecDeque<Pending<P, G>>,
    points: usize,
    ahead: ReadAhead,
}

enum Pending<P, G> {
    /// A frame of the object at this position, whose outline has so many points, and what goes with that.
    Frame {
        position: usize,
        points: usize,
        with: Option<P>,
    },
    Gap(G),
}

impl<P, G> Window<P, G> {
    fn new(ahead: ReadAhead) -> Self {
        Self { pending: VecDeque::new(), points: 0, ahead }
    }

    fn is_empty(&self) -> bool {
        self.pending.is_empty()
    }

    /// Whether more may be read.
    fn has_room(&self) -> bool {
        self.is_empty() || self.pending.len() < self.ahead.outlines.get() && self.points < self.ahead.points
    }

    fn push(&mut self, pending: Pending<P, G>) {
        self.points += pending.points();
        self.pending.push_back(pending);
    }

    /// Hands on what was read first, as far as it has been followed.
    fn hand_on<E>(
        &mut self,
        queues: &mut Queues,
        observe: &mut impl FnMut(Followed<P, G>) -> Result<(), E>,
    ) -> Result<(), E> {
        while let Some(first) = self.pending.pop_front() {
            let points = first.points();
            let followed = match first {
                Pending::Gap(gap) => Followed::Gap(gap),
                Pending::Frame { position, points, with } => match queues.pop(position) {
                    Some((observation, outline)) => Followed::Object(observation, outline.zip(with)),
                    None => {
                        self.pending.push_front(Pending::Frame { position, points, with });
                        return Ok(());
                    }
                },
            };
            self.points -= points;
            observe(followed)?;
        }
        Ok(())
    }
}

impl<P, G> Pending<P, G> {
    fn points(&self) -> usize {
        match self {
            Self::Frame { points, .. } => *points,
            Self::Gap(_) => 0,
        }
    }
}
