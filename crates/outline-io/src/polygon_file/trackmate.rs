//! Contours of the spots of TrackMate: an XML file with spots by frame, and the tracks that link them.
use std::collections::{HashMap, HashSet};

use nalgebra::Point2;
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};

use crate::csv_file::field::quoted_start;
use crate::polygon_file::bodies::{Bodies, Body, checked_name, points_of};
use crate::polygon_file::error::PolygonError;

/// What is wrong where two spots have a name; branches have names of their own.
const REMEDY: &str = "two tracks have this name";

/// A spot, of which the outline is in the text of its element.
#[derive(Debug)]
struct Spot {
    id: String,
    frame: u64,
    time: f64,
    centre: Point2<f64>,
    /// Relative to the centre.
    outline: Vec<f64>,
}

#[derive(Debug, Default)]
struct Track {
    name: String,
    id: String,
    /// Spots that are linked.
    edges: Vec<(String, String)>,
}

/// What is gathered from a file.
#[derive(Debug, Default)]
struct Model {
    spots: Vec<Spot>,
    tracks: Vec<Track>,
    /// Tracks that are not filtered out; `None` where the file does not tell.
    shown: Option<HashSet<String>>,
    /// Seconds in a unit of time; `None` for frames and what is not known.
    second: Option<f64>,
    /// Of the picture, in the unit of length.
    height: f64,
}

/// A body for every spot of a track that is shown. A track that divides or is joined gives an object for every branch.
pub(crate) fn trackmate_bodies(content: &[u8]) -> Result<Bodies, PolygonError> {
    let model = parse(content)?;
    let is_shown = |track: &&Track| model.shown.as_ref().is_none_or(|shown| shown.contains(&track.id));
    let by_id: HashMap<&str, &Spot> = model.spots.iter().map(|spot| (spot.id.as_str(), spot)).collect();
    let mut list = Vec::new();
    for track in model.tracks.iter().filter(is_shown) {
        for (spot, object) in branches(track, &by_id) {
            if spot.outline.is_empty() {
                return Err(PolygonError::NoPolygon { item: format!("spot {}", spot.id) });
            }
            let relative = points_of(&spot.outline, || format!("spot {}", spot.id))?;
            let contour = relative.iter().map(|point| spot.centre + point.coords).collect();
            let time = model.second.map(|second| spot.time * second);
            list.push(Body { object, frame: spot.frame, time, height: model.height, contours: vec![contour] });
        }
    }
    match list.is_empty() {
        true => Err(PolygonError::NoTracks),
        false => Ok(Bodies { list, remedy: REMEDY }),
    }
}

/// The spots of a track in the order of time, each with the name of its branch.
fn branches<'a>(track: &Track, by_id: &HashMap<&str, &'a Spot>) -> Vec<(&'a Spot, String)> {
    let spot = |id: &String| by_id.get(id.as_str()).copied();
    let links: Vec<(&Spot, &Spot)> = track
        .edges
        .iter()
        .filter_map(|(source, target)| spot(source).zip(spot(target)))
        .map(|(a, b)| if a.frame <= b.frame { (a, b) } else { (b, a) })
        .collect();
    let (mut before, mut after): (HashMap<&str, Vec<&str>>, HashMap<&str, usize>) = Default::default();
    let mut spots: Vec<&Spot> = Vec::new();
    let mut known = HashSet::new();
    for (a, b) in links {
        before.entry(&b.id).or_default().push(&a.id);
        *after.entry(&a.id).or_default() += 1;
        spots.extend([a, b].into_iter().filter(|spot| known.insert(spot.id.as_str())));
    }
    spots.sort_by_key(|spot| spot.frame);
    let mut names: HashMap<&str, String> = HashMap::new();
    let mut branches = 0;
    let mut named = Vec::with_capacity(spots.len());
    for spot in spots {
        let goes_on = match before.get(spot.id.as_str()).map(Vec::as_slice) {
            Some([only]) if after.get(only) == Some(&1) => names.get(only).cloned(),
            _ => None,
        };
        let name = goes_on.unwrap_or_else(|| {
            branches += 1;
            if branches == 1 { track.name.clone() } else { format!("{}.{branches}", track.name) }
        });
        names.insert(&spot.id, name.clone());
        named.push((spot, name));
    }
    named
}

