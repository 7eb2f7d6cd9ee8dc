//! Some pictures of a sequence, on which ways of tracing are tried.
use std::sync::Arc;

use image::GrayImage;

use super::scaled::{factor_for, scaled};
use crate::picture_file::channel::Channel;
use crate::picture_file::error::PictureError;
use crate::picture_file::sequence::PictureFrame;
use crate::tracing::margins::Margins;
use crate::tracing::trace::is_two_valued;

/// Pictures that follow each other, so that they show how evenly something moves.
pub(crate) const BURST: u64 = 3;

/// Bursts in a sample.
const BURSTS: u64 = 8;

/// Pictures looked through of a sequence whose length is not known.
const LOOKED_THROUGH: u64 = 150;

/// Of these the first so many are all kept, then a burst of every so many.
const FIRST_KEPT: u64 = 24;
const EVERY: u64 = 9;

/// Most pixels of a picture of a sample; larger ones are scaled down.
const MOST_PIXELS: u64 = 340_000;

/// A channel is not looked at where the pictures have so little colour, in grey values.
const LITTLE_COLOUR: u8 = 24;

/// Which pictures of a sequence a sample is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SamplePlan {
    /// Of a sequence of so many pictures: bursts spread over all of it.
    Spread(u64),
    /// Of a sequence of unknown length: of its first 150 pictures, as they come.
    Ahead,
}

impl SamplePlan {
    /// The numbers of the pictures wanted, in order.
    #[must_use]
    pub fn frames(self) -> Vec<u64> {
        match self {
            Self::Spread(count) if count <= BURST * BURSTS => (0..count).collect(),
            Self::Spread(count) => {
                let last = count - BURST;
                let starts = (0..BURSTS).map(|burst| burst * last / (BURSTS - 1));
                let mut frames: Vec<u64> = starts.flat_map(|start| start..start + BURST).collect();
                frames.dedup();
                frames
            }
            Self::Ahead => (0..LOOKED_THROUGH).filter(|k| *k < FIRST_KEPT || k % EVERY < BURST).collect(),
        }
    }
}

/// Pictures spread over a sequence, in every channel that shows something of its own, scaled down where they are large.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PictureSample {
    /// Numbers of the pictures, in order.
    frames: Vec<u64>,
    channels: Vec<(Channel, Vec<Arc<GrayImage>>)>,
    /// Pixels of the sequence for one of the sample, along rows and columns.
    factor: u32,
    /// Columns and rows of the sequence.
    size: (u32, u32),
}

impl PictureSample {
    /// Reads a sample. `pictures` gives those of the plan, as far as they are there, in a channel; it is asked for other channels than the
    /// first only where there is colour. Pictures that cannot be read, or have another size than the first, are left out.
    pub fn read<I: Iterator<Item = Result<PictureFrame, PictureError>>>(
        channels: &[Channel],
        mut pictures: impl FnMut(Channel) -> Option<I>,
    ) -> Self {
        let mut sample = Self { factor: 1, ..Self::default() };
        let Some((first, others)) = channels.split_first() else { return sample };
        sample.take(*first, pictures(*first).into_iter().flatten());
        if others.is_empty() || sample.frames.is_empty() {
            return sample;
        }
        let mut coloured = Self { channels: Vec::new(), ..sample.clone() };
        coloured.take(Channel::Saturation, pictures(Channel::Saturation).into_iter().flatten());
        if coloured.channels.iter().flat_map(|(_, pictures)| pictures).any(|picture| has_colour(picture)) {
            for channel in others {
                match channel {
                    Channel::Saturation => sample.channels.append(&mut coloured.channels),
                    channel => sample.take(*channel, pictures(*channel).into_iter().flatten()),
                }
            }
        }
        sample
    }

    /// Reads a sample as [`read`](Self::read) does, of `pictures` that each come in all of the channels that are asked for, in their order.
    pub(crate) fn read_at_once<I: Iterator<Item = Result<(u64, Vec<Arc<GrayImage>>), PictureError>>>(
        channels: &[Channel],
        pictures: impl FnOnce(Vec<Channel>) -> I,
    ) -> Self {
        let mut sample = Self { factor: 1, ..Self::default() };
        let Some((first, others)) = channels.split_first() else { return sample };
        let mut wanted = channels.to_vec();
        if !others.is_empty() && !wanted.contains(&Channel::Saturation) {
            // It tells whether there is colour.
            wanted.push(Channel::Saturation);
        }
        let (mut frames, mut kept) = (Vec::new(), vec![Vec::new(); wanted.len()]);
        for (frame, pictures) in pictures(wanted.clone()).flatten() {
            if pictures.first().is_some_and(|picture| sample.is_of_its_size(picture)) {
                frames.push(frame);
                for (k, picture) in pictures.iter().enumerate() {
                    // Channels of a grey picture are one picture, and are made smaller once.
                    let same = pictures[..k].iter().position(|other| Arc::ptr_eq(other, picture));
                    let small = same.and_then(|same| kept[same].last().cloned());
                    kept[k].push(small.unwrap_or_else(|| sample.small(Arc::clone(picture))));
                }
            }
        }
        let saturation = wanted.iter().position(|channel| *channel == Channel::Saturation);
        let is_coloured = saturation.is_some_and(|k| kept[k].iter().any(|picture| has_colour(picture)));
        let mut kept = kept.into_iter();
        sample.keep(*first, &frames, kept.next().unwrap_or_default());
        if is_coloured {
            others.iter().zip(kept).for_each(|(channel, kept)| sample.keep(*channel, &frames, kept));
        }
        sample
    }

