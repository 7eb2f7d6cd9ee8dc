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
    let row = |(rank, (place, candidate)): (usize, (usize, &TracingEvidence))| {
        (caption(rank, candidate, &name(candidate), place == 0), drawn(preview, base, candidate))
    };
    let rows: Vec<(String, Vec<RgbImage>)> = by_score(candidates).into_iter().enumerate().map(row).collect();
    sheet(&rows)
}

/// The ways that are drawn, with their places in the choice, the highest score first.
fn by_score(candidates: &[TracingEvidence]) -> Vec<(usize, &TracingEvidence)> {
    let mut ways: Vec<_> = candidates.iter().enumerate().collect();
    ways.sort_by(|(_, a), (_, b)| b.score.total_cmp(&a.score));
    if let Some(taken) = ways.iter().position(|(place, _)| *place == 0).filter(|rank| *rank >= WAYS) {
        let taken = ways.remove(taken);
        ways.insert(WAYS - 1, taken);
    }
    ways.truncate(WAYS);
    ways
}

fn caption(
    rank: usize,
    TracingEvidence { found, pictures, score, .. }: &TracingEvidence,
    name: &str,
    is_taken: bool,
) -> String {
    let score = short((score * 1000.0).round() / 1000.0);
    let taken = if is_taken { "  taken" } else { "" };
    format!("{}  {name}  score {score}  {found} of {pictures} pictures{taken}", rank + 1)
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
