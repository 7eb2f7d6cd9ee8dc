//! The player of a report: the frames of an object as data, and the elements that show them.
use std::fmt::Write as _;
use std::rc::Rc;

use freeform_motion::curve_fit::Rectangle;
use freeform_motion::outline_filter::KnownPiece;
use freeform_motion::riccati::MotionModel;
use freeform_motion::tracker::ObjectPhase;
use freeform_motion::{short, significant, with_deviation};
use nalgebra::{Matrix3, Point2};
use serde::Serialize;

use super::meaning_of_b::MeaningOfB;
use crate::history::{Playback, PlayedFrame};
use crate::plot::escape;

/// What plays them.
const SCRIPT: &str = include_str!("player.js");

/// Units along the longer side of what is seen.
const UNITS: f64 = 16_000.0;

/// What is seen around the outlines, as a share of their extent.
const SURROUNDINGS: f64 = 0.06;

/// A player of one object.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Player<'a> {
    /// Counted over the page.
    pub(crate) number: usize,
    pub(crate) object: &'a str,
    pub(crate) playback: &'a Playback,
    /// Frames of the object in all.
    pub(crate) frames: usize,
    pub(crate) model: MotionModel,
    pub(crate) b: &'a MeaningOfB,
}

#[derive(Serialize)]
struct Data {
    /// Width and height of what is seen.
    size: [i64; 2],
    /// The outlines as they were known, each where it was in the first frame.
    known: Vec<Vec<Vec<i64>>>,
    frames: Vec<FrameData>,
}

/// One frame. A line is a list of numbers: 1 where it is closed, else 0; its first point; then the steps from point to point.
#[derive(Serialize)]
struct FrameData {
    frame: u64,
    #[serde(skip_serializing_if = "Option::is_none")]
    time: Option<f64>,
    segment: usize,
    phase: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    rejected: Option<String>,
    points: Vec<Vec<i64>>,
    /// Number of the known outline, and the map that places it, row by row.
    #[serde(skip_serializing_if = "Option::is_none")]
    known: Option<(usize, Vec<f64>)>,
    /// Runs of points of the known outline that the frame does not show: first and number.
    hidden: Vec<[usize; 2]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    middle: Option<[i64; 2]>,
    /// Value and standard deviation of every parameter as text; empty where it is not stated.
    values: Vec<[String; 2]>,
}

/// From coordinates of the outlines to those of the player.
struct View {
    low: Point2<f64>,
    high: Point2<f64>,
    units: f64,
}

impl View {
    fn of(frames: &[&PlayedFrame]) -> Option<Self> {
        let outlines: Vec<Point2<f64>> =
            frames.iter().flat_map(|frame| frame.outline.iter().flat_map(|piece| &piece.points)).copied().collect();
        let middles = frames.iter().filter(|frame| frame.rejection.is_none()).filter_map(|frame| frame.middle.as_ref());
        let area = Rectangle::around(outlines.iter().chain(middles).filter(|p| p.iter().all(|c| c.is_finite())))?;
        let Rectangle { low, high } = area.widened(SURROUNDINGS);
        let units = UNITS / (high - low).amax();
        units.is_normal().then_some(Self { low, high, units })
    }

    fn size(&self) -> [i64; 2] {
        [0, 1].map(|axis| (self.units * (self.high[axis] - self.low[axis])).ceil() as i64)
    }

    /// y runs downwards there.
    fn map(&self) -> Matrix3<f64> {
        let s = self.units;
        Matrix3::new(s, 0.0, -s * self.low.x, 0.0, -s, s * self.high.y, 0.0, 0.0, 1.0)
    }

    fn point(&self, p: &Point2<f64>) -> [i64; 2] {
        [(self.units * (p.x - self.low.x)).round() as i64, (self.units * (self.high.y - p.y)).round() as i64]
    }

    fn line(&self, piece: &KnownPiece) -> Vec<i64> {
        let mut line = vec![i64::from(piece.closed)];
        let mut last = [0, 0];
        for point in piece.points.iter().map(|p| self.point(p)) {
            line.extend([point[0].saturating_sub(last[0]), point[1].saturating_sub(last[1])]);
            last = point;
        }
        line
    }
}

