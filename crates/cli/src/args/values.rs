//! Parsers of the values of options.
use std::path::PathBuf;

use freeform_motion::Rectification;
use freeform_motion::curve_fit::Degree;
use freeform_motion::riccati::{AffineMotion, CameraScale, ProjectiveMotion, RigidMotion, SimilarityMotion};
use nalgebra::{Matrix3, Point2, Projective2};

/// Most threads that may be asked for.
const MOST_THREADS: usize = 1024;

/// A finite number.
pub(crate) fn finite(text: &str) -> Result<f64, String> {
    let value: f64 = text.trim().parse().map_err(|_| format!("{text:?} is not a number"))?;
    if value.is_finite() { Ok(value) } else { Err(format!("{text:?} is not a finite number")) }
}

/// A finite number above 0.
pub(crate) fn positive(text: &str) -> Result<f64, String> {
    let value = finite(text)?;
    if value > 0.0 && value.is_normal() { Ok(value) } else { Err(format!("{text} is not above 0")) }
}

/// The scale f/Z0 of a camera.
pub(crate) fn camera_scale(text: &str) -> Result<CameraScale, String> {
    CameraScale::new(positive(text)?).map_err(|error| error.to_string())
}

/// The length of an experiment in seconds, at least 1.
pub(crate) fn run_length(text: &str) -> Result<f64, String> {
    let value = positive(text)?;
    if value >= 1.0 {
        Ok(value)
    } else {
        Err(format!("{text} s are too short to identify a motion from, at least 1 is needed"))
    }
}

/// A finite number, 0 or above.
pub(crate) fn not_negative(text: &str) -> Result<f64, String> {
    let value = finite(text)?;
    if value >= 0.0 { Ok(value) } else { Err(format!("{text} is below 0")) }
}

/// A share of a whole, below 1.
pub(crate) fn fraction(text: &str) -> Result<f64, String> {
    let value = finite(text)?;
    if (0.0..1.0).contains(&value) { Ok(value) } else { Err(format!("{text} is not in [0, 1)")) }
}

/// A whole number, 1 or above.
pub(crate) fn at_least_one(text: &str) -> Result<usize, String> {
    let count: usize = text.trim().parse().map_err(|_| format!("{text:?} is not a whole number"))?;
    if count >= 1 { Ok(count) } else { Err(format!("{text} is below 1")) }
}

/// A number of threads that a machine can have.
pub(crate) fn thread_count(text: &str) -> Result<usize, String> {
    let count = at_least_one(text)?;
    if count <= MOST_THREADS { Ok(count) } else { Err(format!("more than {MOST_THREADS} threads")) }
}

/// A number of frames that can show a motion.
pub(crate) fn frame_count(text: &str) -> Result<usize, String> {
    let count = at_least_one(text)?;
    if count >= 2 { Ok(count) } else { Err("a motion needs at least 2 frames".to_owned()) }
}

/// Numbers between commas.
pub(super) fn list(text: &str) -> Result<Vec<f64>, String> {
    text.split(',').map(finite).collect()
}

/// As many numbers as there are names, such as `VX,VY`.
pub(crate) fn numbers<const N: usize>(
    names: &'static str,
) -> impl Fn(&str) -> Result<[f64; N], String> + Clone + Send + Sync + 'static {
    move |text| {
        let list = list(text)?;
        let count = list.len();
        list.try_into().map_err(|_| format!("expected {names}, found {count} number(s)"))
    }
}

/// A length that is not negative.
pub(crate) fn length(text: &str) -> Result<f64, String> {
    let value = finite(text)?;
    if value >= 0.0 { Ok(value) } else { Err(format!("{text} is negative")) }
}

/// A share of a whole, up to all of it.
pub(crate) fn share(text: &str) -> Result<f64, String> {
    let value = finite(text)?;
    if (0.0..=1.0).contains(&value) { Ok(value) } else { Err(format!("{text} is not in [0, 1]")) }
}

/// `B1,B2`.
pub(crate) fn pair(text: &str) -> Result<[f64; 2], String> {
    numbers("B1,B2")(text)
}

