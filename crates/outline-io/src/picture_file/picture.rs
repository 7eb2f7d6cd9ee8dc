//! One picture from a file or from bytes.
use std::fs::File;
use std::io::{BufRead, BufReader, Seek, SeekFrom};
use std::path::Path;
use std::sync::Arc;

use image::codecs::png::PngDecoder;
#[cfg(feature = "all-pictures")]
use image::codecs::webp::WebPDecoder;
use image::metadata::Orientation;
use image::{DynamicImage, GrayImage, ImageDecoder, ImageError, ImageFormat, ImageReader, Limits};

use crate::foreign_format::is_heic;
use crate::picture_file::channel::Channel;
use crate::picture_file::compressed_video::compressed_video;
use crate::picture_file::error::{PictureError, PictureErrorKind};
use crate::picture_file::jpeg_end::reaches_its_end;
use crate::picture_file::tiff_pages::{bits_of_single_sample, has_several_pages};

/// Largest number of pixels accepted, 8192 x 8192: the program then needs less than 1.5 GiB in the worst case.
pub(crate) const PIXEL_LIMIT: u64 = 1 << 26;

/// Most memory that a decoder may take, in bytes: 16 bits in each of 4 channels of the largest picture, twice.
pub(crate) const DECODER_LIMIT: u64 = 1 << 30;

/// Most bytes of a picture as it is decoded: 16 bits in each of 4 channels of the largest. Others have 32.
const LARGEST_PICTURE: u64 = DECODER_LIMIT / 2;

/// Most bytes that the decoder may take for each pixel of a picture.
const DECODER_LIMIT_OF_PIXEL: u64 = DECODER_LIMIT / PIXEL_LIMIT;

/// Bits of the grey values of a TIFF that are read.
const TIFF_BITS: [u64; 3] = [1, 8, 16];

/// Most memory for what a PNG tells beside its pixels, in bytes: colour profiles of printers have some megabytes, histories of editors some
/// tens.
const METADATA_LIMIT: u64 = 1 << 26;

/// Reads a picture (PNG, BMP, the first frame of a GIF; JPEG, TIFF and WebP with the feature `all-pictures`) as grey values. Its content
/// tells the format, not its name. It is turned and mirrored as the file says that it is to be seen (EXIF, or the tag of TIFF).
///
/// Colours become their luminance, those of inks (CMYK) by way of red, green and blue; a CMYK JPEG is taken as Adobe writes it, with
/// the largest value for no ink, whether or not it says so. Where some pixels are transparent the alpha channel is taken instead, so that the
/// visible part is light on dark.
///
/// # Errors
/// The file cannot be read, is empty, is no picture, has a format that is not supported, holds several pictures (APNG,
/// animated WebP, TIFF of several pages), has more than 2^26 pixels, or more than 2^29 bytes as it is decoded, or is damaged.
pub fn read_picture(path: impl AsRef<Path>) -> Result<GrayImage, PictureError> {
    read_picture_channel(path, Channel::Luminance)
}

/// Like [`read_picture`], from any source; the name stands in error messages.
///
/// # Errors
/// As [`read_picture`].
pub fn decode_picture(mut source: impl BufRead + Seek, name: &str) -> Result<GrayImage, PictureError> {
    decode(&mut source, Channel::Luminance).map_err(|kind| PictureError::of_file(name, kind))
}

/// Like [`read_picture`], with what is looked at of a colour picture.
///
/// # Errors
/// As [`read_picture`].
pub fn read_picture_channel(path: impl AsRef<Path>, channel: Channel) -> Result<GrayImage, PictureError> {
    read_file(path.as_ref(), |source| decode(source, channel))
}

/// The bytes of a picture. Decoders of single pictures are compiled once for all kinds of them.
pub(crate) trait Source: BufRead + Seek {}

impl<T: BufRead + Seek> Source for T {}