impl Player<'_> {
    /// Writes it; the script that plays all of them is [`write_script`]. Nothing is written where there is nothing to see.
    pub(crate) fn write(&self, body: &mut String) -> bool {
        let frames: Vec<&PlayedFrame> = self.playback.frames().iter().map(|kept| &kept.value).collect();
        let Some(view) = View::of(&frames).filter(|_| frames.len() > 1) else { return false };
        let data = self.data(&frames, &view);
        let Ok(json) = serde_json::to_string(&data) else { return false };
        // No name or reason ends the element that the data stand in.
        let json = json.replace('<', "\\u003c");
        let (number, last) = (self.number, frames.len() - 1);
        let [width, height] = view.size();
        let object = escape(self.object);
        let _ = write!(
            body,
            "<div class=\"player\" id=\"player{number}\" role=\"group\" aria-label=\"Object {object}, frame by frame\">\n\
             <svg class=\"stage\" viewBox=\"0 0 {width} {height}\" role=\"img\" aria-label=\"The outline in the frame shown\">\
             <path class=\"way\"/><path class=\"travelled\"/><path class=\"hidden\"/><path class=\"known\"/>\
             <path class=\"points\"/><path class=\"middle\"/></svg>\n\
             <div class=\"controls\"><button type=\"button\" class=\"play\">Play</button>\
             <div class=\"track\"><input type=\"range\" min=\"0\" max=\"{last}\" value=\"0\" step=\"1\" aria-label=\"Frame\">\
             <svg class=\"marks\" viewBox=\"0 0 {last} 1\" preserveAspectRatio=\"none\" aria-hidden=\"true\"><path/></svg></div>\
             <button type=\"button\" class=\"zoom\" aria-pressed=\"false\">Follow closely</button></div>\n\
             <p class=\"now\"></p>\n<noscript><p class=\"alert\">The player needs JavaScript.</p></noscript>\n"
        );
        self.write_values(body);
        body.push_str(LEGEND);
        let _ = writeln!(body, "<p class=\"soft\">{}</p>", self.told(frames.len(), &view));
        let _ = writeln!(body, "<script type=\"application/json\">{json}</script>\n</div>");
        true
    }

    fn write_values(&self, body: &mut String) {
        body.push_str("<div class=\"scroll\"><table class=\"values\">\n<tr><th>parameter</th><th>value</th><th>std</th><th>unit</th></tr>\n");
        let names = self.model.parameter_names().iter().zip(self.model.units()).zip(self.model.parameter_kinds());
        for ((name, unit), kind) in names {
            let unit = self.b.unit_of(*kind, unit);
            let _ = writeln!(body, "<tr><td>{name}</td><td></td><td></td><td>{unit}</td></tr>");
        }
        body.push_str("</table></div>\n");
    }

    /// What is shown of it, and what is not.
    fn told(&self, shown: usize, view: &View) -> String {
        let mut told = "Keys: left and right for a frame, space to play, home and end.".to_owned();
        let every = self.playback.every();
        if every > 1 {
            let _ = write!(told, " Of {} frames every {} is shown, {shown} in all.", self.frames, ordinal(every));
        }
        if self.playback.is_thinned_along {
            told.push_str(" Of long outlines some of the points are shown.");
        }
        let width = significant(view.high.x - view.low.x, 3);
        let _ = match self.b.length_unit() {
            "lengths" => write!(
                told,
                " The part shown, with what surrounds the outlines, is {width} wide in the unit of the coordinates."
            ),
            unit => write!(told, " The part shown, with what surrounds the outlines, is {width} {unit} wide."),
        };
        told
    }

    fn data(&self, frames: &[&PlayedFrame], view: &View) -> Data {
        let map = view.map();
        let back = map.try_inverse().unwrap_or_else(Matrix3::identity);
        let mut known: Vec<&Rc<Vec<KnownPiece>>> = Vec::new();
        let played = frames.iter().map(|frame| {
            let placed = frame.known.as_ref().map(|now| {
                if known.last().is_none_or(|last| !Rc::ptr_eq(last, &now.pieces)) {
                    known.push(&now.pieces);
                }
                (known.len() - 1, numbers(&(map * now.pose * back)))
            });
            let is_used = frame.rejection.is_none();
            let hidden = frame.known.as_ref().filter(|_| is_used).map_or_else(Vec::new, |now| hidden_runs(&now.seen));
            FrameData {
                frame: frame.frame,
                time: frame.time.map(rounded),
                segment: frame.segment,
                phase: frame.phase.map_or("", ObjectPhase::name),
                rejected: frame.rejection.clone(),
                points: frame.outline.iter().map(|piece| view.line(piece)).collect(),
                known: placed.filter(|(_, map)| map.iter().all(|entry| entry.is_finite())),
                hidden,
                middle: frame.middle.map(|middle| view.point(&middle)),
                values: self.values(frame),
            }
        });
        let played = played.collect();
        let known = known.iter().map(|pieces| pieces.iter().map(|piece| view.line(piece)).collect()).collect();
        Data { size: view.size(), known, frames: played }
    }

    fn values(&self, frame: &PlayedFrame) -> Vec<[String; 2]> {
        let Some(estimate) = &frame.estimate else { return vec![Default::default(); self.model.parameter_count()] };
        let parameters = estimate.parameters();
        parameters
            .map(|p| match (p.value, p.standard_deviation) {
                (Some(value), Some(deviation)) => with_deviation(value, deviation),
                (Some(value), None) => [short(value), String::new()],
                (None, _) => Default::default(),
            })
            .collect()
    }
}

