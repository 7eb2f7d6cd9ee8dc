//! Pictures with frame numbers and times, from files, animations or video.
use std::fs::{self, File};
use std::io::{self, BufRead, BufReader, Cursor, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use image::{GrayImage, ImageFormat};

use crate::foreign_format::is_heic;
use crate::picture_file::channel::Channel;
use crate::picture_file::compressed_video::compressed_video;
use crate::picture_file::error::{PictureError, PictureErrorKind};
use crate::picture_file::file_pattern::is_pattern;
use crate::picture_file::files::{MAGIC_LENGTH, beginning, has_picture_extension, picture_files};
use crate::picture_file::gif_animation::GifAnimation;
use crate::picture_file::picture::{decode, read_picture_channel};
use crate::picture_file::y4m::{MAGIC, VideoReader};

/// Frames per second where neither the settings nor the file tell.
pub(crate) const DEFAULT_RATE: f64 = 30.0;

/// Longest picture or animation read from a stream, in bytes.
const STREAM_LIMIT: u64 = 1 << 30;

/// One picture of a sequence.
#[derive(Debug, Clone, PartialEq)]
pub struct PictureFrame {
    /// Number of the frame, counted from 0 over all files; frames that cannot be read are counted.
    pub frame: u64,
    /// Time in seconds.
    pub time: f64,
    /// Name of the file.
    pub file: String,
    /// The grey values. A frame of an animation that shows nothing new shares them with the frame before.
    pub picture: Arc<GrayImage>,
}

/// How a sequence of pictures is read.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SequenceSettings {
    /// Frames per second; `None` for what the file says (y4m, GIF), else 30. Delays of a GIF that are those of a constant
    /// rate rounded to hundredths of a second are taken for that rate.
    pub frames_per_second: Option<f64>,
    /// What is looked at of a colour picture.
    pub channel: Channel,
}

/// The pictures of files, folders, animations, videos or a stream, one after the other; one is in memory at a time.
///
/// A picture that cannot be read is an error item, after which the sequence continues with the next file. Its number is
/// not given to another picture. The same holds for a broken link, a pipe or a folder with the name of a picture among the pictures
/// of a folder. All pictures have the size of the first.
pub struct PictureSequence {
    settings: SequenceSettings,
    open_pipe: OpenPipe,
    files: std::vec::IntoIter<SequenceFile>,
    open: Option<OpenFile>,
    next_frame: u64,
    /// Size of the first picture.
    size: Option<(u32, u32)>,
    frame_count: Option<u64>,
    pixel_aspect: Option<f64>,
    is_interlaced: bool,
}

/// How something that is no file is opened, to be read once.
type OpenPipe = fn(&Path) -> io::Result<Box<dyn BufRead>>;

/// A file of a sequence.
#[derive(Debug)]
struct SequenceFile {
    path: PathBuf,
    origin: Origin,
}

/// Where the name of a file comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Origin {
    /// It was given, and may be that of a pipe.
    Given,
    /// It was found in a folder or by a pattern.
    Found,
}

/// A file of several pictures that is being read.
struct OpenFile {
    name: String,
    /// Number of its first frame in the sequence, and the time of that.
    first: (u64, f64),
    pictures: Pictures,
}

enum Pictures {
    Animation(Box<GifAnimation>),
    Video(VideoReader<Box<dyn BufRead>>),
    /// `None` when it has been taken.
    One(Option<GrayImage>),
}

/// A picture, with its time in seconds if its file tells.
type TimedPicture = (Arc<GrayImage>, Option<f64>);

impl Pictures {
    /// The next picture, with its time in seconds from the beginning of the file if that tells.
    fn next(&mut self) -> Result<Option<TimedPicture>, PictureErrorKind> {
        Ok(match self {
            Self::Animation(animation) => animation.next()?.map(|(picture, time)| (picture, Some(time))),
            Self::Video(video) => video.next().transpose()?.map(|picture| (Arc::new(picture), None)),
            Self::One(picture) => picture.take().map(|picture| (Arc::new(picture), Some(0.0))),
        })
    }
}

