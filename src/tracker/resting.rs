//! Objects whose states wait in a file while others are followed.
use std::{
    collections::BTreeMap,
    fs::File,
    io::{self, Read as _, Seek as _, SeekFrom, Write as _},
    sync::{Arc, Mutex, PoisonError},
};

use freeform_estimate::MotionEstimate;
use freeform_outline_filter::MotionFilter;

use super::filtered_object::FilteredObject;

/// Smallest room in the file, in bytes. Larger ones are twice that, four times, and so on, so that room fits the next that needs it.
const SMALLEST_ROOM: u64 = 1 << 12;

/// Where objects rest, and how many are kept awake.
#[derive(Debug, Clone)]
pub(super) struct Rest {
    pub(super) file: Arc<StateFile>,
    pub(super) most_awake: usize,
}

/// A file of states. What one has left another takes.
#[derive(Debug)]
pub(super) struct StateFile(Mutex<Rooms>);

#[derive(Debug)]
struct Rooms {
    file: File,
    end: u64,
    /// Where rooms of a size that nobody is in begin.
    free: BTreeMap<u64, Vec<u64>>,
}

/// The state of an object in a file. Its room is free again when nobody asks for it any more.
#[derive(Debug)]
pub(super) struct RestingFilter {
    file: Arc<StateFile>,
    start: u64,
    length: usize,
    /// Of these the state of the filter.
    filter_length: usize,
    /// What is asked for while it rests.
    pub(super) segment: usize,
    pub(super) motion_changed: bool,
}

/// Why a state could not be kept in a file or had from it.
#[derive(Debug, thiserror::Error)]
pub(super) enum RestingError {
    #[error(transparent)]
    File(#[from] io::Error),
    #[error(transparent)]
    State(#[from] freeform_outline_filter::StateError),
    #[error(transparent)]
    Encoding(#[from] postcard::Error),
}

impl StateFile {
    pub(super) fn new(file: File) -> Self {
        Self(Mutex::new(Rooms { file, end: 0, free: BTreeMap::new() }))
    }

    fn write(&self, bytes: &[u8]) -> io::Result<u64> {
        // A thread that broke off left at most a room that nobody knows of.
        let mut rooms = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let size = room_for(bytes.len());
        let free = rooms.free.get_mut(&size).and_then(Vec::pop);
        let start = free.unwrap_or(rooms.end);
        let written = rooms.file.seek(SeekFrom::Start(start)).and_then(|_| rooms.file.write_all(bytes));
        match (free, &written) {
            (None, Ok(())) => rooms.end += size,
            (Some(start), Err(_)) => rooms.free.entry(size).or_default().push(start),
            _ => {}
        }
        written.map(|()| start)
    }

    fn read(&self, start: u64, length: usize) -> io::Result<Vec<u8>> {
        let mut rooms = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let mut bytes = vec![0; length];
        rooms.file.seek(SeekFrom::Start(start))?;
        rooms.file.read_exact(&mut bytes)?;
        Ok(bytes)
    }

    fn leave(&self, start: u64, length: usize) {
        let mut rooms = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        rooms.free.entry(room_for(length)).or_default().push(start);
    }
}

fn room_for(length: usize) -> u64 {
    (length as u64).next_power_of_two().max(SMALLEST_ROOM)
}

impl RestingFilter {
    /// Writes what is known of an object into a file.
    pub(super) fn of(object: &FilteredObject, file: &Arc<StateFile>) -> Result<Self, RestingError> {
        let mut bytes = object.filter.to_bytes()?;
        let filter_length = bytes.len();
        bytes.append(&mut postcard::to_allocvec(&object.last_known)?);
        Ok(Self {
            start: file.write(&bytes)?,
            file: Arc::clone(file),
            length: bytes.len(),
            filter_length,
            segment: object.filter.segment(),
            motion_changed: object.filter.motion_changed(),
        })
    }

    /// Reads it back: it goes on to the last bit.
    pub(super) fn read(&self) -> Result<FilteredObject, RestingError> {
        let bytes = self.file.read(self.start, self.length)?;
        let (filter, last_known) = bytes.split_at(self.filter_length);
        let last_known: Option<(f64, MotionEstimate)> = postcard::from_bytes(last_known)?;
        Ok(FilteredObject { filter: MotionFilter::from_bytes(filter)?, last_known })
    }
}

impl Drop for RestingFilter {
    fn drop(&mut self) {
        self.file.leave(self.start, self.length);
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use freeform_outline_filter::FilterSettings;

    use super::*;

    fn waiting() -> FilteredObject {
        FilteredObject { filter: MotionFilter::new(FilterSettings::default()).expect("settings"), last_known: None }
    }

    #[test]
    fn room_that_was_left_is_taken_again() {
        let file = Arc::new(StateFile::new(tempfile::tempfile().expect("a file")));
        let states: Vec<_> = (0..3).map(|_| RestingFilter::of(&waiting(), &file).expect("room")).collect();
        let starts: Vec<u64> = states.iter().map(|state| state.start).collect();
        assert_eq!(starts, [0, SMALLEST_ROOM, 2 * SMALLEST_ROOM]);
        drop(states);
        let again = RestingFilter::of(&waiting(), &file).expect("room");
        assert!(starts.contains(&again.start));
        assert_eq!(again.read().expect("what was written").last_known, None);
    }

    #[test]
    fn a_file_that_cannot_be_written_or_was_cut_short_is_an_error() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("states");
        fs::write(&path, "").expect("a file");
        let read_only = Arc::new(StateFile::new(File::open(&path).expect("the file")));
        assert!(RestingFilter::of(&waiting(), &read_only).is_err());
        let file = File::options().read(true).write(true).open(&path).expect("the file");
        let state = RestingFilter::of(&waiting(), &Arc::new(StateFile::new(file))).expect("room");
        fs::write(&path, "").expect("the file");
        assert!(state.read().is_err());
    }
}
