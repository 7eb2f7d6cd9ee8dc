//! Polygons as labelme has them: one JSON file for every picture.
use nalgebra::Point2;
use serde::Deserialize;
use serde::de::IgnoredAny;
use serde_json::Value;

use crate::picture_file::natural_order::natural_order;
use crate::polygon_file::bodies::{Bodies, Body};
use crate::polygon_file::error::PolygonError;

/// What tells shapes of one label apart.
const REMEDY: &str = "give bodies labels of their own, or the contours of one body the same group_id";

/// The parts of a file that are read.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct LabelmeFile {
    shapes: Vec<Shape>,
    image_path: Option<String>,
    #[serde(default)]
    image_height: Option<f64>,
}

#[derive(Debug, Deserialize)]
struct Shape {
    label: String,
    points: Vec<[f64; 2]>,
    group_id: Option<Value>,
    shape_type: Option<String>,
}

/// Whether a file has the part of labelme.
#[derive(Debug, Deserialize)]
struct Parts {
    shapes: Option<IgnoredAny>,
}

impl LabelmeFile {
    /// `None` for other JSON.
    pub(crate) fn parse(content: &[u8]) -> Result<Option<Self>, serde_json::Error> {
        match serde_json::from_slice(content)? {
            Parts { shapes: Some(_) } => serde_json::from_slice(content).map(Some),
            Parts { shapes: None } => Ok(None),
        }
    }
}

/// The bodies of files, whose order is that of the names of their pictures. Polygons of one label and group are contours of one body;
/// other shapes are left out.
pub(crate) fn labelme_bodies(mut files: Vec<(&str, LabelmeFile)>) -> Result<Bodies, (String, PolygonError)> {
    let picture = |name: &str, file: &LabelmeFile| file.image_path.clone().unwrap_or_else(|| name.to_owned());
    files.sort_by(|(a, file_a), (b, file_b)| natural_order(&picture(a, file_a), &picture(b, file_b)));
    let mut list: Vec<Body> = Vec::new();
    for (frame, (name, file)) in (0..).zip(files) {
        let first = list.len();
        let mut groups: Vec<Option<String>> = Vec::new();
        for shape in file.shapes.iter().filter(|shape| shape.shape_type.as_deref().is_none_or(|kind| kind == "polygon"))
        {
            let group = shape.group_id.as_ref().filter(|group| !group.is_null()).map(ToString::to_string);
            let label = shape.label.trim();
            let points = shape.points.iter().map(|[x, y]| Point2::new(*x, *y)).collect();
            let object = match &group {
                Some(group) => format!("{label}-{group}"),
                None => label.to_owned(),
            };
            let same = list[first..].iter().position(|body| body.object == object);
            match same {
                Some(position) if group.is_some() && groups[position] == group => {
                    list[first + position].contours.push(points);
                }
                Some(_) => {
                    let picture = picture(name, &file);
                    return Err((name.to_owned(), PolygonError::SameName { object, picture, remedy: REMEDY }));
                }
                None => {
                    let height = file.image_height.unwrap_or(0.0);
                    list.push(Body { object, frame, time: None, height, contours: vec![points] });
                    groups.push(group);
                }
            }
        }
    }
    Ok(Bodies { list, remedy: REMEDY })
}