fn parse(content: &[u8]) -> Result<Model, PolygonError> {
    let mut reader = Reader::from_reader(content);
    let (mut model, mut is_trackmate) = (Model::default(), false);
    // The spot whose text is being read.
    let mut open: Option<(Spot, String)> = None;
    loop {
        let position = reader.buffer_position();
        let event = reader.read_event().map_err(|source| PolygonError::Xml { position, source })?;
        match event {
            Event::Eof => break,
            Event::Start(start) if name_of(&start) == "Spot" => open = spot(&start)?.map(|spot| (spot, String::new())),
            Event::Empty(start) if name_of(&start) == "Spot" => model.spots.extend(spot(&start)?),
            Event::Start(start) | Event::Empty(start) => {
                is_trackmate |= name_of(&start) == "TrackMate";
                model.take(&start)?;
            }
            Event::Text(text) => {
                if let Some((_, content)) = &mut open {
                    content.push_str(&text.xml10_content());
                }
            }
            Event::End(_) => {
                if let Some((mut spot, text)) = open.take() {
                    let values = text.split_ascii_whitespace().map(|value| number("Spot", "its outline", value));
                    spot.outline = values.collect::<Result<_, _>>()?;
                    model.spots.push(spot);
                }
            }
            _ => {}
        }
    }
    if is_trackmate { Ok(model) } else { Err(PolygonError::Unknown) }
}

impl Model {
    fn take(&mut self, start: &BytesStart<'_>) -> Result<(), PolygonError> {
        match name_of(start) {
            "Model" => {
                let unit = attribute(start, "timeunits").unwrap_or_default();
                self.second = seconds(&unit);
            }
            "Track" => {
                let id = attribute(start, "TRACK_ID").ok_or(missing("Track", "TRACK_ID"))?;
                let name = attribute(start, "name").filter(|name| !name.trim().is_empty());
                let name = name.map_or_else(|| format!("Track_{id}"), |name| name.trim().to_owned());
                checked_name(&name)?;
                self.tracks.push(Track { name, id, edges: Vec::new() });
            }
            "Edge" => {
                let end = |name| attribute(start, name).ok_or(missing("Edge", name));
                let edge = (end("SPOT_SOURCE_ID")?, end("SPOT_TARGET_ID")?);
                if let Some(track) = self.tracks.last_mut() {
                    track.edges.push(edge);
                }
            }
            "FilteredTracks" => {
                self.shown.get_or_insert_default();
            }
            "TrackID" => {
                let id = attribute(start, "TRACK_ID").ok_or(missing("TrackID", "TRACK_ID"))?;
                self.shown.get_or_insert_default().insert(id);
            }
            "ImageData" => {
                let value = |name| attribute(start, name).map(|text| number("ImageData", name, &text)).transpose();
                self.height = value("height")?.unwrap_or(0.0) * value("pixelheight")?.unwrap_or(1.0);
            }
            _ => {}
        }
        Ok(())
    }
}

/// `None` for a spot that is filtered out.
fn spot(start: &BytesStart<'_>) -> Result<Option<Spot>, PolygonError> {
    let text = |name| attribute(start, name).ok_or(missing("Spot", name));
    let value = |name| number("Spot", name, &text(name)?);
    if attribute(start, "VISIBILITY").is_some_and(|visibility| visibility.trim() == "0") {
        return Ok(None);
    }
    let frame = value("FRAME")?;
    if !(frame >= 0.0 && frame.fract() == 0.0) {
        return Err(PolygonError::NotANumber { element: "Spot", attribute: "FRAME", text: frame.to_string() });
    }
    let centre = Point2::new(value("POSITION_X")?, value("POSITION_Y")?);
    let time = value("POSITION_T")?;
    Ok(Some(Spot { id: text("ID")?, frame: frame as u64, time, centre, outline: Vec::new() }))
}

/// Seconds in a unit of time.
fn seconds(unit: &str) -> Option<f64> {
    match unit.trim().to_ascii_lowercase().as_str() {
        "s" | "sec" | "secs" | "second" | "seconds" => Some(1.0),
        "ms" | "msec" | "millisecond" | "milliseconds" => Some(1e-3),
        "us" | "usec" | "\u{b5}s" | "microseconds" => Some(1e-6),
        "min" | "mins" | "minute" | "minutes" => Some(60.0),
        "h" | "hr" | "hour" | "hours" => Some(3600.0),
        _ => None,
    }
}

fn missing(element: &'static str, attribute: &'static str) -> PolygonError {
    PolygonError::Missing { element, attribute }
}

fn number(element: &'static str, attribute: &'static str, text: &str) -> Result<f64, PolygonError> {
    let value = text.trim().parse().ok().filter(|value: &f64| value.is_finite());
    value.ok_or_else(|| PolygonError::NotANumber { element, attribute, text: quoted_start(text.as_bytes()) })
}

fn name_of<'a>(start: &'a BytesStart<'_>) -> &'a str {
    start.name().into_inner()
}

fn attribute(start: &BytesStart<'_>, name: &str) -> Option<String> {
    let attribute = start.try_get_attribute(name).ok().flatten()?;
    attribute.normalized_value(quick_xml::XmlVersion::Implicit1_0).ok().map(std::borrow::Cow::into_owned)
}
