//! Frames of many objects, which are followed side by side.
use std::collections::{BTreeMap, HashMap, VecDeque};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

use freeform_motion::outline_io::OutlineFrame;

use crate::identifier::{Identifier, Step};

/// Frames of an object followed before the thread looks for another one: many times the work of sharing them out, and few
/// beside those read ahead.
const FRAMES_AT_ONCE: usize = 16;
/// Frames that a sleeping thread is woken for as they are read: where reading takes longer than following, it would
/// fall asleep after each.
const FRAMES_TO_WAKE_FOR: usize = 16;

/// An identifier that is gone on with by one thread after the other.
#[derive(Debug, Clone)]
pub(crate) struct SharedIdentifier(Arc<Mutex<Identifier>>);

impl SharedIdentifier {
    pub(crate) fn new(identifier: Identifier) -> Self {
        Self(Arc::new(Mutex::new(identifier)))
    }

    /// The identifier, for this thread alone.
    pub(crate) fn hold(&self) -> MutexGuard<'_, Identifier> {
        self.0.lock().expect("nobody goes on with an identifier that broke off within a frame")
    }
}

/// For each object the frames that wait for its identifier, and those that it has taken. Any thread may take the next
/// frames of any object; those of one object are taken by one thread at a time, in their order.
#[derive(Default)]
pub(crate) struct Queues {
    state: Mutex<State>,
    /// Wakes a thread that follows objects.
    work: Condvar,
    /// Wakes the reading thread when frames have been followed.
    followed: Condvar,
}

#[derive(Default)]
struct State {
    /// By the position of the object.
    queues: HashMap<usize, Queue>,
    /// Objects that nobody follows although frames of them wait, by the number of the first of these.
    unattended: BTreeMap<u64, usize>,
    /// Frames that wait for these.
    unattended_frames: usize,
    /// Frames pushed, which are numbered so.
    pushed: u64,
    /// Threads that have nothing to follow.
    asleep: usize,
    /// Whether the reading thread has nothing to do either.
    is_reader_asleep: bool,
    is_closed: bool,
}

struct Queue {
    identifier: SharedIdentifier,
    waiting: VecDeque<(u64, OutlineFrame)>,
    followed: VecDeque<(OutlineFrame, Step)>,
    is_attended: bool,
}

/// Frames of an object that one thread follows.
struct Turn {
    position: usize,
    identifier: SharedIdentifier,
    frames: Vec<OutlineFrame>,
}

/// Closes queues when it is dropped, be it by a panic: no thread waits any more.
pub(crate) struct Closing<'a>(&'a Queues);

impl Queues {
    /// Takes the next frame of the object at a position.
    pub(crate) fn push(&self, position: usize, identifier: &SharedIdentifier, frame: OutlineFrame) {
        let mut state = self.state();
        state.push(position, identifier, frame);
        self.wake(&state, FRAMES_TO_WAKE_FOR);
    }

    /// Gives away the next frame of an object with what came of it, if it has been followed.
    pub(crate) fn pop(&self, position: usize) -> Option<(OutlineFrame, Step)> {
        self.state().queues.get_mut(&position)?.followed.pop_front()
    }

    /// Follows objects as their frames come, until the queues are closed.
    pub(crate) fn follow(&self) {
        let _closing = self.closed_at_the_end();
        let mut state = self.state();
        while !state.is_closed {
            if let Some(turn) = state.begin_turn() {
                state = self.take(turn, state);
            } else {
                state.asleep += 1;
                state = self.work.wait(state).unwrap_or_else(PoisonError::into_inner);
                state.asleep -= 1;
            }
        }
    }

    /// Waits for the next frame of an object to be followed, or follows what waits longest meanwhile. Returns whether there
    /// is more to come: not where a thread broke off.
    pub(crate) fn help(&self, position: usize) -> bool {
        let mut state = self.state();
        loop {
            if state.queues.get(&position).is_some_and(|queue| !queue.followed.is_empty()) {
                return true;
            }
            if state.is_closed {
                return false;
            }
            if let Some(turn) = state.begin_turn() {
                // Nothing more is read meanwhile that a sleeping thread might wait for.
                self.wake(&state, 1);
                drop(self.take(turn, state));
                return true;
            }
            state.is_reader_asleep = true;
            state = self.followed.wait(state).unwrap_or_else(PoisonError::into_inner);
            state.is_reader_asleep = false;
        }
    }

    /// Closes the queues when what is returned goes out of scope.
    pub(crate) fn closed_at_the_end(&self) -> Closing<'_> {
        Closing(self)
    }

    /// Takes a turn, while others do what they like.
    fn take<'a>(&'a self, turn: Turn, state: MutexGuard<'a, State>) -> MutexGuard<'a, State> {
        drop(state);
        let position = turn.position;
        let followed = turn.follow();
        let mut state = self.state();
        state.end_turn(position, followed);
        if state.is_reader_asleep {
            self.followed.notify_one();
        }
        self.wake(&state, FRAMES_TO_WAKE_FOR);
        state
    }

    /// Wakes a thread where at least so many frames wait for one.
    fn wake(&self, state: &State, frames: usize) {
        if state.asleep > 0 && state.unattended_frames >= frames {
            self.work.notify_one();
        }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for Closing<'_> {
    fn drop(&mut self) {
        self.0.state().is_closed = true;
        self.0.work.notify_all();
        self.0.followed.notify_all();
    }
}

