//! Frames of many objects, which are followed side by side.
//!
//! One thread reads, and shares the work out: it sends an object with its next frames to whichever thread is free, and gets it back with what came
//! of them. So each object is followed by one thread at a time, in the order of its frames, and no two threads share anything but the channels.
use std::{
    any::Any,
    collections::VecDeque,
    panic::{AssertUnwindSafe, catch_unwind, resume_unwind},
    thread::Scope,
};

use crossbeam_channel::{Receiver, Sender, unbounded};
use freeform_outline_io::OutlineFrame;

#[cfg(feature = "serde")]
use super::resting::Rest;
use super::{object::TrackedObject, observation::Observation};

/// Frames of an object that are sent together: many times the work of sending them, and few beside those read ahead.
const FRAMES_AT_ONCE: usize = 16;

/// Objects that are looked at when one is to be put to rest.
#[cfg(feature = "serde")]
const TRIES: usize = 16;

/// The next frame of an object.
#[derive(Debug)]
pub(super) enum NextFrame {
    Outline(OutlineFrame),
    /// Points that are no outline, with the reason.
    NoOutline {
        frame: u64,
        reason: String,
    },
}

/// What a frame gave, and its outline.
pub(super) type FollowedFrame = (Observation, Option<OutlineFrame>);

/// Frames to be taken by their object.
struct Job {
    position: usize,
    object: TrackedObject,
    frames: Vec<NextFrame>,
}

/// What comes back, or why the thread broke off.
type Done = Result<(usize, TrackedObject, Vec<FollowedFrame>), Box<dyn Any + Send>>;

/// Objects with the frames that wait for them and those that they have taken.
pub(super) struct Queues {
    queues: Vec<Queue>,
    /// Objects at home with frames that wait, those first that have waited longest.
    ready: VecDeque<usize>,
    /// Objects on their way.
    away: usize,
    jobs: Sender<Job>,
    jobs_to_take: Receiver<Job>,
    done: Receiver<Done>,
    done_by_others: Sender<Done>,
    #[cfg(feature = "serde")]
    resting: Resting,
}

/// Which objects are put to rest.
#[cfg(feature = "serde")]
struct Resting {
    /// `None` where nobody is, or no more.
    rest: Option<Rest>,
    /// Objects that do not rest, each once.
    awake: Vec<usize>,
    /// Of the pseudo-random numbers.
    state: u64,
}

#[derive(Default)]
struct Queue {
    /// `None` while it is away.
    object: Option<TrackedObject>,
    waiting: VecDeque<NextFrame>,
    followed: VecDeque<FollowedFrame>,
    is_ready: bool,
    /// Whether it is among those awake.
    #[cfg(feature = "serde")]
    is_awake: bool,
}

impl Queues {
    /// With objects that have no frames yet.
    pub(super) fn new(objects: Vec<TrackedObject>) -> Self {
        let ((jobs, jobs_to_take), (done_by_others, done)) = (unbounded(), unbounded());
        let mut queues = Self {
            queues: Vec::new(),
            ready: VecDeque::new(),
            away: 0,
            jobs,
            jobs_to_take,
            done,
            done_by_others,
            #[cfg(feature = "serde")]
            resting: Resting { rest: None, awake: Vec::new(), state: 1 },
        };
        objects.into_iter().for_each(|object| queues.add(object));
        queues
    }

    /// Adds an object behind the others.
    pub(super) fn add(&mut self, object: TrackedObject) {
        self.queues.push(Queue { object: Some(object), ..Queue::default() });
    }

    /// How many objects there are.
    pub(super) fn len(&self) -> usize {
        self.queues.len()
    }