impl PictureSequence {
    /// The pictures of these paths in the order given. A folder stands for the pictures in it, and a path with `*`, `?` or
    /// `[...]` that is no file for the files that match it, both in natural order (`frame-9` before `frame-10`).
    ///
    /// # Errors
    /// A path that is no file and matches none; a folder that cannot be read or has no pictures; a single y4m video or
    /// GIF that cannot be opened.
    pub fn open(paths: &[PathBuf], settings: SequenceSettings) -> Result<Self, PictureError> {
        let mut files = Vec::new();
        for path in paths {
            let origin = if path.is_dir() || is_pattern(path) { Origin::Found } else { Origin::Given };
            files.extend(picture_files(path)?.into_iter().map(|path| SequenceFile { path, origin }));
        }
        let single = files.len() == 1;
        let frame_count = (!files.iter().any(may_hold_several)).then_some(files.len() as u64);
        let mut sequence = Self::of(settings, files, frame_count);
        if single && frame_count.is_none() {
            // What the header says is known before the first frame is read.
            if let Some(file) = sequence.files.next() {
                let opened = sequence.open_file(&file);
                sequence.open = opened.map_err(|kind| PictureError::of_file(file.path.display().to_string(), kind))?;
            }
        }
        Ok(sequence)
    }

    /// The pictures of a stream: a y4m video, a GIF, or a single picture.
    ///
    /// # Errors
    /// The stream cannot be read, is empty, or begins like none of these.
    pub fn from_stream(
        source: impl BufRead + 'static,
        name: &str,
        settings: SequenceSettings,
    ) -> Result<Self, PictureError> {
        let mut sequence = Self::of(settings, Vec::new(), None);
        let opened = sequence.open_stream(Box::new(source), name);
        sequence.open = Some(opened.map_err(|kind| PictureError::of_file(name, kind))?);
        Ok(sequence)
    }

    fn of(settings: SequenceSettings, files: Vec<SequenceFile>, frame_count: Option<u64>) -> Self {
        let files = files.into_iter();
        let (open, next_frame, size, pixel_aspect, is_interlaced) = Default::default();
        let open_pipe: OpenPipe = |path| Ok(Box::new(BufReader::new(File::open(path)?)));
        Self { settings, open_pipe, files, open, next_frame, size, frame_count, pixel_aspect, is_interlaced }
    }

    /// Opens the pipes among the paths with this function from now on, such as one that does not wait for ever; by default they are
    /// opened as files are, which waits for somebody who writes to them. A single path is opened before.
    #[must_use]
    pub fn with_pipes_opened_by(self, open_pipe: OpenPipe) -> Self {
        Self { open_pipe, ..self }
    }

    /// Whether a path names pictures: by its extension, as a folder, or as a pattern.
    #[must_use]
    pub fn is_named_by(path: &Path) -> bool {
        has_picture_extension(path) || path.is_dir() || is_pattern(path)
    }

    /// Whether the beginning of a stream is that of a picture or video, also of one that cannot be read here.
    #[must_use]
    pub fn begins_with(start: &[u8]) -> bool {
        let start = &start[..start.len().min(MAGIC_LENGTH)];
        start.starts_with(MAGIC)
            || image::guess_format(start).is_ok()
            || is_heic(start)
            || compressed_video(start).is_some()
    }

    /// Number of frames, where it is known before they are read.
    #[must_use]
    pub fn frame_count(&self) -> Option<u64> {
        self.frame_count
    }

    /// Width of a pixel over its height as a video says.
    #[must_use]
    pub fn pixel_aspect(&self) -> Option<f64> {
        self.pixel_aspect
    }

    /// Whether a video says that it is interlaced: every second line of a frame is of another moment.
    #[must_use]
    pub fn is_interlaced(&self) -> bool {
        self.is_interlaced
    }

    fn rate(&self) -> f64 {
        self.settings.frames_per_second.unwrap_or(DEFAULT_RATE)
    }

    /// Opens a file of several pictures; `None` for a file of one.
    fn open_file(&mut self, file: &SequenceFile) -> Result<Option<OpenFile>, PictureErrorKind> {
        let SequenceFile { path, origin } = file;
        // A link may lead nowhere, and to open a pipe is to wait for somebody who writes to it.
        let is_file = fs::metadata(path)?.is_file();
        if *origin == Origin::Found && !is_file {
            return Err(PictureErrorKind::NotAFile);
        }
        let name = path.display().to_string();
        // What is no file can be read only once, front to back.
        if !is_file {
            return self.open_stream((self.open_pipe)(path)?, &name).map(Some);
        }
        let mut source = BufReader::new(File::open(path)?);
        let start = source.fill_buf()?;
        if start.starts_with(MAGIC) {
            return self.open_stream(Box::new(source), &name).map(Some);
        }
        if !matches!(image::guess_format(start), Ok(ImageFormat::Gif)) {
            return Ok(None);
        }
        let animation = GifAnimation::open(source, self.settings.channel)?;
        Ok(Some(self.opened(name, Pictures::Animation(Box::new(animation)))))
    }

