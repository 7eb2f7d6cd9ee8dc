//! The map from a picture to a plane, from an outline that is known in the plane and is seen at rest in the picture.
use freeform_curve_fit::{AreaMoments, ClosedOutline, Outline, evenly_spaced, share_along_side};
use freeform_riccati::{MotionModel, map_point, pull_back};
use nalgebra::{Affine2, Matrix3, Point2, Projective2, Rotation2, SMatrix, SVector, Vector2};

use crate::regular_map::is_regular;

/// Turns that a fit is begun with, all around.
const STARTS: u32 = 24;
/// Points seen, and points of the known outline, that starts are told apart by.
const COARSE: usize = 120;
/// Most points of the known outline; far more than noise lets be told.
const KNOWN_POINTS: usize = 800;
/// Most points seen, of all frames.
const SEEN_POINTS: usize = 1000;
/// An outline of fewer points is taken for a polygon.
const FEWEST_SEEN: usize = 200;
/// Steps of a coarse and of a fine fit, and the step that is the last.
const STEPS: [usize; 2] = [40, 30];
const SETTLED: f64 = 1e-10;
/// Longest step: beyond, the nearest places are others.
const LONGEST_STEP: f64 = 0.3;
/// Largest difference of the entries of two maps that are one.
const SAME_MAP: f64 = 0.05;
/// Coarse fits that are made finer.
const REFINED: usize = 4;
/// Residuals of so many medians count a quarter.
const ROBUST_MEDIANS: f64 = 3.0;
/// Smallest scale of the residuals: below, rounding decides.
const ROUNDING: f64 = 1e-9;
/// Keeps maps that the outline does not tell from growing, per point.
const DAMPING: f64 = 1e-9;
/// Root mean square distance, in radii of the disc with the inertia of the outline, beyond which another object is seen: half of what one
/// in twenty pairs of different outlines are apart (docs/recognition.md).
const ANOTHER: f64 = 0.05;
/// Mean square by which the outline moves per unit of the direction that it shows least, below which that is not told: a circle, as a
/// polygon of 400 corners, has 2e-5.
const OPEN: f64 = 1e-4;
/// A second map that fits no worse than this many times the best is as good as that...
const AS_GOOD: f64 = 1.5;
/// ...and another plane if it changes distances by more than this share of the size of the outline.
const ANOTHER_PLANE: f64 = 0.02;
/// Cosine of the angle to the normal of a side above which a point lies beside the side and not beside its corner.
const SQUARE: f64 = 1.0 - 1e-9;
/// Places that distances are compared between.
const COMPARED: usize = 12;

/// Why an outline tells no map to its plane.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum PlaneByOutlineError {
    /// No outline was given as seen.
    #[error("no outline is seen")]
    NothingSeen,
    /// Open arcs.
    #[error("a part of the outline is hidden")]
    NotWhole,
    /// The outline encloses as much area one way round as the other, or crosses itself.
    #[error("the outline encloses no region")]
    NoRegion,
    /// What is seen is something else.
    #[error("what is seen is not the known outline: the nearest view of it is off by {distance:.3} of its radius")]
    AnotherOutline {
        /// Root mean square, in radii of the disc with the inertia of the outline.
        distance: f64,
    },
    /// Many views look alike.
    #[error("the outline leaves the map open: a circle or an ellipse, for example, is seen alike from many places")]
    Undetermined,
    /// Two planes explain what is seen, as for a rectangle whose sides may be taken for each other.
    #[error(
        "two planes explain what is seen, as for a rectangle, whose sides may be taken for each other: give four points"
    )]
    TwoPlanes,
}

/// A map from a picture to a plane, told by an outline.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaneByOutline {
    /// On homogeneous coordinates; the last entry is 1.
    pub plane_from_picture: Projective2<f64>,
    /// Root mean square distance of the points seen from the known outline, in the lengths of the plane.
    pub distance: f64,
}

