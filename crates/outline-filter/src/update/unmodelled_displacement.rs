//! How far motions that the model leaves out displace the cells of an outline.
use freeform_riccati::{MotionModel, map_point};
use nalgebra::{Matrix2, Matrix3, Point2, SMatrix, SVector, Vector2};

use crate::{
    belief::Belief,
    map::{Cell, OutlineMap},
};

/// Number of motions that may be left out.
pub(crate) const UNMODELLED: usize = 11;

/// Their numbers: the object grows or shrinks about its centroid.
pub(crate) const GROWTH: usize = 0;
/// Stretch and skew of the picture.
pub(crate) const SHEAR: [usize; 2] = [1, 2];
pub(crate) const PERSPECTIVE: [usize; 2] = [3, 4];
/// Rows that are read one after the other.
pub(crate) const READ_OUT: usize = 5;
/// A lens: outwards from the origin, and what that becomes where its middle is elsewhere.
pub(crate) const LENS: [usize; 3] = [6, 7, 8];
/// Edges that are displaced by the direction they face, as light and shadows displace them. Of a displacement `max(0, n . l)` the
/// harmonics of even order are left beside a shift: here the second of the angle of the normal n in the image.
pub(crate) const EDGES: [usize; 2] = [9, 10];
/// The fourth harmonic. Beside a model that has growth and shear it takes the numbers of growth and of the rolling shutter, which is a shear.
pub(crate) const FOURTH_OF_EDGES: [usize; 2] = [GROWTH, READ_OUT];

pub(crate) type UnmodelledVector = SVector<f64, UNMODELLED>;
pub(crate) type UnmodelledMatrix = SMatrix<f64, UNMODELLED, UNMODELLED>;

/// How a model leaves motions out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum LeftOut {
    /// All of them.
    All,
    /// All but growth.
    AllButGrowth,
    /// All but growth, shear, and what a rolling shutter does, which is a shear.
    AllButLinear,
}

impl LeftOut {
    /// `None` of a model beside which nothing is looked for.
    fn by(model: MotionModel) -> Option<Self> {
        match model {
            MotionModel::Rigid => Some(Self::All),
            MotionModel::Similarity => Some(Self::AllButGrowth),
            MotionModel::Affine => Some(Self::AllButLinear),
            MotionModel::Projective => None,
        }
    }
}

/// A pose and motion that displacements are taken at.
#[derive(Debug, Clone, Copy)]
pub(super) struct Instant {
    pose: Matrix3<f64>,
    /// Transposed inverse of the linear part: normals of the body to those of the image, not normalised.
    of_normals: Matrix2<f64>,
    /// Of the object, in the image.
    centroid: Point2<f64>,
    generator: Matrix3<f64>,
    elapsed: f64,
    left_out: LeftOut,
}

impl Instant {
    /// `elapsed` is the time since the first frame. `None` where nothing is looked for, or the pose has collapsed.
    pub(super) fn new(belief: &Belief, pose: &Matrix3<f64>, map: &OutlineMap, elapsed: f64) -> Option<Self> {
        let left_out = LeftOut::by(belief.model)?;
        let linear = pose.fixed_view::<2, 2>(0, 0).into_owned();
        if linear.determinant() <= 0.0 {
            return None;
        }
        Some(Self {
            pose: *pose,
            of_normals: linear.try_inverse()?.transpose(),
            centroid: map_point(pose, &map.centroid()),
            generator: belief.model.generator(&belief.motion[..belief.parameter_count()]),
            elapsed,
            left_out,
        })
    }

    /// Displacement of a cell along its normal in the body frame by a unit of each motion, and how far an error of the pose moves it.
    #[inline(always)]
    pub(super) fn displacement(&self, cell: &Cell) -> ([f64; UNMODELLED], Point2<f64>, Vector2<f64>) {
        let p = map_point(&self.pose, &cell.centre);
        // A step of the image along n moves the body point by as much along the normal of the cell.
        let n = self.of_normals * cell.normal;
        let along = n.dot(&p.coords);
        // A row is seen later the further down it is; the outline has moved on meanwhile.
        let g = &self.generator;
        let velocity = Vector2::new(g.m11 * p.x + g.m12 * p.y + g.m13, g.m21 * p.x + g.m22 * p.y + g.m23);
        let square = p.coords.norm_squared();
        let [second, fourth] = displacements_of_edges(&n);
        let mut all = [
            self.elapsed * n.dot(&(p - self.centroid)),
            n.x * p.x - n.y * p.y,
            n.x * p.y + n.y * p.x,
            p.x * along,
            p.y * along,
            p.y * (n.x * velocity.x + n.y * velocity.y),
            square * along,
            2.0 * p.x * along + square * n.x,
            2.0 * p.y * along + square * n.y,
            second[0],
            second[1],
        ];
        match self.left_out {
            LeftOut::All => {}
            LeftOut::AllButGrowth => all[GROWTH] = 0.0,
            LeftOut::AllButLinear => {
                SHEAR.into_iter().for_each(|number| all[number] = 0.0);
                FOURTH_OF_EDGES.into_iter().zip(fourth).for_each(|(number, displacement)| all[number] = displacement);
            }
        }
        (all, p, n)
    }
}

/// How far a unit of each motion that a picture has displaces a point p of it, as [`Instant::displacement`] has it along a normal, and how fast that
/// changes as the point moves with velocity v. None of growth, and of what edges and rows do: where those put an object is not where it is.
pub(crate) fn displacement_in_picture(p: &Vector2<f64>, v: &Vector2<f64>) -> [[Vector2<f64>; 2]; UNMODELLED] {
    let (square, of_square) = (p.norm_squared(), 2.0 * p.dot(v));
    let [along_x, along_y] = [p.x * p, p.y * p];
    let [of_x, of_y] = [v.x * p + p.x * v, v.y * p + p.y * v];
    let mut all = [[Vector2::zeros(); 2]; UNMODELLED];
    all[SHEAR[0]] = [Vector2::new(p.x, -p.y), Vector2::new(v.x, -v.y)];
    all[SHEAR[1]] = [Vector2::new(p.y, p.x), Vector2::new(v.y, v.x)];
    all[PERSPECTIVE[0]] = [along_x, of_x];
    all[PERSPECTIVE[1]] = [along_y, of_y];
    all[LENS[0]] = [square * p, of_square * p + square * v];
    all[LENS[1]] = [2.0 * along_x + Vector2::new(square, 0.0), 2.0 * of_x + Vector2::new(of_square, 0.0)];
    all[LENS[2]] = [2.0 * along_y + Vector2::new(0.0, square), 2.0 * of_y + Vector2::new(0.0, of_square)];
    all
}

/// Of unit displacements by the cosine and sine of twice and of four times the angle of the normal.
#[inline(always)]
fn displacements_of_edges(n: &Vector2<f64>) -> [[f64; 2]; 2] {
    // A unit along the unit normal is as many along n as n is long.
    let size = n.norm();
    let [cos, sin] = [(n.x * n.x - n.y * n.y) / (size * size), 2.0 * n.x * n.y / (size * size)];
    [[cos, sin], [cos * cos - sin * sin, 2.0 * cos * sin]].map(|harmonic| harmonic.map(|h| size * h))
}
