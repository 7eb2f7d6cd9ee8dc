//! Polygons as COCO has them: one JSON file with images, annotations and categories.
use std::collections::HashMap;

use serde::Deserialize;
use serde::de::IgnoredAny;
use serde_json::Value;

use crate::picture_file::natural_order::natural_order;
use crate::polygon_file::bodies::{Bodies, Body, checked_name, points_of};
use crate::polygon_file::error::PolygonError;

/// What tells annotations of one category apart.
const REMEDY: &str = "give annotations a track_id, or one body a picture and category";

/// The parts of a file that are read.
#[derive(Debug, Deserialize)]
pub(crate) struct CocoFile {
    images: Vec<Image>,
    annotations: Vec<Annotation>,
    #[serde(default)]
    categories: Vec<Category>,
}

#[derive(Debug, Deserialize)]
struct Image {
    id: Value,
    #[serde(default)]
    file_name: String,
    #[serde(default)]
    height: f64,
    /// Of datasets of videos.
    frame_id: Option<u64>,
    video_id: Option<Value>,
}

#[derive(Debug, Deserialize)]
struct Annotation {
    #[serde(default)]
    id: Value,
    image_id: Value,
    #[serde(default)]
    category_id: Value,
    segmentation: Option<Segmentation>,
    track_id: Option<Value>,
    instance_id: Option<Value>,
    attributes: Option<Attributes>,
}

/// Where CVAT keeps the track.
#[derive(Debug, Deserialize)]
struct Attributes {
    track_id: Option<Value>,
}

#[derive(Debug, Deserialize)]
#[serde(untagged)]
enum Segmentation {
    Polygons(Vec<Vec<f64>>),
    Other(IgnoredAny),
}

#[derive(Debug, Deserialize)]
struct Category {
    id: Value,
    name: String,
}

/// Whether a file has the parts of COCO.
#[derive(Debug, Deserialize)]
struct Parts {
    images: Option<IgnoredAny>,
    annotations: Option<IgnoredAny>,
}

impl CocoFile {
    /// `None` for other JSON.
    pub(crate) fn parse(content: &[u8]) -> Result<Option<Self>, serde_json::Error> {
        match serde_json::from_slice(content)? {
            Parts { images: Some(_), annotations: Some(_) } => serde_json::from_slice(content).map(Some),
            Parts { .. } => Ok(None),
        }
    }
}

/// A body for every annotation. Frames are numbered by `frame_id` where every image has one, else by the names of the files in natural
/// order. Bodies are named by their tracks, else by their categories.
pub(crate) fn coco_bodies(file: CocoFile) -> Result<Bodies, PolygonError> {
    let CocoFile { mut images, annotations, categories } = file;
    let videos: Vec<String> = images.iter().filter_map(|image| image.video_id.as_ref()).map(text).collect();
    if let [first, rest @ ..] = &videos[..]
        && let Some(second) = rest.iter().find(|video| *video != first)
    {
        return Err(PolygonError::SeveralVideos { first: first.clone(), second: second.clone() });
    }
    images.sort_by(|a, b| natural_order(&a.file_name, &b.file_name));
    let are_numbered = images.iter().all(|image| image.frame_id.is_some());
    let frames: HashMap<String, (u64, f64)> = (0..)
        .zip(&images)
        .map(|(position, image)| {
            let frame = image.frame_id.filter(|_| are_numbered).unwrap_or(position);
            (text(&image.id), (frame, image.height))
        })
        .collect();
    let named = |category: &'_ Category| Ok((text(&category.id), checked_name(category.name.trim())?.to_owned()));
    let names: HashMap<String, String> = categories.iter().map(named).collect::<Result<_, PolygonError>>()?;
    let list = annotations.into_iter().map(|annotation| body(annotation, &frames, &names)).collect::<Result<_, _>>()?;
    Ok(Bodies { list, remedy: REMEDY })
}

fn body(
    annotation: Annotation,
    frames: &HashMap<String, (u64, f64)>,
    names: &HashMap<String, String>,
) -> Result<Body, PolygonError> {
    let Annotation { id, image_id, category_id, segmentation, track_id, instance_id, attributes } = annotation;
    let item = || format!("annotation {}", text(&id));
    let image = text(&image_id);
    let Some(&(frame, height)) = frames.get(&image) else {
        return Err(PolygonError::NoImage { annotation: text(&id), image });
    };
    let polygons = match segmentation {
        Some(Segmentation::Polygons(polygons)) if !polygons.is_empty() => polygons,
        Some(Segmentation::Other(_)) => return Err(PolygonError::RunLength { annotation: text(&id) }),
        _ => return Err(PolygonError::NoPolygon { item: item() }),
    };
    let contours = polygons.iter().map(|polygon| points_of(polygon, item)).collect::<Result<_, _>>()?;
    let track = track_id.or(instance_id).or(attributes.and_then(|attributes| attributes.track_id));
    let track = track.filter(|track| !track.is_null());
    let category = text(&category_id);
    let object = track.map_or_else(|| names.get(&category).unwrap_or(&category).clone(), |track| text(&track));
    Ok(Body { object, frame, time: None, height, contours })
}

/// A number or text as text.
fn text(value: &Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), |text| text.trim().to_owned())
}
