use std::io::{self, Read};

/// Longest stretch of a file without a complete row, in bytes.
pub(crate) const ROW_LIMIT: u64 = 1 << 20;

/// Passes bytes on until the allowance is used up, so that a file without line ends cannot fill the memory; and knows
/// whether the file ended in the middle of a line.
#[derive(Debug)]
pub(crate) struct RowLimit<R> {
    source: R,
    allowance: u64,
    last_byte: u8,
    at_end: bool,
    exceeded: bool,
}

impl<R: Read> RowLimit<R> {
    pub(crate) fn new(source: R) -> Self {
        Self { source, allowance: ROW_LIMIT, last_byte: b'\n', at_end: false, exceeded: false }
    }

    /// A row is complete: the next may have the full length again.
    pub(crate) fn renew(&mut self) {
        self.allowance = ROW_LIMIT;
    }

    /// Whether reading failed because a row was too long.
    pub(crate) fn exceeded(&self) -> bool {
        self.exceeded
    }

    /// Whether the end has been reached and the last line has no line end.
    pub(crate) fn ended_within_line(&self) -> bool {
        self.at_end && self.last_byte != b'\n'
    }
}

impl<R: Read> Read for RowLimit<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.allowance == 0 {
            self.exceeded = true;
            return Err(io::ErrorKind::FileTooLarge.into());
        }
        let count = self.source.read(buffer)?;
        match buffer[..count].last() {
            Some(&byte) => self.last_byte = byte,
            None => self.at_end |= !buffer.is_empty(),
        }
        self.allowance = self.allowance.saturating_sub(count as u64);
        Ok(count)
    }
}