/// Finds the map from a picture to the plane of an object from its outline, known in the lengths of the plane, and one or more outlines of
/// the object at rest in the picture.
///
/// The squared distances of all points seen from the known outline, in the picture, are made least over all projective maps that
/// keep the orientation: coordinates of picture and plane both have to be right-handed, or both left-handed. Points further off than most count for
/// less. Of an outline that a turn takes to itself, any of the turns is given, which leaves all lengths of the plane as they are. Of
/// outlines with holes the outer boundary is compared.
///
/// ```
/// use freeform_motion::{Rectification, curve_fit::Outline, plane_by_outline, sim_camera::BuiltInShape};
/// use nalgebra::{Matrix3, Projective2};
///
/// let known = Outline::closed(BuiltInShape::Van.shape().sample(300, 0.0))?;
/// // As a camera sees it that looks at the plane from aside.
/// let picture_from_plane = Matrix3::new(900.0, 0.0, 1920.0, 0.0, 450.0, 1080.0, 0.0, 0.8, 3.0);
/// let view = Projective2::from_matrix_unchecked(picture_from_plane);
/// let seen = Outline::closed(BuiltInShape::Van.shape().sample(300, 0.001))?.mapped(|p| view * p)?;
/// let found = plane_by_outline(&known, &[seen])?;
/// let corner = found.plane_from_picture * (view * nalgebra::Point2::new(0.4, 0.2));
/// assert!((corner - nalgebra::Point2::new(0.4, 0.2)).norm() < 1e-3);
/// let _ = Rectification::new(&found.plane_from_picture)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// An outline that is not whole, something else than the known outline, and outlines that leave the map open.
pub fn plane_by_outline(known: &Outline, seen: &[Outline]) -> Result<PlaneByOutline, PlaneByOutlineError> {
    let first = seen.first().ok_or(PlaneByOutlineError::NothingSeen)?;
    let (plane_from_inertia, picture_from_inertia) = (inertia(known)?, inertia(first)?);
    let corners = placed(whole(known)?, &plane_from_inertia);
    let known = if corners.len() > KNOWN_POINTS { evenly_spaced(&corners, KNOWN_POINTS) } else { corners };
    let polygon = placed(whole(first)?, &picture_from_inertia);
    let mut points = Vec::new();
    for outline in seen {
        let seen = placed(whole(outline)?, &picture_from_inertia);
        // Of a polygon the sides tell as much as the corners.
        points.extend(if seen.len() < FEWEST_SEEN { evenly_spaced(&seen, FEWEST_SEEN) } else { seen });
    }
    let views = Views { known, polygon };
    let mut fits = views.coarse();
    fits.truncate(REFINED);
    let every = points.len().div_ceil(SEEN_POINTS);
    let points: Vec<_> = points.into_iter().step_by(every).collect();
    let mut fits: Vec<View> =
        fits.iter().filter_map(|view| views.fit(&views.known, &points, view.map, STEPS[1])).collect();
    fits.sort_by(|a, b| a.distance.total_cmp(&b.distance));
    let Some(best) = fits.first() else { return Err(PlaneByOutlineError::AnotherOutline { distance: f64::INFINITY }) };
    if best.distance > ANOTHER {
        return Err(PlaneByOutlineError::AnotherOutline { distance: best.distance });
    }
    if best.least_shown < OPEN {
        return Err(PlaneByOutlineError::Undetermined);
    }
    let as_good = fits.iter().filter(|view| view.distance <= AS_GOOD * best.distance + ROUNDING);
    if { as_good }.any(|view| views.is_another_plane(best, view, &plane_from_inertia)) {
        return Err(PlaneByOutlineError::TwoPlanes);
    }
    let back = picture_from_inertia.inverse();
    let map = plane_from_inertia.matrix() * best.map * back.matrix();
    let squares = points.iter().map(|p| {
        let q = map_point(&best.map, p);
        (plane_from_inertia * q - plane_from_inertia * foot(&views.known, &q).0).norm_squared()
    });
    let distance = (squares.sum::<f64>() / points.len() as f64).sqrt();
    Ok(PlaneByOutline { plane_from_picture: Projective2::from_matrix_unchecked(map / map[(2, 2)]), distance })
}

