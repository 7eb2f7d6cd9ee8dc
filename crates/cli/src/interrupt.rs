//! Ctrl-C: nothing is left half done.
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

static ASKED_FOR: AtomicBool = AtomicBool::new(false);
static ENDS_WITH_WHAT_IS_KNOWN: AtomicBool = AtomicBool::new(false);
/// Files that are being written and have to go where the process ends at once.
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// From now on Ctrl-C ends the process at once, without the files that it has not finished.
pub(crate) fn leave_nothing_unfinished() {
    // Without a handler Ctrl-C ends the process at once too, as it always does, but leaves them.
    let _ = ctrlc::set_handler(|| {
        let is_first = !ASKED_FOR.swap(true, Ordering::SeqCst);
        if is_first && ENDS_WITH_WHAT_IS_KNOWN.load(Ordering::SeqCst) {
            return;
        }
        // Kept to the end, so that no file is begun any more.
        let unfinished = unfinished();
        for path in unfinished.iter() {
            let _ = std::fs::remove_file(path);
        }
        std::process::exit(130);
    });
}

/// From now on the first Ctrl-C asks the work to end; the second one ends the process.
pub(crate) fn listen() {
    ENDS_WITH_WHAT_IS_KNOWN.store(true, Ordering::SeqCst);
}

/// Whether the work is asked to end.
pub(crate) fn was_asked_for() -> bool {
    ASKED_FOR.load(Ordering::SeqCst)
}

/// The entry of a file that is being written; taken off when it is dropped.
#[derive(Debug)]
pub(crate) struct Unfinished(PathBuf);

impl Unfinished {
    /// Begins a file, and enters its path.
    pub(crate) fn begin<F>(
        create: impl FnOnce() -> io::Result<F>,
        path: impl FnOnce(&F) -> &Path,
    ) -> io::Result<(F, Self)> {
        let mut entries = unfinished();
        let file = create()?;
        let path = path(&file).to_owned();
        entries.push(path.clone());
        Ok((file, Self(path)))
    }
}

impl Drop for Unfinished {
    fn drop(&mut self) {
        unfinished().retain(|path| *path != self.0);
    }
}

fn unfinished() -> MutexGuard<'static, Vec<PathBuf>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}
