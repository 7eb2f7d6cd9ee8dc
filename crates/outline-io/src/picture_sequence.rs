use std::fs::{self, File};
use std::io::{self, BufRead, BufReader, Cursor, Read};
use std::path::{Path, PathBuf};

use image::{GrayImage, ImageFormat};

use crate::channel::Channel;
use crate::compressed_video::compressed_video;
use crate::natural_order::natural_order;
use crate::picture::{Animation, decode, read_picture_channel};
use crate::picture_error::{PictureError, PictureErrorKind};
use crate::y4m::{MAGIC, VideoReader};

/// Frames per second where neither the settings nor the file tell.
const DEFAULT_RATE: f64 = 30.0;

/// Longest picture or animation read from a stream, in bytes.
const STREAM_LIMIT: u64 = 1 << 30;

/// Number of bytes at the beginning of a file that identify its format.
const MAGIC_LENGTH: usize = 16;

/// Extensions of the files that a folder is searched for.
const EXTENSIONS: [&str; 9] = ["png", "jpg", "jpeg", "tif", "tiff", "bmp", "gif", "y4m", "jpe"];

/// One picture of a sequence.
#[derive(Debug, Clone, PartialEq)]
pub struct PictureFrame {
    /// Number of the frame, counted from 0 over all files; frames that cannot be read are counted.
    pub frame: u64,
    /// Time in seconds.
    pub time: f64,
    /// Name of the file.
    pub file: String,
    /// The grey values.
    pub picture: GrayImage,
}

/// How a sequence of pictures is read.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
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
/// not given to another picture. All pictures have the size of the first.
pub struct PictureSequence {
    settings: SequenceSettings,
    files: std::vec::IntoIter<PathBuf>,
    open: Option<OpenFile>,
    next_frame: u64,
    /// Size of the first picture.
    size: Option<(u32, u32)>,
    frame_count: Option<u64>,
    pixel_aspect: Option<f64>,
}

/// A file of several pictures that is being read.
struct OpenFile {
    name: String,
    /// Number of its first frame in the sequence, and the time of that.
    first: (u64, f64),
    pictures: Pictures,
}