fn whole(outline: &Outline) -> Result<&ClosedOutline, PlaneByOutlineError> {
    match outline {
        Outline::Closed(closed) => Ok(closed),
        Outline::Open(_) => Err(PlaneByOutlineError::NotWhole),
    }
}

/// From coordinates in which an outline has the inertia of the unit disc.
fn inertia(outline: &Outline) -> Result<Affine2<f64>, PlaneByOutlineError> {
    let moments = AreaMoments::of(whole(outline)?).ok_or(PlaneByOutlineError::NoRegion)?;
    Ok(moments.image_from_inertia_circle())
}

fn placed(outline: &ClosedOutline, from_inertia: &Affine2<f64>) -> Vec<Point2<f64>> {
    let back = from_inertia.inverse();
    outline.points().iter().map(|p| back * p).collect()
}

/// The known outline and that of the first frame, both where they have the inertia of the unit disc.
struct Views {
    known: Vec<Point2<f64>>,
    polygon: Vec<Point2<f64>>,
}

/// A map from what is seen to what is known, in the coordinates of [`Views`].
struct View {
    map: Matrix3<f64>,
    /// Root mean square distance of both outlines from each other, where they are seen.
    distance: f64,
    /// Smallest mean square by which points move, per unit of any direction of the map.
    least_shown: f64,
}

type Matrix8 = SMatrix<f64, 8, 8>;
type Vector8 = SVector<f64, 8>;

/// The family of all views of a plane.
const VIEWS: MotionModel = MotionModel::Projective;

impl Views {
    /// Best first, from turns all around.
    fn coarse(&self) -> Vec<View> {
        let thin = |polygon: &[Point2<f64>]| evenly_spaced(polygon, COARSE);
        let (known, points) = (thin(&self.known), thin(&self.polygon));
        let starts = (0..STARTS).map(|i| {
            let turn = std::f64::consts::TAU * f64::from(i) / f64::from(STARTS);
            Rotation2::new(turn).to_homogeneous()
        });
        let mut fits: Vec<View> = starts.filter_map(|start| self.fit(&known, &points, start, STEPS[0])).collect();
        fits.sort_by(|a, b| a.distance.total_cmp(&b.distance));
        // Each of them once.
        let mut different: Vec<View> = Vec::new();
        for fit in fits {
            if !different.iter().any(|other| (fit.map - other.map).amax() < SAME_MAP) {
                different.push(fit);
            }
        }
        different
    }

    /// Iterated closest points: each step brings the points seen onto the lines through the places of the known outline nearest to them, by
    /// least squares of the distances in the picture.
    fn fit(&self, known: &[Point2<f64>], points: &[Point2<f64>], start: Matrix3<f64>, steps: usize) -> Option<View> {
        let mut map = start;
        let mut information = Matrix8::zeros();
        for _ in 0..steps {
            let mut rows = Vec::with_capacity(points.len());
            for p in points {
                let q = map_point(&map, p);
                let (place, normal) = foot(known, &q);
                // What a step in the picture is in the plane.
                let stretch = pull_back(&map, p, &q, &normal).norm();
                let distance = normal.dot(&(q - place)) / stretch;
                rows.push((Vector8::from(VIEWS.normal_velocities(&place, &normal)) / stretch, distance));
            }
            let mut sizes: Vec<f64> = rows.iter().map(|(_, distance)| distance.abs()).collect();
            let middle = sizes.len() / 2;
            let median = *sizes.select_nth_unstable_by(middle, f64::total_cmp).1;
            let scale = (ROBUST_MEDIANS * median).max(ROUNDING);
            information = Matrix8::identity() * (DAMPING * points.len() as f64);
            let mut right = Vector8::zeros();
            for (row, distance) in &rows {
                let weight = (1.0 + (distance / scale).powi(2)).powi(-2);
                information.ger(weight, row, row, 1.0);
                right.axpy(-weight * distance, row, 1.0);
            }
            let step = information.cholesky()?.solve(&right);
            let step = step * (LONGEST_STEP / step.norm()).min(1.0);
            map = VIEWS.flow(step.as_slice(), 1.0).into_inner() * map;
            map /= map[(2, 2)];
            if !is_regular(&map) {
                return None;
            }
            if step.amax() < SETTLED {
                break;
            }
        }
        let distance = self.distance(known, points, &map)?;
        let least_shown = information.symmetric_eigenvalues().min() / points.len() as f64;
        Some(View { map, distance, least_shown })
    }

