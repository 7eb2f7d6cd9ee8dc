//! A picture of what each way of tracing finds, to choose one by eye.
use freeform_motion::outline_io::{
    Channel, GrayImage, PictureFrame, PictureOutlines, PicturePreview, PictureSettings, Selection, TracingEvidence,
    TracingWay,
};
use freeform_motion::short;
use image::RgbImage;
use image::imageops::{FilterType, overlay, resize};

use crate::overlay::{Canvas, Label};

/// Ways drawn: the best ones.
const WAYS: usize = 6;

/// Pictures drawn of each.
const PICTURES: usize = 4;

/// Pixels between what is drawn.
const GAP: u32 = 6;

/// Width of a picture on the sheet, in pixels, unless it is smaller.
const WIDTH: u32 = 320;

/// Height of the line of text above a row, in pixels.
const TEXT_HEIGHT: u32 = 24;

/// Draws the ways of tracing of the highest scores, in their order: a row for each with its name, its score, and the outlines that it finds in
/// pictures of the sequence. The first of `candidates` is the one taken, which is always drawn, and marked: a simpler way may be preferred to one
/// of a higher score. `base` has the settings that they do not say.
#[must_use]
pub fn candidate_sheet(
    preview: &PicturePreview,
    base: &PictureSettings,
    candidates: &[TracingEvidence],
    name: impl Fn(&TracingEvidence) -> String,
) -> RgbImage {
    let row = |way: Ranked<'_>| (way.caption(&name(way.evidence)), drawn(preview, base, way.evidence));
    let rows: Vec<(String, Vec<RgbImage>)> = ranked(candidates).into_iter().map(row).collect();
    sheet(&rows)
}

/// A way of tracing among all.
#[derive(Debug, Clone, Copy)]
struct Ranked<'a> {
    /// By score, from 1 on.
    rank: usize,
    is_taken: bool,
    evidence: &'a TracingEvidence,
}

impl Ranked<'_> {
    fn caption(&self, name: &str) -> String {
        let TracingEvidence { found, pictures, score, .. } = self.evidence;
        let score = short((score * 1000.0).round() / 1000.0);
        let taken = if self.is_taken { "  taken" } else { "" };
        format!("{}  {name}  score {score}  {found} of {pictures} pictures{taken}", self.rank)
    }
}

/// The ways that are drawn, the highest score first; the last of them is the one taken where it is not among the best.
fn ranked(candidates: &[TracingEvidence]) -> Vec<Ranked<'_>> {
    let ways = (1..).zip(TracingEvidence::by_score(candidates)).map(|(rank, (place, evidence))| Ranked {
        rank,
        is_taken: place == 0,
        evidence,
    });
    let (mut best, others): (Vec<_>, Vec<_>) = ways.partition(|way| way.rank <= WAYS);
    if let Some(taken) = others.into_iter().find(|way| way.is_taken) {
        best.truncate(WAYS - 1);
        best.push(taken);
    }
    best
}

/// Pictures of the sequence with the outlines that a way finds in them, in the size of the sheet.
fn drawn(preview: &PicturePreview, base: &PictureSettings, candidate: &TracingEvidence) -> Vec<RgbImage> {
    let channel = candidate.tracing.channel;
    let ground = match candidate.tracing.way {
        TracingWay::Median(_) => preview.ground(channel),
        _ => None,
    };
    let settings = PictureSettings { selection: Selection::All, ..candidate.tracing.settings(base, ground) };
    let pictures = spread(preview, channel);
    let grid = pictures.first().map(|first| settings.trace.pixel_grid(first.picture.height()));
    let Ok(traced) = PictureOutlines::new(pictures.into_iter().map(Ok), settings) else { return Vec::new() };
    let draw = |picture: &GrayImage, outlines: &[Vec<[f64; 2]>]| {
        let (columns, rows) = picture.dimensions();
        let factor = (f64::from(WIDTH) / f64::from(columns)).min(1.0);
        let size = [columns, rows].map(|side| ((f64::from(side) * factor).round() as u32).max(1));
        let small =
            if factor < 1.0 { resize(picture, size[0], size[1], FilterType::Triangle) } else { picture.clone() };
        let mut canvas = Canvas::of(&small);
        for outline in outlines {
            canvas.outline(outline.iter().map(|[x, y]| [factor * x, factor * y]));
        }
        canvas.into_picture()
    };
    let frames = traced.flatten().map(|frame| {
        let objects = frame.objects.unwrap_or_default();
        let pieces = objects.iter().flat_map(|(_, traced)| traced.outline.pieces());
        let outlines: Vec<Vec<[f64; 2]>> = pieces
            .map(|piece| {
                let closing = piece.points.first().filter(|_| piece.closed);
                let points = piece.points.iter().chain(closing);
                points.filter_map(|point| grid.as_ref().map(|grid| grid.to_pixels(point))).collect()
            })
            .collect();
        draw(&frame.frame.picture, &outlines)
    });
    frames.collect()
}