enum Pictures {
    Animation(Animation),
    Video(VideoReader<Box<dyn BufRead>>),
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
            files.append(&mut picture_files(path)?);
        }
        let single = files.len() == 1;
        let frame_count = (!files.iter().any(|file| may_hold_several(file))).then_some(files.len() as u64);
        let mut sequence = Self::of(settings, files, frame_count);
        if single && frame_count.is_none() {
            // What the header says is known before the first frame is read.
            let path = sequence.files.next().unwrap_or_default();
            let name = path.display().to_string();
            let opened = sequence.open_file(&path);
            sequence.open = opened.map_err(|kind| PictureError::of_file(name, kind))?;
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

    fn of(settings: SequenceSettings, files: Vec<PathBuf>, frame_count: Option<u64>) -> Self {
        let files = files.into_iter();
        Self { settings, files, open: None, next_frame: 0, size: None, frame_count, pixel_aspect: None }
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
        start.starts_with(MAGIC) || image::guess_format(start).is_ok() || compressed_video(start).is_some()
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

    fn rate(&self) -> f64 {
        self.settings.frames_per_second.unwrap_or(DEFAULT_RATE)
    }

    /// Opens a file of several pictures; `None` for a file of one.
    fn open_file(&mut self, path: &Path) -> Result<Option<OpenFile>, PictureErrorKind> {
        let mut source = BufReader::new(File::open(path)?);
        let start = source.fill_buf()?;
        let name = path.display().to_string();
        if start.starts_with(MAGIC) {
            return self.open_stream(Box::new(source), &name).map(Some);
        }
        if !matches!(image::guess_format(start), Ok(ImageFormat::Gif)) {
            return Ok(None);
        }
        let animation = Animation::open(source, self.settings.channel)?;
        Ok(Some(self.opened(name, Pictures::Animation(animation))))
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
            self.settings.frames_per_second = self.settings.frames_per_second.or(video.frame_rate);
            Pictures::Video(video)
        } else {
            // These formats are not read front to back.
            let is_animation = start.starts_with(b"GIF");
            let mut bytes = Vec::new();
            source.take(STREAM_LIMIT).read_to_end(&mut bytes)?;
            let bytes = Cursor::new(bytes);
            Pictures::Animation(match is_animation {
                true => Animation::open(bytes, channel)?,
                false => Animation::of_one(decode(bytes, channel)?),
            })
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
        let item = match &mut open.pictures {
            Pictures::Video(video) => video.next().map(|picture| picture.map(|picture| (picture, None))),
            Pictures::Animation(animation) => {
                animation.next().map(|item| item.map(|(picture, time)| (picture, Some(time))))
            }
        };
        let (name, first) = (open.name.clone(), open.first);
        let frame = self.next_frame;
        let Some(item) = item else {
            self.open = None;
            return None;
        };
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
        let (width, height) = frame.picture.dimensions();
        let (first_width, first_height) = *self.size.get_or_insert((width, height));
        if (width, height) != (first_width, first_height) {
            let kind = PictureErrorKind::SizeChanged { width, height, first_width, first_height };
            return Err(PictureError { file: frame.file, frame: in_file, kind });
        }
        Ok(frame)
    }
}

impl Iterator for PictureSequence {
    type Item = Result<PictureFrame, PictureError>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            if let Some(item) = self.next_of_open() {
                return Some(item);
            }
            let path = self.files.next()?;
            let name = path.display().to_string();
            let frame = self.next_frame;
            match self.open_file(&path) {
                Ok(Some(open)) => self.open = Some(open),
                Ok(None) => {
                    self.next_frame += 1;
                    let time = frame as f64 / self.rate();
                    let read = read_picture_channel(&path, self.settings.channel);
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

fn is_pattern(path: &Path) -> bool {
    path.to_str().is_some_and(|text| text.contains(['*', '?', '['])) && !path.exists()
}

/// Whether a file is taken for a picture where its folder is searched, by its extension.
#[must_use]
pub fn has_picture_extension(path: &Path) -> bool {
    let extension = path.extension().and_then(|extension| extension.to_str());
    extension.is_some_and(|extension| EXTENSIONS.iter().any(|known| known.eq_ignore_ascii_case(extension)))
}

/// Whether a file may hold several pictures, as far as its name and beginning tell.
fn may_hold_several(path: &Path) -> bool {
    let start = beginning(path).unwrap_or_default();
    start.starts_with(MAGIC) || start.starts_with(b"GIF")
}

/// What a file begins with, as far as it tells the format.
fn beginning(path: &Path) -> io::Result<Vec<u8>> {
    let mut start = Vec::new();
    File::open(path)?.take(MAGIC_LENGTH as u64).read_to_end(&mut start)?;
    Ok(start)
}

/// Why there are no pictures among files: video that is not decoded, or none at all.
fn nothing_to_read(path: &Path, mut files: Vec<PathBuf>) -> PictureError {
    files.sort_by(|a, b| natural_order(&a.to_string_lossy(), &b.to_string_lossy()));
    let format = |file: &PathBuf| compressed_video(&beginning(file).unwrap_or_default());
    match files.iter().find_map(|file| Some((file, format(file)?))) {
        Some((file, format)) => {
            PictureError::of_file(file.display().to_string(), PictureErrorKind::CompressedVideo { format })
        }
        None => PictureError::of_file(path.display().to_string(), PictureErrorKind::NoPictures),
    }
}

/// The files that a path stands for: those of the pictures in a folder or that match a pattern, in natural order, or the path.
///
/// # Errors
/// A folder that cannot be read; a folder or a pattern without pictures; a folder of nothing but compressed video, whose
/// first is named.
pub fn picture_files(path: &Path) -> Result<Vec<PathBuf>, PictureError> {
    let failed = |kind| PictureError::of_file(path.display().to_string(), kind);
    let mut found: Vec<PathBuf> = if path.is_dir() {
        let entries = fs::read_dir(path).map_err(|error| failed(error.into()))?;
        let entries = entries.collect::<Result<Vec<_>, _>>().map_err(|error| failed(error.into()))?;
        let is_hidden = |path: &Path| path.file_name().is_some_and(|name| name.as_encoded_bytes().starts_with(b"."));
        let all = entries.into_iter().map(|entry| entry.path()).filter(|path| !is_hidden(path) && path.is_file());
        let (pictures, others): (Vec<_>, Vec<_>) = all.partition(|path| has_picture_extension(path));
        if pictures.is_empty() {
            return Err(nothing_to_read(path, others));
        }
        pictures
    } else if is_pattern(path) {
        let matches = glob::glob(&path.to_string_lossy()).map_err(|_| failed(PictureErrorKind::WrongPattern))?;
        matches.filter_map(Result::ok).filter(|path| path.is_file()).collect()
    } else {
        return Ok(vec![path.to_owned()]);
    };
    if found.is_empty() {
        return Err(failed(PictureErrorKind::NoPictures));
    }
    found.sort_by(|a, b| natural_order(&a.to_string_lossy(), &b.to_string_lossy()));
    Ok(found)
}
