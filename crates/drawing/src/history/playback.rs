//! The frames of an object as they are played in a report.
use std::rc::Rc;

use freeform_motion::curve_fit::Outline;
use freeform_motion::estimate::MotionEstimate;
use freeform_motion::outline_filter::{KnownOutline, KnownPiece};
use freeform_motion::riccati::map_point;
use freeform_motion::tracker::{ObjectPhase, Observation};
use nalgebra::{Matrix3, Point2};

use super::thinned::{Kept, Thinned};

/// Most points of an outline in one frame.
const POINTS_OF_OUTLINE: usize = 160;

/// What a frame takes room for besides the points of its outline, in points: its values, and why it was not used.
const ROOM_OF_FRAME: usize = 40;

/// A known outline is that of the frame before as long as no point of it has moved by more than this share of its size.
const SAME: f64 = 0.003;

/// The frames of one object, as many as there is room for.
#[derive(Debug, Default)]
pub(crate) struct Playback {
    frames: Thinned<PlayedFrame>,
    /// Points of the frames kept.
    points: usize,
    latest_known: Option<Rc<Vec<KnownPiece>>>,
    /// Whether an outline has more points than are kept of it.
    pub(crate) is_thinned_along: bool,
}

/// One frame.
#[derive(Debug)]
pub(crate) struct PlayedFrame {
    pub(crate) frame: u64,
    /// In seconds; `None` where the points are no outline.
    pub(crate) time: Option<f64>,
    /// Counted up from 0 where poses get another reference, as where the object was begun anew: `TrajectoryRow::segment` has all causes.
    pub(crate) segment: usize,
    pub(crate) phase: Option<ObjectPhase>,
    /// Why it was not used, if it was not.
    pub(crate) rejection: Option<String>,
    /// Points of the outline.
    pub(crate) outline: Vec<KnownPiece>,
    /// Points that the outline has in all.
    pub(crate) point_count: usize,
    /// Standard deviation of their noise, if it was found.
    pub(crate) noise: Option<f64>,
    pub(crate) known: Option<KnownInFrame>,
    /// Where the middle of the object is.
    pub(crate) middle: Option<Point2<f64>>,
    pub(crate) estimate: Option<MotionEstimate>,
}

/// What is known of an outline in a frame.
#[derive(Debug)]
pub(crate) struct KnownInFrame {
    /// Where it was in the first frame.
    pub(crate) pieces: Rc<Vec<KnownPiece>>,
    /// From there to where it is.
    pub(crate) pose: Matrix3<f64>,
    /// Which of its points the frame shows, piece by piece.
    pub(crate) seen: Vec<bool>,
}

impl KnownInFrame {
    /// The pieces in their present place, with which of their points the frame shows.
    pub(crate) fn placed(&self) -> impl Iterator<Item = (Vec<Point2<f64>>, bool, &[bool])> {
        let mut seen = &self.seen[..];
        self.pieces.iter().map(move |piece| {
            let (here, rest) = seen.split_at(piece.points.len());
            seen = rest;
            (piece.points.iter().map(|p| map_point(&self.pose, p)).collect(), piece.closed, here)
        })
    }
}

impl Playback {
    /// The frames kept, in order.
    pub(crate) fn frames(&self) -> &[Kept<PlayedFrame>] {
        self.frames.kept()
    }

    /// Of so many frames the first is kept.
    pub(crate) fn every(&self) -> usize {
        self.frames.every()
    }

    /// Adds a frame with its outline, in the coordinates of the poses.
    pub(crate) fn take(&mut self, observation: &Observation, outline: Option<&Outline>) {
        self.is_thinned_along |= outline.is_some_and(|outline| outline.point_count() > POINTS_OF_OUTLINE);
        if !self.frames.keeps_next() {
            return self.frames.pass();
        }
        let (state, is_lost) = (observation.present_state(), observation.phase == Some(ObjectPhase::Lost));
        let known = observation.known_outline.as_ref().filter(|_| !is_lost);
        let known = known.map(|known| self.known_in_frame(known, outline, observation));
        let middle = match state {
            Some(state) => {
                let pose = state.pose_parameters();
                let coordinate = |name| pose.iter().find(|p| p.name == name).map(|p| p.value);
                coordinate("x").zip(coordinate("y")).map(|(x, y)| Point2::new(x, y))
            }
            // The adaptive method has no pose.
            None => outline.filter(|_| observation.fit.is_some()).map(Outline::centroid),
        };
        let frame = PlayedFrame {
            frame: observation.frame,
            time: observation.time,
            segment: observation.segment,
            phase: observation.phase,
            rejection: observation.rejection.as_ref().map(|rejection| rejection.cause.to_string()),
            outline: outline.map_or_else(Vec::new, |outline| {
                let pieces = outline.pieces().map(|piece| (piece.points, piece.closed));
                thinned(pieces, outline.point_count())
            }),
            point_count: outline.map_or(0, Outline::point_count),
            noise: observation.residual,
            known,
            middle,
            estimate: observation.estimate,
        };
        self.points += points_of(&frame, self.frames.kept().last().map(|kept| &kept.value));
        self.frames.push(frame);
    }