pub(crate) fn decode(source: &mut dyn Source, channel: Channel) -> Result<GrayImage, PictureErrorKind> {
    let (picture, orientation) = decode_colours(source)?;
    Ok(turned(channel.of(picture), orientation))
}

/// What is read of a file, which errors name.
fn read_file<T>(
    path: &Path,
    read: impl FnOnce(&mut dyn Source) -> Result<T, PictureErrorKind>,
) -> Result<T, PictureError> {
    let file = File::open(path).map_err(PictureErrorKind::Io);
    let read = file.and_then(|file| read(&mut BufReader::new(file)));
    read.map_err(|kind| PictureError::of_file(path.display().to_string(), kind))
}

/// Several channels of a picture that is decoded once, in their order.
pub(crate) fn read_picture_channels(path: &Path, channels: &[Channel]) -> Result<Vec<Arc<GrayImage>>, PictureError> {
    Ok(Channel::all_of(read_picture_colours(path)?, channels))
}

/// A picture with its colours, as it is to be seen.
pub(crate) fn read_picture_colours(path: &Path) -> Result<DynamicImage, PictureError> {
    let (mut picture, orientation) = read_file(path, decode_colours)?;
    picture.apply_orientation(orientation);
    Ok(picture)
}

/// A picture as it is to be seen.
pub(crate) fn turned(picture: GrayImage, orientation: Orientation) -> GrayImage {
    let mut picture = DynamicImage::ImageLuma8(picture);
    picture.apply_orientation(orientation);
    picture.into_luma8()
}

/// A picture with its colours, and how it is to be turned.
fn decode_colours(source: &mut dyn Source) -> Result<(DynamicImage, Orientation), PictureErrorKind> {
    let start = source.fill_buf()?;
    if start.is_empty() {
        return Err(PictureErrorKind::Empty);
    }
    if let Some(format) = compressed_video(start) {
        return Err(PictureErrorKind::CompressedVideo { format });
    }
    if is_heic(start) {
        return Err(PictureErrorKind::Unsupported { format: "image/heic" });
    }
    let limits = limits(start);
    let reader = ImageReader::new(source).with_guessed_format()?;
    let Some(format) = reader.format() else { return Err(PictureErrorKind::NotAPicture) };
    if !format.reading_enabled() {
        return Err(PictureErrorKind::Unsupported { format: format.to_mime_type() });
    }
    let mut source = reader.into_inner();
    if format == ImageFormat::Jpeg {
        let start = source.stream_position()?;
        if !reaches_its_end(&mut source)? {
            return Err(PictureErrorKind::CutShort);
        }
        source.seek(SeekFrom::Start(start))?;
    }
    if let Some(format) = several_pictures(source, format, &limits)? {
        return Err(PictureErrorKind::SeveralPictures { format });
    }
    let other_bits = if format == ImageFormat::Tiff { unread_bits(source)? } else { None };
    let mut reader = ImageReader::with_format(source, format);
    reader.limits(limits);
    let mut decoder = reader.into_decoder().map_err(|error| match (damaged(error), other_bits) {
        (PictureErrorKind::UnsupportedKind(_), Some(bits)) => PictureErrorKind::TiffBits { bits },
        (other, _) => other,
    })?;
    // The header has been read, the pixels have not: nothing large is allocated yet.
    let (width, height) = decoder.dimensions();
    check_size(width, height)?;
    let bytes_of_pixel = u64::from(decoder.color_type().bytes_per_pixel());
    if decoder.total_bytes() > LARGEST_PICTURE {
        return Err(PictureErrorKind::TooLarge { width, height, limit: LARGEST_PICTURE / bytes_of_pixel });
    }
    // What cannot be understood turns nothing.
    let orientation = decoder.orientation().unwrap_or(Orientation::NoTransforms);
    Ok((with_small_values(DynamicImage::from_decoder(decoder).map_err(damaged)?), orientation))
}