/// Some pictures of the sample, evenly spread over it.
fn spread(preview: &PicturePreview, channel: Channel) -> Vec<PictureFrame> {
    let all: Vec<PictureFrame> = preview.pictures(channel).into_iter().flatten().flatten().collect();
    let count = PICTURES.min(all.len());
    let mut places: Vec<usize> = (0..count).map(|k| (2 * k + 1) * all.len() / (2 * count)).collect();
    places.dedup();
    let mut kept = Vec::new();
    for (index, picture) in all.into_iter().enumerate() {
        if places.contains(&index) {
            kept.push(picture);
        }
    }
    kept
}

/// All rows below each other.
fn sheet(rows: &[(String, Vec<RgbImage>)]) -> RgbImage {
    let side = |of: fn(&RgbImage) -> u32| rows.iter().flat_map(|(_, pictures)| pictures).map(of).max().unwrap_or(1);
    let (width, height) = (side(RgbImage::width), side(RgbImage::height));
    let across = rows.iter().map(|(_, pictures)| pictures.len() as u32).max().unwrap_or(1).max(1);
    let text = rows.iter().map(|(caption, _)| Label::width(caption)).max().unwrap_or(0);
    let row_height = TEXT_HEIGHT + height + GAP;
    let size = [(across * (width + GAP)).max(text) + GAP, rows.len() as u32 * row_height + GAP];
    let mut canvas = Canvas::of(&GrayImage::new(size[0], size[1].max(1)));
    for (row, (caption, _)) in rows.iter().enumerate() {
        canvas.label([GAP, row as u32 * row_height + GAP], caption);
    }
    let mut sheet = canvas.into_picture();
    for (row, (_, pictures)) in rows.iter().enumerate() {
        let top = row as u32 * row_height + TEXT_HEIGHT;
        for (column, picture) in pictures.iter().enumerate() {
            overlay(&mut sheet, picture, i64::from(GAP + column as u32 * (width + GAP)), i64::from(top));
        }
    }
    sheet
}

#[cfg(test)]
mod tests {
    use freeform_motion::outline_io::{Smoothing, Tracing};

    use super::*;

    /// A way of tracing of some score.
    fn way(score: f64) -> TracingEvidence {
        let (way, smoothing) = (TracingWay::Lighter, Smoothing::default());
        TracingEvidence {
            tracing: Tracing { way, channel: Channel::Luminance, smoothing, level: None },
            pictures: 12,
            found: 11,
            steadiness: 1.0,
            evenness: 1.0,
            contrast: 1.0,
            smoothness: 1.0,
            movement: 5.0,
            rests: false,
            clipped: 0.0,
            area_share: 0.1,
            objects: 1,
            second: 0.0,
            selection: Selection::Largest,
            largest_hole: 0.0,
            has_steady_contours: false,
            score,
        }
    }

    fn captions(scores: &[f64]) -> Vec<String> {
        let ways: Vec<_> = scores.iter().map(|score| way(*score)).collect();
        ranked(&ways).iter().map(|way| way.caption("--light")).collect()
    }

    #[test]
    fn ways_are_drawn_by_their_scores_and_the_one_taken_is_marked_with_its_rank() {
        let caption =
            |rank: usize, score: f64, taken: &str| format!("{rank}  --light  score {score}  11 of 12 pictures{taken}");
        assert_eq!(captions(&[0.5, 0.7, 0.6]), [caption(1, 0.7, ""), caption(2, 0.6, ""), caption(3, 0.5, "  taken")]);
        let many = captions(&[0.1, 0.2, 0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3]);
        let expected = [(1, 0.9), (2, 0.8), (3, 0.7), (4, 0.6), (5, 0.5)].map(|(rank, score)| caption(rank, score, ""));
        assert_eq!(many, [&expected[..], &[caption(9, 0.1, "  taken")]].concat());
    }
}
