//! The channel of a colour picture that is looked at.
use std::sync::Arc;

use image::{DynamicImage, GrayImage, Luma, RgbImage};

/// What is looked at of a colour picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Channel {
    /// The luminance. Where some pixels of a picture are transparent its alpha channel is taken instead, so that the
    /// visible part is light on dark.
    #[default]
    Luminance,
    /// The red channel.
    Red,
    /// The green channel.
    Green,
    /// The blue channel.
    Blue,
    /// How far a colour is from grey: the largest of its channels less the smallest.
    Saturation,
}

impl Channel {
    /// The channel of a decoded picture, as grey values.
    pub(crate) fn of(self, picture: DynamicImage) -> GrayImage {
        match self {
            Self::Luminance => visible_part(&picture).unwrap_or_else(|| picture.into_luma8()),
            channel => channel.of_colours(&picture.into_rgb8()),
        }
    }

    /// Several channels of a decoded picture, as [`of`](Self::of) gives each; those that are equal, as in grey pictures, are one picture.
    pub(crate) fn all_of(picture: DynamicImage, channels: &[Self]) -> Vec<Arc<GrayImage>> {
        let visible = visible_part(&picture).map(Arc::new);
        if !picture.color().has_color() || channels.iter().all(|channel| *channel == Self::Luminance) {
            let grey = Arc::new(picture.into_luma8());
            let of_grey = |channel: &Self| match (channel, &visible) {
                (Self::Luminance, Some(visible)) => Arc::clone(visible),
                (Self::Saturation, _) => Arc::new(GrayImage::new(grey.width(), grey.height())),
                _ => Arc::clone(&grey),
            };
            return channels.iter().map(of_grey).collect();
        }
        let luminance = channels.contains(&Self::Luminance);
        let luminance = luminance.then(|| visible.unwrap_or_else(|| Arc::new(picture.to_luma8())));
        let colours = picture.into_rgb8();
        let of_colours = |channel: &Self| match (channel, &luminance) {
            (Self::Luminance, Some(luminance)) => Arc::clone(luminance),
            _ => Arc::new(channel.of_colours(&colours)),
        };
        channels.iter().map(of_colours).collect()
    }

    /// The channel of each pixel.
    fn of_colours(self, colours: &RgbImage) -> GrayImage {
        let (pixels, _) = colours.as_raw().as_chunks::<3>();
        // One loop for each channel: what is done in it is known then.
        let grey = match self {
            Self::Red => pixels.iter().map(|[red, ..]| *red).collect(),
            Self::Green => pixels.iter().map(|[_, green, _]| *green).collect(),
            Self::Blue => pixels.iter().map(|[.., blue]| *blue).collect(),
            Self::Saturation => pixels.iter().map(|colour| Self::Saturation.of_colour(*colour)).collect(),
            Self::Luminance => pixels.iter().map(|colour| Self::Luminance.of_colour(*colour)).collect(),
        };
        GrayImage::from_raw(colours.width(), colours.height(), grey).unwrap_or_default()
    }

    /// The channel of one colour: red, green, blue.
    pub(crate) fn of_colour(self, [red, green, blue]: [u8; 3]) -> u8 {
        match self {
            Self::Red => red,
            Self::Green => green,
            Self::Blue => blue,
            Self::Saturation => red.max(green).max(blue) - red.min(green).min(blue),
            Self::Luminance => {
                let Luma([grey]) = image::Pixel::to_luma(&image::Rgb([red, green, blue]));
                grey
            }
        }
    }
}

/// The alpha channel, if any of the pixels is transparent.
fn visible_part(picture: &DynamicImage) -> Option<GrayImage> {
    if !picture.color().has_alpha() {
        return None;
    }
    let alpha: Vec<u8> = picture.to_luma_alpha8().pixels().map(|pixel| pixel.0[1]).collect();
    let transparent = alpha.iter().any(|&value| value < u8::MAX);
    if transparent { GrayImage::from_raw(picture.width(), picture.height(), alpha) } else { None }
}