    fn open_stream(&mut self, mut source: Box<dyn BufRead>, name: &str) -> Result<OpenFile, PictureErrorKind> {
        let channel = self.settings.channel;
        let start = filled(&mut source)?;
        let pictures = if start.is_empty() {
            return Err(PictureErrorKind::Empty);
        } else if let Some(format) = compressed_video(start) {
            return Err(PictureErrorKind::CompressedVideo { format });
        } else if start.starts_with(b"Y") {
            let video = VideoReader::open(source, channel)?;
            self.pixel_aspect = video.pixel_aspect;
            self.is_interlaced |= video.is_interlaced;
            self.settings.frames_per_second = self.settings.frames_per_second.or(video.frame_rate);
            Pictures::Video(video)
        } else {
            // These formats are not read front to back.
            let is_animation = start.starts_with(b"GIF");
            let mut bytes = Vec::new();
            source.take(STREAM_LIMIT).read_to_end(&mut bytes)?;
            let mut bytes = Cursor::new(bytes);
            match is_animation {
                true => Pictures::Animation(Box::new(GifAnimation::open(bytes, channel)?)),
                false => Pictures::One(Some(decode(&mut bytes, channel)?)),
            }
        };
        Ok(self.opened(name.to_owned(), pictures))
    }

    fn opened(&self, name: String, pictures: Pictures) -> OpenFile {
        let first = (self.next_frame, self.next_frame as f64 / self.rate());
        OpenFile { name, first, pictures }
    }

    /// The next picture of the open file; `None` at its end.
    fn next_of_open(&mut self) -> Option<Result<PictureFrame, PictureError>> {
        let rate = self.rate();
        let open = self.open.as_mut()?;
        let item = open.pictures.next().transpose();
        let (name, first) = (open.name.clone(), open.first);
        let frame = self.next_frame;
        // Nothing can be trusted behind an error.
        if !matches!(item, Some(Ok(_))) {
            self.open = None;
        }
        let item = item?;
        self.next_frame += 1;
        let in_file = Some(frame - first.0);
        Some(match item {
            Ok((picture, delay)) => {
                let own = delay.filter(|_| self.settings.frames_per_second.is_none()).map(|delay| first.1 + delay);
                let time = own.unwrap_or(frame as f64 / rate);
                self.checked(PictureFrame { frame, time, file: name, picture }, in_file)
            }
            Err(kind) => Err(PictureError { file: name, frame: in_file, kind }),
        })
    }

    /// Refuses a picture of another size than the first.
    fn checked(&mut self, frame: PictureFrame, in_file: Option<u64>) -> Result<PictureFrame, PictureError> {
        match PictureErrorKind::check_size(&mut self.size, frame.picture.dimensions()) {
            Ok(()) => Ok(frame),
            Err(kind) => Err(PictureError { file: frame.file, frame: in_file, kind }),
        }
    }
}

impl Iterator for PictureSequence {
    type Item = Result<PictureFrame, PictureError>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            if let Some(item) = self.next_of_open() {
                return Some(item);
            }
            let file = self.files.next()?;
            let path = &file.path;
            let name = path.display().to_string();
            let frame = self.next_frame;
            match self.open_file(&file) {
                Ok(Some(open)) => self.open = Some(open),
                Ok(None) => {
                    self.next_frame += 1;
                    let time = frame as f64 / self.rate();
                    let read = read_picture_channel(path, self.settings.channel).map(Arc::new);
                    let read = read.map(|picture| PictureFrame { frame, time, file: name, picture });
                    return Some(read.and_then(|frame| self.checked(frame, None)));
                }
                Err(kind) => {
                    self.next_frame += 1;
                    return Some(Err(PictureError::of_file(name, kind)));
                }
            }
        }
    }
}

impl std::fmt::Debug for PictureSequence {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let files = self.files.as_slice();
        f.debug_struct("PictureSequence").field("files", &files).field("next_frame", &self.next_frame).finish()
    }
}

/// The first bytes of a stream, which stay in it.
fn filled(source: &mut impl BufRead) -> io::Result<&[u8]> {
    loop {
        match source.fill_buf() {
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
            // Asked for a second time because a borrow cannot leave the loop; what is filled stays filled.
            Ok(_) => return source.fill_buf(),
        }
    }
}

/// Whether a file may hold several pictures, as far as its beginning tells; that of a pipe would be gone.
fn may_hold_several(SequenceFile { path, origin }: &SequenceFile) -> bool {
    if !path.is_file() {
        return *origin == Origin::Given;
    }
    let start = beginning(path).unwrap_or_default();
    start.starts_with(MAGIC) || start.starts_with(b"GIF")
}