    fn take(&mut self, channel: Channel, pictures: impl Iterator<Item = Result<PictureFrame, PictureError>>) {
        let mut kept = Vec::new();
        let mut frames = Vec::new();
        for PictureFrame { frame, picture, .. } in pictures.flatten() {
            if self.is_of_its_size(&picture) {
                frames.push(frame);
                kept.push(self.small(picture));
            }
        }
        self.keep(channel, &frames, kept);
    }

    /// Whether a picture has the size of the first, which it may be.
    fn is_of_its_size(&mut self, picture: &GrayImage) -> bool {
        let size = picture.dimensions();
        if self.size == (0, 0) {
            self.size = size;
            self.factor = factor_for(size.0, size.1, MOST_PIXELS);
        }
        size == self.size
    }

    /// A picture as the sample holds it.
    fn small(&self, picture: Arc<GrayImage>) -> Arc<GrayImage> {
        if self.factor == 1 { picture } else { Arc::new(scaled(&picture, self.factor)) }
    }

    /// Keeps of the pictures with these numbers those that the sample is made of.
    fn keep(&mut self, channel: Channel, frames: &[u64], kept: Vec<Arc<GrayImage>>) {
        if self.frames.is_empty() {
            // Of a sequence whose length was not known more may have been kept than are needed.
            let bursts = SamplePlan::Spread(frames.len() as u64).frames();
            let starts_burst = |k: usize| k + 1 < frames.len() && frames[k] + 1 == frames[k + 1];
            let is_even = frames.len() as u64 <= BURST * BURSTS;
            let wanted: Vec<usize> = if is_even {
                (0..frames.len()).collect()
            } else {
                let mut wanted: Vec<usize> = bursts
                    .chunks(BURST as usize)
                    .flat_map(|burst| {
                        let mut start = burst[0] as usize;
                        while start > 0 && !(starts_burst(start) && starts_burst(start + 1)) {
                            start -= 1;
                        }
                        (start..start + BURST as usize).filter(|k| *k < frames.len())
                    })
                    .collect();
                wanted.sort_unstable();
                wanted.dedup();
                wanted
            };
            self.frames = wanted.iter().map(|&k| frames[k]).collect();
        }
        let wanted = |frame: &u64| self.frames.binary_search(frame).is_ok();
        let kept: Vec<Arc<GrayImage>> =
            frames.iter().zip(kept).filter(|(frame, _)| wanted(frame)).map(|(_, picture)| picture).collect();
        if kept.len() == self.frames.len() && !kept.is_empty() {
            self.channels.push((channel, kept));
        }
    }

    /// The channels, the first one first.
    pub fn channels(&self) -> impl Iterator<Item = Channel> {
        self.channels.iter().map(|(channel, _)| *channel)
    }

    /// Number of pictures.
    #[must_use]
    pub fn len(&self) -> usize {
        self.frames.len()
    }

    /// Whether there is no picture.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.frames.is_empty()
    }

    /// The even bars at the sides of the pictures of the sequence.
    pub(super) fn bars(&self) -> Margins {
        // Bars are looked for in pictures that may have been made smaller: up to a pixel of these, `factor` of the sequence, is taken off too much.
        self.channels
            .first()
            .map_or_else(Margins::default, |(_, pictures)| Margins::of_bars(pictures))
            .times(self.factor)
    }

    /// What is left within margins, which are those of the sequence.
    pub(super) fn within(&self, margins: Margins) -> Self {
        let (columns, rows) = self.size;
        let of_sample = margins.scaled(self.factor);
        let within = |pictures: &Vec<Arc<GrayImage>>| -> Vec<Arc<GrayImage>> {
            pictures
                .iter()
                .map(|picture| {
                    of_sample.within(picture).map_or_else(|_| picture.clone(), |left| Arc::new(left.into_owned()))
                })
                .collect()
        };
        Self {
            channels: self.channels.iter().map(|(channel, pictures)| (*channel, within(pictures))).collect(),
            size: (
                columns.saturating_sub(margins.left.saturating_add(margins.right)),
                rows.saturating_sub(margins.top.saturating_add(margins.bottom)),
            ),
            frames: self.frames.clone(),
            factor: self.factor,
        }
    }

    /// Numbers of the pictures, and what a channel shows.
    pub(super) fn of(&self, channel: Channel) -> (&[u64], &[Arc<GrayImage>]) {
        let found = self.channels.iter().find(|(known, _)| *known == channel);
        (&self.frames, found.map_or(&[], |(_, pictures)| pictures))
    }

    pub(super) fn factor(&self) -> u32 {
        self.factor
    }

    pub(super) fn size(&self) -> (u32, u32) {
        self.size
    }

    /// Whether the pictures are masks.
    pub(super) fn is_two_valued(&self) -> bool {
        let Some((_, pictures)) = self.channels.first() else { return false };
        self.factor == 1 && pictures.iter().all(|picture| is_two_valued(picture))
    }
}

/// Whether a picture of the saturation shows more than some specks.
fn has_colour(saturation: &GrayImage) -> bool {
    let strong = saturation.as_raw().iter().filter(|value| **value > LITTLE_COLOUR).count();
    1000 * strong > saturation.as_raw().len()
}