/// A mask or labels in 16 bits, as programs that mark objects write them: where all values are such of 8 bits they are taken as these. Of other
/// pictures of 16 bits the upper 8 are looked at.
fn with_small_values(picture: DynamicImage) -> DynamicImage {
    let DynamicImage::ImageLuma16(wide) = &picture else { return picture };
    let values: Result<Vec<u8>, _> = wide.as_raw().iter().map(|value| u8::try_from(*value)).collect();
    let narrow = values.ok().and_then(|values| GrayImage::from_raw(wide.width(), wide.height(), values));
    narrow.map_or(picture, DynamicImage::ImageLuma8)
}

/// Name of the kind of file, if it holds several pictures of which one alone would be read. Leaves the source at its beginning.
fn several_pictures(
    mut source: &mut dyn Source,
    format: ImageFormat,
    limits: &Limits,
) -> Result<Option<&'static str>, PictureErrorKind> {
    let start = source.stream_position()?;
    // A damaged file is told as such later.
    let is_animated = match format {
        ImageFormat::Png => {
            PngDecoder::with_limits(&mut *source, limits.clone()).and_then(|png| png.is_apng()).unwrap_or(false)
        }
        #[cfg(feature = "all-pictures")]
        ImageFormat::WebP => WebPDecoder::new(&mut *source).is_ok_and(|webp| webp.has_animation()),
        _ => false,
    };
    let has_pages = format == ImageFormat::Tiff && has_several_pages(&mut source)?;
    source.seek(SeekFrom::Start(start))?;
    Ok(match (is_animated, has_pages) {
        (true, _) if format == ImageFormat::Png => Some("an animated PNG"),
        (true, _) => Some("an animated WebP"),
        (_, true) => Some("a TIFF of several pages"),
        _ => None,
    })
}

/// How many bits the grey values of a TIFF have, where it has no colours and these are none that are read. Leaves the source at its beginning.
fn unread_bits(mut source: &mut dyn Source) -> Result<Option<u64>, PictureErrorKind> {
    let bits = bits_of_single_sample(&mut source).filter(|bits| !TIFF_BITS.contains(bits));
    source.rewind()?;
    Ok(bits)
}

/// The limits of a file that begins so. That of a PNG is told by its size, since its colour profile may unpack to any.
fn limits(start: &[u8]) -> Limits {
    let mut limits = Limits::no_limits();
    let of_size = png_size(start).map(|[width, height]| {
        let pixels = u64::from(width).saturating_mul(height.into()).min(PIXEL_LIMIT);
        METADATA_LIMIT + DECODER_LIMIT_OF_PIXEL * pixels
    });
    limits.max_alloc = Some(of_size.unwrap_or(DECODER_LIMIT).min(DECODER_LIMIT));
    limits
}

/// Columns and rows of a PNG that begins so.
fn png_size(start: &[u8]) -> Option<[u32; 2]> {
    let header = start.strip_prefix(b"\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR")?;
    let (numbers, _) = header.split_first_chunk::<8>()?;
    let [a, b, c, d, e, f, g, h] = *numbers;
    Some([u32::from_be_bytes([a, b, c, d]), u32::from_be_bytes([e, f, g, h])])
}

pub(crate) fn check_size(width: u32, height: u32) -> Result<(), PictureErrorKind> {
    if u64::from(width) * u64::from(height) > PIXEL_LIMIT {
        return Err(PictureErrorKind::TooLarge { width, height, limit: PIXEL_LIMIT });
    }
    Ok(())
}

pub(crate) fn damaged(error: ImageError) -> PictureErrorKind {
    match error {
        ImageError::IoError(error) if error.kind() != std::io::ErrorKind::UnexpectedEof => PictureErrorKind::Io(error),
        error @ ImageError::Unsupported(_) => PictureErrorKind::UnsupportedKind(error),
        error => PictureErrorKind::Damaged(error),
    }
}
