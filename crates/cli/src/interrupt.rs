//! Ctrl-C, and other signals that ask the process to end: nothing is left half done.
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

static ASKED_FOR: AtomicBool = AtomicBool::new(false);
static ENDS_WITH_WHAT_IS_KNOWN: AtomicBool = AtomicBool::new(false);
/// Files that are being written and have to go where the process ends at once.
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// From now on Ctrl-C, SIGTERM and SIGHUP end the process at once, without the files that it has not finished. A signal that is to
/// be ignored, as SIGHUP is below `nohup`, stays so. A limit on the size of files is an error of writing and not the end.
#[cfg(unix)]
pub(crate) fn leave_nothing_unfinished() {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGXFSZ};
    let ignored = ignored_signals();
    let is_heard = |signal: &i32| *signal == SIGINT || ignored >> (signal - 1) & 1 == 0;
    let signals: Vec<i32> = [SIGINT, SIGTERM, SIGHUP, SIGXFSZ].into_iter().filter(is_heard).collect();
    // Without a handler a signal ends the process at once too, as it always does, but leaves the files.
    let Ok(mut signals) = signal_hook::iterator::Signals::new(signals) else { return };
    std::thread::spawn(move || {
        for signal in signals.forever() {
            // Writing beyond the limit has failed, which is told where it was tried.
            if signal != SIGXFSZ {
                end(128 + signal);
            }
        }
    });
}

/// From now on Ctrl-C ends the process at once, without the files that it has not finished.
#[cfg(not(unix))]
pub(crate) fn leave_nothing_unfinished() {
    // Without a handler Ctrl-C ends the process at once too, as it always does, but leaves them.
    let _ = ctrlc::set_handler(|| end(130));
}

/// One bit for each signal that was ignored when the process began, that of signal 1 the lowest; none where the system does not tell.
#[cfg(unix)]
fn ignored_signals() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0)
}

/// Ends the process, unless it is the first time and the work ends by itself.
fn end(status: i32) {
    let is_first = !ASKED_FOR.swap(true, Ordering::SeqCst);
    if is_first && ENDS_WITH_WHAT_IS_KNOWN.load(Ordering::SeqCst) {
        return;
    }
    // Kept to the end, so that no file is begun any more.
    let unfinished = unfinished();
    for path in unfinished.iter() {
        let _ = std::fs::remove_file(path);
    }
    std::process::exit(status);
}

/// From now on the first of these signals asks the work to end; the second one ends the process.
pub(crate) fn listen() {
    ENDS_WITH_WHAT_IS_KNOWN.store(true, Ordering::SeqCst);
}

/// Goes on in spite of having been asked to end: what has been read so far is dealt with as a whole. The next signal asks again.
pub(crate) fn put_off() {
    ASKED_FOR.store(false, Ordering::SeqCst);
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
