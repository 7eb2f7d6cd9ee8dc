//! Lines of bounded length, without the comments between them.
use std::io::{self, BufRead, BufReader, Read};

/// Longest stretch of a file without a complete row, in bytes.
pub(crate) const ROW_LIMIT: usize = 1 << 20;

/// What a line begins with that is no row.
pub(crate) const COMMENT: u8 = b'#';

/// Bytes read from the source at once, if it has as many.
const BUFFER: usize = 1 << 16;

/// Passes a file on, one line per read at most, until a row takes more than [`ROW_LIMIT`], so that a file without line
/// ends cannot fill the memory; comments and empty lines before a row may have any length, as nothing of them is kept. Knows
/// whether the file ended in the middle of a line.
#[derive(Debug)]
pub(crate) struct Lines<R> {
    source: BufReader<R>,
    allowance: usize,
    /// Whether nothing but comments and empty lines has passed since the last row was complete.
    is_between_rows: bool,
    last_byte: u8,
    at_end: bool,
    exceeded: bool,
    first_line: FirstLine,
    head: Head,
}

/// Longest comment that is taken for a header, in bytes.
const LONGEST_HEADER: usize = 1 << 12;

/// The last comment before the first row: `numpy.savetxt` writes a header so.
#[derive(Debug, Default)]
struct Head {
    comment: Vec<u8>,
    is_in_comment: bool,
    is_over: bool,
}

impl Head {
    /// Looks at what has been read, a line at most.
    fn take(&mut self, line: &[u8], begins_line: bool) {
        if self.is_over {
            return;
        }
        if let Some(first) = line.first().filter(|_| begins_line) {
            self.is_in_comment = *first == COMMENT;
            self.is_over = !self.is_in_comment && !line.trim_ascii().is_empty();
            if self.is_in_comment {
                self.comment.clear();
            }
        }
        if self.is_in_comment {
            let room = LONGEST_HEADER.saturating_sub(self.comment.len());
            self.comment.extend_from_slice(&line[..line.len().min(room)]);
        }
    }
}

/// What is known of the first line, by which lines that end otherwise are told.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum FirstLine {
    /// It has not ended.
    Open,
    /// Nor has it, though there was a carriage return in it.
    OpenWithReturn,
    Ended,
}

impl<R: Read> Lines<R> {
    pub(crate) fn new(source: R) -> Self {
        let source = BufReader::with_capacity(BUFFER, source);
        Self {
            source,
            allowance: ROW_LIMIT,
            is_between_rows: true,
            last_byte: b'\n',
            at_end: false,
            exceeded: false,
            first_line: FirstLine::Open,
            head: Head::default(),
        }
    }

    /// The last comment line before the first row, without `#`; empty where there is none.
    pub(crate) fn last_comment(&self) -> &[u8] {
        let comment = self.head.comment.trim_ascii();
        let marks = comment.iter().take_while(|byte| **byte == COMMENT).count();
        comment[marks..].trim_ascii()
    }

    /// The last row is complete: the next may have the full length again.
    pub(crate) fn begin_row(&mut self) {
        self.allowance = ROW_LIMIT;
        self.is_between_rows = true;
    }

    /// What has been read from the source and not been passed on. Maybe nothing: the next read is what fills it.
    pub(crate) fn buffered(&self) -> &[u8] {
        self.source.buffer()
    }

    /// Leaves out a whole line of what is buffered; its length counts the line end.
    pub(crate) fn skip_line(&mut self, length: usize) {
        self.source.consume(length);
    }

    /// Whether reading failed because a row was too long.
    pub(crate) fn exceeded(&self) -> bool {
        self.exceeded
    }

    /// Whether there was a carriage return, and no line end so far.
    pub(crate) fn has_returns_alone(&self) -> bool {
        self.first_line == FirstLine::OpenWithReturn
    }

    /// Whether the end has been reached and the last line has no line end.
    pub(crate) fn ended_within_line(&self) -> bool {
        self.at_end && self.last_byte != b'\n'
    }
}

impl<R: Read> Read for Lines<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.allowance == 0 {
            self.exceeded = true;
            return Err(io::ErrorKind::FileTooLarge.into());
        }
        let available = self.source.fill_buf()?;
        self.at_end |= available.is_empty();
        let most = available.len().min(buffer.len()).min(self.allowance);
        let end = available[..most].iter().position(|byte| *byte == b'\n');
        let line = &available[..end.map_or(most, |end| end + 1)];
        let count = line.len();
        buffer[..count].copy_from_slice(line);
        if self.last_byte == b'\n' && self.is_between_rows && !line.is_empty() {
            self.is_between_rows = matches!(line[0], COMMENT | b'\n') || line == b"\r\n";
        }
        if self.first_line != FirstLine::Ended {
            self.first_line = match (line.ends_with(b"\n"), line.contains(&b'\r')) {
                (true, _) => FirstLine::Ended,
                (false, true) => FirstLine::OpenWithReturn,
                (false, false) => self.first_line,
            };
        }
        self.head.take(line, self.last_byte == b'\n');
        self.last_byte = *line.last().unwrap_or(&self.last_byte);
        self.source.consume(count);
        if !self.is_between_rows {
            self.allowance -= count;
        }
        Ok(count)
    }
}