    /// Adds a thread that follows objects until the queues are dropped.
    pub(super) fn add_thread<'scope>(&self, scope: &'scope Scope<'scope, '_>) {
        let (jobs, done) = (self.jobs_to_take.clone(), self.done_by_others.clone());
        scope.spawn(move || {
            for job in jobs {
                if done.send(job.run()).is_err() {
                    break;
                }
            }
        });
    }

    /// Takes the next frame of the object at a position.
    pub(super) fn push(&mut self, position: usize, frame: NextFrame) {
        self.take_all_home();
        self.queues[position].waiting.push_back(frame);
        self.make_ready(position);
    }

    /// Gives away the next frame of an object with what came of it, if it has been followed.
    pub(super) fn pop(&mut self, position: usize) -> Option<FollowedFrame> {
        let queue = &mut self.queues[position];
        let first = queue.followed.pop_front();
        if queue.followed.is_empty() {
            // Room for many frames, for each of many objects, is more than what is known of them.
            queue.followed = VecDeque::new();
        }
        first
    }

    /// Follows what waits longest, or waits for another thread to do so. Nothing is done where nothing waits.
    pub(super) fn help(&mut self) {
        self.take_all_home();
        while let Some(position) = self.ready.pop_front() {
            self.queues[position].is_ready = false;
            self.send(position);
        }
        if let Ok(job) = self.jobs_to_take.try_recv() {
            self.take_home(job.run());
        } else if self.away > 0
            && let Ok(done) = self.done.recv()
        {
            self.take_home(done);
        }
    }

    /// The objects, when those that are away have come home. Frames that wait are given up.
    pub(super) fn into_objects(mut self) -> Vec<TrackedObject> {
        while self.away > 0 {
            self.queues.iter_mut().for_each(|queue| queue.waiting.clear());
            self.help();
        }
        self.queues.into_iter().filter_map(|queue| queue.object).collect()
    }

    /// Sends an object off when it has frames for a job, or lists it among those that will have.
    fn make_ready(&mut self, position: usize) {
        let queue = &mut self.queues[position];
        if queue.waiting.len() >= FRAMES_AT_ONCE {
            self.send(position);
        } else if !queue.waiting.is_empty() && !queue.is_ready {
            queue.is_ready = true;
            self.ready.push_back(position);
        }
    }

    /// Sends an object at home with its next frames.
    fn send(&mut self, position: usize) {
        let queue = &mut self.queues[position];
        if queue.waiting.is_empty() {
            return;
        }
        let Some(object) = queue.object.take() else { return };
        let count = queue.waiting.len().min(FRAMES_AT_ONCE);
        let frames = queue.waiting.drain(..count).collect();
        self.away += 1;
        // Received by this thread, if by no other.
        let _ = self.jobs.send(Job { position, object, frames });
    }

    /// Takes those home that are back, so that threads have work while this one follows an object itself.
    fn take_all_home(&mut self) {
        while let Ok(done) = self.done.try_recv() {
            self.take_home(done);
        }
    }

    fn take_home(&mut self, done: Done) {
        let (position, object, followed) = done.unwrap_or_else(|panic| resume_unwind(panic));
        let queue = &mut self.queues[position];
        queue.object = Some(object);
        queue.followed.extend(followed);
        self.away -= 1;
        self.make_ready(position);
        #[cfg(feature = "serde")]
        self.put_to_rest(position);
    }
}

#[cfg(feature = "serde")]
impl Queues {
    /// Has objects beyond a number rest in a file.
    pub(super) fn let_rest(&mut self, rest: Option<Rest>) {
        self.resting.rest = rest;
        (0..self.queues.len()).for_each(|position| self.count_awake(position));
    }

    fn count_awake(&mut self, position: usize) {
        if self.resting.rest.is_some() && !std::mem::replace(&mut self.queues[position].is_awake, true) {
            self.resting.awake.push(position);
        }
    }

    /// Puts objects at home for which nothing waits to rest, until few enough are awake; one that has come home is awake.
    fn put_to_rest(&mut self, home: usize) {
        self.count_awake(home);
        let Some(Rest { file, most_awake }) = self.resting.rest.clone() else { return };
        // Those that are at work are passed over.
        for _ in 0..TRIES {
            let Resting { awake, state, .. } = &mut self.resting;
            if awake.len() <= most_awake {
                return;
            }
            // Xorshift (G. Marsaglia, 2003): any order will do.
            *state ^= *state << 13;
            *state ^= *state >> 7;
            *state ^= *state << 17;
            let place = (*state % awake.len() as u64) as usize;
            let queue = &mut self.queues[awake[place]];
            let Some(object) = queue.object.as_mut().filter(|_| queue.waiting.is_empty()) else { continue };
            if object.identifier.rest(&file).is_err() {
                // Nor will the others find room.
                self.resting.rest = None;
                return;
            }
            queue.waiting = VecDeque::new();
            queue.is_awake = false;
            awake.swap_remove(place);
        }
    }
}

impl Job {
    fn run(self) -> Done {
        let Self { position, mut object, frames } = self;
        catch_unwind(AssertUnwindSafe(move || {
            let followed = frames.into_iter().map(|frame| follow(&mut object, frame)).collect();
            (position, object, followed)
        }))
    }
}

fn follow(object: &mut TrackedObject, frame: NextFrame) -> FollowedFrame {
    match frame {
        NextFrame::Outline(frame) => (object.push(&frame), Some(frame)),
        NextFrame::NoOutline { frame, reason } => (object.reject(frame, reason), None),
    }
}

#[cfg(test)]
mod tests {
    use std::{panic, thread};

    use super::*;
    use crate::{Tracker, TrackerSettings};

    #[test]
    fn nobody_waits_for_a_thread_that_broke_off() {
        let tracker = Tracker::new(TrackerSettings::default()).expect("default settings");
        let broken = panic::catch_unwind(|| {
            thread::scope(|scope| {
                let mut queues = Queues::new(vec![tracker.new_object("0", 0)]);
                queues.push(0, NextFrame::NoOutline { frame: 0, reason: "torn".to_owned() });
                // In place of a thread that takes the object and breaks off.
                queues.send(0);
                queues.jobs_to_take.recv().expect("a job");
                queues.done_by_others.send(Err(Box::new("on purpose"))).expect("the queues are there");
                // Threads that are free end with the queues.
                queues.add_thread(scope);
                queues.help();
            });
        });
        let payload = broken.expect_err("the panic goes on in the reading thread");
        assert_eq!(payload.downcast_ref(), Some(&"on purpose"));
    }
}