impl State {
    fn push(&mut self, position: usize, identifier: &SharedIdentifier, frame: OutlineFrame) {
        let queue = self.queues.entry(position).or_insert_with(|| Queue::new(identifier.clone()));
        if !queue.is_attended {
            self.unattended_frames += 1;
            if queue.waiting.is_empty() {
                self.unattended.insert(self.pushed, position);
            }
        }
        queue.waiting.push_back((self.pushed, frame));
        self.pushed += 1;
    }

    /// The object whose frames wait longest is next.
    fn begin_turn(&mut self) -> Option<Turn> {
        let (_, position) = self.unattended.pop_first()?;
        let queue = self.queues.get_mut(&position)?;
        queue.is_attended = true;
        self.unattended_frames -= queue.waiting.len();
        let count = queue.waiting.len().min(FRAMES_AT_ONCE);
        let frames = queue.waiting.drain(..count).map(|(_, frame)| frame).collect();
        Some(Turn { position, identifier: queue.identifier.clone(), frames })
    }

    fn end_turn(&mut self, position: usize, followed: Vec<(OutlineFrame, Step)>) {
        let Some(queue) = self.queues.get_mut(&position) else { return };
        queue.followed.extend(followed);
        queue.is_attended = false;
        if let Some((number, _)) = queue.waiting.front() {
            self.unattended.insert(*number, position);
            self.unattended_frames += queue.waiting.len();
        }
    }
}

impl Queue {
    fn new(identifier: SharedIdentifier) -> Self {
        Self { identifier, waiting: VecDeque::new(), followed: VecDeque::new(), is_attended: false }
    }
}

impl Turn {
    fn follow(self) -> Vec<(OutlineFrame, Step)> {
        let mut identifier = self.identifier.hold();
        let step = |frame: OutlineFrame| {
            let step = identifier.push(frame.time, &frame.outline);
            (frame, step)
        };
        self.frames.into_iter().map(step).collect()
    }
}

#[cfg(test)]
mod tests {
    use std::panic::{AssertUnwindSafe, catch_unwind};
    use std::thread;

    use freeform_motion::curve_fit::Outline;
    use nalgebra::Point2;

    use super::*;
    use crate::args::{IdentifyMethod, MotionChoice, TrackOptions};

    fn identifier() -> SharedIdentifier {
        let (motion, method) = (MotionChoice::Rigid, IdentifyMethod::Adaptive);
        let options = TrackOptions { motion, method, degree: None, scale: None };
        SharedIdentifier::new(Identifier::new(&options).expect("settings"))
    }

    /// An ellipse with a dent.
    fn frame(number: u64, points: usize) -> OutlineFrame {
        let point = |index: usize| {
            let angle = std::f64::consts::TAU * index as f64 / points as f64;
            Point2::new(angle.cos(), 0.5 * angle.sin() + 0.1 * (2.0 * angle).cos())
        };
        let outline = Outline::closed((0..points).map(point).collect()).expect("an outline");
        OutlineFrame { frame: number, time: number as f64, object: String::new(), outline }
    }

    #[test]
    fn every_object_gives_its_frames_in_order_whoever_follows_it() {
        // The first object is much more work than the others, and the last one comes late.
        let identifiers = [(); 4].map(|()| identifier());
        let points = [3000, 40, 50, 60];
        let queues = Queues::default();
        thread::scope(|scope| {
            let _closing = queues.closed_at_the_end();
            for _ in 0..3 {
                scope.spawn(|| queues.follow());
            }
            for number in 0..100 {
                for position in (0..4).filter(|position| *position < 3 || number >= 50) {
                    queues.push(position, &identifiers[position], frame(number, points[position]));
                }
            }
            for (position, first) in [(3, 50), (0, 0), (1, 0), (2, 0)] {
                for number in first..100 {
                    let (frame, _) = loop {
                        match queues.pop(position) {
                            Some(followed) => break followed,
                            None => assert!(queues.help(position)),
                        }
                    };
                    assert_eq!((frame.frame, frame.outline.point_count()), (number, points[position]));
                }
                assert!(queues.pop(position).is_none());
            }
        });
    }

    #[test]
    fn nobody_waits_for_a_thread_that_broke_off() {
        let (queues, broken) = (Queues::default(), identifier());
        let breaking = catch_unwind(AssertUnwindSafe(|| {
            let _held = broken.hold();
            panic!("on purpose, so that following breaks off");
        }));
        assert!(breaking.is_err());
        queues.push(0, &broken, frame(0, 40));
        let is_more_to_come = thread::scope(|scope| {
            let broke_off = scope.spawn(|| queues.follow()).join();
            assert!(broke_off.is_err());
            // Others that follow end, and the reading thread learns that there will be nothing.
            scope.spawn(|| queues.follow());
            queues.help(0)
        });
        assert!(!is_more_to_come);
    }
}