    /// Keeps no more points than so many, by leaving out frames.
    pub(crate) fn keep_points(&mut self, most: usize) {
        while self.points > most && self.frames.kept().len() > 2 {
            self.frames.halve();
            let mut before = None;
            self.points = 0;
            for kept in self.frames.kept() {
                self.points += points_of(&kept.value, before);
                before = Some(&kept.value);
            }
        }
    }

    fn known_in_frame(
        &mut self,
        known: &KnownOutline,
        outline: Option<&Outline>,
        observation: &Observation,
    ) -> KnownInFrame {
        let count = known.pieces.iter().map(|piece| piece.points.len()).sum();
        let pieces = thinned(known.pieces.iter().map(|piece| (&piece.points[..], piece.closed)), count);
        let pieces = match self.latest_known.take().filter(|latest| is_same(latest, &pieces)) {
            Some(latest) => latest,
            None => Rc::new(pieces),
        };
        self.latest_known = Some(Rc::clone(&pieces));
        let pose = *known.pose.matrix();
        let noise = observation.residual.unwrap_or(0.0);
        let seen = outline.filter(|_| observation.is_accepted()).map_or_else(Vec::new, |outline| {
            let observed: Vec<Point2<f64>> = outline.points().copied().collect();
            let step = longest_step(outline.pieces().map(|piece| (piece.points, piece.closed)));
            pieces
                .iter()
                .flat_map(|piece| {
                    let placed: Vec<Point2<f64>> = piece.points.iter().map(|p| map_point(&pose, p)).collect();
                    let reach = step.max(longest_step(std::iter::once((&placed[..], piece.closed)))) + 4.0 * noise;
                    let is_near = |p: &Point2<f64>| observed.iter().any(|q| (p - q).norm_squared() <= reach * reach);
                    placed.iter().map(is_near).collect::<Vec<bool>>()
                })
                .collect()
        });
        let seen =
            if seen.is_empty() { vec![false; pieces.iter().map(|piece| piece.points.len()).sum()] } else { seen };
        KnownInFrame { pieces, pose, seen }
    }
}

/// Points that a frame takes room for, the known outline only if it is not that of the frame before.
fn points_of(frame: &PlayedFrame, before: Option<&PlayedFrame>) -> usize {
    let outline: usize = frame.outline.iter().map(|piece| piece.points.len()).sum();
    let latest = before.and_then(|before| before.known.as_ref());
    let of_known = |known: &KnownInFrame| {
        let is_old = latest.is_some_and(|latest| Rc::ptr_eq(&latest.pieces, &known.pieces));
        if is_old { 0 } else { known.seen.len() }
    };
    ROOM_OF_FRAME + outline + frame.known.as_ref().map_or(0, of_known)
}

/// Pieces of so many points together with fewer of them, evenly spread.
fn thinned<'a>(pieces: impl Iterator<Item = (&'a [Point2<f64>], bool)>, count: usize) -> Vec<KnownPiece> {
    let every = count.div_ceil(POINTS_OF_OUTLINE).max(1);
    let thin = |(points, closed): (&[Point2<f64>], bool)| {
        let mut kept: Vec<Point2<f64>> = points.iter().step_by(every).copied().collect();
        // An arc keeps its end.
        kept.extend(points.last().filter(|_| !closed && !(points.len() - 1).is_multiple_of(every)));
        KnownPiece { points: kept, closed }
    };
    pieces.filter(|(points, _)| !points.is_empty()).map(thin).collect()
}

/// The 0.9 quantile of the distances of neighbours, so that a gap or two do not count.
fn longest_step<'a>(pieces: impl Iterator<Item = (&'a [Point2<f64>], bool)>) -> f64 {
    let mut steps: Vec<f64> =
        pieces.flat_map(|(points, _)| points.windows(2).map(|pair| (pair[1] - pair[0]).norm())).collect();
    let place = steps.len() * 9 / 10;
    if steps.is_empty() { 0.0 } else { *steps.select_nth_unstable_by(place, f64::total_cmp).1 }
}

fn is_same(a: &[KnownPiece], b: &[KnownPiece]) -> bool {
    let is_alike =
        a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.points.len() == b.points.len() && a.closed == b.closed);
    let points = |pieces: &[KnownPiece]| pieces.iter().flat_map(|piece| &piece.points).copied().collect::<Vec<_>>();
    let (a, b) = (points(a), points(b));
    let size = a.iter().map(|p| (p - a[0]).norm()).fold(0.0, f64::max);
    is_alike && a.iter().zip(&b).all(|(a, b)| (a - b).norm() <= SAME * size)
}
