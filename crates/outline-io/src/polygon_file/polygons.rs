//! Outlines that were drawn or found in annotation programs, as polygons in pictures.
use std::collections::HashSet;

use nalgebra::Point2;

use crate::error::{Place, ReadError, ReadErrorKind};
use crate::frame::OutlineFrame;
use crate::picture_file::natural_order::natural_order;
use crate::picture_file::sequence::DEFAULT_RATE;
use crate::polygon_file::bodies::{Bodies, Body};
use crate::polygon_file::coco::{CocoFile, coco_bodies};
use crate::polygon_file::error::PolygonError;
use crate::polygon_file::labelme::{LabelmeFile, labelme_bodies};
use crate::polygon_file::trackmate::trackmate_bodies;
use crate::table::outline_rows::closed_outline;

/// Most bytes of a file of polygons, which is read as a whole.
pub(crate) const FILE_LIMIT: u64 = 1 << 30;

/// Direction of the second coordinate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum VerticalAxis {
    /// From the lower edge of the picture upwards, as outlines of pictures are traced.
    #[default]
    Up,
    /// From the upper edge downwards, as in the file.
    Down,
}

/// How polygons are read.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PolygonSettings {
    /// Frames per second; `None` for what the file says, else 30.
    pub frames_per_second: Option<f64>,
    /// Direction of y.
    pub vertical: VerticalAxis,
    /// Length of a pixel, or of the unit of the file.
    pub pixel_size: f64,
}

impl Default for PolygonSettings {
    fn default() -> Self {
        Self { frames_per_second: None, vertical: VerticalAxis::Up, pixel_size: 1.0 }
    }
}

/// The outlines of polygons.
#[derive(Debug)]
pub(crate) struct PolygonOutlines {
    pub(crate) outlines: Vec<Result<OutlineFrame, ReadError>>,
    /// Whether the rate of the frames is neither given nor in the file.
    pub(crate) is_rate_assumed: bool,
}

/// Whether text begins like a file of polygons: JSON or XML.
pub(crate) fn begins_like_polygons(start: &[u8]) -> bool {
    let start = start.strip_prefix(b"\xef\xbb\xbf").unwrap_or(start).trim_ascii_start();
    matches!(start.first(), Some(b'{' | b'<'))
}

/// Reads polygons of files, given with their names and content.
pub(crate) fn read_polygons(
    files: &[(String, Vec<u8>)],
    settings: &PolygonSettings,
) -> Result<PolygonOutlines, ReadError> {
    let Bodies { mut list, remedy } = bodies(files)?;
    let name = files.first().map_or("", |(name, _)| name.as_str());
    list.sort_by(|a, b| a.frame.cmp(&b.frame).then_with(|| natural_order(&a.object, &b.object)));
    let mut seen = HashSet::new();
    for body in &list {
        if !seen.insert((body.frame, body.object.as_str())) {
            let (object, picture) = (body.object.clone(), format!("frame {}", body.frame));
            return Err(failed(name, PolygonError::SameName { object, picture, remedy }));
        }
    }
    let is_rate_assumed = settings.frames_per_second.is_none() && list.iter().any(|body| body.time.is_none());
    let outlines = list.into_iter().map(|body| outline(body, settings, name)).collect();
    Ok(PolygonOutlines { outlines, is_rate_assumed })
}

fn bodies(files: &[(String, Vec<u8>)]) -> Result<Bodies, ReadError> {
    let mut labelme = Vec::new();
    for (name, content) in files {
        let content = content.strip_prefix(b"\xef\xbb\xbf").unwrap_or(content);
        let single = |bodies: Result<Bodies, PolygonError>| match files {
            [_] => bodies.map_err(|error| failed(name, error)),
            _ => Err(failed(name, PolygonError::SeveralFiles)),
        };
        if content.trim_ascii_start().starts_with(b"<") {
            return single(trackmate_bodies(content));
        }
        let json = |error: serde_json::Error| failed(name, error.into());
        if let Some(coco) = CocoFile::parse(content).map_err(json)? {
            return single(coco_bodies(coco));
        }
        match LabelmeFile::parse(content).map_err(json)? {
            Some(file) => labelme.push((name.as_str(), file)),
            None => return Err(failed(name, PolygonError::Unknown)),
        }
    }
    labelme_bodies(labelme).map_err(|(name, error)| failed(&name, error))
}

fn outline(body: Body, settings: &PolygonSettings, name: &str) -> Result<OutlineFrame, ReadError> {
    let Body { object, frame, time, height, mut contours } = body;
    let placed = |point: &Point2<f64>| {
        let y = match settings.vertical {
            VerticalAxis::Up => height - point.y,
            VerticalAxis::Down => point.y,
        };
        Point2::new(point.x, y) * settings.pixel_size
    };
    for contour in &mut contours {
        contour.iter_mut().for_each(|point| *point = placed(point));
    }
    // The boundary first.
    contours.sort_by(|a, b| area(b).total_cmp(&area(a)));
    let rate = settings.frames_per_second.unwrap_or(DEFAULT_RATE);
    let time = time.filter(|_| settings.frames_per_second.is_none()).unwrap_or(frame as f64 / rate);
    match closed_outline(contours) {
        Ok(outline) => Ok(OutlineFrame { frame, time, object, outline }),
        Err(source) => Err(ReadError { place: place(name), kind: ReadErrorKind::Degenerate { object, frame, source } }),
    }
}

/// Twice the area of a polygon.
fn area(points: &[Point2<f64>]) -> f64 {
    let next = points.iter().cycle().skip(1);
    points.iter().zip(next).map(|(a, b)| a.x * b.y - a.y * b.x).sum::<f64>().abs()
}

fn place(name: &str) -> Place {
    Place { file: name.to_owned(), span: None, column: None }
}

pub(crate) fn failed(name: &str, error: PolygonError) -> ReadError {
    ReadError { place: place(name), kind: ReadErrorKind::Polygons(error) }
}