    /// Both ways, so that neither a part that is missing nor one that is too many goes unseen. `None` where the map takes a part beyond the
    /// horizon or turns the outline over.
    fn distance(&self, known: &[Point2<f64>], points: &[Point2<f64>], map: &Matrix3<f64>) -> Option<f64> {
        let back = map.try_inverse()?;
        let is_before = |map: &Matrix3<f64>, p: &Point2<f64>| (map.row(2) * p.to_homogeneous())[0] > 0.0;
        let back = back / back[(2, 2)];
        let is_view = map.determinant() > 0.0
            && points.iter().all(|p| is_before(map, p))
            && known.iter().all(|q| is_before(&back, q));
        if !is_view {
            return None;
        }
        let seen = points.iter().map(|p| (p - map_point(&back, &foot(known, &map_point(map, p)).0)).norm_squared());
        let seen = seen.sum::<f64>() / points.len() as f64;
        let places = evenly_spaced(known, COARSE);
        let missed = places.iter().map(|q| {
            let p = map_point(&back, q);
            (p - foot(&self.polygon, &p).0).norm_squared()
        });
        let missed = missed.sum::<f64>() / places.len() as f64;
        let distance = (0.5 * (seen + missed)).sqrt();
        distance.is_finite().then_some(distance)
    }

    /// Whether lengths in the plane are others by another view.
    fn is_another_plane(&self, best: &View, other: &View, plane_from_inertia: &Affine2<f64>) -> bool {
        let Some(back) = best.map.try_inverse() else { return true };
        let change = other.map * back;
        let places = evenly_spaced(&self.known, COMPARED);
        let before: Vec<_> = places.iter().map(|q| plane_from_inertia * q).collect();
        let after: Vec<_> = places.iter().map(|q| plane_from_inertia * map_point(&change, q)).collect();
        let pairs = || (0..COMPARED).flat_map(|i| (0..i).map(move |j| (i, j)));
        let largest = pairs().map(|(i, j)| (before[i] - before[j]).norm()).fold(0.0, f64::max);
        pairs().any(|(i, j)| {
            let off = (after[i] - after[j]).norm() - (before[i] - before[j]).norm();
            off.abs() > ANOTHER_PLANE * largest
        })
    }
}

/// The place of a closed polygon that is nearest to a point, and the normal there.
fn foot(polygon: &[Point2<f64>], p: &Point2<f64>) -> (Point2<f64>, Vector2<f64>) {
    let [x, y] = <[f64; 2]>::from(*p);
    let mut best = (f64::INFINITY, [x, y], [1.0, 0.0]);
    // Plain numbers: most of the search for a plane is spent here.
    let mut compare = |from: &Point2<f64>, to: &Point2<f64>| {
        let share = share_along_side(from, to, p);
        let (along_x, along_y) = (to.x - from.x, to.y - from.y);
        let (foot_x, foot_y) = (from.x + share * along_x, from.y + share * along_y);
        let square = (x - foot_x) * (x - foot_x) + (y - foot_y) * (y - foot_y);
        if square < best.0 {
            best = (square, [foot_x, foot_y], [along_x, along_y]);
        }
    };
    for side in polygon.windows(2) {
        compare(&side[0], &side[1]);
    }
    if let [first, .., last] = polygon {
        compare(last, first);
    }
    let (foot, along) = (Point2::from(best.1), Vector2::from(best.2));
    let across = Vector2::new(along.y, -along.x).try_normalize(0.0).unwrap_or_else(Vector2::x);
    let off = p - foot;
    // Beside a corner the distance is that from the corner.
    let is_beside = off.norm() * SQUARE < off.dot(&across).abs();
    let normal = if is_beside { across } else { off.try_normalize(0.0).unwrap_or(across) };
    (foot, normal)
}