/// What the lines of a player are.
const LEGEND: &str = "<ul class=\"legend\">\
<li><svg viewBox=\"0 0 24 10\" aria-hidden=\"true\"><path class=\"points\" d=\"M4 5h0M12 5h0M20 5h0\"/></svg>points of the outline</li>\
<li><svg viewBox=\"0 0 24 10\" aria-hidden=\"true\"><path class=\"known\" d=\"M1 5h22\"/></svg>what is known of it</li>\
<li><svg viewBox=\"0 0 24 10\" aria-hidden=\"true\"><path class=\"hidden\" d=\"M1 5h22\"/></svg>known, not seen in this frame</li>\
<li><svg viewBox=\"0 0 24 10\" aria-hidden=\"true\"><path class=\"travelled\" d=\"M1 5h22\"/><path class=\"middle\" d=\"M23 5h0\"/></svg>path of the middle</li>\
<li><svg viewBox=\"0 0 24 10\" aria-hidden=\"true\"><path class=\"points rejected\" d=\"M4 5h0M12 5h0M20 5h0\"/></svg>frame not used</li>\
</ul>\n";

/// The script of all players of a page.
pub(crate) fn write_script(body: &mut String) {
    let _ = writeln!(body, "<script>\n{SCRIPT}</script>");
}

/// The entries of a map row by row, to what a player can show; only the first six of an affine one.
fn numbers(map: &Matrix3<f64>) -> Vec<f64> {
    let map = map / map[(2, 2)];
    let is_affine = map[(2, 0)] == 0.0 && map[(2, 1)] == 0.0;
    let rows = if is_affine { 2 } else { 3 };
    (0..rows).flat_map(|row| (0..3).map(move |column| (row, column))).map(|place| rounded(map[place])).collect()
}

/// A number to seven digits, which its text then has no more of.
fn rounded(value: f64) -> f64 {
    format!("{value:.6e}").parse().unwrap_or(value)
}

/// Runs of points that are not seen: the first of each and its length.
fn hidden_runs(seen: &[bool]) -> Vec<[usize; 2]> {
    let mut runs: Vec<[usize; 2]> = Vec::new();
    for index in (0..seen.len()).filter(|index| !seen[*index]) {
        match runs.last_mut().filter(|[first, count]| first + count == index) {
            Some([_, count]) => *count += 1,
            None => runs.push([index, 1]),
        }
    }
    runs
}

fn ordinal(number: usize) -> String {
    match number {
        2 => "second".to_owned(),
        number => format!("{number}th"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_of_points_that_are_not_seen_are_the_first_and_their_number() {
        let seen = [false, false, true, false, true, true, false];
        assert_eq!(hidden_runs(&seen), [[0, 2], [3, 1], [6, 1]]);
        assert_eq!(hidden_runs(&[true; 4]), [[0_usize; 2]; 0]);
    }

    #[test]
    fn lines_are_their_first_point_and_the_steps_from_it_with_y_downwards() {
        let view = View { low: Point2::new(-1.0, -1.0), high: Point2::new(3.0, 1.0), units: 100.0 };
        let piece = KnownPiece { points: vec![Point2::new(0.0, 1.0), Point2::new(1.0, 0.5)], closed: false };
        assert_eq!((view.size(), view.line(&piece)), ([400, 200], vec![0, 100, 0, 100, 50]));
        let placed = view.map() * Point2::new(1.0, 0.5).to_homogeneous();
        assert_eq!((placed.x, placed.y), (200.0, 50.0));
    }
}