/// `A1,A2,A3,A4,B1,B2`.
pub(crate) fn affine(text: &str) -> Result<AffineMotion, String> {
    let [a1, a2, a3, a4, b1, b2] = numbers("A1,A2,A3,A4,B1,B2")(text)?;
    Ok(AffineMotion { a1, a2, a3, a4, b1, b2 })
}

/// `A1,A2,A3,A4,B1,B2,C1,C2`.
pub(crate) fn projective(text: &str) -> Result<ProjectiveMotion, String> {
    let [a1, a2, a3, a4, b1, b2, c1, c2] = numbers("A1,A2,A3,A4,B1,B2,C1,C2")(text)?;
    Ok(ProjectiveMotion { a1, a2, a3, a4, b1, b2, c1, c2 })
}

/// The parameters of a rigid, similarity, affine or projective motion.
pub(crate) fn motion(text: &str) -> Result<ProjectiveMotion, String> {
    match list(text)?[..] {
        [omega, b1, b2] => Ok(RigidMotion { omega, b1, b2 }.into()),
        [sigma, omega, b1, b2] => Ok(SimilarityMotion { sigma, omega, b1, b2 }.into()),
        [a1, a2, a3, a4, b1, b2] => Ok(AffineMotion { a1, a2, a3, a4, b1, b2 }.into()),
        [a1, a2, a3, a4, b1, b2, c1, c2] => Ok(ProjectiveMotion { a1, a2, a3, a4, b1, b2, c1, c2 }),
        ref other => Err(format!(
            "expected OMEGA,B1,B2 or SIGMA,OMEGA,B1,B2 or A1,...,A4,B1,B2 or A1,...,B2,C1,C2, found {} number(s)",
            other.len()
        )),
    }
}

/// A map from the picture to a plane, and the file that it was read from, if it was.
#[derive(Debug, Clone)]
pub(crate) struct GivenRectification {
    pub(crate) map: Rectification,
    pub(crate) file: Option<PathBuf>,
}

/// A map from the picture to a plane: nine numbers row by row, or a file with them, lines that begin with # left out.
pub(crate) fn rectification(text: &str) -> Result<GivenRectification, String> {
    let (numbers, file) = match list(text) {
        Ok(numbers) => (numbers, None),
        Err(_) => {
            let content = std::fs::read_to_string(text).map_err(|error| format!("{text}: {error}"))?;
            let lines = content.lines().map(|line| line.split('#').next().unwrap_or_default());
            let fields = lines.flat_map(|line| line.split(|c: char| c == ',' || c.is_whitespace()));
            let numbers = fields.filter(|field| !field.is_empty()).map(finite);
            let numbers = numbers.collect::<Result<_, _>>().map_err(|error| format!("{text}: {error}"))?;
            (numbers, Some(PathBuf::from(text)))
        }
    };
    let count = numbers.len();
    let entries: [f64; 9] = numbers.try_into().map_err(|_| format!("expected nine numbers, found {count}"))?;
    let map = Projective2::from_matrix_unchecked(Matrix3::from_row_slice(&entries));
    let map = Rectification::new(&map).map_err(|error| error.to_string())?;
    Ok(GivenRectification { map, file })
}

/// `X,Y=U,V`: a point of a picture, and the same point in a plane.
pub(crate) fn point_pair(text: &str) -> Result<(Point2<f64>, Point2<f64>), String> {
    let expected = || format!("expected X,Y=U,V, found {text:?}");
    let (picture, plane) = text.split_once('=').ok_or_else(expected)?;
    let point = |text: &str| {
        let [x, y]: [f64; 2] = list(text)?.try_into().map_err(|_| expected())?;
        Ok::<_, String>(Point2::new(x, y))
    };
    Ok((point(picture)?, point(plane)?))
}

/// 2, 4, 6 or 8.
pub(crate) fn degree(text: &str) -> Result<Degree, String> {
    let number = text.trim().parse::<usize>().ok();
    let degree = number.and_then(|number| Degree::try_from(number).ok());
    degree.ok_or_else(|| "the degree is one of 2, 4, 6, 8".to_owned())
}
