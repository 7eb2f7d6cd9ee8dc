//! Input that Ctrl-C ends, also while nothing comes.
use std::fs::File;
use std::io::{self, BufRead, Read};
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::thread;
use std::time::Duration;

use crate::interrupt;

/// Whether the beginning of a stream may be read before its first picture is dealt with, to choose how it is traced.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Waiting {
    /// Every picture is dealt with as soon as it is there.
    None,
    /// Some pictures are waited for.
    Allowed,
    /// Some are, and Ctrl-C ends that: what has come by then is dealt with.
    UntilInterrupted,
}

/// Bytes read at once.
const CHUNK: usize = 1 << 16;

/// Chunks read ahead.
const AHEAD: usize = 4;

/// How often Ctrl-C is looked for while nothing comes.
const LOOK: Duration = Duration::from_millis(50);

/// Standard input or a named pipe, read by a separate thread, since a waiting read cannot be cancelled.
pub(crate) struct Awaited {
    chunks: Receiver<io::Result<Vec<u8>>>,
    chunk: Vec<u8>,
    used: usize,
}

impl Awaited {
    /// Standard input.
    pub(crate) fn stdin() -> Self {
        Self::read(|| Ok(io::stdin().lock()))
    }

    /// Something that is no file. To open it is to wait for somebody who writes to it.
    pub(crate) fn open(path: PathBuf) -> Self {
        Self::read(|| File::open(path))
    }

    /// Starts reading.
    fn read<R: Read>(open: impl FnOnce() -> io::Result<R> + Send + 'static) -> Self {
        let (sender, chunks) = sync_channel(AHEAD);
        thread::spawn(move || {
            let mut source = match open() {
                Ok(source) => source,
                Err(error) => return drop(sender.send(Err(error))),
            };
            loop {
                let mut chunk = vec![0; CHUNK];
                let read = match source.read(&mut chunk) {
                    Ok(0) => return,
                    Ok(count) => {
                        chunk.truncate(count);
                        Ok(chunk)
                    }
                    Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
                    Err(error) => Err(error),
                };
                let failed = read.is_err();
                if sender.send(read).is_err() || failed {
                    return;
                }
            }
        });
        Self { chunks, chunk: Vec::new(), used: 0 }
    }
}

impl BufRead for Awaited {
    /// Empty at the end of the input, or when Ctrl-C has asked for one.
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        while self.used == self.chunk.len() {
            match self.chunks.recv_timeout(LOOK) {
                Ok(chunk) => (self.chunk, self.used) = (chunk?, 0),
                Err(RecvTimeoutError::Timeout) if !interrupt::was_asked_for() => {}
                Err(_) => break,
            }
        }
        Ok(&self.chunk[self.used..])
    }

    fn consume(&mut self, count: usize) {
        self.used += count;
    }
}

impl Read for Awaited {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let available = self.fill_buf()?;
        let count = available.len().min(buffer.len());
        buffer[..count].copy_from_slice(&available[..count]);
        self.consume(count);
        Ok(count)
    }
}
